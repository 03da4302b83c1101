/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Scales commanded joint velocities so that a collision with a chest stays below its limit.
 *
 * The control callback has the shape that 1 kHz interfaces such as libfranka's ask for: a robot's
 * state comes in, joint velocities go out. It is fed from a file of states, or from a motion of its
 * own:
 *
 *     safe_stream               a swing of the first joints, far too fast
 *     safe_stream - < log.csv   lines of time, q1 ... q7, dq1 ... dq7 (s, rad, rad/s)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "panda.h"

#define JOINTS PANDA_JOINTS

/* The part of a robot's state that a speed limit needs. */
typedef struct {
    double time;       /* s */
    double q[JOINTS];  /* rad */
    double dq[JOINTS]; /* rad/s, as the planner wants them */
} robot_state;

typedef struct {
    panda_params drives;
    panda_region body;
    double limit; /* N */
} guard;

/* What one call decided. */
typedef struct {
    double planned, allowed; /* m/s, of the contact point */
    double share;            /* of the planned velocities */
} verdict;

static int prepare(guard *g)
{
    panda_default_params(&g->drives);
    if (panda_body_region(PANDA_CHEST, 0, &g->body) != PANDA_OK) {
        return 0;
    }
    for (int i = 0; i < JOINTS; ++i) {
        g->drives.joint_stiffness[i] = 3000; /* N m/rad; yours */
    }
    g->drives.horizon = 0.1; /* s; what comes later is for the quasi-static limit */
    g->limit = g->body.force_limit;
    return 1;
}

/* The contact point would hit what lies in the direction in which it moves. */
static double velocity_of_tip(const robot_state *state, double velocity[3])
{
    double J[3][JOINTS];
    if (panda_jacobian(state->q, J) != PANDA_OK) {
        return NAN;
    }
    for (int k = 0; k < 3; ++k) {
        velocity[k] = 0;
        for (int i = 0; i < JOINTS; ++i) {
            velocity[k] += J[k][i]*state->dq[i];
        }
    }
    return sqrt(velocity[0]*velocity[0] + velocity[1]*velocity[1] + velocity[2]*velocity[2]);
}

/* The callback: 1 kHz in, 1 kHz out. A state that makes no sense stops the arm. */
static verdict control(const guard *g, const robot_state *state, double command[JOINTS])
{
    double direction[3];
    verdict v = {velocity_of_tip(state, direction), 0, 0};
    if (v.planned < 1e-6) {
        v.share = 1; /* as good as at rest: no direction to speak of */
    } else if (isfinite(v.planned)) {
        panda_safe_speed_t safe;
        const int status =
            panda_safe_speed(state->q, direction, g->limit, &g->body, &g->drives, &safe);
        /* where nothing is known to be safe, nothing is */
        v.allowed = status == PANDA_OK || status == PANDA_BOUNDED ? safe.speed : 0;
        v.share = fmin(1, v.allowed/v.planned);
    }
    for (int i = 0; i < JOINTS; ++i) {
        command[i] = v.share > 0 ? v.share*state->dq[i] : 0;
    }
    return v;
}

/* Next state of a file; 0 at its end, -1 for a line that is not one. */
static int read_state(FILE *file, robot_state *state)
{
    char line[1024];
    double numbers[1 + 2*JOINTS];
    if (fgets(line, sizeof line, file) == NULL) {
        return 0;
    }
    const char *at = line;
    for (int i = 0; i < 1 + 2*JOINTS; ++i) {
        char *end;
        numbers[i] = strtod(at, &end);
        if (end == at) {
            return -1;
        }
        at = *end == ',' ? end + 1 : end;
    }
    state->time = numbers[0];
    memcpy(state->q, numbers + 1, sizeof state->q);
    memcpy(state->dq, numbers + 1 + JOINTS, sizeof state->dq);
    return 1;
}

/* Two seconds there and back, at 1 kHz. */
static int next_state(int cycle, robot_state *state)
{
    static const double middle[JOINTS] = {0, -0.1, 0, -2, 0, 2, 0.8};
    static const double swing[JOINTS] = {1.2, 0.4, 0, 0.4, 0, 0, 0};
    const double rate = 3.14159265358979; /* rad/s */
    state->time = 0.001*cycle;
    for (int i = 0; i < JOINTS; ++i) {
        state->q[i] = middle[i] - swing[i]*cos(rate*state->time);
        state->dq[i] = swing[i]*rate*sin(rate*state->time);
    }
    return cycle < 2000;
}

int main(int count, char **arguments)
{
    guard g;
    robot_state state;
    const int from_file = count > 1 && strcmp(arguments[1], "-") == 0;
    if (!prepare(&g)) {
        return 2;
    }
    int slowed = 0;
    double least = 1, highest = 0;
    puts("time [s]  planned [m/s]  allowed [m/s]  share  first joint [rad/s]");
    for (int cycle = 0;; ++cycle) {
        const int more = from_file ? read_state(stdin, &state) : next_state(cycle, &state);
        if (more < 0) {
            return fprintf(stderr, "line %d is not a state\n", cycle + 1), 2;
        }
        if (more == 0) {
            printf("%d states, %d slowed down, least share %.3f, fastest plan %.2f m/s\n", cycle,
                   slowed, least, highest);
            return 0;
        }
        double command[JOINTS];
        const verdict v = control(&g, &state, command);
        slowed += v.share < 1;
        least = fmin(least, v.share);
        highest = fmax(highest, v.planned);
        if (cycle % 100 == 0) {
            printf("%8.3f  %13.3f  %13.3f  %5.3f  %19.3f\n", state.time, v.planned, v.allowed,
                   v.share, command[0]);
        }
    }
}
