/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of rmin_ when its motors are let go, in modes of loose motors. */
#include "rmin_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (RMIN_ELASTIC ? 2 : RMIN_LEVELS - 1)

/* Displacements and velocities of `size` coordinates beside the motion before, from a phase's modes. */
static void coordinates_of(const rmin_state *s, int size, rmin_real *place, rmin_real *rate)
{
    const rmin_modes *const modes = &s->phase->modes;
    for (int j = 0; j < size; ++j) {
        place[j] = RMIN_R(0.0);
        rate[j] = RMIN_R(0.0);
    }
    for (int i = 0; i < modes->count; ++i) {
        const bool moves = i < s->phase->active;
        const rmin_real led = modes->start[i]*s->speed;
        const rmin_real a = moves ? s->amplitude[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        const rmin_real b = moves ? s->rate[i] - led : RMIN_R(0.0);
        const rmin_real *const shape = modes->shape[i];
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
static rmin_real swings_of(const rmin_state *s, const rmin_phase *next, const rmin_real *a,
    const rmin_real *b)
{
    const rmin_region *const region = s->impact->region;
    const rmin_modes *const modes = &next->modes;
    rmin_real sum = RMIN_R(0.0);
    for (int i = next->active; i < modes->count; ++i) {
        const rmin_real rate = RMIN_SQRT(modes->squared[i]);
        const rmin_real away = a[i] + modes->row[i]/modes->squared[i]*s->f;
        const rmin_real swing = RMIN_SQRT(away*away + b[i]*b[i]/modes->squared[i]);
        sum += (region->stiffness + region->damping*rate)*RMIN_FABS(modes->row[i])*swing;
    }
    return sum;
}

void rmin_release(rmin_state *s)
{
    const rmin_impact *const impact = s->impact;
    const rmin_phase *const next = &impact->phase[RMIN_LOOSE];
    const rmin_modes *const modes = &next->modes;
    rmin_real place[RMIN_SYSTEM];
    rmin_real rate[RMIN_SYSTEM];
    rmin_real a[RMIN_MODES];
    rmin_real b[RMIN_MODES];
    if (s->phase->damped) {
        rmin_damp(s->phase, s->speed, s->owed, s->rate);
    }
    coordinates_of(s, RMIN_STRUCTURED && impact->motors == RMIN_MOTORS_DRIVEN ? RMIN_N : RMIN_SYSTEM, place, rate);
#if RMIN_STRUCTURED
    const rmin_modes *const before = &s->phase->modes;
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    rmin_real x = s->drifted - s->phase->compliance*s->f;
    rmin_real v = s->phase->drift*s->speed;
    for (int i = 0; i < own; ++i) {
        x += before->row[i]*s->amplitude[i];
        v += before->row[i]*s->rate[i];
    }
    for (int j = 0; j < RMIN_N; ++j) {
        if (impact->motors == RMIN_MOTORS_SERVO) {
            const rmin_real root = RMIN_SQRT(RMIN_SPRING(impact->p, j));
            place[j] = root*(place[j] - place[RMIN_N + j]);
            rate[j] = root*(rate[j] - rate[RMIN_N + j]);
        }
        x -= impact->carried[j]*place[j];
        v -= impact->carried[j]*rate[j];
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
    for (int i = 1; i < modes->count; ++i) {
        a[i] = RMIN_R(0.0);
        b[i] = RMIN_R(0.0);
        for (int j = 0; j < RMIN_N; ++j) {
            a[i] += modes->shape[i][j]*place[j];
            b[i] += modes->shape[i][j]*rate[j];
        }
        if (modes->squared[i] > RMIN_R(0.0)) {
            a[i] /= modes->squared[i];
            b[i] /= modes->squared[i];
        }
    }
#else
    rmin_real momentum[RMIN_SYSTEM];
    rmin_real carry[RMIN_SYSTEM];
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        const rmin_real before = s->speed*impact->arrival.rates[j % RMIN_N];
        place[j] += before*s->time;
        rate[j] += before;
    }
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        momentum[j] = RMIN_R(0.0);
        carry[j] = RMIN_R(0.0);
        if (j < RMIN_N) {
            for (int k = 0; k < RMIN_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*rate[k];
                carry[j] += impact->arrival.links.M[j][k]*place[k];
            }
        }
#if RMIN_ELASTIC
        if (j >= RMIN_N) {
            momentum[j] = RMIN_ROTOR(impact->p, j - RMIN_N)*rate[j];
            carry[j] = RMIN_ROTOR(impact->p, j - RMIN_N)*place[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = RMIN_R(0.0);
        b[i] = RMIN_R(0.0);
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
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
    const rmin_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    rmin_phase_begin(next, s->touching ? LET_GO : 0, s);
}

