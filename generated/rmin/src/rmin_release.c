/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of rmin_ when its motors are let go, in modes of loose motors. */
#include "rmin_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (RMIN_ELASTIC ? 2 : RMIN_LEVELS - 1)

/* Amplitudes and rates of modes beside the motion before, in their order `from`; the force bends those that stand. */
static void beside(const rmin_state *s, rmin_real a[RMIN_MODES], rmin_real b[RMIN_MODES])
{
    const rmin_modes *const modes = &s->phase->modes;
    for (int i = 0; i < modes->count; ++i) {
        const int from = modes->from[i];
        const bool moves = i < s->phase->active;
        const rmin_real led = modes->start[i]*s->speed;
        const rmin_real per = RMIN_R(1.0)/modes->row[i];
        a[from] = moves ? per*s->motion->place[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        b[from] = moves ? per*s->motion->rate[i] - led : RMIN_R(0.0);
    }
}

/* Displacements and velocities of links and motors, from those of modes. */
static void coordinates_of(const rmin_modes *modes, const rmin_real *a, const rmin_real *b,
    rmin_real place[RMIN_SYSTEM], rmin_real rate[RMIN_SYSTEM])
{
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        rmin_real x = RMIN_R(0.0);
        rmin_real v = RMIN_R(0.0);
        for (int i = 0; i < modes->count; ++i) {
            x += modes->shape[i][j]*a[i];
            v += modes->shape[i][j]*b[i];
        }
        place[j] = x;
        rate[j] = v;
    }
}

#if RMIN_STRUCTURED
/* What springs are bent by, times the roots of their stiffness, and the rates of that, for those of modes. */
static void bend(const rmin_state *s, rmin_real a[RMIN_MODES], rmin_real b[RMIN_MODES])
{
    const rmin_modes *const modes = &s->phase->modes;
    if (s->impact->motors == RMIN_MOTORS_SERVO) {
        rmin_real place[RMIN_SYSTEM];
        rmin_real rate[RMIN_SYSTEM];
        coordinates_of(modes, a, b, place, rate);
        for (int j = 0; j < RMIN_N; ++j) {
            const rmin_real root = RMIN_SQRT(RMIN_SPRING(s->impact->p, j));
            a[j] = root*(place[j] - place[RMIN_N + j]);
            b[j] = root*(rate[j] - rate[RMIN_N + j]);
        }
    } else {
        for (int i = 0; i < modes->count; ++i) {
            const int from = modes->from[i];
            const rmin_real fast = RMIN_SQRT(modes->squared[i]);
            a[from] *= fast;
            b[from] *= fast;
        }
        rmin_compose(&modes->turns, a, b);
    }
}
#endif

/*
 * Most that modes that stand, bent by the force, add to it as they swing about that: springs that
 * motors wound up may hold more energy than the body does.
 */
static rmin_real swings_of(const rmin_state *s, const rmin_phase *next, const rmin_real *a, const rmin_real *b)
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
    rmin_real place[RMIN_MODES] = {0}; /* of modes, and then of what they move */
    rmin_real rate[RMIN_MODES] = {0};
    rmin_real a[RMIN_MODES]; /* amplitudes of the modes that follow */
    rmin_real b[RMIN_MODES];
    rmin_feel(s);
    rmin_motion *const motion = s->motion;
    if (s->phase->damped) {
        rmin_damp(s->phase, s->speed, s->owed, motion->rate);
    }
    const int was = s->phase->active > 0 ? s->phase->active - 1 : 0; /* the body, if it gives way */
    const rmin_real body = motion->place[was];
    const rmin_real body_rate = motion->rate[was];
    beside(s, place, rate);
#if RMIN_STRUCTURED
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    rmin_real x = s->drifted - s->phase->compliance*s->f;
    rmin_real v = s->phase->drift*s->speed;
    bend(s, place, rate);
    for (int i = 0; i < own; ++i) {
        x += motion->place[i];
        v += motion->rate[i];
    }
    rmin_decompose(&modes->turns, place, rate);
    for (int i = 1; i < modes->count; ++i) {
        const int from = modes->from[i];
        if (from < RMIN_N) {
            const rmin_real slow = RMIN_R(1.0)/RMIN_SQRT(modes->squared[i]);
            a[i] = place[from]*slow;
            b[i] = rate[from]*slow;
            x -= modes->row[i]*a[i];
            v -= modes->row[i]*b[i];
        }
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
#else
    rmin_real momentum[RMIN_SYSTEM];
    rmin_real carry[RMIN_SYSTEM];
    rmin_real moved[RMIN_SYSTEM];
    rmin_real moving[RMIN_SYSTEM];
    coordinates_of(&s->phase->modes, place, rate, moved, moving);
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        const rmin_real before = s->speed*impact->arrival.rates[j % RMIN_N];
        moved[j] += before*s->time;
        moving[j] += before;
    }
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        momentum[j] = RMIN_R(0.0);
        carry[j] = RMIN_R(0.0);
        if (j < RMIN_N) {
            for (int k = 0; k < RMIN_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*moving[k];
                carry[j] += impact->arrival.links.M[j][k]*moved[k];
            }
        }
#if RMIN_ELASTIC
        if (j >= RMIN_N) {
            momentum[j] = RMIN_ROTOR(impact->p, j - RMIN_N)*moving[j];
            carry[j] = RMIN_ROTOR(impact->p, j - RMIN_N)*moved[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = RMIN_R(0.0);
        b[i] = RMIN_R(0.0);
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
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
    const rmin_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    rmin_phase_begin(next, s->touching ? LET_GO : 0, s);
}
