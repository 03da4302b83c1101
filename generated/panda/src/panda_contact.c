/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of panda_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of panda_law.c. x' is
 * exact at every node and u' a backward difference, so that no damping makes it unstable. The force is
 * quadratic between nodes; steps are halved where it bends too much for that.
 */
#include "panda_state.h"

/*
 * Halley's iterations, and the relative change after which the next, a fourth of its cube, is nothing. A guess is
 * off by a factor of 1.7 at most, which iterations take to 1.09, 1.0002 and 1: the root of the step before where
 * its depth is within DEPTH_OFF, or else one made of square roots, 1.1 times the root where body and skin are as human
 * ones, 1.7 times for a cubic light of 1e11. Five square roots in a row take as long as the rest of a step.
 */
#define ITERATIONS 3
#define CLOSE PANDA_R(0.01)
#define DEPTH_OFF PANDA_R(2.8)
/* Steps of one length after which the next is as the last was. */
#define LIKE 3
/* Parts of a step between which a law through points is looked at. */
#define PLACES 4

void panda_glide(const panda_state *s, panda_trial *t)
{
    const panda_phase *const phase = s->phase;
    const panda_level *const level = s->step;
    const panda_real *rate = s->rate;
    panda_real damped[PANDA_MODES];
    if (phase->damped) {
        panda_damp_ahead(s, damped);
        rate = damped;
    }
    panda_real x = s->drifted + s->drift*level->h;
    panda_real v = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        const panda_mode_step *const step = &level->mode[i];
        const panda_real a = s->amplitude[i];
        const panda_real b = rate[i];
        t->amplitude[i] = step->cosine*a + step->sine*b;
        t->rate[i] = step->back*a + step->cosine*b;
        x += phase->modes.row[i]*t->amplitude[i];
        v += phase->modes.row[i]*t->rate[i];
    }
    t->x = x;
    t->v = v;
}

/* The root of u^2 + cubic u^3 = depth > 0; near a guess, or else anywhere. */
static panda_real root_of(panda_real depth, panda_real cubic, panda_real guess)
{
    const panda_real guessed = guess*guess*(PANDA_R(1.0) + cubic*guess);
    panda_real u = guess;
    if (!(DEPTH_OFF*guessed > depth && guessed < DEPTH_OFF*depth)) {
        const panda_real light = PANDA_SQRT(depth);
        const panda_real fourth = PANDA_SQRT(PANDA_SQRT(PANDA_R(1.0) + cubic*light));
        u = light/(fourth*PANDA_SQRT(PANDA_SQRT(fourth))); /* never below the root, as 5/16 < 1/3 < 1/2 */
    }
    for (int i = 0; i < ITERATIONS; ++i) {
        const panda_real bend = PANDA_R(1.0) + PANDA_R(3.0)*cubic*u;
        const panda_real slope = u*(PANDA_R(1.0) + bend);
        const panda_real over = u*u*(PANDA_R(1.0) + cubic*u) - depth;
        const panda_real change = over*slope/(slope*slope - over*bend);
        u -= change;
        if (PANDA_FABS(change) <= CLOSE*u) {
            break;
        }
    }
    return u;
}

/* What steps of one length have in common, as far as those before them were as long. */
static void set_pace(panda_state *s)
{
    const panda_region *const region = s->impact->region;
    const panda_level *const level = s->step;
    const panda_real one = PANDA_R(1.0);
    panda_pace *const pace = &s->pace;
    panda_real ratio = PANDA_R(0.0);
    panda_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    pace->before = PANDA_R(0.0);
    if (s->past > 0) {
        ratio = level->h/s->h;
        if (s->past > 1) {
            const panda_real lead = (PANDA_R(0.5)*level->h + s->h)/(level->h + s->h + s->h_before);
            more += lead;
            pace->before = lead*ratio*ratio;
        }
    }
    const panda_real rate = level->per;
    const panda_real early = ratio/(one + ratio);
    pace->ratio = ratio;
    pace->share = early/PANDA_R(6.0);
    pace->more = more;
    const panda_real lag = (one + early)*rate;
    pace->u = (one + ratio)*rate;
    pace->u_before = ratio*early*rate;
    const panda_real share = pace->share*more;
    pace->yields = level->late - share*level->push;
    const panda_real slows = level->push*rate - share*level->kick;
    pace->hold = region->stiffness + region->damping*lag;
    pace->soft = one + region->stiffness*pace->yields + region->damping*slows + pace->hold*s->phase->compliance;
}

void panda_press(panda_state *s, panda_trial *t)
{
    const panda_region *const region = s->impact->region;
    const panda_phase *const phase = s->phase;
    const panda_level *const level = s->step;
    const panda_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const panda_real plain = pace->share*(s->f + pace->ratio*s->rise);
    t->share = pace->more*pace->share;
    t->base = pace->more*plain - pace->before*s->bump;
    const panda_real first = s->f + t->base;
    const panda_real x = t->x - level->push*first + level->late*s->f; /* a force that falls to its base */
    const panda_real v = t->v - level->kick*first + level->push*level->per*s->f;
    const panda_real slip = v + pace->u*s->u - pace->u_before*s->u_before; /* less what u' gains by u */
    const panda_real pressed = region->stiffness*x + region->damping*slip;
    t->root = PANDA_R(0.0);
    if (pressed > PANDA_R(0.0)) {
        if (region->law == NULL) {
            const panda_real per = PANDA_R(1.0)/pace->hold;
            t->root = root_of(pressed*per, region->hertz_stiffness*pace->soft*per, s->root);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->f = panda_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + phase->compliance*t->f;
        t->x = x - pace->yields*t->f;
        t->bump = plain - pace->share*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const panda_real from = pace->hold*s->now + pace->soft*s->f;
        t->base = from > PANDA_R(0.0) ? PANDA_R(0.5)*s->f*pressed/(from - pressed) : PANDA_R(0.0);
        t->share = PANDA_R(0.0);
        t->x -= level->push*(s->f + t->base) - level->late*s->f;
        t->bump = PANDA_R(0.0);
        t->f = PANDA_R(0.0);
        t->u = PANDA_R(0.0);
        t->depth = PANDA_R(0.0);
    }
}

void panda_take(const panda_trial *t, panda_state *s)
{
    const panda_phase *const phase = s->phase;
    const panda_level *const level = s->step;
    const panda_real first = s->f + t->base - t->share*t->f;
    const panda_real rise = t->f - s->f;
    const panda_real slope = rise*level->per;
    for (int i = 0; i < phase->active; ++i) {
        const panda_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push*first - step->late*rise;
        s->rate[i] = t->rate[i] - phase->modes.row[i]*step->sine*first - step->push*slope;
    }
}

panda_real panda_force_between(const panda_state *s, const panda_trial *t)
{
    const panda_region *const region = s->impact->region;
    const panda_phase *const phase = s->phase;
    const panda_level *const level = s->step;
    const panda_real h = level->h;
    const panda_real first = s->f + t->base - t->share*t->f;
    const panda_real after = h*(t->v - level->kick*first) - level->push*(t->f - s->f);
    panda_real before = s->drift;
    for (int i = 0; i < phase->active; ++i) {
        before += phase->modes.row[i]*s->rate[i];
    }
    before *= h;
    panda_real most = PANDA_R(0.0);
    for (int k = 1; k < PLACES; ++k) { /* x is a cubic, the body's own deflection followed at once */
        const panda_real share = (panda_real)k/(panda_real)PLACES;
        const panda_real left = PANDA_R(1.0) - share;
        const panda_real even = s->x + share*share*(PANDA_R(3.0) - share - share)*(t->x - s->x);
        const panda_real x = even + share*left*(left*before - share*after);
        const panda_real damper = region->damping/(share*h);
        const panda_real hold = region->stiffness + damper;
        const panda_real pressed = hold*x - damper*(s->x - s->u);
        const panda_real soft = PANDA_R(1.0) + hold*phase->compliance;
        panda_real depth;
        if (pressed > PANDA_R(0.0)) {
            most = PANDA_FMAX(most, panda_law_press(region, hold, soft, pressed, &depth));
        }
    }
    return most;
}

panda_real panda_slip_off(const panda_state *s, const panda_trial *t)
{
    const panda_real rate = (t->u - s->u)*s->step->per;
    const panda_real before = s->past > 0 ? (s->u - s->u_before)/s->h : rate;
    return s->impact->region->damping*PANDA_FABS(rate - before);
}
