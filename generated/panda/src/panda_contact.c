/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of panda_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of panda_law.c. x' is
 * exact at every node and u' a difference of the last four nodes, so that no damping makes it unstable. The force
 * is quadratic between nodes; steps are halved where it bends too much for that.
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

void panda_feel(panda_state *s)
{
    panda_motion *const motion = s->motion;
    const panda_level *const level = s->due.level;
    const panda_real slope = s->due.rise*level->per;
    for (int i = 0; i < s->phase->active; ++i) {
        const panda_mode_step *const step = &level->mode[i];
        motion->place[i] = panda_felt_place(step, motion->place[i], s->due.mean, s->due.rise);
        motion->rate[i] = panda_felt_rate(step, motion->rate[i], s->due.mean, slope);
    }
    s->due.mean = PANDA_R(0.0);
    s->due.rise = PANDA_R(0.0);
}

void panda_glide(panda_state *s, panda_trial *t)
{
    const panda_phase *const phase = s->phase;
    const panda_level *const level = s->step;
    panda_real damped[PANDA_MODES];
    if (phase->damped) {
        panda_damp_ahead(s, damped);
    }
    const panda_motion *const motion = s->motion;
    const panda_real *const rate = phase->damped ? damped : motion->rate;
    panda_motion *const next = s->trial;
    const panda_level *const felt = s->due.level;
    const panda_real mean = s->due.mean;
    const panda_real rise = s->due.rise;
    const panda_real kicked = phase->damped ? PANDA_R(0.0) : mean; /* damped rates have felt it */
    const panda_real slope = phase->damped ? PANDA_R(0.0) : rise*felt->per;
    panda_real v = s->drift;
    panda_real x = s->drifted + s->drift*level->h;
    for (int i = 0; i < phase->active; ++i) {
        const panda_mode_step *const due = &felt->mode[i];
        const panda_mode_step *const step = &level->mode[i];
        const panda_real a = panda_felt_place(due, motion->place[i], mean, rise);
        const panda_real b = panda_felt_rate(due, rate[i], kicked, slope);
        const panda_real place = step->cosine*a + step->sine*b;
        const panda_real velocity = step->back*a + step->cosine*b;
        next->place[i] = place;
        next->rate[i] = velocity;
        x += place;
        v += velocity;
    }
    t->x = x;
    t->v = phase->damped ? v - panda_owed_slip(s) : v;
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

/*
 * What steps of one length have in common, as far as those before them were as long. Of the skin's u the slope is that
 * of the polynomial through the last four nodes, or three where there are no more since the touch or the step is the
 * first of its length: just after a touch u is no cubic yet, and a later contact was 1.2 % too weak by that.
 */
static void set_pace(panda_state *s)
{
    const panda_region *const region = s->region;
    const panda_level *const level = s->step;
    const panda_real one = PANDA_R(1.0);
    const panda_real h = level->h;
    const panda_real rate = level->per;
    const panda_real damping = region->damping;
    panda_pace *const pace = &s->pace;
    panda_real ratio = PANDA_R(0.0);
    panda_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    panda_real more_u = PANDA_R(0.0); /* of u' by a node of u more, 1/s: by what the end adds */
    panda_real more_before = PANDA_R(0.0);
    panda_real third = PANDA_R(0.0);
    pace->before = PANDA_R(0.0);
    if (s->past > 0) {
        ratio = h*s->per;
        if (s->past > 1) {
            const panda_real both = s->h + s->h_before;
            const panda_real lead = (PANDA_R(0.5)*h + s->h)/(h + both);
            more += lead;
            pace->before = lead*ratio*ratio;
            if (s->even > 0) {
                more_u = one/(h + both);
                more_before = ratio/s->h_before;
                third = h*(h + s->h)/((h + both)*both*s->h_before);
            }
        }
    }
    const panda_real early = ratio/(one + ratio);
    const panda_real lag = (one + early)*rate + more_u;
    pace->ratio = ratio;
    pace->share = early/PANDA_R(6.0);
    pace->whole = pace->share*more;
    pace->u_before = damping*(ratio*early*rate + more_before);
    pace->u_third = damping*third;
    pace->u = damping*lag + pace->u_before - pace->u_third;
    pace->stays = region->stiffness*level->push + damping*level->kick;
    pace->grows = region->stiffness*level->late + damping*level->grow;
    pace->yields = level->late - pace->whole*level->push;
    pace->hold = region->stiffness + damping*lag;
    pace->soft = one + pace->grows - pace->whole*pace->stays + pace->hold*s->phase->compliance;
    pace->per_hold = one/pace->hold;
    pace->cubic = region->hertz_stiffness*pace->soft*pace->per_hold;
}

void panda_press(panda_state *s, panda_trial *t)
{
    const panda_region *const region = s->region;
    const panda_level *const level = s->step;
    const panda_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const panda_real straight_on = s->f + pace->ratio*s->rise;
    const panda_real mean = s->f + pace->whole*straight_on - pace->before*s->bump; /* were there no force at the end */
    const panda_real pressed = region->stiffness*t->x + region->damping*t->v - pace->stays*mean + pace->grows*s->f
        + pace->u*s->u - pace->u_before*s->u_before + pace->u_third*s->u_third;
    t->x += level->late*s->f;
    if (pressed > PANDA_R(0.0)) {
        if (region->law == NULL) {
            t->root = root_of(pressed*pace->per_hold, pace->cubic, s->root);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->root = PANDA_R(0.0);
            t->f = panda_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + s->phase->compliance*t->f;
        t->x -= level->push*mean + pace->yields*t->f;
        t->bump = pace->share*(straight_on - t->f);
        t->mean = mean - pace->whole*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const panda_real from = pace->hold*s->now + pace->soft*s->f;
        t->mean = s->f + (from > PANDA_R(0.0) ? PANDA_R(0.5)*s->f*pressed/(from - pressed) : PANDA_R(0.0));
        t->x -= level->push*t->mean;
        t->bump = PANDA_R(0.0);
        t->f = PANDA_R(0.0);
        t->u = PANDA_R(0.0);
        t->depth = PANDA_R(0.0);
        t->root = PANDA_R(0.0);
    }
}

void panda_take(panda_state *s, panda_real mean, panda_real rise)
{
    panda_motion *const before = s->motion;
    s->motion = s->trial;
    s->trial = before;
    s->due.level = s->step;
    s->due.mean = mean;
    s->due.rise = rise;
}

panda_real panda_force_between(panda_state *s, const panda_trial *t)
{
    const panda_region *const region = s->region;
    const panda_phase *const phase = s->phase;
    const panda_level *const level = s->step;
    const panda_real h = level->h;
    const panda_real after = h*(t->v - level->kick*t->mean - level->grow*(t->f - s->f));
    panda_real before = s->drift;
    panda_feel(s);
    for (int i = 0; i < phase->active; ++i) {
        before += s->motion->rate[i];
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
    return s->region->damping*PANDA_FABS(rate - before);
}
