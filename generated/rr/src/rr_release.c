/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of rr_ when its motors are let go, in modes of loose motors. */
#include "rr_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (RR_ELASTIC ? 2 : RR_LEVELS - 1)

/* Amplitudes and rates of modes beside the motion before, in their order `from`; the force bends those that stand. */
static void beside(const rr_state *s, rr_real a[RR_MODES], rr_real b[RR_MODES])
{
    const rr_modes *const modes = &s->phase->modes;
    for (int i = 0; i < modes->count; ++i) {
        const int from = modes->from[i];
        const bool moves = i < s->phase->active;
        const rr_real led = modes->start[i]*s->speed;
        const rr_real per = RR_R(1.0)/modes->row[i];
        a[from] = moves ? per*s->motion->place[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        b[from] = moves ? per*s->motion->rate[i] - led : RR_R(0.0);
    }
}

/* Displacements and velocities of links and motors, from those of modes. */
static void coordinates_of(const rr_modes *modes, const rr_real *a, const rr_real *b,
    rr_real place[RR_SYSTEM], rr_real rate[RR_SYSTEM])
{
    for (int j = 0; j < RR_SYSTEM; ++j) {
        rr_real x = RR_R(0.0);
        rr_real v = RR_R(0.0);
        for (int i = 0; i < modes->count; ++i) {
            x += modes->shape[i][j]*a[i];
            v += modes->shape[i][j]*b[i];
        }
        place[j] = x;
        rate[j] = v;
    }
}

#if RR_STRUCTURED
/* What springs are bent by, times the roots of their stiffness, and the rates of that, for those of modes. */
static void bend(const rr_state *s, rr_real a[RR_MODES], rr_real b[RR_MODES])
{
    const rr_modes *const modes = &s->phase->modes;
    if (s->impact->motors == RR_MOTORS_SERVO) {
        rr_real place[RR_SYSTEM];
        rr_real rate[RR_SYSTEM];
        coordinates_of(modes, a, b, place, rate);
        for (int j = 0; j < RR_N; ++j) {
            const rr_real root = RR_SQRT(RR_SPRING(s->impact->p, j));
            a[j] = root*(place[j] - place[RR_N + j]);
            b[j] = root*(rate[j] - rate[RR_N + j]);
        }
    } else {
        for (int i = 0; i < modes->count; ++i) {
            const int from = modes->from[i];
            const rr_real fast = RR_SQRT(modes->squared[i]);
            a[from] *= fast;
            b[from] *= fast;
        }
        rr_compose(&modes->turns, a, b);
    }
}
#endif

/*
 * Most that modes that stand, bent by the force, add to it as they swing about that: springs that
 * motors wound up may hold more energy than the body does.
 */
static rr_real swings_of(const rr_state *s, const rr_phase *next, const rr_real *a, const rr_real *b)
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
    rr_real place[RR_MODES] = {0}; /* of modes, and then of what they move */
    rr_real rate[RR_MODES] = {0};
    rr_real a[RR_MODES]; /* amplitudes of the modes that follow */
    rr_real b[RR_MODES];
    rr_feel(s);
    rr_motion *const motion = s->motion;
    if (s->phase->damped) {
        rr_damp(s->phase, s->speed, s->owed, motion->rate);
    }
    const int was = s->phase->active > 0 ? s->phase->active - 1 : 0; /* the body, if it gives way */
    const rr_real body = motion->place[was];
    const rr_real body_rate = motion->rate[was];
    beside(s, place, rate);
#if RR_STRUCTURED
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    rr_real x = s->drifted - s->phase->compliance*s->f;
    rr_real v = s->phase->drift*s->speed;
    bend(s, place, rate);
    for (int i = 0; i < own; ++i) {
        x += motion->place[i];
        v += motion->rate[i];
    }
    rr_decompose(&modes->turns, place, rate);
    for (int i = 1; i < modes->count; ++i) {
        const int from = modes->from[i];
        if (from < RR_N) {
            const rr_real slow = RR_R(1.0)/RR_SQRT(modes->squared[i]);
            a[i] = place[from]*slow;
            b[i] = rate[from]*slow;
            x -= modes->row[i]*a[i];
            v -= modes->row[i]*b[i];
        }
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
#else
    rr_real momentum[RR_SYSTEM];
    rr_real carry[RR_SYSTEM];
    rr_real moved[RR_SYSTEM];
    rr_real moving[RR_SYSTEM];
    coordinates_of(&s->phase->modes, place, rate, moved, moving);
    for (int j = 0; j < RR_SYSTEM; ++j) {
        const rr_real before = s->speed*impact->arrival.rates[j % RR_N];
        moved[j] += before*s->time;
        moving[j] += before;
    }
    for (int j = 0; j < RR_SYSTEM; ++j) {
        momentum[j] = RR_R(0.0);
        carry[j] = RR_R(0.0);
        if (j < RR_N) {
            for (int k = 0; k < RR_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*moving[k];
                carry[j] += impact->arrival.links.M[j][k]*moved[k];
            }
        }
#if RR_ELASTIC
        if (j >= RR_N) {
            momentum[j] = RR_ROTOR(impact->p, j - RR_N)*moving[j];
            carry[j] = RR_ROTOR(impact->p, j - RR_N)*moved[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = RR_R(0.0);
        b[i] = RR_R(0.0);
        for (int j = 0; j < RR_SYSTEM; ++j) {
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
    const rr_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    rr_phase_begin(next, s->touching ? LET_GO : 0, s);
}
