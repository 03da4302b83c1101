/* SPDX-License-Identifier: 0BSD */
/*
 * Dampers of rr_'s joints and servos, in coordinates of their own.
 *
 * They are few beside the modes: what turns them is summed over all modes, their impulses to second order in
 * time follow from how they act on each other, and then go to the modes.
 */
#include "rr_state.h"

rr_real rr_damping_rate(rr_phase *phase)
{
    rr_real rate = RR_R(0.0);
    for (int i = 0; i < RR_DAMPERS && phase->damped; ++i) {
        for (int j = 0; j <= i; ++j) {
            rr_real sum = RR_R(0.0);
            for (int k = 0; k < phase->modes.count; ++k) {
                const int from = phase->modes.from[k];
                const rr_real *const shape = &phase->modes.shape[from][RR_SYSTEM - RR_DAMPERS];
                sum += shape[i]*shape[j];
            }
            phase->together[i][j] = sum;
            phase->together[j][i] = sum;
        }
        rate = RR_FMAX(rate, phase->damping[i]*phase->together[i][i]);
    }
    return rate;
}

void rr_slowing(rr_phase *phase)
{
    const rr_modes *const modes = &phase->modes;
    rr_real held[RR_DAMPERS];
    for (int j = 0; j < RR_DAMPERS; ++j) {
        rr_real sum = RR_R(0.0);
        for (int i = 0; i < phase->active; ++i) {
            sum += modes->row[i]*modes->shape[modes->from[i]][RR_SYSTEM - RR_DAMPERS + j];
        }
        held[j] = phase->damping[j]*sum;
    }
    for (int i = 0; i < phase->active; ++i) {
        rr_real sum = RR_R(0.0);
        for (int j = 0; j < RR_DAMPERS; ++j) {
            sum += modes->shape[modes->from[i]][RR_SYSTEM - RR_DAMPERS + j]*held[j];
        }
        phase->slows[i] = RR_R(0.5)*sum/modes->row[i];
    }
    for (int k = 0; k < RR_LEVELS; ++k) {
        rr_level *const level = &phase->level[k];
        for (int i = 0; i < phase->active; ++i) {
            level->kick -= level->h*phase->slows[i]*level->mode[i].kick;
            level->grow -= phase->slows[i]*level->mode[i].push;
        }
    }
}

void rr_damp(const rr_phase *phase, rr_real speed, rr_real time, rr_real *rate)
{
    const rr_modes *const modes = &phase->modes;
    rr_real turned[RR_DAMPERS];
    rr_real impulse[RR_DAMPERS]; /* of each damper, to first and then to second order */
    for (int j = 0; j < RR_DAMPERS; ++j) {
        turned[j] = RR_R(0.0);
    }
    for (int i = 0; i < phase->active; ++i) {
        const rr_real *const shape = &modes->shape[modes->from[i]][RR_SYSTEM - RR_DAMPERS];
        const rr_real led = rate[i]/modes->row[i] - speed*modes->start[i];
        for (int j = 0; j < RR_DAMPERS; ++j) {
            turned[j] += shape[j]*led;
        }
    }
    for (int j = 0; j < RR_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int j = 0; j < RR_DAMPERS; ++j) {
        rr_real slowed = RR_R(0.0);
        for (int k = 0; k < RR_DAMPERS; ++k) {
            slowed += phase->together[j][k]*impulse[k];
        }
        turned[j] -= RR_R(0.5)*slowed;
    }
    for (int j = 0; j < RR_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int i = 0; i < phase->active; ++i) {
        const rr_real *const shape = &modes->shape[modes->from[i]][RR_SYSTEM - RR_DAMPERS];
        rr_real change = RR_R(0.0);
        for (int j = 0; j < RR_DAMPERS; ++j) {
            change += shape[j]*impulse[j];
        }
        rate[i] -= modes->row[i]*change;
    }
}

void rr_damp_ahead(const rr_state *s, rr_real *rate)
{
    const rr_level *const level = s->due.level;
    const rr_real slope = s->due.rise*level->per;
    for (int i = 0; i < s->phase->active; ++i) {
        rate[i] = rr_felt_rate(&level->mode[i], s->motion->rate[i], s->due.mean, slope);
    }
    rr_damp(s->phase, s->speed, s->owed + RR_R(0.5)*s->step->h, rate);
}

rr_real rr_owed_slip(const rr_state *s)
{
    const rr_phase *const phase = s->phase;
    rr_real slowed = RR_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        slowed += phase->slows[i]*(s->trial->rate[i] - s->speed*phase->modes.row[i]*phase->modes.start[i]);
    }
    return s->step->h*slowed;
}
