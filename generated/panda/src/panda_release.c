/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of panda_ when its motors are let go, in modes of loose motors. */
#include "panda_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (PANDA_ELASTIC ? 2 : PANDA_LEVELS - 1)

/* Amplitudes and rates of modes beside the motion before, in their order `from`; the force bends those that stand. */
static void beside(const panda_state *s, panda_real a[PANDA_MODES], panda_real b[PANDA_MODES])
{
    const panda_modes *const modes = &s->phase->modes;
    for (int i = 0; i < modes->count; ++i) {
        const int from = modes->from[i];
        const bool moves = i < s->phase->active;
        const panda_real led = modes->start[i]*s->speed;
        const panda_real per = PANDA_R(1.0)/modes->row[i];
        a[from] = moves ? per*s->motion->place[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        b[from] = moves ? per*s->motion->rate[i] - led : PANDA_R(0.0);
    }
}

/* Displacements and velocities of links and motors, from those of modes. */
static void coordinates_of(const panda_modes *modes, const panda_real *a, const panda_real *b,
    panda_real place[PANDA_SYSTEM], panda_real rate[PANDA_SYSTEM])
{
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        panda_real x = PANDA_R(0.0);
        panda_real v = PANDA_R(0.0);
        for (int i = 0; i < modes->count; ++i) {
            x += modes->shape[i][j]*a[i];
            v += modes->shape[i][j]*b[i];
        }
        place[j] = x;
        rate[j] = v;
    }
}

#if PANDA_STRUCTURED
/* What springs are bent by, times the roots of their stiffness, and the rates of that, for those of modes. */
static void bend(const panda_state *s, panda_real a[PANDA_MODES], panda_real b[PANDA_MODES])
{
    const panda_modes *const modes = &s->phase->modes;
    if (s->impact->motors == PANDA_MOTORS_SERVO) {
        panda_real place[PANDA_SYSTEM];
        panda_real rate[PANDA_SYSTEM];
        coordinates_of(modes, a, b, place, rate);
        for (int j = 0; j < PANDA_N; ++j) {
            const panda_real root = PANDA_SQRT(PANDA_SPRING(s->impact->p, j));
            a[j] = root*(place[j] - place[PANDA_N + j]);
            b[j] = root*(rate[j] - rate[PANDA_N + j]);
        }
    } else {
        for (int i = 0; i < modes->count; ++i) {
            const int from = modes->from[i];
            const panda_real fast = PANDA_SQRT(modes->squared[i]);
            a[from] *= fast;
            b[from] *= fast;
        }
        panda_compose(&modes->turns, a, b);
    }
}
#endif

/*
 * Most that modes that stand, bent by the force, add to it as they swing about that: springs that
 * motors wound up may hold more energy than the body does.
 */
static panda_real swings_of(const panda_state *s, const panda_phase *next, const panda_real *a, const panda_real *b)
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
    panda_real place[PANDA_MODES] = {0}; /* of modes, and then of what they move */
    panda_real rate[PANDA_MODES] = {0};
    panda_real a[PANDA_MODES]; /* amplitudes of the modes that follow */
    panda_real b[PANDA_MODES];
    panda_feel(s);
    panda_motion *const motion = s->motion;
    if (s->phase->damped) {
        panda_damp(s->phase, s->speed, s->owed, motion->rate);
    }
    const int was = s->phase->active > 0 ? s->phase->active - 1 : 0; /* the body, if it gives way */
    const panda_real body = motion->place[was];
    const panda_real body_rate = motion->rate[was];
    beside(s, place, rate);
#if PANDA_STRUCTURED
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    panda_real x = s->drifted - s->phase->compliance*s->f;
    panda_real v = s->phase->drift*s->speed;
    bend(s, place, rate);
    for (int i = 0; i < own; ++i) {
        x += motion->place[i];
        v += motion->rate[i];
    }
    panda_decompose(&modes->turns, place, rate);
    for (int i = 1; i < modes->count; ++i) {
        const int from = modes->from[i];
        if (from < PANDA_N) {
            const panda_real slow = PANDA_R(1.0)/PANDA_SQRT(modes->squared[i]);
            a[i] = place[from]*slow;
            b[i] = rate[from]*slow;
            x -= modes->row[i]*a[i];
            v -= modes->row[i]*b[i];
        }
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
#else
    panda_real momentum[PANDA_SYSTEM];
    panda_real carry[PANDA_SYSTEM];
    panda_real moved[PANDA_SYSTEM];
    panda_real moving[PANDA_SYSTEM];
    coordinates_of(&s->phase->modes, place, rate, moved, moving);
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        const panda_real before = s->speed*impact->arrival.rates[j % PANDA_N];
        moved[j] += before*s->time;
        moving[j] += before;
    }
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        momentum[j] = PANDA_R(0.0);
        carry[j] = PANDA_R(0.0);
        if (j < PANDA_N) {
            for (int k = 0; k < PANDA_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*moving[k];
                carry[j] += impact->arrival.links.M[j][k]*moved[k];
            }
        }
#if PANDA_ELASTIC
        if (j >= PANDA_N) {
            momentum[j] = PANDA_ROTOR(impact->p, j - PANDA_N)*moving[j];
            carry[j] = PANDA_ROTOR(impact->p, j - PANDA_N)*moved[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = PANDA_R(0.0);
        b[i] = PANDA_R(0.0);
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            a[i] += modes->shape[modes->from[i]][j]*carry[j];
            b[i] += modes->shape[modes->from[i]][j]*momentum[j];
        }
    }
#endif
    s->swings = swings_of(s, next, a, b);
    /* The body is the last of the modes that move: at least one does. */
    if (impact->gives_way && next->active > 0) {
        a[next->active - 1] = body/modes->row[next->active - 1];
        b[next->active - 1] = body_rate/modes->row[next->active - 1];
    }
    for (int i = 0; i < next->active; ++i) {
        motion->place[i] = modes->row[i]*a[i];
        motion->rate[i] = modes->row[i]*b[i];
    }
    const panda_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    panda_phase_begin(next, s->touching ? LET_GO : 0, s);
}
