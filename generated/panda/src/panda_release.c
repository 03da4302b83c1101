/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of panda_ when its motors are let go, in modes of loose motors. */
#include "panda_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (PANDA_ELASTIC ? 2 : PANDA_LEVELS - 1)

/* Displacements and velocities of `size` coordinates beside the motion before, from a phase's modes. */
static void coordinates_of(const panda_state *s, int size, panda_real *place, panda_real *rate)
{
    const panda_modes *const modes = &s->phase->modes;
    for (int j = 0; j < size; ++j) {
        place[j] = PANDA_R(0.0);
        rate[j] = PANDA_R(0.0);
    }
    for (int i = 0; i < modes->count; ++i) {
        const bool moves = i < s->phase->active;
        const panda_real led = modes->start[i]*s->speed;
        const panda_real a = moves ? s->amplitude[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        const panda_real b = moves ? s->rate[i] - led : PANDA_R(0.0);
        const panda_real *const shape = modes->shape[i];
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
static panda_real swings_of(const panda_state *s, const panda_phase *next, const panda_real *a,
    const panda_real *b)
{
    const panda_region *const region = s->impact->region;
    const panda_modes *const modes = &next->modes;
    panda_real sum = PANDA_R(0.0);
    for (int i = next->active; i < modes->count; ++i) {
        const panda_real rate = PANDA_SQRT(modes->squared[i]);
        const panda_real away = a[i] + modes->row[i]/modes->squared[i]*s->f;
        const panda_real swing = PANDA_SQRT(away*away + b[i]*b[i]/modes->squared[i]);
        sum += (region->stiffness + region->damping*rate)*PANDA_FABS(modes->row[i])*swing;
    }
    return sum;
}

void panda_release(panda_state *s)
{
    const panda_impact *const impact = s->impact;
    const panda_phase *const next = &impact->phase[PANDA_LOOSE];
    const panda_modes *const modes = &next->modes;
    panda_real place[PANDA_SYSTEM];
    panda_real rate[PANDA_SYSTEM];
    panda_real a[PANDA_MODES];
    panda_real b[PANDA_MODES];
    if (s->phase->damped) {
        panda_damp(s->phase, s->speed, s->owed, s->rate);
    }
    coordinates_of(s, PANDA_STRUCTURED && impact->motors == PANDA_MOTORS_DRIVEN ? PANDA_N : PANDA_SYSTEM, place, rate);
#if PANDA_STRUCTURED
    const panda_modes *const before = &s->phase->modes;
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    panda_real x = s->drifted - s->phase->compliance*s->f;
    panda_real v = s->phase->drift*s->speed;
    for (int i = 0; i < own; ++i) {
        x += before->row[i]*s->amplitude[i];
        v += before->row[i]*s->rate[i];
    }
    for (int j = 0; j < PANDA_N; ++j) {
        if (impact->motors == PANDA_MOTORS_SERVO) {
            const panda_real root = PANDA_SQRT(PANDA_SPRING(impact->p, j));
            place[j] = root*(place[j] - place[PANDA_N + j]);
            rate[j] = root*(rate[j] - rate[PANDA_N + j]);
        }
        x -= impact->carried[j]*place[j];
        v -= impact->carried[j]*rate[j];
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
    for (int i = 1; i < modes->count; ++i) {
        a[i] = PANDA_R(0.0);
        b[i] = PANDA_R(0.0);
        for (int j = 0; j < PANDA_N; ++j) {
            a[i] += modes->shape[i][j]*place[j];
            b[i] += modes->shape[i][j]*rate[j];
        }
        if (modes->squared[i] > PANDA_R(0.0)) {
            a[i] /= modes->squared[i];
            b[i] /= modes->squared[i];
        }
    }
#else
    panda_real momentum[PANDA_SYSTEM];
    panda_real carry[PANDA_SYSTEM];
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        const panda_real before = s->speed*impact->arrival.rates[j % PANDA_N];
        place[j] += before*s->time;
        rate[j] += before;
    }
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        momentum[j] = PANDA_R(0.0);
        carry[j] = PANDA_R(0.0);
        if (j < PANDA_N) {
            for (int k = 0; k < PANDA_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*rate[k];
                carry[j] += impact->arrival.links.M[j][k]*place[k];
            }
        }
#if PANDA_ELASTIC
        if (j >= PANDA_N) {
            momentum[j] = PANDA_ROTOR(impact->p, j - PANDA_N)*rate[j];
            carry[j] = PANDA_ROTOR(impact->p, j - PANDA_N)*place[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = PANDA_R(0.0);
        b[i] = PANDA_R(0.0);
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
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
    const panda_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    panda_phase_begin(next, s->touching ? LET_GO : 0, s);
}

