/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of rr_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of rr_law.c. x' is
 * exact at every node and u' a difference of the last four nodes, so that no damping makes it unstable. The force
 * is quadratic between nodes; steps are halved where it bends too much for that.
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

void rr_feel(rr_state *s)
{
    rr_motion *const motion = s->motion;
    const rr_level *const level = s->due.level;
    const rr_real slope = s->due.rise*level->per;
    for (int i = 0; i < s->phase->active; ++i) {
        const rr_mode_step *const step = &level->mode[i];
        motion->place[i] = rr_felt_place(step, motion->place[i], s->due.mean, s->due.rise);
        motion->rate[i] = rr_felt_rate(step, motion->rate[i], s->due.mean, slope);
    }
    s->due.mean = RR_R(0.0);
    s->due.rise = RR_R(0.0);
}

void rr_glide(rr_state *s, rr_trial *t)
{
    const rr_phase *const phase = s->phase;
    const rr_level *const level = s->step;
    rr_real damped[RR_MODES];
    if (phase->damped) {
        rr_damp_ahead(s, damped);
    }
    const rr_motion *const motion = s->motion;
    const rr_real *const rate = phase->damped ? damped : motion->rate;
    rr_motion *const next = s->trial;
    const rr_level *const felt = s->due.level;
    const rr_real mean = s->due.mean;
    const rr_real rise = s->due.rise;
    const rr_real kicked = phase->damped ? RR_R(0.0) : mean; /* damped rates have felt it */
    const rr_real slope = phase->damped ? RR_R(0.0) : rise*felt->per;
    rr_real v = s->drift;
    rr_real x = s->drifted + s->drift*level->h;
    for (int i = 0; i < phase->active; ++i) {
        const rr_mode_step *const due = &felt->mode[i];
        const rr_mode_step *const step = &level->mode[i];
        const rr_real a = rr_felt_place(due, motion->place[i], mean, rise);
        const rr_real b = rr_felt_rate(due, rate[i], kicked, slope);
        const rr_real place = step->cosine*a + step->sine*b;
        const rr_real velocity = step->back*a + step->cosine*b;
        next->place[i] = place;
        next->rate[i] = velocity;
        x += place;
        v += velocity;
    }
    t->x = x;
    t->v = phase->damped ? v - rr_owed_slip(s) : v;
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

/*
 * What steps of one length have in common, as far as those before them were as long. Of the skin's u the slope is that
 * of the polynomial through the last four nodes, or three where there are no more since the touch or the step is the
 * first of its length: just after a touch u is no cubic yet, and a later contact was 1.2 % too weak by that.
 */
static void set_pace(rr_state *s)
{
    const rr_region *const region = s->region;
    const rr_level *const level = s->step;
    const rr_real one = RR_R(1.0);
    const rr_real h = level->h;
    const rr_real rate = level->per;
    const rr_real damping = region->damping;
    rr_pace *const pace = &s->pace;
    rr_real ratio = RR_R(0.0);
    rr_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    rr_real more_u = RR_R(0.0); /* of u' by a node of u more, 1/s: by what the end adds */
    rr_real more_before = RR_R(0.0);
    rr_real third = RR_R(0.0);
    pace->before = RR_R(0.0);
    if (s->past > 0) {
        ratio = h*s->per;
        if (s->past > 1) {
            const rr_real both = s->h + s->h_before;
            const rr_real lead = (RR_R(0.5)*h + s->h)/(h + both);
            more += lead;
            pace->before = lead*ratio*ratio;
            if (s->even > 0) {
                more_u = one/(h + both);
                more_before = ratio/s->h_before;
                third = h*(h + s->h)/((h + both)*both*s->h_before);
            }
        }
    }
    const rr_real early = ratio/(one + ratio);
    const rr_real lag = (one + early)*rate + more_u;
    pace->ratio = ratio;
    pace->share = early/RR_R(6.0);
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

void rr_press(rr_state *s, rr_trial *t)
{
    const rr_region *const region = s->region;
    const rr_level *const level = s->step;
    const rr_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const rr_real straight_on = s->f + pace->ratio*s->rise;
    const rr_real mean = s->f + pace->whole*straight_on - pace->before*s->bump; /* were there no force at the end */
    const rr_real pressed = region->stiffness*t->x + region->damping*t->v - pace->stays*mean + pace->grows*s->f
        + pace->u*s->u - pace->u_before*s->u_before + pace->u_third*s->u_third;
    t->x += level->late*s->f;
    if (pressed > RR_R(0.0)) {
        if (region->law == NULL) {
            t->root = root_of(pressed*pace->per_hold, pace->cubic, s->root);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->root = RR_R(0.0);
            t->f = rr_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + s->phase->compliance*t->f;
        t->x -= level->push*mean + pace->yields*t->f;
        t->bump = pace->share*(straight_on - t->f);
        t->mean = mean - pace->whole*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const rr_real from = pace->hold*s->now + pace->soft*s->f;
        t->mean = s->f + (from > RR_R(0.0) ? RR_R(0.5)*s->f*pressed/(from - pressed) : RR_R(0.0));
        t->x -= level->push*t->mean;
        t->bump = RR_R(0.0);
        t->f = RR_R(0.0);
        t->u = RR_R(0.0);
        t->depth = RR_R(0.0);
        t->root = RR_R(0.0);
    }
}

void rr_take(rr_state *s, rr_real mean, rr_real rise)
{
    rr_motion *const before = s->motion;
    s->motion = s->trial;
    s->trial = before;
    s->due.level = s->step;
    s->due.mean = mean;
    s->due.rise = rise;
}

rr_real rr_force_between(rr_state *s, const rr_trial *t)
{
    const rr_region *const region = s->region;
    const rr_phase *const phase = s->phase;
    const rr_level *const level = s->step;
    const rr_real h = level->h;
    const rr_real after = h*(t->v - level->kick*t->mean - level->grow*(t->f - s->f));
    rr_real before = s->drift;
    rr_feel(s);
    for (int i = 0; i < phase->active; ++i) {
        before += s->motion->rate[i];
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
    return s->region->damping*RR_FABS(rate - before);
}
