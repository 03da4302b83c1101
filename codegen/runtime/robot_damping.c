/* SPDX-License-Identifier: 0BSD */
/*
 * Dampers of robot_'s joints and servos, in coordinates of their own.
 *
 * They are few beside the modes: what turns them is summed over all modes, their impulses to second order in
 * time follow from how they act on each other, and then go to the modes.
 */
#include "robot_state.h"

robot_real robot_damping_rate(robot_phase *phase)
{
    robot_real rate = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_DAMPERS && phase->damped; ++i) {
        for (int j = 0; j <= i; ++j) {
            robot_real sum = ROBOT_R(0.0);
            for (int k = 0; k < phase->modes.count; ++k) {
                const int from = phase->modes.from[k];
                const robot_real *const shape = &phase->modes.shape[from][ROBOT_SYSTEM - ROBOT_DAMPERS];
                sum += shape[i]*shape[j];
            }
            phase->together[i][j] = sum;
            phase->together[j][i] = sum;
        }
        rate = ROBOT_FMAX(rate, phase->damping[i]*phase->together[i][i]);
    }
    return rate;
}

void robot_slowing(robot_phase *phase)
{
    const robot_modes *const modes = &phase->modes;
    robot_real held[ROBOT_DAMPERS];
    for (int j = 0; j < ROBOT_DAMPERS; ++j) {
        robot_real sum = ROBOT_R(0.0);
        for (int i = 0; i < phase->active; ++i) {
            sum += modes->row[i]*modes->shape[modes->from[i]][ROBOT_SYSTEM - ROBOT_DAMPERS + j];
        }
        held[j] = phase->damping[j]*sum;
    }
    for (int i = 0; i < phase->active; ++i) {
        robot_real sum = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_DAMPERS; ++j) {
            sum += modes->shape[modes->from[i]][ROBOT_SYSTEM - ROBOT_DAMPERS + j]*held[j];
        }
        phase->slows[i] = ROBOT_R(0.5)*sum/modes->row[i];
    }
    for (int k = 0; k < ROBOT_LEVELS; ++k) {
        robot_level *const level = &phase->level[k];
        for (int i = 0; i < phase->active; ++i) {
            level->kick -= level->h*phase->slows[i]*level->mode[i].kick;
            level->grow -= phase->slows[i]*level->mode[i].push;
        }
    }
}

void robot_damp(const robot_phase *phase, robot_real speed, robot_real time, robot_real *rate)
{
    const robot_modes *const modes = &phase->modes;
    robot_real turned[ROBOT_DAMPERS];
    robot_real impulse[ROBOT_DAMPERS]; /* of each damper, to first and then to second order */
    for (int j = 0; j < ROBOT_DAMPERS; ++j) {
        turned[j] = ROBOT_R(0.0);
    }
    for (int i = 0; i < phase->active; ++i) {
        const robot_real *const shape = &modes->shape[modes->from[i]][ROBOT_SYSTEM - ROBOT_DAMPERS];
        const robot_real led = rate[i]/modes->row[i] - speed*modes->start[i];
        for (int j = 0; j < ROBOT_DAMPERS; ++j) {
            turned[j] += shape[j]*led;
        }
    }
    for (int j = 0; j < ROBOT_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int j = 0; j < ROBOT_DAMPERS; ++j) {
        robot_real slowed = ROBOT_R(0.0);
        for (int k = 0; k < ROBOT_DAMPERS; ++k) {
            slowed += phase->together[j][k]*impulse[k];
        }
        turned[j] -= ROBOT_R(0.5)*slowed;
    }
    for (int j = 0; j < ROBOT_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int i = 0; i < phase->active; ++i) {
        const robot_real *const shape = &modes->shape[modes->from[i]][ROBOT_SYSTEM - ROBOT_DAMPERS];
        robot_real change = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_DAMPERS; ++j) {
            change += shape[j]*impulse[j];
        }
        rate[i] -= modes->row[i]*change;
    }
}

void robot_damp_ahead(const robot_state *s, robot_real *rate)
{
    const robot_level *const level = s->due.level;
    const robot_real slope = s->due.rise*level->per;
    for (int i = 0; i < s->phase->active; ++i) {
        rate[i] = robot_felt_rate(&level->mode[i], s->motion->rate[i], s->due.mean, slope);
    }
    robot_damp(s->phase, s->speed, s->owed + ROBOT_R(0.5)*s->step->h, rate);
}

robot_real robot_owed_slip(const robot_state *s)
{
    const robot_phase *const phase = s->phase;
    robot_real slowed = ROBOT_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        slowed += phase->slows[i]*(s->trial->rate[i] - s->speed*phase->modes.row[i]*phase->modes.start[i]);
    }
    return s->step->h*slowed;
}
