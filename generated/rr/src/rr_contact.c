/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of rr_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of rr_law.c. x' is
 * exact at every node and u' a backward difference, so that no damping makes it unstable. The force is
 * quadratic between nodes; steps are halved where it bends too much for that.
 */
#include "rr_state.h"

/*
 * Halley's iterations, and the relative change after which the next, a fourth of its cube, is nothing. A guess is
 * off by a factor of 1.7 at most, which iterations take to 1.09, 1.0002 and 1: the root of the step before where
 * its depth is within DEPTH_OFF, or else one made of square roots, 1.1 times the root where body and skin are as human
 * ones, 1.7 times for a cubic light of 1e11. Five square roots in a row take as long as the rest of a step.
 */
#define ITERATIONS 3
#define CLOSE RR_R(0.01)
#define DEPTH_OFF RR_R(2.8)
/* Steps of one length after which the next is as the last was. */
#define LIKE 3
/* Parts of a step between which a law through points is looked at. */
#define PLACES 4

void rr_glide(const rr_state *s, rr_trial *t)
{
    const rr_phase *const phase = s->phase;
    const rr_level *const level = s->step;
    const rr_real *rate = s->rate;
    rr_real damped[RR_MODES];
    if (phase->damped) {
        rr_damp_ahead(s, damped);
        rate = damped;
    }
    rr_real x = s->drifted + s->drift*level->h;
    rr_real v = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        const rr_mode_step *const step = &level->mode[i];
        const rr_real a = s->amplitude[i];
        const rr_real b = rate[i];
        t->amplitude[i] = step->cosine*a + step->sine*b;
        t->rate[i] = step->back*a + step->cosine*b;
        x += phase->modes.row[i]*t->amplitude[i];
        v += phase->modes.row[i]*t->rate[i];
    }
    t->x = x;
    t->v = v;
}

/* The root of u^2 + cubic u^3 = depth > 0; near a guess, or else anywhere. */
static rr_real root_of(rr_real depth, rr_real cubic, rr_real guess)
{
    const rr_real guessed = guess*guess*(RR_R(1.0) + cubic*guess);
    rr_real u = guess;
    if (!(DEPTH_OFF*guessed > depth && guessed < DEPTH_OFF*depth)) {
        const rr_real light = RR_SQRT(depth);
        const rr_real fourth = RR_SQRT(RR_SQRT(RR_R(1.0) + cubic*light));
        u = light/(fourth*RR_SQRT(RR_SQRT(fourth))); /* never below the root, as 5/16 < 1/3 < 1/2 */
    }
    for (int i = 0; i < ITERATIONS; ++i) {
        const rr_real bend = RR_R(1.0) + RR_R(3.0)*cubic*u;
        const rr_real slope = u*(RR_R(1.0) + bend);
        const rr_real over = u*u*(RR_R(1.0) + cubic*u) - depth;
        const rr_real change = over*slope/(slope*slope - over*bend);
        u -= change;
        if (RR_FABS(change) <= CLOSE*u) {
            break;
        }
    }
    return u;
}

/* What steps of one length have in common, as far as those before them were as long. */
static void set_pace(rr_state *s)
{
    const rr_region *const region = s->impact->region;
    const rr_level *const level = s->step;
    const rr_real one = RR_R(1.0);
    rr_pace *const pace = &s->pace;
    rr_real ratio = RR_R(0.0);
    rr_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    pace->before = RR_R(0.0);
    if (s->past > 0) {
        ratio = level->h/s->h;
        if (s->past > 1) {
            const rr_real lead = (RR_R(0.5)*level->h + s->h)/(level->h + s->h + s->h_before);
            more += lead;
            pace->before = lead*ratio*ratio;
        }
    }
    const rr_real rate = level->per;
    const rr_real early = ratio/(one + ratio);
    pace->ratio = ratio;
    pace->share = early/RR_R(6.0);
    pace->more = more;
    const rr_real lag = (one + early)*rate;
    pace->u = (one + ratio)*rate;
    pace->u_before = ratio*early*rate;
    const rr_real share = pace->share*more;
    pace->yields = level->late - share*level->push;
    const rr_real slows = level->push*rate - share*level->kick;
    pace->hold = region->stiffness + region->damping*lag;
    pace->soft = one + region->stiffness*pace->yields + region->damping*slows + pace->hold*s->phase->compliance;
}

void rr_press(rr_state *s, rr_trial *t)
{
    const rr_region *const region = s->impact->region;
    const rr_phase *const phase = s->phase;
    const rr_level *const level = s->step;
    const rr_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const rr_real plain = pace->share*(s->f + pace->ratio*s->rise);
    t->share = pace->more*pace->share;
    t->base = pace->more*plain - pace->before*s->bump;
    const rr_real first = s->f + t->base;
    const rr_real x = t->x - level->push*first + level->late*s->f; /* a force that falls to its base */
    const rr_real v = t->v - level->kick*first + level->push*level->per*s->f;
    const rr_real slip = v + pace->u*s->u - pace->u_before*s->u_before; /* less what u' gains by u */
    const rr_real pressed = region->stiffness*x + region->damping*slip;
    t->root = RR_R(0.0);
    if (pressed > RR_R(0.0)) {
        if (region->law == NULL) {
            const rr_real per = RR_R(1.0)/pace->hold;
            t->root = root_of(pressed*per, region->hertz_stiffness*pace->soft*per, s->root);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->f = rr_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + phase->compliance*t->f;
        t->x = x - pace->yields*t->f;
        t->bump = plain - pace->share*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const rr_real from = pace->hold*s->now + pace->soft*s->f;
        t->base = from > RR_R(0.0) ? RR_R(0.5)*s->f*pressed/(from - pressed) : RR_R(0.0);
        t->share = RR_R(0.0);
        t->x -= level->push*(s->f + t->base) - level->late*s->f;
        t->bump = RR_R(0.0);
        t->f = RR_R(0.0);
        t->u = RR_R(0.0);
        t->depth = RR_R(0.0);
    }
}

void rr_take(const rr_trial *t, rr_state *s)
{
    const rr_phase *const phase = s->phase;
    const rr_level *const level = s->step;
    const rr_real first = s->f + t->base - t->share*t->f;
    const rr_real rise = t->f - s->f;
    const rr_real slope = rise*level->per;
    for (int i = 0; i < phase->active; ++i) {
        const rr_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push*first - step->late*rise;
        s->rate[i] = t->rate[i] - phase->modes.row[i]*step->sine*first - step->push*slope;
    }
}

rr_real rr_force_between(const rr_state *s, const rr_trial *t)
{
    const rr_region *const region = s->impact->region;
    const rr_phase *const phase = s->phase;
    const rr_level *const level = s->step;
    const rr_real h = level->h;
    const rr_real first = s->f + t->base - t->share*t->f;
    const rr_real after = h*(t->v - level->kick*first) - level->push*(t->f - s->f);
    rr_real before = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        before += phase->modes.row[i]*s->rate[i];
    }
    before *= h;
    rr_real most = RR_R(0.0);
    for (int k = 1; k < PLACES; ++k) { /* x is a cubic, the body's own deflection followed at once */
        const rr_real share = (rr_real)k/(rr_real)PLACES;
        const rr_real left = RR_R(1.0) - share;
        const rr_real even = s->x + share*share*(RR_R(3.0) - share - share)*(t->x - s->x);
        const rr_real x = even + share*left*(left*before - share*after);
        const rr_real damper = region->damping/(share*h);
        const rr_real hold = region->stiffness + damper;
        const rr_real pressed = hold*x - damper*(s->x - s->u);
        const rr_real soft = RR_R(1.0) + hold*phase->compliance;
        rr_real depth;
        if (pressed > RR_R(0.0)) {
            most = RR_FMAX(most, rr_law_press(region, hold, soft, pressed, &depth));
        }
    }
    return most;
}

rr_real rr_slip_off(const rr_state *s, const rr_trial *t)
{
    const rr_real rate = (t->u - s->u)*s->step->per;
    const rr_real before = s->past > 0 ? (s->u - s->u_before)/s->h : rate;
    return s->impact->region->damping*RR_FABS(rate - before);
}
