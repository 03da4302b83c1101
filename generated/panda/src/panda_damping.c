/* SPDX-License-Identifier: 0BSD */
/*
 * Dampers of panda_'s joints and servos, in coordinates of their own.
 *
 * They are few beside the modes: what turns them is summed over all modes, their impulses to second order in
 * time follow from how they act on each other, and then go to the modes.
 */
#include "panda_state.h"

panda_real panda_damping_rate(panda_phase *phase)
{
    panda_real rate = PANDA_R(0.0);
    for (int i = 0; i < PANDA_DAMPERS && phase->damped; ++i) {
        for (int j = 0; j <= i; ++j) {
            panda_real sum = PANDA_R(0.0);
            for (int k = 0; k < phase->modes.count; ++k) {
                const panda_real *const shape = &phase->modes.shape[k][PANDA_SYSTEM - PANDA_DAMPERS];
                sum += shape[i]*shape[j];
            }
            phase->together[i][j] = sum;
            phase->together[j][i] = sum;
        }
        rate = PANDA_FMAX(rate, phase->damping[i]*phase->together[i][i]);
    }
    return rate;
}

void panda_damp(const panda_phase *phase, panda_real speed, panda_real time, panda_real *rate)
{
    const panda_modes *const modes = &phase->modes;
    panda_real turned[PANDA_DAMPERS];
    panda_real impulse[PANDA_DAMPERS]; /* of each damper, to first and then to second order */
    for (int j = 0; j < PANDA_DAMPERS; ++j) {
        turned[j] = PANDA_R(0.0);
    }
    for (int i = 0; i < phase->active; ++i) {
        const panda_real *const shape = &modes->shape[i][PANDA_SYSTEM - PANDA_DAMPERS];
        const panda_real led = rate[i] - speed*modes->start[i];
        for (int j = 0; j < PANDA_DAMPERS; ++j) {
            turned[j] += shape[j]*led;
        }
    }
    for (int j = 0; j < PANDA_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int j = 0; j < PANDA_DAMPERS; ++j) {
        panda_real slowed = PANDA_R(0.0);
        for (int k = 0; k < PANDA_DAMPERS; ++k) {
            slowed += phase->together[j][k]*impulse[k];
        }
        turned[j] -= PANDA_R(0.5)*slowed;
    }
    for (int j = 0; j < PANDA_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int i = 0; i < phase->active; ++i) {
        const panda_real *const shape = &modes->shape[i][PANDA_SYSTEM - PANDA_DAMPERS];
        panda_real change = PANDA_R(0.0);
        for (int j = 0; j < PANDA_DAMPERS; ++j) {
            change += shape[j]*impulse[j];
        }
        rate[i] -= change;
    }
}

void panda_damp_ahead(const panda_state *s, panda_real *rate)
{
    for (int i = 0; i < s->phase->active; ++i) {
        rate[i] = s->rate[i];
    }
    panda_damp(s->phase, s->speed, s->owed + PANDA_R(0.5)*s->step->h, rate);
}
