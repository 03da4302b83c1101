/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of robot_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of robot_law.c. x' is
 * exact at every node and u' a backward difference, so that no damping makes it unstable. The force is
 * quadratic between nodes; steps are halved where it bends too much for that.
 */
#include "robot_state.h"

/*
 * Halley's iterations, and the relative change after which the next, a fourth of its cube, is nothing. A guess is
 * off by a factor of 1.7 at most, which iterations take to 1.09, 1.0002 and 1: the root of the step before where
 * its depth is within DEPTH_OFF, or else one made of square roots, 1.1 times the root where body and skin are as human
 * ones, 1.7 times for a cubic light of 1e11. Five square roots in a row take as long as the rest of a step.
 */
#define ITERATIONS 3
#define CLOSE ROBOT_R(0.01)
#define DEPTH_OFF ROBOT_R(2.8)
/* Steps of one length after which the next is as the last was. */
#define LIKE 3
/* Parts of a step between which a law through points is looked at. */
#define PLACES 4

void robot_glide(const robot_state *s, robot_trial *t)
{
    const robot_phase *const phase = s->phase;
    const robot_level *const level = s->step;
    const robot_real *rate = s->rate;
    robot_real damped[ROBOT_MODES];
    robot_real v = s->drift;
    if (phase->damped) {
        robot_damp_ahead(s, damped);
        rate = damped;
        v -= robot_owed_slip(s, rate);
    }
    robot_real x = s->drifted + s->drift*level->h;
    for (int i = 0; i < phase->active; ++i) {
        const robot_mode_step *const step = &level->mode[i];
        const robot_real a = s->amplitude[i];
        const robot_real b = rate[i];
        t->amplitude[i] = step->cosine*a + step->sine*b;
        t->rate[i] = step->back*a + step->cosine*b;
        x += phase->modes.row[i]*t->amplitude[i];
        v += phase->modes.row[i]*t->rate[i];
    }
    t->x = x;
    t->v = v;
}

/* The root of u^2 + cubic u^3 = depth > 0; near a guess, or else anywhere. */
static robot_real root_of(robot_real depth, robot_real cubic, robot_real guess)
{
    const robot_real guessed = guess*guess*(ROBOT_R(1.0) + cubic*guess);
    robot_real u = guess;
    if (!(DEPTH_OFF*guessed > depth && guessed < DEPTH_OFF*depth)) {
        const robot_real light = ROBOT_SQRT(depth);
        const robot_real fourth = ROBOT_SQRT(ROBOT_SQRT(ROBOT_R(1.0) + cubic*light));
        u = light/(fourth*ROBOT_SQRT(ROBOT_SQRT(fourth))); /* never below the root, as 5/16 < 1/3 < 1/2 */
    }
    for (int i = 0; i < ITERATIONS; ++i) {
        const robot_real bend = ROBOT_R(1.0) + ROBOT_R(3.0)*cubic*u;
        const robot_real slope = u*(ROBOT_R(1.0) + bend);
        const robot_real over = u*u*(ROBOT_R(1.0) + cubic*u) - depth;
        const robot_real change = over*slope/(slope*slope - over*bend);
        u -= change;
        if (ROBOT_FABS(change) <= CLOSE*u) {
            break;
        }
    }
    return u;
}

/* What steps of one length have in common, as far as those before them were as long. */
static void set_pace(robot_state *s)
{
    const robot_region *const region = s->impact->region;
    const robot_level *const level = s->step;
    const robot_real one = ROBOT_R(1.0);
    robot_pace *const pace = &s->pace;
    robot_real ratio = ROBOT_R(0.0);
    robot_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    pace->before = ROBOT_R(0.0);
    if (s->past > 0) {
        ratio = level->h/s->h;
        if (s->past > 1) {
            const robot_real lead = (ROBOT_R(0.5)*level->h + s->h)/(level->h + s->h + s->h_before);
            more += lead;
            pace->before = lead*ratio*ratio;
        }
    }
    const robot_real rate = level->per;
    const robot_real early = ratio/(one + ratio);
    pace->ratio = ratio;
    pace->share = early/ROBOT_R(6.0);
    pace->more = more;
    const robot_real lag = (one + early)*rate;
    pace->u = (one + ratio)*rate;
    pace->u_before = ratio*early*rate;
    const robot_real share = pace->share*more;
    pace->yields = level->late - share*level->push;
    const robot_real slows = level->grow - share*level->kick;
    pace->hold = region->stiffness + region->damping*lag;
    pace->soft = one + region->stiffness*pace->yields + region->damping*slows + pace->hold*s->phase->compliance;
}

void robot_press(robot_state *s, robot_trial *t)
{
    const robot_region *const region = s->impact->region;
    const robot_phase *const phase = s->phase;
    const robot_level *const level = s->step;
    const robot_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const robot_real plain = pace->share*(s->f + pace->ratio*s->rise);
    t->share = pace->more*pace->share;
    t->base = pace->more*plain - pace->before*s->bump;
    const robot_real first = s->f + t->base;
    const robot_real x = t->x - level->push*first + level->late*s->f; /* a force that falls to its base */
    const robot_real v = t->v - level->kick*first + level->grow*s->f;
    const robot_real slip = v + pace->u*s->u - pace->u_before*s->u_before; /* less what u' gains by u */
    const robot_real pressed = region->stiffness*x + region->damping*slip;
    t->root = ROBOT_R(0.0);
    if (pressed > ROBOT_R(0.0)) {
        if (region->law == NULL) {
            const robot_real per = ROBOT_R(1.0)/pace->hold;
            t->root = root_of(pressed*per, region->hertz_stiffness*pace->soft*per, s->root);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->f = robot_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + phase->compliance*t->f;
        t->x = x - pace->yields*t->f;
        t->bump = plain - pace->share*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const robot_real from = pace->hold*s->now + pace->soft*s->f;
        t->base = from > ROBOT_R(0.0) ? ROBOT_R(0.5)*s->f*pressed/(from - pressed) : ROBOT_R(0.0);
        t->share = ROBOT_R(0.0);
        t->x -= level->push*(s->f + t->base) - level->late*s->f;
        t->bump = ROBOT_R(0.0);
        t->f = ROBOT_R(0.0);
        t->u = ROBOT_R(0.0);
        t->depth = ROBOT_R(0.0);
    }
}

void robot_take(const robot_trial *t, robot_state *s)
{
    const robot_phase *const phase = s->phase;
    const robot_level *const level = s->step;
    const robot_real first = s->f + t->base - t->share*t->f;
    const robot_real rise = t->f - s->f;
    const robot_real slope = rise*level->per;
    for (int i = 0; i < phase->active; ++i) {
        const robot_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push*first - step->late*rise;
        s->rate[i] = t->rate[i] - phase->modes.row[i]*step->sine*first - step->push*slope;
    }
}

robot_real robot_force_between(const robot_state *s, const robot_trial *t)
{
    const robot_region *const region = s->impact->region;
    const robot_phase *const phase = s->phase;
    const robot_level *const level = s->step;
    const robot_real h = level->h;
    const robot_real first = s->f + t->base - t->share*t->f;
    const robot_real after = h*(t->v - level->kick*first - level->grow*(t->f - s->f));
    robot_real before = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        before += phase->modes.row[i]*s->rate[i];
    }
    before *= h;
    robot_real most = ROBOT_R(0.0);
    for (int k = 1; k < PLACES; ++k) { /* x is a cubic, the body's own deflection followed at once */
        const robot_real share = (robot_real)k/(robot_real)PLACES;
        const robot_real left = ROBOT_R(1.0) - share;
        const robot_real even = s->x + share*share*(ROBOT_R(3.0) - share - share)*(t->x - s->x);
        const robot_real x = even + share*left*(left*before - share*after);
        const robot_real damper = region->damping/(share*h);
        const robot_real hold = region->stiffness + damper;
        const robot_real pressed = hold*x - damper*(s->x - s->u);
        const robot_real soft = ROBOT_R(1.0) + hold*phase->compliance;
        robot_real depth;
        if (pressed > ROBOT_R(0.0)) {
            most = ROBOT_FMAX(most, robot_law_press(region, hold, soft, pressed, &depth));
        }
    }
    return most;
}

robot_real robot_slip_off(const robot_state *s, const robot_trial *t)
{
    const robot_real rate = (t->u - s->u)*s->step->per;
    const robot_real before = s->past > 0 ? (s->u - s->u_before)/s->h : rate;
    return s->impact->region->damping*ROBOT_FABS(rate - before);
}
