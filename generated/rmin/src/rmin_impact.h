/* SPDX-License-Identifier: 0BSD */
/*
 * An impact of rmin_ on a part of the body; not for its users.
 *
 * The robot is a sum of modes that only meet in the contact force. While motors drive (or servo) the
 * modes are those of links whose motors do; once motors are released they are those of links, springs
 * and rotors. Each mode's step is exact for a force that is linear over the step.
 * README.md of the package and docs/impacts-in-c.md of softimpact derive all of it.
 */
#ifndef RMIN_IMPACT_H
#define RMIN_IMPACT_H

#include "rmin_internal.h"

#if RMIN_ELASTIC
#define RMIN_SYSTEM (2*RMIN_N) /* links, then motors */
#else
#define RMIN_SYSTEM RMIN_N
#endif
#define RMIN_DAMPERS (RMIN_DAMPED ? RMIN_SYSTEM : RMIN_N) /* of the last ones of these */
#define RMIN_MODES (RMIN_SYSTEM + 1) /* one for a body that gives way */
#define RMIN_LEVELS 7 /* lengths of steps, each half the one before */

/* The robot about to touch at one of its points, along n. */
typedef struct {
    rmin_links_t links;
    rmin_real row[RMIN_N];   /* n'J */
    rmin_real rates[RMIN_N]; /* joint velocities for an approach of 1 m/s */
} rmin_arrival;

/* Matrices of up to RMIN_SYSTEM rows. */
typedef rmin_real rmin_matrix[RMIN_SYSTEM][RMIN_SYSTEM];

/* As many vectors of them. */
typedef rmin_real rmin_vectors[][RMIN_SYSTEM];

/* One rotation of two rows that follow each other: its cosine and sine. */
typedef struct {
    rmin_real c, s;
} rmin_rotation;

/*
 * Steps and rotations that find eigenvalues of N rows to four digits: of 110,000 compliances of seven joints none
 * took more than 14 and 54. What is not done by then fails.
 */
#define RMIN_MOST_QR (2*RMIN_N + 2)
#define RMIN_MOST_ROTATIONS (RMIN_N*(RMIN_N + 2))

/* Q of Q diag(values) Q', of N rows: reflections I - scale v v', and then rotations of steps. */
typedef struct {
    rmin_real v[RMIN_N][RMIN_N], scale[RMIN_N];
    int steps, count;
    unsigned char first[RMIN_MOST_QR], last[RMIN_MOST_QR]; /* rows of each */
    rmin_rotation by[RMIN_MOST_ROTATIONS];
} rmin_turns;

/*
 * Motions of unit mass that do not act on each other: displacement of links and motors = shape amplitude. Where motors
 * have none of their own (driven) or are eliminated (free motors without gravity) it is that of deflections times the
 * root of their springs' stiffness, u = Q frequency amplitude, and Q is known by how it came about.
 */
typedef struct {
    int count;
    int rigid; /* the first ones have no frequency */
    rmin_real fastest; /* largest squared frequency that is known, 1/s^2 */
    rmin_real squared[RMIN_MODES]; /* frequency, 1/s^2 */
    rmin_real noise[RMIN_MODES]; /* of these, where rounding may matter, 1/s^2 */
    rmin_real row[RMIN_MODES]; /* what the contact point moves with each, 1/sqrt(kg) */
    rmin_real start[RMIN_MODES]; /* rates at first touch of an approach of 1 m/s */
    int from[RMIN_MODES]; /* row of their shape, or column of Q */
    rmin_real shape[RMIN_MODES][RMIN_SYSTEM];
#if RMIN_STRUCTURED
    rmin_turns turns; /* Q */
#endif
} rmin_modes;

/* One step of what a mode moves the contact point by, row amplitude: what it does by itself, and by a force. */
typedef struct {
    rmin_real cosine, sine; /* cos(wh), sin(wh)/w */
    rmin_real back; /* -w sin(wh) */
    rmin_real push; /* row^2 (1 - cos(wh))/w^2: on the place, of a force that stays */
    rmin_real late; /* row^2 (wh - sin(wh))/(w^3 h): the same of one that grows from none */
    rmin_real kick; /* row^2 sin(wh)/w: on the velocity, of a force that stays; of one that grows it is push/h */
} rmin_mode_step;

/* Steps of one length. */
typedef struct {
    rmin_real h; /* s */
    rmin_real relax; /* what is left of the body's own deflection after a step out of contact */
    rmin_real per; /* 1/h */
    rmin_real push, late, kick; /* of all modes, the kick less what dampers take of it within the step */
    rmin_real grow; /* kick of a force that grows from none */
    rmin_mode_step mode[RMIN_MODES];
} rmin_level;

/* A time in which the motors follow one law. */
typedef struct {
    bool known; /* modes are those of this arrival; the body is one of them if it `has_body` */
    bool has_body;
    bool ready; /* steps are */
    rmin_real blur; /* share of an approach that rounding may change */
    bool blurred; /* too few digits to integrate it */
    bool settles; /* motors do not push on and on, nothing else brings energy: see rmin_settled.c */
    rmin_modes modes; /* the first `active` ones move, the others stand, bent by the force */
    int active;
    rmin_real compliance; /* of those that stand, m/N */
    rmin_real reach; /* of all that vibrate, m/N */
    rmin_real drift; /* velocity of the contact point that motors keep up, over the speed */
    bool damped; /* by joints of their own, or by a servo on its motors' rates, N m s/rad */
    rmin_real damping[RMIN_DAMPERS];
    rmin_real slows[RMIN_MODES]; /* half of what they do to the contact point by each mode's velocity, 1/s */
    rmin_real together[RMIN_DAMPERS][RMIN_DAMPERS]; /* rate of one damper by an impulse on another, 1/(kg m^2) */
    int steps; /* of the longest level until the time is over */
    int longest_pressed; /* level of the longest step in contact */
    rmin_level level[RMIN_LEVELS];
} rmin_phase;

/* Smoothness below which a body's damper makes forces ripple with modes that steps pass over. */
#define RMIN_HARD RMIN_R(0.4)

/*
 * Smoothness above which a body hardly damps, so that errors grow from contact to contact, and the share of the limit
 * that counts there and before a hard damper: forces on such bodies were up to 2e-2 and 1.5e-2 (1.4e-2 at 0.26) too low
 * in inputs that a search climbed to. Parts of the human body are between. Nothing swings where motors hold the contact
 * point, and the body is held, too.
 */
#define RMIN_HARDLY RMIN_R(0.99)
#define RMIN_COUNTS_ELSEWHERE RMIN_R(0.985)

/* Everything that does not depend on the speed. */
typedef struct {
    rmin_arrival arrival;
    const rmin_region *region;
    const rmin_params *p;
    int motors, led; /* what they do, and in the modes of the first phase */
    bool gives_way;
    rmin_real mobility; /* of the contact, 1/kg */
    rmin_real rotors; /* of rotors alone, all links being locked to them, 1/kg */
    rmin_real hold; /* K: no energy E presses harder than sqrt(2 K E) */
    rmin_real skin_rate; /* squared frequency of the contact with a stiff body, 1/s^2 */
    rmin_real scale; /* of forces, N: what bends are measured by */
    rmin_real smooth; /* 1, or less where the damper makes forces jump */
    int sure; /* contacts before forces are in doubt: errors grow from one to the next */
    int first, last; /* phases of an impact */
    int status; /* of what was prepared */
    rmin_phase phase[2]; /* RMIN_LED and RMIN_LOOSE */
} rmin_impact;

/* Phases: motors drive or servo, motors are free. */
#define RMIN_LED 0
#define RMIN_LOOSE 1

typedef struct rmin_watch rmin_watch;

/* Steps of the budget that a run takes before its first: it is prepared, and motors are let go. */
#define RMIN_STEPS_OF_RUN 7

/* What may be spent, and how exactly. */
typedef struct {
    int steps; /* that are left */
    bool rough; /* longer steps do */
    bool fine; /* only shorter ones do */
    rmin_real stop_above; /* force after whose passing the rest does not matter, N */
    rmin_watch *watch; /* who sees each step and ends the impact, or NULL; rmin_state.h */
} rmin_budget;

typedef struct {
    rmin_real force; /* largest, N */
    rmin_real later; /* the same of contacts in doubt */
    rmin_real time; /* of the largest since first touch, s */
    int contact; /* in which contact, the first is 1 */
    int contacts; /* how many there were */
    bool ended; /* within the budget */
    bool torn; /* a law by table bent more over the shortest step than can be known: the force may be any */
} rmin_peak;

/* Checks what says who hits whom, and how, but for the robot's own numbers. */
int rmin_check_impact(const rmin_region *region, const rmin_params *p);

/* The contact point's row along n, and the joint velocities of least norm that move it along n. */
int rmin_arrive(const rmin_real n[3], int point, rmin_arrival *arrival);

/* Links of a robot whose joints move, and the velocities of its independent joints. */
int rmin_set_off(const rmin_real q[RMIN_JOINTS], const rmin_real dq[RMIN_JOINTS],
    const rmin_params *p, rmin_real rates[RMIN_N], rmin_arrival *arrival);

/* Prepares the arrival of a point as it moves at joint velocities, along its way; returns its speed. */
rmin_real rmin_arrive_as_it_moves(int point, const rmin_real rates[RMIN_N], rmin_arrival *arrival);

/* Checks and links of an impact of one of the contact points. */
int rmin_approach(const rmin_real q[RMIN_JOINTS], int point, const rmin_real n[3],
    const rmin_region *region, const rmin_params *p, rmin_impact *impact);

/* To be called as impact->arrival changes: no modes are known. */
void rmin_impact_forget(rmin_impact *impact);

/*
 * Prepares impacts of impact->arrival with motors of one kind, not the bracket, for forces of about
 * a size (or, if that is negative, for a speed of its size).
 */
int rmin_impact_prepare(const rmin_region *region, const rmin_params *p, int motors,
    rmin_real force, rmin_impact *impact);

/* Prepares what comes after the motors' release, once it is asked for. */
void rmin_impact_let_go(rmin_impact *impact);

/*
 * Twice the energy that an impact with loose motors can take, for 1 m/s: at most r'(M + B)r for joint
 * velocities r; where nothing but joints' springs pulls that of links, rotors and body as two masses.
 */
rmin_real rmin_twice_energy(const rmin_impact *impact);
/* The first of these, r'(M + B)r. */
rmin_real rmin_twice_energy_of_arrival(const rmin_arrival *arrival, const rmin_params *p);

/* No force is larger than this times the speed, N s/m; 0 where none is known. */
rmin_real rmin_bound(const rmin_impact *impact);
/* The same for a K and an energy of one's own, where there is a bound. */
rmin_real rmin_bound_by(const rmin_impact *impact, rmin_real hold, rmin_real twice);

/* Least and largest kind of motors that parameters stand for: two for the bracket. */
void rmin_kinds_of_motors(const rmin_params *p, int *first, int *last);

/*
 * What is known of a region's law of contact: its depth under a force, twice the work done by then, and the
 * largest stiffness up to it.
 */
rmin_real rmin_law_depth(const rmin_region *region, rmin_real force);
rmin_real rmin_law_twice_work(const rmin_region *region, rmin_real force);
rmin_real rmin_law_stiffness(const rmin_region *region, rmin_real force);

/* Force of a law through points whose depth d makes hold d + soft f(d) = pressed > 0; and that depth. */
rmin_real rmin_law_press(const rmin_region *region, rmin_real hold, rmin_real soft, rmin_real pressed,
    rmin_real *depth);

/* Whether a law by table, if there is one, rises from 0 on, and its numbers are finite. */
bool rmin_law_is_one(const rmin_region *region);

/* Force of two bodies that meet at 1 m/s times speed, and the speed of a force: first guesses. */
rmin_real rmin_two_body_force(const rmin_region *region, rmin_real mobility, rmin_real speed);
rmin_real rmin_two_body_speed(const rmin_region *region, rmin_real mobility, rmin_real force);

/*
 * Largest share of a limit that counts as kept: with what arms and bodies have, forces are within 2e-3 of the
 * right ones, in the worst of 100,000 within 1e-2.
 */
#define RMIN_KEPT RMIN_R(0.99)
/* Speed of a contact point that counts as rest: it can hardly be measured, m/s. */
#define RMIN_AT_REST RMIN_R(1e-6)

/*
 * Largest speed, at most `cap` where that is positive, up to which an impact keeps a limit: OK,
 * BOUNDED or another status.
 */
int rmin_find_speed(const rmin_region *region, const rmin_params *p, rmin_real limit,
    rmin_real cap, rmin_impact *impact, rmin_safe_speed_t *found);

/* Largest force of an arrival by any of the motors that p stands for: OK, BOUNDED or another status. */
int rmin_find_peak(const rmin_region *region, const rmin_params *p, rmin_real speed,
    rmin_impact *impact, rmin_peak_force_t *out);

#if RMIN_FRAMES > 0
/* Links, with the motion of a place in a frame in place of that of the package's own point. */
int rmin_links_on(const rmin_real q[RMIN_JOINTS], int frame, const rmin_real place[3],
    const rmin_params *p, rmin_links_t *links);
#endif

/* Largest force over all contacts of an impact at a speed. */
void rmin_impact_run(rmin_impact *impact, rmin_real speed, rmin_budget *budget,
    rmin_peak *peak);

/* Modes of links whose motors drive or servo, and of loose ones; 0 or a status. */
int rmin_driven_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real *drift);
int rmin_servo_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real *drift);
int rmin_free_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes);

/*
 * Mobility of the contact point with links alone, and with rotors alone, 1/kg; 0 or a status. Leaves L of the links'
 * mass M = L L', where loose modes look for it: in their `shape`, which they do not need else.
 */
int rmin_mobilities(const rmin_arrival *arrival, const rmin_params *p, rmin_matrix L, rmin_real *links,
    rmin_real *rotors);
/* The same with links and rotors as one; 0 if their mass is not positive definite. */
rmin_real rmin_together(const rmin_arrival *arrival, const rmin_params *p);

/* How a phase's dampers act on each other; returns the most that they damp, 1/s. */
rmin_real rmin_damping_rate(rmin_phase *phase);
/* Takes from the contact point's velocity after steps what is damped in their other half. */
void rmin_slowing(rmin_phase *phase);
/* Lets fast modes stand, adds the body, and makes the steps of a phase that lasts `time`. */
void rmin_phase_steps(const rmin_impact *impact, rmin_real time, rmin_phase *phase);

/* L of A = L L' in place, below and on the diagonal; false unless A is positive definite. */
bool rmin_cholesky(int size, rmin_matrix A);
/* x = L^-1 x and x = L^-T x. */
void rmin_forward(int size, rmin_matrix L, rmin_real *x);
void rmin_backward(int size, rmin_matrix L, rmin_real *x);
/* Turns two vectors, a towards b, by an angle of such a cosine and sine, or of a tangent. */
void rmin_turn(int size, rmin_real c, rmin_real s, rmin_real *a, rmin_real *b);
void rmin_turn_by(int size, rmin_real t, rmin_real *a, rmin_real *b);
/*
 * Tangent of the angle that leaves nothing of an entry `off` of a symmetric matrix (Jacobi): the later one of its
 * entries on the diagonal, which is more by `apart`, turns towards the earlier one.
 */
rmin_real rmin_tangent(rmin_real apart, rmin_real off);
/* Turns the rows of X, and A with them, until A = XKX' is diagonal (Jacobi); false if that does not end. */
bool rmin_diagonalise(int size, rmin_matrix A, rmin_matrix X);
/*
 * Eigenvalues of a symmetric A, which is lost; turns vectors x to Q'x, of A = Q diag(values) Q', and keeps how
 * unless `turns` is NULL; false if that does not end. `small` is the square of an entry beside the diagonal, over
 * the product of its neighbours on it, that counts as none.
 */
bool rmin_spectrum(int size, rmin_real small, rmin_matrix A, rmin_real *values, int count, rmin_vectors x,
    rmin_turns *turns);
#if RMIN_STRUCTURED
/* Q'x and Qx of two vectors. */
void rmin_decompose(const rmin_turns *turns, rmin_real x[RMIN_N], rmin_real y[RMIN_N]);
void rmin_compose(const rmin_turns *turns, rmin_real x[RMIN_N], rmin_real y[RMIN_N]);
#endif

#endif
