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
                const int from = phase->modes.from[k];
                const panda_real *const shape = &phase->modes.shape[from][PANDA_SYSTEM - PANDA_DAMPERS];
                sum += shape[i]*shape[j];
            }
            phase->together[i][j] = sum;
            phase->together[j][i] = sum;
        }
        rate = PANDA_FMAX(rate, phase->damping[i]*phase->together[i][i]);
    }
    return rate;
}

void panda_slowing(panda_phase *phase)
{
    const panda_modes *const modes = &phase->modes;
    panda_real held[PANDA_DAMPERS];
    for (int j = 0; j < PANDA_DAMPERS; ++j) {
        panda_real sum = PANDA_R(0.0);
        for (int i = 0; i < phase->active; ++i) {
            sum += modes->row[i]*modes->shape[modes->from[i]][PANDA_SYSTEM - PANDA_DAMPERS + j];
        }
        held[j] = phase->damping[j]*sum;
    }
    for (int i = 0; i < phase->active; ++i) {
        panda_real sum = PANDA_R(0.0);
        for (int j = 0; j < PANDA_DAMPERS; ++j) {
            sum += modes->shape[modes->from[i]][PANDA_SYSTEM - PANDA_DAMPERS + j]*held[j];
        }
        phase->slows[i] = PANDA_R(0.5)*sum/modes->row[i];
    }
    for (int k = 0; k < PANDA_LEVELS; ++k) {
        panda_level *const level = &phase->level[k];
        for (int i = 0; i < phase->active; ++i) {
            level->kick -= level->h*phase->slows[i]*level->mode[i].kick;
            level->grow -= phase->slows[i]*level->mode[i].push;
        }
    }
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
        const panda_real *const shape = &modes->shape[modes->from[i]][PANDA_SYSTEM - PANDA_DAMPERS];
        const panda_real led = rate[i]/modes->row[i] - speed*modes->start[i];
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
        const panda_real *const shape = &modes->shape[modes->from[i]][PANDA_SYSTEM - PANDA_DAMPERS];
        panda_real change = PANDA_R(0.0);
        for (int j = 0; j < PANDA_DAMPERS; ++j) {
            change += shape[j]*impulse[j];
        }
        rate[i] -= modes->row[i]*change;
    }
}

void panda_damp_ahead(const panda_state *s, panda_real *rate)
{
    const panda_level *const level = s->due.level;
    const panda_real slope = s->due.rise*level->per;
    for (int i = 0; i < s->phase->active; ++i) {
        rate[i] = panda_felt_rate(&level->mode[i], s->motion->rate[i], s->due.mean, slope);
    }
    panda_damp(s->phase, s->speed, s->owed + PANDA_R(0.5)*s->step->h, rate);
}

panda_real panda_owed_slip(const panda_state *s)
{
    const panda_phase *const phase = s->phase;
    panda_real slowed = PANDA_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        slowed += phase->slows[i]*(s->trial->rate[i] - s->speed*phase->modes.row[i]*phase->modes.start[i]);
    }
    return s->step->h*slowed;
}
