/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of ur5e_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f = k_f d^1.5 = k_h s + c_h s' with s = x - u, where x is how far the
 * contact point has come and u = d + (compliance of modes that stand) f. x' is exact at every node and u'
 * a backward difference, so that no damping makes it unstable. The force is quadratic between nodes;
 * steps are halved where it bends too much for that.
 */
#include "ur5e_state.h"

/* Halley's iterations, and the relative change after which the next would be nothing. */
#define ITERATIONS 32
#define CLOSE UR5E_R(0.01)

void ur5e_damp(const ur5e_phase *phase, ur5e_real speed, ur5e_real time, ur5e_real *rate)
{
    ur5e_real halfway[UR5E_MODES];
    for (int round = 0; round < 2; ++round) {
        const ur5e_real span = round == 0 ? UR5E_R(0.5)*time : time;
        const ur5e_real *const from = round == 0 ? rate : halfway;
        ur5e_real torque[UR5E_N];
        for (int j = 0; j < UR5E_N; ++j) {
            const int motor = UR5E_SYSTEM - UR5E_N + j;
            ur5e_real turned = UR5E_R(0.0);
            for (int i = 0; i < phase->active; ++i) {
                turned += phase->modes.shape[i][motor]*(from[i] - speed*phase->modes.start[i]);
            }
            torque[j] = span*phase->damping[j]*turned;
        }
        for (int i = 0; i < phase->active; ++i) {
            ur5e_real change = UR5E_R(0.0);
            for (int j = 0; j < UR5E_N; ++j) {
                change += phase->modes.shape[i][UR5E_SYSTEM - UR5E_N + j]*torque[j];
            }
            if (round == 0) {
                halfway[i] = rate[i] - change;
            } else {
                rate[i] -= change;
            }
        }
    }
}

void ur5e_glide(const ur5e_state *s, ur5e_trial *t)
{
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = &phase->level[s->level];
    const ur5e_real *rate = s->rate;
    ur5e_real damped[UR5E_MODES];
    if (phase->damped) {
        for (int i = 0; i < phase->active; ++i) {
            damped[i] = s->rate[i];
        }
        ur5e_damp(phase, s->speed, UR5E_R(0.5)*level->h, damped);
        rate = damped;
    }
    const ur5e_real drift = phase->drift*s->speed;
    ur5e_real x = s->drifted + drift*level->h;
    ur5e_real v = drift;
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

/* The root of u^2 + cubic u^3 = depth > 0. */
static ur5e_real root_of(ur5e_real depth, ur5e_real cubic, ur5e_real guess)
{
    ur5e_real u = guess;
    if (!(u > UR5E_R(0.0))) {
        const ur5e_real light = UR5E_SQRT(depth);
        u = light/UR5E_SQRT(UR5E_SQRT(UR5E_R(1.0) + cubic*light));
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

void ur5e_press(const ur5e_state *s, ur5e_trial *t)
{
    const ur5e_region *const region = s->impact->region;
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = &phase->level[s->level];
    const ur5e_real one = UR5E_R(1.0);
    const ur5e_real h = level->h;
    ur5e_real lag = one/h; /* backward difference: u' = lag u + memory */
    ur5e_real memory = -s->u/h;
    t->share = UR5E_R(0.0);
    t->base = UR5E_R(0.0);
    ur5e_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    ur5e_real before = UR5E_R(0.0);
    if (s->past > 0) {
        const ur5e_real ratio = h/s->h;
        t->share = ratio/(one + ratio)/UR5E_R(6.0);
        t->base = t->share*(s->f + ratio*s->rise);
        if (s->past > 1) {
            const ur5e_real lead = (UR5E_R(0.5)*h + s->h)/(h + s->h + s->h_before);
            more += lead;
            before = lead*ratio*ratio*s->bump;
        }
        lag = (one + ratio + ratio)/((one + ratio)*h);
        memory = (ratio*ratio/(one + ratio)*s->u_before - (one + ratio)*s->u)/h;
    }
    const ur5e_real plain = t->base;
    const ur5e_real plain_share = t->share;
    t->share *= more;
    t->base = more*plain - before;
    const ur5e_real first = s->f + t->base;
    const ur5e_real x = t->x - level->push[0]*first - level->push[1]*t->base;
    const ur5e_real v = t->v - level->kick[0]*first - level->kick[1]*t->base;
    const ur5e_real yields = (one - t->share)*level->push[1] - t->share*level->push[0];
    const ur5e_real slows = (one - t->share)*level->kick[1] - t->share*level->kick[0];
    const ur5e_real hold = region->stiffness + region->damping*lag;
    const ur5e_real pressed = region->stiffness*x + region->damping*(v - memory);
    const ur5e_real soft =
        one + region->stiffness*yields + region->damping*slows + hold*phase->compliance;
    t->f = UR5E_R(0.0);
    t->u = UR5E_R(0.0);
    t->root = UR5E_R(0.0);
    if (pressed > UR5E_R(0.0)) {
        t->root = root_of(pressed/hold, region->hertz_stiffness*soft/hold, s->root);
        t->f = region->hertz_stiffness*t->root*t->root*t->root;
        t->u = t->root*t->root + phase->compliance*t->f;
    }
    t->x = x - yields*t->f;
    t->bump = plain - plain_share*t->f;
}

void ur5e_take(const ur5e_trial *t, ur5e_state *s)
{
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = &phase->level[s->level];
    const ur5e_real first = s->f + t->base - t->share*t->f;
    const ur5e_real last = t->base + (UR5E_R(1.0) - t->share)*t->f;
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push[0]*first - step->push[1]*last;
        s->rate[i] = t->rate[i] - step->kick[0]*first - step->kick[1]*last;
    }
}
