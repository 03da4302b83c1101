/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of rmin_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f = k_f d^1.5 = k_h s + c_h s' with s = x - u, where x is how far the
 * contact point has come and u = d + (compliance of modes that stand) f. x' is exact at every node and u'
 * a backward difference, so that no damping makes it unstable. The force is quadratic between nodes;
 * steps are halved where it bends too much for that.
 */
#include "rmin_state.h"

/* Halley's iterations, and the relative change after which the next would be nothing. */
#define ITERATIONS 32
#define CLOSE RMIN_R(0.01)

void rmin_damp(const rmin_phase *phase, rmin_real speed, rmin_real time, rmin_real *rate)
{
    rmin_real halfway[RMIN_MODES];
    for (int round = 0; round < 2; ++round) {
        const rmin_real span = round == 0 ? RMIN_R(0.5)*time : time;
        const rmin_real *const from = round == 0 ? rate : halfway;
        rmin_real torque[RMIN_N];
        for (int j = 0; j < RMIN_N; ++j) {
            const int motor = RMIN_SYSTEM - RMIN_N + j;
            rmin_real turned = RMIN_R(0.0);
            for (int i = 0; i < phase->active; ++i) {
                turned += phase->modes.shape[i][motor]*(from[i] - speed*phase->modes.start[i]);
            }
            torque[j] = span*phase->damping[j]*turned;
        }
        for (int i = 0; i < phase->active; ++i) {
            rmin_real change = RMIN_R(0.0);
            for (int j = 0; j < RMIN_N; ++j) {
                change += phase->modes.shape[i][RMIN_SYSTEM - RMIN_N + j]*torque[j];
            }
            if (round == 0) {
                halfway[i] = rate[i] - change;
            } else {
                rate[i] -= change;
            }
        }
    }
}

void rmin_glide(const rmin_state *s, rmin_trial *t)
{
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = &phase->level[s->level];
    const rmin_real *rate = s->rate;
    rmin_real damped[RMIN_MODES];
    if (phase->damped) {
        for (int i = 0; i < phase->active; ++i) {
            damped[i] = s->rate[i];
        }
        rmin_damp(phase, s->speed, RMIN_R(0.5)*level->h, damped);
        rate = damped;
    }
    const rmin_real drift = phase->drift*s->speed;
    rmin_real x = s->drifted + drift*level->h;
    rmin_real v = drift;
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

/* The root of u^2 + cubic u^3 = depth > 0. */
static rmin_real root_of(rmin_real depth, rmin_real cubic, rmin_real guess)
{
    rmin_real u = guess;
    if (!(u > RMIN_R(0.0))) {
        const rmin_real light = RMIN_SQRT(depth);
        u = light/RMIN_SQRT(RMIN_SQRT(RMIN_R(1.0) + cubic*light));
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

void rmin_press(const rmin_state *s, rmin_trial *t)
{
    const rmin_region *const region = s->impact->region;
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = &phase->level[s->level];
    const rmin_real one = RMIN_R(1.0);
    const rmin_real h = level->h;
    rmin_real lag = one/h; /* backward difference: u' = lag u + memory */
    rmin_real memory = -s->u/h;
    t->share = RMIN_R(0.0);
    t->base = RMIN_R(0.0);
    rmin_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    rmin_real before = RMIN_R(0.0);
    if (s->past > 0) {
        const rmin_real ratio = h/s->h;
        t->share = ratio/(one + ratio)/RMIN_R(6.0);
        t->base = t->share*(s->f + ratio*s->rise);
        if (s->past > 1) {
            const rmin_real lead = (RMIN_R(0.5)*h + s->h)/(h + s->h + s->h_before);
            more += lead;
            before = lead*ratio*ratio*s->bump;
        }
        lag = (one + ratio + ratio)/((one + ratio)*h);
        memory = (ratio*ratio/(one + ratio)*s->u_before - (one + ratio)*s->u)/h;
    }
    const rmin_real plain = t->base;
    const rmin_real plain_share = t->share;
    t->share *= more;
    t->base = more*plain - before;
    const rmin_real first = s->f + t->base;
    const rmin_real x = t->x - level->push[0]*first - level->push[1]*t->base;
    const rmin_real v = t->v - level->kick[0]*first - level->kick[1]*t->base;
    const rmin_real yields = (one - t->share)*level->push[1] - t->share*level->push[0];
    const rmin_real slows = (one - t->share)*level->kick[1] - t->share*level->kick[0];
    const rmin_real hold = region->stiffness + region->damping*lag;
    const rmin_real pressed = region->stiffness*x + region->damping*(v - memory);
    const rmin_real soft =
        one + region->stiffness*yields + region->damping*slows + hold*phase->compliance;
    t->f = RMIN_R(0.0);
    t->u = RMIN_R(0.0);
    t->root = RMIN_R(0.0);
    if (pressed > RMIN_R(0.0)) {
        t->root = root_of(pressed/hold, region->hertz_stiffness*soft/hold, s->root);
        t->f = region->hertz_stiffness*t->root*t->root*t->root;
        t->u = t->root*t->root + phase->compliance*t->f;
    }
    t->x = x - yields*t->f;
    t->bump = plain - plain_share*t->f;
}

void rmin_take(const rmin_trial *t, rmin_state *s)
{
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = &phase->level[s->level];
    const rmin_real first = s->f + t->base - t->share*t->f;
    const rmin_real last = t->base + (RMIN_R(1.0) - t->share)*t->f;
    for (int i = 0; i < phase->active; ++i) {
        const rmin_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push[0]*first - step->push[1]*last;
        s->rate[i] = t->rate[i] - step->kick[0]*first - step->kick[1]*last;
    }
}
