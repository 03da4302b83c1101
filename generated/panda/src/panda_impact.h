/* SPDX-License-Identifier: 0BSD */
/*
 * An impact of panda_ on a part of the body; not for its users.
 *
 * The robot is a sum of modes that only meet in the contact force. While motors drive (or servo) the
 * modes are those of links whose motors do; once motors are released they are those of links, springs
 * and rotors. Each mode's step is exact for a force that is linear over the step.
 * README.md of the package and docs/impacts-in-c.md of softimpact derive all of it.
 */
#ifndef PANDA_IMPACT_H
#define PANDA_IMPACT_H

#include "panda_internal.h"

#if PANDA_ELASTIC
#define PANDA_SYSTEM (2*PANDA_N) /* links, then motors */
#else
#define PANDA_SYSTEM PANDA_N
#endif
#define PANDA_MODES (PANDA_SYSTEM + 1) /* one for a body that gives way */
#define PANDA_LEVELS 7 /* lengths of steps, each half the one before */

/* The robot about to touch at one of its points, along n. */
typedef struct {
    panda_links_t links;
    panda_real row[PANDA_N];   /* n'J */
    panda_real rates[PANDA_N]; /* joint velocities for an approach of 1 m/s */
} panda_arrival;

/* Motions of unit mass that do not act on each other: displacement = shape amplitude. */
typedef struct {
    int count;
    panda_real noise; /* of squared frequencies, where rounding may matter, 1/s^2 */
    panda_real squared[PANDA_MODES]; /* frequency, 1/s^2 */
    panda_real row[PANDA_MODES]; /* what the contact point moves with each, 1/sqrt(kg) */
    panda_real start[PANDA_MODES]; /* rates at first touch of an approach of 1 m/s */
    panda_real shape[PANDA_SYSTEM][PANDA_MODES];
} panda_modes;

/* One step of a mode: what amplitude, rate and the forces at both ends do. */
typedef struct {
    panda_real cosine, sine; /* cos(wh), sin(wh)/w */
    panda_real back; /* -w sin(wh) */
    panda_real push[2]; /* on the amplitude, of the forces at start and end */
    panda_real kick[2]; /* on the rate */
} panda_mode_step;

/* Steps of one length. */
typedef struct {
    panda_real h; /* s */
    panda_real relax; /* what is left of the body's own deflection after a step out of contact */
    panda_real push[2]; /* on the contact point */
    panda_real kick[2];
    panda_mode_step mode[PANDA_MODES];
} panda_level;

/* A time in which the motors follow one law. */
typedef struct {
    panda_modes modes; /* the first `active` ones move, the others stand, bent by the force */
    int active;
    panda_real compliance; /* of those that stand, m/N */
    panda_real drift; /* velocity of the contact point that motors keep up, over the speed */
    bool damped; /* by a servo, of these gains on the motors' rates, N m s/rad */
    panda_real damping[PANDA_N];
    int steps; /* of the longest level until the time is over */
    panda_level level[PANDA_LEVELS];
} panda_phase;

/* Everything that does not depend on the speed. */
typedef struct {
    panda_arrival arrival;
    panda_real stiffness, damping, skin; /* k_h, c_h, k_f */
    bool gives_way;
    panda_real mobility; /* of the contact, 1/kg */
    panda_real scale; /* of forces, N: what bends are measured by */
    bool blurred; /* too few digits to integrate it */
    panda_real smooth; /* 1, or less where the damper makes forces jump */
    int phases; /* one, or two where motors are released */
    panda_phase phase[2];
#if PANDA_ELASTIC
    panda_real springs[PANDA_N]; /* k_s */
    panda_real rotors[PANDA_N]; /* B */
#endif
    panda_real carried[PANDA_N]; /* what deflections move of the contact point, rotors being free */
    panda_real bound; /* no force is larger than this times the speed, N s/m; 0: no bound */
} panda_impact;

/* What may be spent, and how exactly. */
typedef struct {
    int steps; /* that are left */
    bool rough; /* steps twice as long do */
    panda_real stop_above; /* force after whose passing the rest does not matter, N */
} panda_budget;

typedef struct {
    panda_real force; /* largest, N */
    panda_real time; /* of it since first touch, s */
    int contact; /* in which contact, the first is 1 */
    int contacts; /* how many there were */
    bool ended; /* within the budget */
} panda_peak;

/* Checks what says who hits whom, and how, but for the robot's own numbers. */
int panda_check_impact(const panda_region *region, const panda_params *p);

/* The contact point's row along n, and the joint velocities of least norm that move it along n. */
int panda_arrive(const panda_real n[3], int point, panda_arrival *arrival);

/*
 * Prepares impacts of impact->arrival with motors of one kind, not the bracket, for forces of about
 * a size (or, if that is negative, for a speed of its size).
 */
int panda_impact_prepare(const panda_region *region, const panda_params *p, int motors,
    panda_real force, panda_impact *impact);

/* No force is larger than this times the speed, N s/m; 0 where none is known. */
panda_real panda_bound(const panda_params *p, int motors, const panda_impact *impact);

/* Least and largest kind of motors that parameters stand for: two for the bracket. */
void panda_kinds_of_motors(const panda_params *p, int *first, int *last);

/* Force of two bodies that meet at 1 m/s times speed, and the speed of a force: first guesses. */
panda_real panda_two_body_force(const panda_region *region, panda_real mobility, panda_real speed);
panda_real panda_two_body_speed(const panda_region *region, panda_real mobility, panda_real force);

/*
 * Largest speed, at most `cap` where that is positive, up to which an impact keeps a limit: OK,
 * BOUNDED or another status.
 */
int panda_find_speed(const panda_region *region, const panda_params *p, panda_real limit,
    panda_real cap, panda_impact *impact, panda_safe_speed_t *found);

/* Largest force over all contacts of an impact at a speed. */
void panda_impact_run(const panda_impact *impact, panda_real speed, panda_budget *budget,
    panda_peak *peak);

/* Modes of links whose motors follow `motors`, and of released ones; 0 or a status. */
int panda_driven_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift);
int panda_servo_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift);
int panda_free_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real carried[PANDA_N]);

/*
 * Lets fast modes stand, adds the body, and makes the steps of a phase that lasts `time`; one in which
 * motors have just been `released` starts with modes that swing.
 */
void panda_phase_steps(const panda_region *region, panda_real mobility, panda_real skin_rate,
    panda_real time, bool released, panda_phase *phase);

/* Linear algebra on matrices of up to PANDA_SYSTEM rows. */
typedef panda_real panda_matrix[PANDA_SYSTEM][PANDA_SYSTEM];

/* L of A = L L' in place, below and on the diagonal; false unless A is positive definite. */
bool panda_cholesky(int size, panda_matrix A);
/* x = L^-1 x and x = L^-T x. */
void panda_forward(int size, panda_matrix L, panda_real *x);
void panda_backward(int size, panda_matrix L, panda_real *x);
/*
 * Rotates the columns of X, and A with them, until A = X'KX is diagonal (Jacobi's method). Entries
 * below `noise` count as none. False if that does not end.
 */
bool panda_diagonalise(int size, panda_matrix A, panda_matrix X, panda_real noise);

#endif
