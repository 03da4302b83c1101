/* SPDX-License-Identifier: 0BSD */
/*
 * Dampers of ur5e_'s joints and servos, in coordinates of their own.
 *
 * They are few beside the modes: what turns them is summed over all modes, their impulses to second order in
 * time follow from how they act on each other, and then go to the modes.
 */
#include "ur5e_state.h"

ur5e_real ur5e_damping_rate(ur5e_phase *phase)
{
    ur5e_real rate = UR5E_R(0.0);
    for (int i = 0; i < UR5E_DAMPERS && phase->damped; ++i) {
        for (int j = 0; j <= i; ++j) {
            ur5e_real sum = UR5E_R(0.0);
            for (int k = 0; k < phase->modes.count; ++k) {
                const int from = phase->modes.from[k];
                const ur5e_real *const shape = &phase->modes.shape[from][UR5E_SYSTEM - UR5E_DAMPERS];
                sum += shape[i]*shape[j];
            }
            phase->together[i][j] = sum;
            phase->together[j][i] = sum;
        }
        rate = UR5E_FMAX(rate, phase->damping[i]*phase->together[i][i]);
    }
    return rate;
}

void ur5e_slowing(ur5e_phase *phase)
{
    const ur5e_modes *const modes = &phase->modes;
    ur5e_real held[UR5E_DAMPERS];
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        ur5e_real sum = UR5E_R(0.0);
        for (int i = 0; i < phase->active; ++i) {
            sum += modes->row[i]*modes->shape[modes->from[i]][UR5E_SYSTEM - UR5E_DAMPERS + j];
        }
        held[j] = phase->damping[j]*sum;
    }
    for (int i = 0; i < phase->active; ++i) {
        ur5e_real sum = UR5E_R(0.0);
        for (int j = 0; j < UR5E_DAMPERS; ++j) {
            sum += modes->shape[modes->from[i]][UR5E_SYSTEM - UR5E_DAMPERS + j]*held[j];
        }
        phase->slows[i] = UR5E_R(0.5)*sum/modes->row[i];
    }
    for (int k = 0; k < UR5E_LEVELS; ++k) {
        ur5e_level *const level = &phase->level[k];
        for (int i = 0; i < phase->active; ++i) {
            level->kick -= level->h*phase->slows[i]*level->mode[i].kick;
            level->grow -= phase->slows[i]*level->mode[i].push;
        }
    }
}

void ur5e_damp(const ur5e_phase *phase, ur5e_real speed, ur5e_real time, ur5e_real *rate)
{
    const ur5e_modes *const modes = &phase->modes;
    ur5e_real turned[UR5E_DAMPERS];
    ur5e_real impulse[UR5E_DAMPERS]; /* of each damper, to first and then to second order */
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        turned[j] = UR5E_R(0.0);
    }
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_real *const shape = &modes->shape[modes->from[i]][UR5E_SYSTEM - UR5E_DAMPERS];
        const ur5e_real led = rate[i]/modes->row[i] - speed*modes->start[i];
        for (int j = 0; j < UR5E_DAMPERS; ++j) {
            turned[j] += shape[j]*led;
        }
    }
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        ur5e_real slowed = UR5E_R(0.0);
        for (int k = 0; k < UR5E_DAMPERS; ++k) {
            slowed += phase->together[j][k]*impulse[k];
        }
        turned[j] -= UR5E_R(0.5)*slowed;
    }
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_real *const shape = &modes->shape[modes->from[i]][UR5E_SYSTEM - UR5E_DAMPERS];
        ur5e_real change = UR5E_R(0.0);
        for (int j = 0; j < UR5E_DAMPERS; ++j) {
            change += shape[j]*impulse[j];
        }
        rate[i] -= modes->row[i]*change;
    }
}

void ur5e_damp_ahead(const ur5e_state *s, ur5e_real *rate)
{
    const ur5e_level *const level = s->due.level;
    const ur5e_real slope = s->due.rise*level->per;
    for (int i = 0; i < s->phase->active; ++i) {
        rate[i] = ur5e_felt_rate(&level->mode[i], s->motion->rate[i], s->due.mean, slope);
    }
    ur5e_damp(s->phase, s->speed, s->owed + UR5E_R(0.5)*s->step->h, rate);
}

ur5e_real ur5e_owed_slip(const ur5e_state *s)
{
    const ur5e_phase *const phase = s->phase;
    ur5e_real slowed = UR5E_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        slowed += phase->slows[i]*(s->trial->rate[i] - s->speed*phase->modes.row[i]*phase->modes.start[i]);
    }
    return s->step->h*slowed;
}
