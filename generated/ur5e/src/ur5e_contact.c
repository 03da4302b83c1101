/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of ur5e_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of ur5e_law.c. x' is
 * exact at every node and u' a difference of the last four nodes, so that no damping makes it unstable. The force
 * is quadratic between nodes; steps are halved where it bends too much for that.
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

void ur5e_feel(ur5e_state *s)
{
    ur5e_motion *const motion = s->motion;
    const ur5e_level *const level = s->due.level;
    const ur5e_real slope = s->due.rise*level->per;
    for (int i = 0; i < s->phase->active; ++i) {
        const ur5e_mode_step *const step = &level->mode[i];
        motion->place[i] = ur5e_felt_place(step, motion->place[i], s->due.mean, s->due.rise);
        motion->rate[i] = ur5e_felt_rate(step, motion->rate[i], s->due.mean, slope);
    }
    s->due.mean = UR5E_R(0.0);
    s->due.rise = UR5E_R(0.0);
}

void ur5e_glide(ur5e_state *s, ur5e_trial *t)
{
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    ur5e_real damped[UR5E_MODES];
    if (phase->damped) {
        ur5e_damp_ahead(s, damped);
    }
    const ur5e_motion *const motion = s->motion;
    const ur5e_real *const rate = phase->damped ? damped : motion->rate;
    ur5e_motion *const next = s->trial;
    const ur5e_level *const felt = s->due.level;
    const ur5e_real mean = s->due.mean;
    const ur5e_real rise = s->due.rise;
    const ur5e_real kicked = phase->damped ? UR5E_R(0.0) : mean; /* damped rates have felt it */
    const ur5e_real slope = phase->damped ? UR5E_R(0.0) : rise*felt->per;
    ur5e_real v = s->drift;
    ur5e_real x = s->drifted + s->drift*level->h;
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_mode_step *const due = &felt->mode[i];
        const ur5e_mode_step *const step = &level->mode[i];
        const ur5e_real a = ur5e_felt_place(due, motion->place[i], mean, rise);
        const ur5e_real b = ur5e_felt_rate(due, rate[i], kicked, slope);
        const ur5e_real place = step->cosine*a + step->sine*b;
        const ur5e_real velocity = step->back*a + step->cosine*b;
        next->place[i] = place;
        next->rate[i] = velocity;
        x += place;
        v += velocity;
    }
    t->x = x;
    t->v = phase->damped ? v - ur5e_owed_slip(s) : v;
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

/*
 * What steps of one length have in common, as far as those before them were as long. Of the skin's u the slope is that
 * of the polynomial through the last four nodes, or three where there are no more since the touch or the step is the
 * first of its length: just after a touch u is no cubic yet, and a later contact was 1.2 % too weak by that.
 */
static void set_pace(ur5e_state *s)
{
    const ur5e_region *const region = s->region;
    const ur5e_level *const level = s->step;
    const ur5e_real one = UR5E_R(1.0);
    const ur5e_real h = level->h;
    const ur5e_real rate = level->per;
    const ur5e_real damping = region->damping;
    ur5e_pace *const pace = &s->pace;
    ur5e_real ratio = UR5E_R(0.0);
    ur5e_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    ur5e_real more_u = UR5E_R(0.0); /* of u' by a node of u more, 1/s: by what the end adds */
    ur5e_real more_before = UR5E_R(0.0);
    ur5e_real third = UR5E_R(0.0);
    pace->before = UR5E_R(0.0);
    if (s->past > 0) {
        ratio = h*s->per;
        if (s->past > 1) {
            const ur5e_real both = s->h + s->h_before;
            const ur5e_real lead = (UR5E_R(0.5)*h + s->h)/(h + both);
            more += lead;
            pace->before = lead*ratio*ratio;
            if (s->even > 0) {
                more_u = one/(h + both);
                more_before = ratio/s->h_before;
                third = h*(h + s->h)/((h + both)*both*s->h_before);
            }
        }
    }
    const ur5e_real early = ratio/(one + ratio);
    const ur5e_real lag = (one + early)*rate + more_u;
    pace->ratio = ratio;
    pace->share = early/UR5E_R(6.0);
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

void ur5e_press(ur5e_state *s, ur5e_trial *t)
{
    const ur5e_region *const region = s->region;
    const ur5e_level *const level = s->step;
    const ur5e_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const ur5e_real straight_on = s->f + pace->ratio*s->rise;
    const ur5e_real mean = s->f + pace->whole*straight_on - pace->before*s->bump; /* were there no force at the end */
    const ur5e_real pressed = region->stiffness*t->x + region->damping*t->v - pace->stays*mean + pace->grows*s->f
        + pace->u*s->u - pace->u_before*s->u_before + pace->u_third*s->u_third;
    t->x += level->late*s->f;
    if (pressed > UR5E_R(0.0)) {
        if (region->law == NULL) {
            t->root = root_of(pressed*pace->per_hold, pace->cubic, s->root);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->root = UR5E_R(0.0);
            t->f = ur5e_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + s->phase->compliance*t->f;
        t->x -= level->push*mean + pace->yields*t->f;
        t->bump = pace->share*(straight_on - t->f);
        t->mean = mean - pace->whole*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const ur5e_real from = pace->hold*s->now + pace->soft*s->f;
        t->mean = s->f + (from > UR5E_R(0.0) ? UR5E_R(0.5)*s->f*pressed/(from - pressed) : UR5E_R(0.0));
        t->x -= level->push*t->mean;
        t->bump = UR5E_R(0.0);
        t->f = UR5E_R(0.0);
        t->u = UR5E_R(0.0);
        t->depth = UR5E_R(0.0);
        t->root = UR5E_R(0.0);
    }
}

void ur5e_take(ur5e_state *s, ur5e_real mean, ur5e_real rise)
{
    ur5e_motion *const before = s->motion;
    s->motion = s->trial;
    s->trial = before;
    s->due.level = s->step;
    s->due.mean = mean;
    s->due.rise = rise;
}

ur5e_real ur5e_force_between(ur5e_state *s, const ur5e_trial *t)
{
    const ur5e_region *const region = s->region;
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    const ur5e_real h = level->h;
    const ur5e_real after = h*(t->v - level->kick*t->mean - level->grow*(t->f - s->f));
    ur5e_real before = s->drift;
    ur5e_feel(s);
    for (int i = 0; i < phase->active; ++i) {
        before += s->motion->rate[i];
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
    return s->region->damping*UR5E_FABS(rate - before);
}
