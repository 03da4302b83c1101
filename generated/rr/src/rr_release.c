/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of rr_ when its motors are let go, in modes of loose motors. */
#include "rr_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (RR_ELASTIC ? 2 : RR_LEVELS - 1)

/* Displacements and velocities of `size` coordinates beside the motion before, from a phase's modes. */
static void coordinates_of(const rr_state *s, int size, rr_real *place, rr_real *rate)
{
    const rr_modes *const modes = &s->phase->modes;
    for (int j = 0; j < size; ++j) {
        place[j] = RR_R(0.0);
        rate[j] = RR_R(0.0);
    }
    for (int i = 0; i < modes->count; ++i) {
        const bool moves = i < s->phase->active;
        const rr_real led = modes->start[i]*s->speed;
        const rr_real a = moves ? s->amplitude[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        const rr_real b = moves ? s->rate[i] - led : RR_R(0.0);
        const rr_real *const shape = modes->shape[i];
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
static rr_real swings_of(const rr_state *s, const rr_phase *next, const rr_real *a,
    const rr_real *b)
{
    const rr_region *const region = s->impact->region;
    const rr_modes *const modes = &next->modes;
    rr_real sum = RR_R(0.0);
    for (int i = next->active; i < modes->count; ++i) {
        const rr_real rate = RR_SQRT(modes->squared[i]);
        const rr_real away = a[i] + modes->row[i]/modes->squared[i]*s->f;
        const rr_real swing = RR_SQRT(away*away + b[i]*b[i]/modes->squared[i]);
        sum += (region->stiffness + region->damping*rate)*RR_FABS(modes->row[i])*swing;
    }
    return sum;
}

void rr_release(rr_state *s)
{
    const rr_impact *const impact = s->impact;
    const rr_phase *const next = &impact->phase[RR_LOOSE];
    const rr_modes *const modes = &next->modes;
    rr_real place[RR_SYSTEM];
    rr_real rate[RR_SYSTEM];
    rr_real a[RR_MODES];
    rr_real b[RR_MODES];
    if (s->phase->damped) {
        rr_damp(s->phase, s->speed, s->owed, s->rate);
    }
    coordinates_of(s, RR_STRUCTURED && impact->motors == RR_MOTORS_DRIVEN ? RR_N : RR_SYSTEM, place, rate);
#if RR_STRUCTURED
    const rr_modes *const before = &s->phase->modes;
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    rr_real x = s->drifted - s->phase->compliance*s->f;
    rr_real v = s->phase->drift*s->speed;
    for (int i = 0; i < own; ++i) {
        x += before->row[i]*s->amplitude[i];
        v += before->row[i]*s->rate[i];
    }
    for (int j = 0; j < RR_N; ++j) {
        if (impact->motors == RR_MOTORS_SERVO) {
            const rr_real root = RR_SQRT(RR_SPRING(impact->p, j));
            place[j] = root*(place[j] - place[RR_N + j]);
            rate[j] = root*(rate[j] - rate[RR_N + j]);
        }
        x -= impact->carried[j]*place[j];
        v -= impact->carried[j]*rate[j];
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
    for (int i = 1; i < modes->count; ++i) {
        a[i] = RR_R(0.0);
        b[i] = RR_R(0.0);
        for (int j = 0; j < RR_N; ++j) {
            a[i] += modes->shape[i][j]*place[j];
            b[i] += modes->shape[i][j]*rate[j];
        }
        if (modes->squared[i] > RR_R(0.0)) {
            a[i] /= modes->squared[i];
            b[i] /= modes->squared[i];
        }
    }
#else
    rr_real momentum[RR_SYSTEM];
    rr_real carry[RR_SYSTEM];
    for (int j = 0; j < RR_SYSTEM; ++j) {
        const rr_real before = s->speed*impact->arrival.rates[j % RR_N];
        place[j] += before*s->time;
        rate[j] += before;
    }
    for (int j = 0; j < RR_SYSTEM; ++j) {
        momentum[j] = RR_R(0.0);
        carry[j] = RR_R(0.0);
        if (j < RR_N) {
            for (int k = 0; k < RR_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*rate[k];
                carry[j] += impact->arrival.links.M[j][k]*place[k];
            }
        }
#if RR_ELASTIC
        if (j >= RR_N) {
            momentum[j] = RR_ROTOR(impact->p, j - RR_N)*rate[j];
            carry[j] = RR_ROTOR(impact->p, j - RR_N)*place[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = RR_R(0.0);
        b[i] = RR_R(0.0);
        for (int j = 0; j < RR_SYSTEM; ++j) {
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
    const rr_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    rr_phase_begin(next, s->touching ? LET_GO : 0, s);
}

