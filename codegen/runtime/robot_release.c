/* SPDX-License-Identifier: 0BSD */
/* What is left of an impact of robot_ when its motors are let go, in modes of loose motors. */
#include "robot_state.h"

/*
 * Level of the first step in contact: where motors are on the links themselves these have another acceleration at
 * once; behind springs only its second rate is another, and a quarter of the longest step does.
 */
#define LET_GO (ROBOT_ELASTIC ? 2 : ROBOT_LEVELS - 1)

/* Amplitudes and rates of modes beside the motion before, in their order `from`; the force bends those that stand. */
static void beside(const robot_state *s, robot_real a[ROBOT_MODES], robot_real b[ROBOT_MODES])
{
    const robot_modes *const modes = &s->phase->modes;
    for (int i = 0; i < modes->count; ++i) {
        const int from = modes->from[i];
        const bool moves = i < s->phase->active;
        const robot_real led = modes->start[i]*s->speed;
        const robot_real per = ROBOT_R(1.0)/modes->row[i];
        a[from] = moves ? per*s->motion->place[i] - led*s->time : -modes->row[i]/modes->squared[i]*s->f;
        b[from] = moves ? per*s->motion->rate[i] - led : ROBOT_R(0.0);
    }
}

/* Displacements and velocities of links and motors, from those of modes. */
static void coordinates_of(const robot_modes *modes, const robot_real *a, const robot_real *b,
    robot_real place[ROBOT_SYSTEM], robot_real rate[ROBOT_SYSTEM])
{
    for (int j = 0; j < ROBOT_SYSTEM; ++j) {
        robot_real x = ROBOT_R(0.0);
        robot_real v = ROBOT_R(0.0);
        for (int i = 0; i < modes->count; ++i) {
            x += modes->shape[i][j]*a[i];
            v += modes->shape[i][j]*b[i];
        }
        place[j] = x;
        rate[j] = v;
    }
}

#if ROBOT_STRUCTURED
/* What springs are bent by, times the roots of their stiffness, and the rates of that, for those of modes. */
static void bend(const robot_state *s, robot_real a[ROBOT_MODES], robot_real b[ROBOT_MODES])
{
    const robot_modes *const modes = &s->phase->modes;
    if (s->impact->motors == ROBOT_MOTORS_SERVO) {
        robot_real place[ROBOT_SYSTEM];
        robot_real rate[ROBOT_SYSTEM];
        coordinates_of(modes, a, b, place, rate);
        for (int j = 0; j < ROBOT_N; ++j) {
            const robot_real root = ROBOT_SQRT(ROBOT_SPRING(s->impact->p, j));
            a[j] = root*(place[j] - place[ROBOT_N + j]);
            b[j] = root*(rate[j] - rate[ROBOT_N + j]);
        }
    } else {
        for (int i = 0; i < modes->count; ++i) {
            const int from = modes->from[i];
            const robot_real fast = ROBOT_SQRT(modes->squared[i]);
            a[from] *= fast;
            b[from] *= fast;
        }
        robot_compose(&modes->turns, a, b);
    }
}
#endif

/*
 * Most that modes that stand, bent by the force, add to it as they swing about that: springs that
 * motors wound up may hold more energy than the body does.
 */
static robot_real swings_of(const robot_state *s, const robot_phase *next, const robot_real *a, const robot_real *b)
{
    const robot_region *const region = s->impact->region;
    const robot_modes *const modes = &next->modes;
    robot_real sum = ROBOT_R(0.0);
    for (int i = next->active; i < modes->count; ++i) {
        const robot_real rate = ROBOT_SQRT(modes->squared[i]);
        const robot_real away = a[i] + modes->row[i]/modes->squared[i]*s->f;
        const robot_real swing = ROBOT_SQRT(away*away + b[i]*b[i]/modes->squared[i]);
        sum += (region->stiffness + region->damping*rate)*ROBOT_FABS(modes->row[i])*swing;
    }
    return sum;
}

void robot_release(robot_state *s)
{
    const robot_impact *const impact = s->impact;
    const robot_phase *const next = &impact->phase[ROBOT_LOOSE];
    const robot_modes *const modes = &next->modes;
    robot_real place[ROBOT_MODES] = {0}; /* of modes, and then of what they move */
    robot_real rate[ROBOT_MODES] = {0};
    robot_real a[ROBOT_MODES]; /* amplitudes of the modes that follow */
    robot_real b[ROBOT_MODES];
    robot_feel(s);
    robot_motion *const motion = s->motion;
    if (s->phase->damped) {
        robot_damp(s->phase, s->speed, s->owed, motion->rate);
    }
    const int was = s->phase->active > 0 ? s->phase->active - 1 : 0; /* the body, if it gives way */
    const robot_real body = motion->place[was];
    const robot_real body_rate = motion->rate[was];
    beside(s, place, rate);
#if ROBOT_STRUCTURED
    const int own = s->phase->active - (impact->gives_way ? 1 : 0);
    robot_real x = s->drifted - s->phase->compliance*s->f;
    robot_real v = s->phase->drift*s->speed;
    bend(s, place, rate);
    for (int i = 0; i < own; ++i) {
        x += motion->place[i];
        v += motion->rate[i];
    }
    robot_decompose(&modes->turns, place, rate);
    for (int i = 1; i < modes->count; ++i) {
        const int from = modes->from[i];
        if (from < ROBOT_N) {
            const robot_real slow = ROBOT_R(1.0)/ROBOT_SQRT(modes->squared[i]);
            a[i] = place[from]*slow;
            b[i] = rate[from]*slow;
            x -= modes->row[i]*a[i];
            v -= modes->row[i]*b[i];
        }
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
#else
    robot_real momentum[ROBOT_SYSTEM];
    robot_real carry[ROBOT_SYSTEM];
    robot_real moved[ROBOT_SYSTEM];
    robot_real moving[ROBOT_SYSTEM];
    coordinates_of(&s->phase->modes, place, rate, moved, moving);
    for (int j = 0; j < ROBOT_SYSTEM; ++j) {
        const robot_real before = s->speed*impact->arrival.rates[j % ROBOT_N];
        moved[j] += before*s->time;
        moving[j] += before;
    }
    for (int j = 0; j < ROBOT_SYSTEM; ++j) {
        momentum[j] = ROBOT_R(0.0);
        carry[j] = ROBOT_R(0.0);
        if (j < ROBOT_N) {
            for (int k = 0; k < ROBOT_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*moving[k];
                carry[j] += impact->arrival.links.M[j][k]*moved[k];
            }
        }
#if ROBOT_ELASTIC
        if (j >= ROBOT_N) {
            momentum[j] = ROBOT_ROTOR(impact->p, j - ROBOT_N)*moving[j];
            carry[j] = ROBOT_ROTOR(impact->p, j - ROBOT_N)*moved[j];
        }
#endif
    }
    for (int i = 0; i < modes->count; ++i) {
        a[i] = ROBOT_R(0.0);
        b[i] = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
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
    const robot_real more = next->compliance - s->phase->compliance; /* of modes that stand from now on */
    s->x += more*s->f;
    s->u += more*s->f;
    s->u_before += more*(s->f - s->rise);
    s->past = s->past > 1 ? 1 : s->past;
    robot_phase_begin(next, s->touching ? LET_GO : 0, s);
}
