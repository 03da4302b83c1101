/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of ur5e_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of ur5e_law.c. x' is
 * exact at every node and u' a backward difference, so that no damping makes it unstable. The force is
 * quadratic between nodes; steps are halved where it bends too much for that.
 */
#include "ur5e_state.h"

/*
 * Halley's iterations, and the relative change after which the next, a fourth of its cube, is nothing. A guess is
 * off by a factor of 1.7 at most, which iterations take to 1.09, 1.0002 and 1: the root of the step before where
 * its depth is within DEPTH_OFF, or else one made of square roots, 1.1 times the root where body and skin are as human
 * ones, 1.7 times for a cubic light of 1e11. Five square roots in a row take as long as the rest of a step.
 */
#define ITERATIONS 3
#define CLOSE UR5E_R(0.01)
#define DEPTH_OFF UR5E_R(2.8)
/* Steps of one length after which the next is as the last was. */
#define LIKE 3
/* Parts of a step between which a law through points is looked at. */
#define PLACES 4

void ur5e_glide(const ur5e_state *s, ur5e_trial *t)
{
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    const ur5e_real *rate = s->rate;
    ur5e_real damped[UR5E_MODES];
    if (phase->damped) {
        ur5e_damp_ahead(s, damped);
        rate = damped;
    }
    ur5e_real x = s->drifted + s->drift*level->h;
    ur5e_real v = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_mode_step *const step = &level->mode[i];
        const ur5e_real a = s->amplitude[i];
        const ur5e_real b = rate[i];
        t->amplitude[i] = step->cosine*a + step->sine*b;
        t->rate[i] = step->back*a + step->cosine*b;
        x += phase->modes.row[i]*t->amplitude[i];
        v += phase->modes.row[i]*t->rate[i];
    }
    t->x = x;
    t->v = v;
}

/* The root of u^2 + cubic u^3 = depth > 0; near a guess, or else anywhere. */
static ur5e_real root_of(ur5e_real depth, ur5e_real cubic, ur5e_real guess)
{
    const ur5e_real guessed = guess*guess*(UR5E_R(1.0) + cubic*guess);
    ur5e_real u = guess;
    if (!(DEPTH_OFF*guessed > depth && guessed < DEPTH_OFF*depth)) {
        const ur5e_real light = UR5E_SQRT(depth);
        const ur5e_real fourth = UR5E_SQRT(UR5E_SQRT(UR5E_R(1.0) + cubic*light));
        u = light/(fourth*UR5E_SQRT(UR5E_SQRT(fourth))); /* never below the root, as 5/16 < 1/3 < 1/2 */
    }
    for (int i = 0; i < ITERATIONS; ++i) {
        const ur5e_real bend = UR5E_R(1.0) + UR5E_R(3.0)*cubic*u;
        const ur5e_real slope = u*(UR5E_R(1.0) + bend);
        const ur5e_real over = u*u*(UR5E_R(1.0) + cubic*u) - depth;
        const ur5e_real change = over*slope/(slope*slope - over*bend);
        u -= change;
        if (UR5E_FABS(change) <= CLOSE*u) {
            break;
        }
    }
    return u;
}

/* What steps of one length have in common, as far as those before them were as long. */
static void set_pace(ur5e_state *s)
{
    const ur5e_region *const region = s->impact->region;
    const ur5e_level *const level = s->step;
    const ur5e_real one = UR5E_R(1.0);
    ur5e_pace *const pace = &s->pace;
    ur5e_real ratio = UR5E_R(0.0);
    ur5e_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    pace->before = UR5E_R(0.0);
    if (s->past > 0) {
        ratio = level->h/s->h;
        if (s->past > 1) {
            const ur5e_real lead = (UR5E_R(0.5)*level->h + s->h)/(level->h + s->h + s->h_before);
            more += lead;
            pace->before = lead*ratio*ratio;
        }
    }
    const ur5e_real rate = level->per;
    const ur5e_real early = ratio/(one + ratio);
    pace->ratio = ratio;
    pace->share = early/UR5E_R(6.0);
    pace->more = more;
    const ur5e_real lag = (one + early)*rate;
    pace->u = (one + ratio)*rate;
    pace->u_before = ratio*early*rate;
    const ur5e_real share = pace->share*more;
    pace->yields = level->late - share*level->push;
    const ur5e_real slows = level->push*rate - share*level->kick;
    pace->hold = region->stiffness + region->damping*lag;
    pace->soft = one + region->stiffness*pace->yields + region->damping*slows + pace->hold*s->phase->compliance;
}

void ur5e_press(ur5e_state *s, ur5e_trial *t)
{
    const ur5e_region *const region = s->impact->region;
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    const ur5e_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const ur5e_real plain = pace->share*(s->f + pace->ratio*s->rise);
    t->share = pace->more*pace->share;
    t->base = pace->more*plain - pace->before*s->bump;
    const ur5e_real first = s->f + t->base;
    const ur5e_real x = t->x - level->push*first + level->late*s->f; /* a force that falls to its base */
    const ur5e_real v = t->v - level->kick*first + level->push*level->per*s->f;
    const ur5e_real slip = v + pace->u*s->u - pace->u_before*s->u_before; /* less what u' gains by u */
    const ur5e_real pressed = region->stiffness*x + region->damping*slip;
    t->root = UR5E_R(0.0);
    if (pressed > UR5E_R(0.0)) {
        if (region->law == NULL) {
            const ur5e_real per = UR5E_R(1.0)/pace->hold;
            t->root = root_of(pressed*per, region->hertz_stiffness*pace->soft*per, s->root);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->f = ur5e_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + phase->compliance*t->f;
        t->x = x - pace->yields*t->f;
        t->bump = plain - pace->share*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const ur5e_real from = pace->hold*s->now + pace->soft*s->f;
        t->base = from > UR5E_R(0.0) ? UR5E_R(0.5)*s->f*pressed/(from - pressed) : UR5E_R(0.0);
        t->share = UR5E_R(0.0);
        t->x -= level->push*(s->f + t->base) - level->late*s->f;
        t->bump = UR5E_R(0.0);
        t->f = UR5E_R(0.0);
        t->u = UR5E_R(0.0);
        t->depth = UR5E_R(0.0);
    }
}

void ur5e_take(const ur5e_trial *t, ur5e_state *s)
{
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    const ur5e_real first = s->f + t->base - t->share*t->f;
    const ur5e_real rise = t->f - s->f;
    const ur5e_real slope = rise*level->per;
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push*first - step->late*rise;
        s->rate[i] = t->rate[i] - phase->modes.row[i]*step->sine*first - step->push*slope;
    }
}

ur5e_real ur5e_force_between(const ur5e_state *s, const ur5e_trial *t)
{
    const ur5e_region *const region = s->impact->region;
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    const ur5e_real h = level->h;
    const ur5e_real first = s->f + t->base - t->share*t->f;
    const ur5e_real after = h*(t->v - level->kick*first) - level->push*(t->f - s->f);
    ur5e_real before = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        before += phase->modes.row[i]*s->rate[i];
    }
    before *= h;
    ur5e_real most = UR5E_R(0.0);
    for (int k = 1; k < PLACES; ++k) { /* x is a cubic, the body's own deflection followed at once */
        const ur5e_real share = (ur5e_real)k/(ur5e_real)PLACES;
        const ur5e_real left = UR5E_R(1.0) - share;
        const ur5e_real even = s->x + share*share*(UR5E_R(3.0) - share - share)*(t->x - s->x);
        const ur5e_real x = even + share*left*(left*before - share*after);
        const ur5e_real damper = region->damping/(share*h);
        const ur5e_real hold = region->stiffness + damper;
        const ur5e_real pressed = hold*x - damper*(s->x - s->u);
        const ur5e_real soft = UR5E_R(1.0) + hold*phase->compliance;
        ur5e_real depth;
        if (pressed > UR5E_R(0.0)) {
            most = UR5E_FMAX(most, ur5e_law_press(region, hold, soft, pressed, &depth));
        }
    }
    return most;
}

ur5e_real ur5e_slip_off(const ur5e_state *s, const ur5e_trial *t)
{
    const ur5e_real rate = (t->u - s->u)*s->step->per;
    const ur5e_real before = s->past > 0 ? (s->u - s->u_before)/s->h : rate;
    return s->impact->region->damping*UR5E_FABS(rate - before);
}
