/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of rr_ when its motors are let go, in modes of loose motors. */
#include "rr_state.h"

/* Levels by which the first step is shorter than the last: the bend of the force jumps. */
#define AFTER 2

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

void rr_release(rr_state *s)
{
    const rr_impact *const impact = s->impact;
    const rr_phase *const next = &impact->phase[RR_LOOSE];
    const rr_modes *const modes = &next->modes;
    rr_real place[RR_SYSTEM];
    rr_real rate[RR_SYSTEM];
    rr_real a[RR_MODES];
    rr_real b[RR_MODES];
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
    for (int i = 1; i < next->active; ++i) {
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
    for (int i = 0; i < next->active; ++i) {
        a[i] = RR_R(0.0);
        b[i] = RR_R(0.0);
        for (int j = 0; j < RR_SYSTEM; ++j) {
            a[i] += modes->shape[i][j]*carry[j];
            b[i] += modes->shape[i][j]*momentum[j];
        }
    }
#endif
    /* The body is the last of the modes that move: at least one does. */
    if (impact->gives_way && next->active > 0 && s->phase->active > 0) {
        a[next->active - 1] = s->amplitude[s->phase->active - 1];
        b[next->active - 1] = s->rate[s->phase->active - 1];
    }
    for (int i = 0; i < next->active; ++i) {
        s->amplitude[i] = a[i];
        s->rate[i] = b[i];
    }
    const rr_real h = s->phase->level[s->level].h;
    s->phase = next;
    s->drifted = RR_R(0.0);
    s->level = 0;
    for (int k = 0; k < RR_LEVELS - 1; ++k) { /* the longest step that is no longer than the last */
        s->level = next->level[k].h > RR_R(1.01)*h ? k + 1 : s->level;
    }
    s->level = s->level + AFTER < RR_LEVELS ? s->level + AFTER : RR_LEVELS - 1;
    s->past = s->past > 1 ? 1 : s->past;
    s->ticks = next->steps*(1 << (RR_LEVELS - 1));
}

