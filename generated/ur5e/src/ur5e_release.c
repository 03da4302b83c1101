/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of ur5e_ when its motors are let go, in modes of loose motors. */
#include "ur5e_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (UR5E_ELASTIC ? 2 : UR5E_LEVELS - 1)

/* Amplitudes and rates of modes beside the motion before, in their order `from`; the force bends those that stand. */
static void beside(const ur5e_state *s, ur5e_real a[UR5E_MODES], ur5e_real b[UR5E_MODES])
{
    const ur5e_modes *const modes = &s->phase->modes;
    for (int i = 0; i < modes->count; ++i) {
        const int from = modes->from[i];
        const bool moves = i < s->phase->active;
        const ur5e_real led = modes->start[i]*s->speed;
        const ur5e_real per = UR5E_R(1.0)/modes->row[i];
        a[from] = moves ? per*s->motion->place[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        b[from] = moves ? per*s->motion->rate[i] - led : UR5E_R(0.0);
    }
}

/* Displacements and velocities of links and motors, from those of modes. */
static void coordinates_of(const ur5e_modes *modes, const ur5e_real *a, const ur5e_real *b,
    ur5e_real place[UR5E_SYSTEM], ur5e_real rate[UR5E_SYSTEM])
{
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        ur5e_real x = UR5E_R(0.0);
        ur5e_real v = UR5E_R(0.0);
        for (int i = 0; i < modes->count; ++i) {
            x += modes->shape[i][j]*a[i];
            v += modes->shape[i][j]*b[i];
        }
        place[j] = x;
        rate[j] = v;
    }
}

#if UR5E_STRUCTURED
/* What springs are bent by, times the roots of their stiffness, and the rates of that, for those of modes. */
static void bend(const ur5e_state *s, ur5e_real a[UR5E_MODES], ur5e_real b[UR5E_MODES])
{
    const ur5e_modes *const modes = &s->phase->modes;
    if (s->impact->motors == UR5E_MOTORS_SERVO) {
        ur5e_real place[UR5E_SYSTEM];
        ur5e_real rate[UR5E_SYSTEM];
        coordinates_of(modes, a, b, place, rate);
        for (int j = 0; j < UR5E_N; ++j) {
            const ur5e_real root = UR5E_SQRT(UR5E_SPRING(s->impact->p, j));
            a[j] = root*(place[j] - place[UR5E_N + j]);
            b[j] = root*(rate[j] - rate[UR5E_N + j]);
        }
    } else {
        for (int i = 0; i < modes->count; ++i) {
            const int from = modes->from[i];
            const ur5e_real fast = UR5E_SQRT(modes->squared[i]);
            a[from] *= fast;
            b[from] *= fast;
        }
        ur5e_compose(&modes->turns, a, b);
    }
}
#endif

/*
 * Most that modes that stand, bent by the force, add to it as they swing about that: springs that
 * motors wound up may hold more energy than the body does.
 */
static ur5e_real swings_of(const ur5e_state *s, const ur5e_phase *next, const ur5e_real *a, const ur5e_real *b)
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
    ur5e_real place[UR5E_MODES] = {0}; /* of modes, and then of what they move */
    ur5e_real rate[UR5E_MODES] = {0};
    ur5e_real a[UR5E_MODES]; /* amplitudes of the modes that follow */
    ur5e_real b[UR5E_MODES];
    ur5e_feel(s);
    ur5e_motion *const motion = s->motion;
    if (s->phase->damped) {
        ur5e_damp(s->phase, s->speed, s->owed, motion->rate);
    }
    const int was = s->phase->active > 0 ? s->phase->active - 1 : 0; /* the body, if it gives way */
    const ur5e_real body = motion->place[was];
    const ur5e_real body_rate = motion->rate[was];
    beside(s, place, rate);
#if UR5E_STRUCTURED
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    ur5e_real x = s->drifted - s->phase->compliance*s->f;
    ur5e_real v = s->phase->drift*s->speed;
    bend(s, place, rate);
    for (int i = 0; i < own; ++i) {
        x += motion->place[i];
        v += motion->rate[i];
    }
    ur5e_decompose(&modes->turns, place, rate);
    for (int i = 1; i < modes->count; ++i) {
        const int from = modes->from[i];
        if (from < UR5E_N) {
            const ur5e_real slow = UR5E_R(1.0)/UR5E_SQRT(modes->squared[i]);
            a[i] = place[from]*slow;
            b[i] = rate[from]*slow;
            x -= modes->row[i]*a[i];
            v -= modes->row[i]*b[i];
        }
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
#else
    ur5e_real momentum[UR5E_SYSTEM];
    ur5e_real carry[UR5E_SYSTEM];
    ur5e_real moved[UR5E_SYSTEM];
    ur5e_real moving[UR5E_SYSTEM];
    coordinates_of(&s->phase->modes, place, rate, moved, moving);
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        const ur5e_real before = s->speed*impact->arrival.rates[j % UR5E_N];
        moved[j] += before*s->time;
        moving[j] += before;
    }
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        momentum[j] = UR5E_R(0.0);
        carry[j] = UR5E_R(0.0);
        if (j < UR5E_N) {
            for (int k = 0; k < UR5E_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*moving[k];
                carry[j] += impact->arrival.links.M[j][k]*moved[k];
            }
        }
#if UR5E_ELASTIC
        if (j >= UR5E_N) {
            momentum[j] = UR5E_ROTOR(impact->p, j - UR5E_N)*moving[j];
            carry[j] = UR5E_ROTOR(impact->p, j - UR5E_N)*moved[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = UR5E_R(0.0);
        b[i] = UR5E_R(0.0);
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
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
    const ur5e_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    ur5e_phase_begin(next, s->touching ? LET_GO : 0, s);
}
