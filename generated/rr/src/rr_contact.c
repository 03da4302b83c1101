/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of rr_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f = k_f d^1.5 = k_h s + c_h s' with s = x - u, where x is how far the
 * contact point has come and u = d + (compliance of modes that stand) f. x' is exact at every node and u'
 * a backward difference, so that no damping makes it unstable. The force is quadratic between nodes;
 * steps are halved where it bends too much for that.
 */
#include "rr_state.h"

/* Halley's iterations, and the relative change after which the next would be nothing. */
#define ITERATIONS 32
#define CLOSE RR_R(0.01)

void rr_damp(const rr_phase *phase, rr_real speed, rr_real time, rr_real *rate)
{
    rr_real halfway[RR_MODES];
    for (int round = 0; round < 2; ++round) {
        const rr_real span = round == 0 ? RR_R(0.5)*time : time;
        const rr_real *const from = round == 0 ? rate : halfway;
        rr_real torque[RR_N];
        for (int j = 0; j < RR_N; ++j) {
            const int motor = RR_SYSTEM - RR_N + j;
            rr_real turned = RR_R(0.0);
            for (int i = 0; i < phase->active; ++i) {
                turned += phase->modes.shape[i][motor]*(from[i] - speed*phase->modes.start[i]);
            }
            torque[j] = span*phase->damping[j]*turned;
        }
        for (int i = 0; i < phase->active; ++i) {
            rr_real change = RR_R(0.0);
            for (int j = 0; j < RR_N; ++j) {
                change += phase->modes.shape[i][RR_SYSTEM - RR_N + j]*torque[j];
            }
            if (round == 0) {
                halfway[i] = rate[i] - change;
            } else {
                rate[i] -= change;
            }
        }
    }
}

void rr_glide(const rr_state *s, rr_trial *t)
{
    const rr_phase *const phase = s->phase;
    const rr_level *const level = &phase->level[s->level];
    const rr_real *rate = s->rate;
    rr_real damped[RR_MODES];
    if (phase->damped) {
        for (int i = 0; i < phase->active; ++i) {
            damped[i] = s->rate[i];
        }
        rr_damp(phase, s->speed, RR_R(0.5)*level->h, damped);
        rate = damped;
    }
    const rr_real drift = phase->drift*s->speed;
    rr_real x = s->drifted + drift*level->h;
    rr_real v = drift;
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

/* The root of u^2 + cubic u^3 = depth > 0. */
static rr_real root_of(rr_real depth, rr_real cubic, rr_real guess)
{
    rr_real u = guess;
    if (!(u > RR_R(0.0))) {
        const rr_real light = RR_SQRT(depth);
        u = light/RR_SQRT(RR_SQRT(RR_R(1.0) + cubic*light));
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

void rr_press(const rr_state *s, rr_trial *t)
{
    const rr_region *const region = s->impact->region;
    const rr_phase *const phase = s->phase;
    const rr_level *const level = &phase->level[s->level];
    const rr_real one = RR_R(1.0);
    const rr_real h = level->h;
    rr_real lag = one/h; /* backward difference: u' = lag u + memory */
    rr_real memory = -s->u/h;
    t->share = RR_R(0.0);
    t->base = RR_R(0.0);
    rr_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    rr_real before = RR_R(0.0);
    if (s->past > 0) {
        const rr_real ratio = h/s->h;
        t->share = ratio/(one + ratio)/RR_R(6.0);
        t->base = t->share*(s->f + ratio*s->rise);
        if (s->past > 1) {
            const rr_real lead = (RR_R(0.5)*h + s->h)/(h + s->h + s->h_before);
            more += lead;
            before = lead*ratio*ratio*s->bump;
        }
        lag = (one + ratio + ratio)/((one + ratio)*h);
        memory = (ratio*ratio/(one + ratio)*s->u_before - (one + ratio)*s->u)/h;
    }
    const rr_real plain = t->base;
    const rr_real plain_share = t->share;
    t->share *= more;
    t->base = more*plain - before;
    const rr_real first = s->f + t->base;
    const rr_real x = t->x - level->push[0]*first - level->push[1]*t->base;
    const rr_real v = t->v - level->kick[0]*first - level->kick[1]*t->base;
    const rr_real yields = (one - t->share)*level->push[1] - t->share*level->push[0];
    const rr_real slows = (one - t->share)*level->kick[1] - t->share*level->kick[0];
    const rr_real hold = region->stiffness + region->damping*lag;
    const rr_real pressed = region->stiffness*x + region->damping*(v - memory);
    const rr_real soft =
        one + region->stiffness*yields + region->damping*slows + hold*phase->compliance;
    t->f = RR_R(0.0);
    t->u = RR_R(0.0);
    t->root = RR_R(0.0);
    if (pressed > RR_R(0.0)) {
        t->root = root_of(pressed/hold, region->hertz_stiffness*soft/hold, s->root);
        t->f = region->hertz_stiffness*t->root*t->root*t->root;
        t->u = t->root*t->root + phase->compliance*t->f;
    }
    t->x = x - yields*t->f;
    t->bump = plain - plain_share*t->f;
}

void rr_take(const rr_trial *t, rr_state *s)
{
    const rr_phase *const phase = s->phase;
    const rr_level *const level = &phase->level[s->level];
    const rr_real first = s->f + t->base - t->share*t->f;
    const rr_real last = t->base + (RR_R(1.0) - t->share)*t->f;
    for (int i = 0; i < phase->active; ++i) {
        const rr_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push[0]*first - step->push[1]*last;
        s->rate[i] = t->rate[i] - step->kick[0]*first - step->kick[1]*last;
    }
}
