/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Largest force of many impacts: the tests' own integrator, for searches of millions of them.
 *
 * With z the deviation from the motion before the impact, in coordinates of unit mass,
 *     z'' + D z' + K z = -row f - pull v t,   x = v t + row.z,
 * and a body k s + c s' = f(d) whose end, of some mass or none that moves, is at b:
 *     d = x - b - s > 0,   mass b'' = f,
 * f(d) = skin d^1.5 or straight between many points.
 * All that is linear goes by matrices' exponentials (no modes, none left out; linear.c), over steps in
 * which the force is a parabola through its values at the step's ends and one step before (impact.c).
 * Only that is approximate; a step is halved where the force is not nearly straight. One equation in d is
 * solved a step (contact.c). Matrices are symmetric, or stored by columns.
 */
#ifndef ORACLE_H
#define ORACLE_H

#include <math.h>
#include <stddef.h>
#include <string.h>

#define MOST 32            /* coordinates */
#define STATES (2*MOST)    /* z, then z' over `rate` */
#define LEVELS 24
#define FLIGHT 6          /* levels out of contact beyond those in it */

enum { LOOSE_ALONE = 1, LED_FIRST = 2 }; /* what to integrate: the larger force counts */

typedef struct {
    const double *stiffness, *damping, *row, *pull; /* matrices with rows of `stride` */
    long size, stride;
} robot;

typedef struct {
    robot led, loose; /* coordinates of `led` are the first of `loose`; the others stand still */
    long runs;
    double release, horizon;
    double counts, late; /* until when a force counts, and from when on as pressing; at the latest at the horizon */
    double stiffness, damping, mass, skin; /* mass 0: its end is held */
    const double *depths, *law; /* forces at depths, both rising from 0 on, in place of skin d^1.5 */
    long points; /* 0 for that */
    double scale;     /* force by which bends are measured from the start, N */
    double tolerance; /* most bend of the force over a step, over the largest force */
    double longest, shortest; /* steps, s; of longest while something may touch */
    long flies; /* whether nothing but joints' springs pulls, so that steps may be longer out of contact */
} impact;

/* A response to f = 1, f = s and f = s^2, s being the time since the step began. */
typedef struct {
    double one, time, square;
} response;

typedef struct {
    double h, fade; /* fade: what is left of s without a force */
    double turn[STATES*STATES]; /* z at its end from z at its start, by columns */
    double one[STATES], time[STATES], square[STATES];
    double pull_one[STATES], pull_time[STATES];
    response body, speed, bent; /* of the body's end, its velocity, its deflection */
    response gap; /* of x - b */
    response closing; /* of its rate */
} level;

typedef struct {
    long size, states, levels;
    long pressed; /* levels in contact */
    double rate;
    double row[MOST];
    int pulled;
    level level[LEVELS];
} prepared;

typedef struct {
    double z[STATES];
    double body, speed, bent;
    double time;
    double before, now; /* forces */
    double shallow, depth; /* d with these */
    double h; /* of the last step */
    long past; /* steps in contact */
    long at;   /* level */
    double peak, late; /* largest force that counts, and that presses */
    long steps;
} state;

/* y = A x + y */
void apply(long n, const double *restrict A, const double *restrict x, double *restrict y);

/* What steps of all lengths do to a robot and what it presses. */
void prepare(const impact *p, const robot *of, prepared *out);

/* What the body does in steps of one length, and with the robot what the gap between them does. */
void body_steps(const impact *p, const prepared *linear, level *l);

/* The depth d at which d + soft f(d) = open, near a guess; 0 where there is none. */
double depth_of(const impact *p, double open, double soft, double guess);

double force_at(const impact *p, double depth);

/* Slope of f at a depth. */
double stiffness_at(const impact *p, double depth);

/*
 * Largest force [N] of each of many impacts at each of some speeds, and the largest that presses late; returns
 * the steps it took.
 */
long largest_forces(long count, const impact *p, long speeds, const double *speed, double *out, double *late);

#endif
