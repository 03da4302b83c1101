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

/* Halley's iterations, and the relative change after which the next would be nothing. */
#define ITERATIONS 8
#define CLOSE ROBOT_R(0.01)
/* Steps of one length after which the next is as the last was. */
#define LIKE 3
/* Parts of a step between which a law through points is looked at. */
#define PLACES 4

void robot_damp(const robot_phase *phase, robot_real speed, robot_real time, robot_real *rate)
{
    robot_real halfway[ROBOT_MODES];
    for (int round = 0; round < 2; ++round) {
        const robot_real span = round == 0 ? ROBOT_R(0.5)*time : time;
        const robot_real *const from = round == 0 ? rate : halfway;
        robot_real torque[ROBOT_DAMPERS];
        for (int j = 0; j < ROBOT_DAMPERS; ++j) {
            const int place = ROBOT_SYSTEM - ROBOT_DAMPERS + j;
            robot_real turned = ROBOT_R(0.0);
            for (int i = 0; i < phase->active; ++i) {
                turned += phase->modes.shape[i][place]*(from[i] - speed*phase->modes.start[i]);
            }
            torque[j] = span*phase->damping[j]*turned;
        }
        for (int i = 0; i < phase->active; ++i) {
            robot_real change = ROBOT_R(0.0);
            for (int j = 0; j < ROBOT_DAMPERS; ++j) {
                change += phase->modes.shape[i][ROBOT_SYSTEM - ROBOT_DAMPERS + j]*torque[j];
            }
            if (round == 0) {
                halfway[i] = rate[i] - change;
            } else {
                rate[i] -= change;
            }
        }
    }
}

void robot_glide(const robot_state *s, robot_trial *t)
{
    const robot_phase *const phase = s->phase;
    const robot_level *const level = &phase->level[s->level];
    const robot_real *rate = s->rate;
    robot_real damped[ROBOT_MODES];
    if (phase->damped) {
        for (int i = 0; i < phase->active; ++i) {
            damped[i] = s->rate[i];
        }
        robot_damp(phase, s->speed, ROBOT_R(0.5)*level->h, damped);
        rate = damped;
    }
    const robot_real drift = phase->drift*s->speed;
    robot_real x = s->drifted + drift*level->h;
    robot_real v = drift;
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

/* The root of u^2 + cubic u^3 = depth > 0. */
static robot_real root_of(robot_real depth, robot_real cubic, robot_real guess)
{
    robot_real u = guess;
    if (!(u > ROBOT_R(0.0))) {
        const robot_real light = ROBOT_SQRT(depth);
        u = light/ROBOT_SQRT(ROBOT_SQRT(ROBOT_R(1.0) + cubic*light));
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
    const robot_level *const level = &s->phase->level[s->level];
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
    const robot_real rate = one/level->h;
    const robot_real early = ratio/(one + ratio);
    pace->ratio = ratio;
    pace->share = early/ROBOT_R(6.0);
    pace->more = more;
    const robot_real lag = (one + early)*rate;
    pace->u = (one + ratio)*rate;
    pace->u_before = ratio*early*rate;
    const robot_real share = pace->share*more;
    pace->yields = (one - share)*level->push[1] - share*level->push[0];
    const robot_real slows = (one - share)*level->kick[1] - share*level->kick[0];
    pace->hold = region->stiffness + region->damping*lag;
    pace->soft = one + region->stiffness*pace->yields + region->damping*slows + pace->hold*s->phase->compliance;
}

void robot_press(robot_state *s, robot_trial *t)
{
    const robot_region *const region = s->impact->region;
    const robot_phase *const phase = s->phase;
    const robot_level *const level = &phase->level[s->level];
    const robot_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const robot_real plain = pace->share*(s->f + pace->ratio*s->rise);
    t->share = pace->more*pace->share;
    t->base = pace->more*plain - pace->before*s->bump;
    const robot_real first = s->f + t->base;
    const robot_real x = t->x - level->push[0]*first - level->push[1]*t->base;
    const robot_real v = t->v - level->kick[0]*first - level->kick[1]*t->base;
    const robot_real slip = v + pace->u*s->u - pace->u_before*s->u_before; /* less what u' gains by u */
    const robot_real pressed = region->stiffness*x + region->damping*slip;
    t->f = ROBOT_R(0.0);
    t->u = ROBOT_R(0.0);
    t->root = ROBOT_R(0.0);
    t->depth = ROBOT_R(0.0);
    if (pressed > ROBOT_R(0.0)) {
        if (region->law == NULL) {
            t->root = root_of(pressed/pace->hold, region->hertz_stiffness*pace->soft/pace->hold, s->root);
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
        t->x -= level->push[0]*(s->f + t->base) + level->push[1]*t->base;
        t->bump = ROBOT_R(0.0);
    }
}

void robot_take(const robot_trial *t, robot_state *s)
{
    const robot_phase *const phase = s->phase;
    const robot_level *const level = &phase->level[s->level];
    const robot_real first = s->f + t->base - t->share*t->f;
    const robot_real last = t->base + (ROBOT_R(1.0) - t->share)*t->f;
    for (int i = 0; i < phase->active; ++i) {
        const robot_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push[0]*first - step->push[1]*last;
        s->rate[i] = t->rate[i] - step->kick[0]*first - step->kick[1]*last;
    }
}

robot_real robot_force_between(const robot_state *s, const robot_trial *t)
{
    const robot_region *const region = s->impact->region;
    const robot_phase *const phase = s->phase;
    const robot_level *const level = &phase->level[s->level];
    const robot_real h = level->h;
    const robot_real first = s->f + t->base - t->share*t->f;
    const robot_real last = t->base + (ROBOT_R(1.0) - t->share)*t->f;
    const robot_real after = h*(t->v - level->kick[0]*first - level->kick[1]*last);
    robot_real before = phase->drift*s->speed;
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
    const robot_real rate = (t->u - s->u)/s->phase->level[s->level].h;
    const robot_real before = s->past > 0 ? (s->u - s->u_before)/s->h : rate;
    return s->impact->region->damping*ROBOT_FABS(rate - before);
}
