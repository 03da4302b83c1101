/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of ur5e_ when its motors are let go, in modes of loose motors. */
#include "ur5e_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (UR5E_ELASTIC ? 2 : UR5E_LEVELS - 1)

/* Displacements and velocities of `size` coordinates beside the motion before, from a phase's modes. */
static void coordinates_of(const ur5e_state *s, int size, ur5e_real *place, ur5e_real *rate)
{
    const ur5e_modes *const modes = &s->phase->modes;
    for (int j = 0; j < size; ++j) {
        place[j] = UR5E_R(0.0);
        rate[j] = UR5E_R(0.0);
    }
    for (int i = 0; i < modes->count; ++i) {
        const bool moves = i < s->phase->active;
        const ur5e_real led = modes->start[i]*s->speed;
        const ur5e_real a = moves ? s->amplitude[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        const ur5e_real b = moves ? s->rate[i] - led : UR5E_R(0.0);
        const ur5e_real *const shape = modes->shape[i];
        for (int j = 0; j < size; ++j) {
            place[j] += shape[j]*a;
            rate[j] += shape[j]*b;
        }
    }
}

/*
 * Most that modes that stand, bent by the force, add to it as they swing about that: springs that
 * motors wound up may hold more energy than the body does.
 */
static ur5e_real swings_of(const ur5e_state *s, const ur5e_phase *next, const ur5e_real *a,
    const ur5e_real *b)
{
    const ur5e_region *const region = s->impact->region;
    const ur5e_modes *const modes = &next->modes;
    ur5e_real sum = UR5E_R(0.0);
    for (int i = next->active; i < modes->count; ++i) {
        const ur5e_real rate = UR5E_SQRT(modes->squared[i]);
        const ur5e_real away = a[i] + modes->row[i]/modes->squared[i]*s->f;
        const ur5e_real swing = UR5E_SQRT(away*away + b[i]*b[i]/modes->squared[i]);
        sum += (region->stiffness + region->damping*rate)*UR5E_FABS(modes->row[i])*swing;
    }
    return sum;
}

void ur5e_release(ur5e_state *s)
{
    const ur5e_impact *const impact = s->impact;
    const ur5e_phase *const next = &impact->phase[UR5E_LOOSE];
    const ur5e_modes *const modes = &next->modes;
    ur5e_real place[UR5E_SYSTEM];
    ur5e_real rate[UR5E_SYSTEM];
    ur5e_real a[UR5E_MODES];
    ur5e_real b[UR5E_MODES];
    if (s->phase->damped) {
        ur5e_damp(s->phase, s->speed, s->owed, s->rate);
    }
    coordinates_of(s, UR5E_STRUCTURED && impact->motors == UR5E_MOTORS_DRIVEN ? UR5E_N : UR5E_SYSTEM, place, rate);
#if UR5E_STRUCTURED
    const ur5e_modes *const before = &s->phase->modes;
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    ur5e_real x = s->drifted - s->phase->compliance*s->f;
    ur5e_real v = s->phase->drift*s->speed;
    for (int i = 0; i < own; ++i) {
        x += before->row[i]*s->amplitude[i];
        v += before->row[i]*s->rate[i];
    }
    for (int j = 0; j < UR5E_N; ++j) {
        if (impact->motors == UR5E_MOTORS_SERVO) {
            const ur5e_real root = UR5E_SQRT(UR5E_SPRING(impact->p, j));
            place[j] = root*(place[j] - place[UR5E_N + j]);
            rate[j] = root*(rate[j] - rate[UR5E_N + j]);
        }
        x -= impact->carried[j]*place[j];
        v -= impact->carried[j]*rate[j];
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
    for (int i = 1; i < modes->count; ++i) {
        a[i] = UR5E_R(0.0);
        b[i] = UR5E_R(0.0);
        for (int j = 0; j < UR5E_N; ++j) {
            a[i] += modes->shape[i][j]*place[j];
            b[i] += modes->shape[i][j]*rate[j];
        }
        if (modes->squared[i] > UR5E_R(0.0)) {
            a[i] /= modes->squared[i];
            b[i] /= modes->squared[i];
        }
    }
#else
    ur5e_real momentum[UR5E_SYSTEM];
    ur5e_real carry[UR5E_SYSTEM];
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        const ur5e_real before = s->speed*impact->arrival.rates[j % UR5E_N];
        place[j] += before*s->time;
        rate[j] += before;
    }
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        momentum[j] = UR5E_R(0.0);
        carry[j] = UR5E_R(0.0);
        if (j < UR5E_N) {
            for (int k = 0; k < UR5E_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*rate[k];
                carry[j] += impact->arrival.links.M[j][k]*place[k];
            }
        }
#if UR5E_ELASTIC
        if (j >= UR5E_N) {
            momentum[j] = UR5E_ROTOR(impact->p, j - UR5E_N)*rate[j];
            carry[j] = UR5E_ROTOR(impact->p, j - UR5E_N)*place[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = UR5E_R(0.0);
        b[i] = UR5E_R(0.0);
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            a[i] += modes->shape[i][j]*carry[j];
            b[i] += modes->shape[i][j]*momentum[j];
        }
    }
#endif
    s->swings = swings_of(s, next, a, b);
    /* The body is the last of the modes that move: at least one does. */
    if (impact->gives_way && next->active > 0 && s->phase->active > 0) {
        a[next->active - 1] = s->amplitude[s->phase->active - 1];
        b[next->active - 1] = s->rate[s->phase->active - 1];
    }
    for (int i = 0; i < next->active; ++i) {
        s->amplitude[i] = a[i];
        s->rate[i] = b[i];
    }
    const ur5e_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    ur5e_phase_begin(next, s->touching ? LET_GO : 0, s);
}

