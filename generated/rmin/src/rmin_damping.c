/* SPDX-License-Identifier: 0BSD */
/*
 * Dampers of rmin_'s joints and servos, in coordinates of their own.
 *
 * They are few beside the modes: what turns them is summed over all modes, their impulses to second order in
 * time follow from how they act on each other, and then go to the modes.
 */
#include "rmin_state.h"

rmin_real rmin_damping_rate(rmin_phase *phase)
{
    rmin_real rate = RMIN_R(0.0);
    for (int i = 0; i < RMIN_DAMPERS && phase->damped; ++i) {
        for (int j = 0; j <= i; ++j) {
            rmin_real sum = RMIN_R(0.0);
            for (int k = 0; k < phase->modes.count; ++k) {
                const int from = phase->modes.from[k];
                const rmin_real *const shape = &phase->modes.shape[from][RMIN_SYSTEM - RMIN_DAMPERS];
                sum += shape[i]*shape[j];
            }
            phase->together[i][j] = sum;
            phase->together[j][i] = sum;
        }
        rate = RMIN_FMAX(rate, phase->damping[i]*phase->together[i][i]);
    }
    return rate;
}

void rmin_slowing(rmin_phase *phase)
{
    const rmin_modes *const modes = &phase->modes;
    rmin_real held[RMIN_DAMPERS];
    for (int j = 0; j < RMIN_DAMPERS; ++j) {
        rmin_real sum = RMIN_R(0.0);
        for (int i = 0; i < phase->active; ++i) {
            sum += modes->row[i]*modes->shape[modes->from[i]][RMIN_SYSTEM - RMIN_DAMPERS + j];
        }
        held[j] = phase->damping[j]*sum;
    }
    for (int i = 0; i < phase->active; ++i) {
        rmin_real sum = RMIN_R(0.0);
        for (int j = 0; j < RMIN_DAMPERS; ++j) {
            sum += modes->shape[modes->from[i]][RMIN_SYSTEM - RMIN_DAMPERS + j]*held[j];
        }
        phase->slows[i] = RMIN_R(0.5)*sum/modes->row[i];
    }
    for (int k = 0; k < RMIN_LEVELS; ++k) {
        rmin_level *const level = &phase->level[k];
        for (int i = 0; i < phase->active; ++i) {
            level->kick -= level->h*phase->slows[i]*level->mode[i].kick;
            level->grow -= phase->slows[i]*level->mode[i].push;
        }
    }
}

void rmin_damp(const rmin_phase *phase, rmin_real speed, rmin_real time, rmin_real *rate)
{
    const rmin_modes *const modes = &phase->modes;
    rmin_real turned[RMIN_DAMPERS];
    rmin_real impulse[RMIN_DAMPERS]; /* of each damper, to first and then to second order */
    for (int j = 0; j < RMIN_DAMPERS; ++j) {
        turned[j] = RMIN_R(0.0);
    }
    for (int i = 0; i < phase->active; ++i) {
        const rmin_real *const shape = &modes->shape[modes->from[i]][RMIN_SYSTEM - RMIN_DAMPERS];
        const rmin_real led = rate[i]/modes->row[i] - speed*modes->start[i];
        for (int j = 0; j < RMIN_DAMPERS; ++j) {
            turned[j] += shape[j]*led;
        }
    }
    for (int j = 0; j < RMIN_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int j = 0; j < RMIN_DAMPERS; ++j) {
        rmin_real slowed = RMIN_R(0.0);
        for (int k = 0; k < RMIN_DAMPERS; ++k) {
            slowed += phase->together[j][k]*impulse[k];
        }
        turned[j] -= RMIN_R(0.5)*slowed;
    }
    for (int j = 0; j < RMIN_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int i = 0; i < phase->active; ++i) {
        const rmin_real *const shape = &modes->shape[modes->from[i]][RMIN_SYSTEM - RMIN_DAMPERS];
        rmin_real change = RMIN_R(0.0);
        for (int j = 0; j < RMIN_DAMPERS; ++j) {
            change += shape[j]*impulse[j];
        }
        rate[i] -= modes->row[i]*change;
    }
}

void rmin_damp_ahead(const rmin_state *s, rmin_real *rate)
{
    const rmin_level *const level = s->due.level;
    const rmin_real slope = s->due.rise*level->per;
    for (int i = 0; i < s->phase->active; ++i) {
        rate[i] = rmin_felt_rate(&level->mode[i], s->motion->rate[i], s->due.mean, slope);
    }
    rmin_damp(s->phase, s->speed, s->owed + RMIN_R(0.5)*s->step->h, rate);
}

rmin_real rmin_owed_slip(const rmin_state *s)
{
    const rmin_phase *const phase = s->phase;
    rmin_real slowed = RMIN_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        slowed += phase->slows[i]*(s->trial->rate[i] - s->speed*phase->modes.row[i]*phase->modes.start[i]);
    }
    return s->step->h*slowed;
}
