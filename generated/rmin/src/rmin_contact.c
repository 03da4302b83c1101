/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of rmin_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of rmin_law.c. x' is
 * exact at every node and u' a backward difference, so that no damping makes it unstable. The force is
 * quadratic between nodes; steps are halved where it bends too much for that.
 */
#include "rmin_state.h"

/*
 * Halley's iterations, and the relative change after which the next, a fourth of its cube, is nothing. A guess is
 * off by a factor of 1.7 at most, which iterations take to 1.09, 1.0002 and 1: the root of the step before where
 * its depth is within DEPTH_OFF, or else one made of square roots, 1.1 times the root where body and skin are as human
 * ones, 1.7 times for a cubic light of 1e11. Five square roots in a row take as long as the rest of a step.
 */
#define ITERATIONS 3
#define CLOSE RMIN_R(0.01)
#define DEPTH_OFF RMIN_R(2.8)
/* Steps of one length after which the next is as the last was. */
#define LIKE 3
/* Parts of a step between which a law through points is looked at. */
#define PLACES 4

void rmin_glide(const rmin_state *s, rmin_trial *t)
{
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = s->step;
    const rmin_real *rate = s->rate;
    rmin_real damped[RMIN_MODES];
    if (phase->damped) {
        rmin_damp_ahead(s, damped);
        rate = damped;
    }
    rmin_real x = s->drifted + s->drift*level->h;
    rmin_real v = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        const rmin_mode_step *const step = &level->mode[i];
        const rmin_real a = s->amplitude[i];
        const rmin_real b = rate[i];
        t->amplitude[i] = step->cosine*a + step->sine*b;
        t->rate[i] = step->back*a + step->cosine*b;
        x += phase->modes.row[i]*t->amplitude[i];
        v += phase->modes.row[i]*t->rate[i];
    }
    t->x = x;
    t->v = v;
}

/* The root of u^2 + cubic u^3 = depth > 0; near a guess, or else anywhere. */
static rmin_real root_of(rmin_real depth, rmin_real cubic, rmin_real guess)
{
    const rmin_real guessed = guess*guess*(RMIN_R(1.0) + cubic*guess);
    rmin_real u = guess;
    if (!(DEPTH_OFF*guessed > depth && guessed < DEPTH_OFF*depth)) {
        const rmin_real light = RMIN_SQRT(depth);
        const rmin_real fourth = RMIN_SQRT(RMIN_SQRT(RMIN_R(1.0) + cubic*light));
        u = light/(fourth*RMIN_SQRT(RMIN_SQRT(fourth))); /* never below the root, as 5/16 < 1/3 < 1/2 */
    }
    for (int i = 0; i < ITERATIONS; ++i) {
        const rmin_real bend = RMIN_R(1.0) + RMIN_R(3.0)*cubic*u;
        const rmin_real slope = u*(RMIN_R(1.0) + bend);
        const rmin_real over = u*u*(RMIN_R(1.0) + cubic*u) - depth;
        const rmin_real change = over*slope/(slope*slope - over*bend);
        u -= change;
        if (RMIN_FABS(change) <= CLOSE*u) {
            break;
        }
    }
    return u;
}

/* What steps of one length have in common, as far as those before them were as long. */
static void set_pace(rmin_state *s)
{
    const rmin_region *const region = s->impact->region;
    const rmin_level *const level = s->step;
    const rmin_real one = RMIN_R(1.0);
    rmin_pace *const pace = &s->pace;
    rmin_real ratio = RMIN_R(0.0);
    rmin_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    pace->before = RMIN_R(0.0);
    if (s->past > 0) {
        ratio = level->h/s->h;
        if (s->past > 1) {
            const rmin_real lead = (RMIN_R(0.5)*level->h + s->h)/(level->h + s->h + s->h_before);
            more += lead;
            pace->before = lead*ratio*ratio;
        }
    }
    const rmin_real rate = level->per;
    const rmin_real early = ratio/(one + ratio);
    pace->ratio = ratio;
    pace->share = early/RMIN_R(6.0);
    pace->more = more;
    const rmin_real lag = (one + early)*rate;
    pace->u = (one + ratio)*rate;
    pace->u_before = ratio*early*rate;
    const rmin_real share = pace->share*more;
    pace->yields = level->late - share*level->push;
    const rmin_real slows = level->push*rate - share*level->kick;
    pace->hold = region->stiffness + region->damping*lag;
    pace->soft = one + region->stiffness*pace->yields + region->damping*slows + pace->hold*s->phase->compliance;
}

void rmin_press(rmin_state *s, rmin_trial *t)
{
    const rmin_region *const region = s->impact->region;
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = s->step;
    const rmin_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const rmin_real plain = pace->share*(s->f + pace->ratio*s->rise);
    t->share = pace->more*pace->share;
    t->base = pace->more*plain - pace->before*s->bump;
    const rmin_real first = s->f + t->base;
    const rmin_real x = t->x - level->push*first + level->late*s->f; /* a force that falls to its base */
    const rmin_real v = t->v - level->kick*first + level->push*level->per*s->f;
    const rmin_real slip = v + pace->u*s->u - pace->u_before*s->u_before; /* less what u' gains by u */
    const rmin_real pressed = region->stiffness*x + region->damping*slip;
    t->root = RMIN_R(0.0);
    if (pressed > RMIN_R(0.0)) {
        if (region->law == NULL) {
            const rmin_real per = RMIN_R(1.0)/pace->hold;
            t->root = root_of(pressed*per, region->hertz_stiffness*pace->soft*per, s->root);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->f = rmin_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + phase->compliance*t->f;
        t->x = x - pace->yields*t->f;
        t->bump = plain - pace->share*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const rmin_real from = pace->hold*s->now + pace->soft*s->f;
        t->base = from > RMIN_R(0.0) ? RMIN_R(0.5)*s->f*pressed/(from - pressed) : RMIN_R(0.0);
        t->share = RMIN_R(0.0);
        t->x -= level->push*(s->f + t->base) - level->late*s->f;
        t->bump = RMIN_R(0.0);
        t->f = RMIN_R(0.0);
        t->u = RMIN_R(0.0);
        t->depth = RMIN_R(0.0);
    }
}

void rmin_take(const rmin_trial *t, rmin_state *s)
{
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = s->step;
    const rmin_real first = s->f + t->base - t->share*t->f;
    const rmin_real rise = t->f - s->f;
    const rmin_real slope = rise*level->per;
    for (int i = 0; i < phase->active; ++i) {
        const rmin_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push*first - step->late*rise;
        s->rate[i] = t->rate[i] - phase->modes.row[i]*step->sine*first - step->push*slope;
    }
}

rmin_real rmin_force_between(const rmin_state *s, const rmin_trial *t)
{
    const rmin_region *const region = s->impact->region;
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = s->step;
    const rmin_real h = level->h;
    const rmin_real first = s->f + t->base - t->share*t->f;
    const rmin_real after = h*(t->v - level->kick*first) - level->push*(t->f - s->f);
    rmin_real before = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        before += phase->modes.row[i]*s->rate[i];
    }
    before *= h;
    rmin_real most = RMIN_R(0.0);
    for (int k = 1; k < PLACES; ++k) { /* x is a cubic, the body's own deflection followed at once */
        const rmin_real share = (rmin_real)k/(rmin_real)PLACES;
        const rmin_real left = RMIN_R(1.0) - share;
        const rmin_real even = s->x + share*share*(RMIN_R(3.0) - share - share)*(t->x - s->x);
        const rmin_real x = even + share*left*(left*before - share*after);
        const rmin_real damper = region->damping/(share*h);
        const rmin_real hold = region->stiffness + damper;
        const rmin_real pressed = hold*x - damper*(s->x - s->u);
        const rmin_real soft = RMIN_R(1.0) + hold*phase->compliance;
        rmin_real depth;
        if (pressed > RMIN_R(0.0)) {
            most = RMIN_FMAX(most, rmin_law_press(region, hold, soft, pressed, &depth));
        }
    }
    return most;
}

rmin_real rmin_slip_off(const rmin_state *s, const rmin_trial *t)
{
    const rmin_real rate = (t->u - s->u)*s->step->per;
    const rmin_real before = s->past > 0 ? (s->u - s->u_before)/s->h : rate;
    return s->impact->region->damping*RMIN_FABS(rate - before);
}
