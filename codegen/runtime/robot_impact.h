/* SPDX-License-Identifier: 0BSD */
/*
 * An impact of robot_ on a part of the body; not for its users.
 *
 * The robot is a sum of modes that only meet in the contact force. While motors drive (or servo) the
 * modes are those of links whose motors do; once motors are released they are those of links, springs
 * and rotors. Each mode's step is exact for a force that is linear over the step.
 * README.md of the package and docs/impacts-in-c.md of softimpact derive all of it.
 */
#ifndef ROBOT_IMPACT_H
#define ROBOT_IMPACT_H

#include "robot_internal.h"

#if ROBOT_ELASTIC
#define ROBOT_SYSTEM (2*ROBOT_N) /* links, then motors */
#else
#define ROBOT_SYSTEM ROBOT_N
#endif
#define ROBOT_DAMPERS (ROBOT_DAMPED ? ROBOT_SYSTEM : ROBOT_N) /* of the last ones of these */
#define ROBOT_MODES (ROBOT_SYSTEM + 1) /* one for a body that gives way */
#define ROBOT_LEVELS 7 /* lengths of steps, each half the one before */

/* The robot about to touch at one of its points, along n. */
typedef struct {
    robot_links_t links;
    robot_real row[ROBOT_N];   /* n'J */
    robot_real rates[ROBOT_N]; /* joint velocities for an approach of 1 m/s */
} robot_arrival;

/* Matrices of up to ROBOT_SYSTEM rows. */
typedef robot_real robot_matrix[ROBOT_SYSTEM][ROBOT_SYSTEM];

/* As many vectors of them. */
typedef robot_real robot_vectors[][ROBOT_SYSTEM];

/* One rotation of two rows that follow each other: its cosine and sine. */
typedef struct {
    robot_real c, s;
} robot_rotation;

/*
 * Steps and rotations that find eigenvalues of N rows to four digits: of 110,000 compliances of seven joints none
 * took more than 14 and 54. What is not done by then fails.
 */
#define ROBOT_MOST_QR (2*ROBOT_N + 2)
#define ROBOT_MOST_ROTATIONS (ROBOT_N*(ROBOT_N + 2))

/* Q of Q diag(values) Q', of N rows: reflections I - scale v v', and then rotations of steps. */
typedef struct {
    robot_real v[ROBOT_N][ROBOT_N], scale[ROBOT_N];
    int steps, count;
    unsigned char first[ROBOT_MOST_QR], last[ROBOT_MOST_QR]; /* rows of each */
    robot_rotation by[ROBOT_MOST_ROTATIONS];
} robot_turns;

/*
 * Motions of unit mass that do not act on each other: displacement of links and motors = shape amplitude. Where motors
 * have none of their own (driven) or are eliminated (free motors without gravity) it is that of deflections times the
 * root of their springs' stiffness, u = Q frequency amplitude, and Q is known by how it came about.
 */
typedef struct {
    int count;
    int rigid; /* the first ones have no frequency */
    robot_real fastest; /* largest squared frequency that is known, 1/s^2 */
    robot_real squared[ROBOT_MODES]; /* frequency, 1/s^2 */
    robot_real noise[ROBOT_MODES]; /* of these, where rounding may matter, 1/s^2 */
    robot_real row[ROBOT_MODES]; /* what the contact point moves with each, 1/sqrt(kg) */
    robot_real start[ROBOT_MODES]; /* rates at first touch of an approach of 1 m/s */
    int from[ROBOT_MODES]; /* row of their shape, or column of Q */
    robot_real shape[ROBOT_MODES][ROBOT_SYSTEM];
#if ROBOT_STRUCTURED
    robot_turns turns; /* Q */
#endif
} robot_modes;

/* One step of what a mode moves the contact point by, row amplitude: what it does by itself, and by a force. */
typedef struct {
    robot_real cosine, sine; /* cos(wh), sin(wh)/w */
    robot_real back; /* -w sin(wh) */
    robot_real push; /* row^2 (1 - cos(wh))/w^2: on the place, of a force that stays */
    robot_real late; /* row^2 (wh - sin(wh))/(w^3 h): the same of one that grows from none */
    robot_real kick; /* row^2 sin(wh)/w: on the velocity, of a force that stays; of one that grows it is push/h */
} robot_mode_step;

/* Steps of one length. */
typedef struct {
    robot_real h; /* s */
    robot_real relax; /* what is left of the body's own deflection after a step out of contact */
    robot_real per; /* 1/h */
    robot_real push, late, kick; /* of all modes, the kick less what dampers take of it within the step */
    robot_real grow; /* kick of a force that grows from none */
    robot_mode_step mode[ROBOT_MODES];
} robot_level;

/* A time in which the motors follow one law. */
typedef struct {
    bool known; /* modes are those of this arrival; the body is one of them if it `has_body` */
    bool has_body;
    bool ready; /* steps are */
    robot_real blur; /* share of an approach that rounding may change */
    bool blurred; /* too few digits to integrate it */
    bool settles; /* motors do not push on and on, nothing else brings energy: see robot_settled.c */
    robot_modes modes; /* the first `active` ones move, the others stand, bent by the force */
    int active;
    robot_real compliance; /* of those that stand, m/N */
    robot_real reach; /* of all that vibrate, m/N */
    robot_real drift; /* velocity of the contact point that motors keep up, over the speed */
    bool damped; /* by joints of their own, or by a servo on its motors' rates, N m s/rad */
    robot_real damping[ROBOT_DAMPERS];
    robot_real slows[ROBOT_MODES]; /* half of what they do to the contact point by each mode's velocity, 1/s */
    robot_real together[ROBOT_DAMPERS][ROBOT_DAMPERS]; /* rate of one damper by an impulse on another, 1/(kg m^2) */
    int steps; /* of the longest level until the time is over */
    int longest_pressed; /* level of the longest step in contact */
    robot_level level[ROBOT_LEVELS];
} robot_phase;

/* Smoothness below which a body's damper makes forces ripple with modes that steps pass over. */
#define ROBOT_HARD ROBOT_R(0.4)

/*
 * Smoothness above which a body hardly damps, so that errors grow from contact to contact, and the share of the limit
 * that counts there and before a hard damper: forces on such bodies were up to 2e-2 and 1.5e-2 (1.4e-2 at 0.26) too low
 * in inputs that a search climbed to. Parts of the human body are between. Nothing swings where motors hold the contact
 * point, and the body is held, too.
 */
#define ROBOT_HARDLY ROBOT_R(0.99)
#define ROBOT_COUNTS_ELSEWHERE ROBOT_R(0.985)

/* Everything that does not depend on the speed. */
typedef struct {
    robot_arrival arrival;
    const robot_region *region;
    const robot_params *p;
    int motors, led; /* what they do, and in the modes of the first phase */
    bool gives_way;
    robot_real mobility; /* of the contact, 1/kg */
    robot_real rotors; /* of rotors alone, all links being locked to them, 1/kg */
    robot_real hold; /* K: no energy E presses harder than sqrt(2 K E) */
    robot_real skin_rate; /* squared frequency of the contact with a stiff body, 1/s^2 */
    robot_real scale; /* of forces, N: what bends are measured by */
    robot_real smooth; /* 1, or less where the damper makes forces jump */
    int sure; /* contacts before forces are in doubt: errors grow from one to the next */
    int first, last; /* phases of an impact */
    int status; /* of what was prepared */
    robot_phase phase[2]; /* ROBOT_LED and ROBOT_LOOSE */
} robot_impact;

/* Phases: motors drive or servo, motors are free. */
#define ROBOT_LED 0
#define ROBOT_LOOSE 1

typedef struct robot_watch robot_watch;

/* Steps of the budget that a run takes before its first: it is prepared, and motors are let go. */
#define ROBOT_STEPS_OF_RUN 7

/* What may be spent, and how exactly. */
typedef struct {
    int steps; /* that are left */
    bool rough; /* longer steps do */
    bool fine; /* only shorter ones do */
    robot_real stop_above; /* force after whose passing the rest does not matter, N */
    robot_watch *watch; /* who sees each step and ends the impact, or NULL; robot_state.h */
} robot_budget;

typedef struct {
    robot_real force; /* largest, N */
    robot_real later; /* the same of contacts in doubt */
    robot_real time; /* of the largest since first touch, s */
    int contact; /* in which contact, the first is 1 */
    int contacts; /* how many there were */
    bool ended; /* within the budget */
    bool torn; /* a law by table bent more over the shortest step than can be known: the force may be any */
} robot_peak;

/* Checks what says who hits whom, and how, but for the robot's own numbers. */
int robot_check_impact(const robot_region *region, const robot_params *p);

/* The contact point's row along n, and the joint velocities of least norm that move it along n. */
int robot_arrive(const robot_real n[3], int point, robot_arrival *arrival);

/* Links of a robot whose joints move, and the velocities of its independent joints. */
int robot_set_off(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS],
    const robot_params *p, robot_real rates[ROBOT_N], robot_arrival *arrival);

/* Prepares the arrival of a point as it moves at joint velocities, along its way; returns its speed. */
robot_real robot_arrive_as_it_moves(int point, const robot_real rates[ROBOT_N], robot_arrival *arrival);

/* Checks and links of an impact of one of the contact points. */
int robot_approach(const robot_real q[ROBOT_JOINTS], int point, const robot_real n[3],
    const robot_region *region, const robot_params *p, robot_impact *impact);

/* To be called as impact->arrival changes: no modes are known. */
void robot_impact_forget(robot_impact *impact);

/*
 * Prepares impacts of impact->arrival with motors of one kind, not the bracket, for forces of about
 * a size (or, if that is negative, for a speed of its size).
 */
int robot_impact_prepare(const robot_region *region, const robot_params *p, int motors,
    robot_real force, robot_impact *impact);

/* Prepares what comes after the motors' release, once it is asked for. */
void robot_impact_let_go(robot_impact *impact);

/*
 * Twice the energy that an impact with loose motors can take, for 1 m/s: at most r'(M + B)r for joint
 * velocities r; where nothing but joints' springs pulls that of links, rotors and body as two masses.
 */
robot_real robot_twice_energy(const robot_impact *impact);
/* The first of these, r'(M + B)r. */
robot_real robot_twice_energy_of_arrival(const robot_arrival *arrival, const robot_params *p);

/* No force is larger than this times the speed, N s/m; 0 where none is known. */
robot_real robot_bound(const robot_impact *impact);
/* The same for a K and an energy of one's own, where there is a bound. */
robot_real robot_bound_by(const robot_impact *impact, robot_real hold, robot_real twice);

/* Least and largest kind of motors that parameters stand for: two for the bracket. */
void robot_kinds_of_motors(const robot_params *p, int *first, int *last);

/*
 * What is known of a region's law of contact: its depth under a force, twice the work done by then, and the
 * largest stiffness up to it.
 */
robot_real robot_law_depth(const robot_region *region, robot_real force);
robot_real robot_law_twice_work(const robot_region *region, robot_real force);
robot_real robot_law_stiffness(const robot_region *region, robot_real force);

/* Force of a law through points whose depth d makes hold d + soft f(d) = pressed > 0; and that depth. */
robot_real robot_law_press(const robot_region *region, robot_real hold, robot_real soft, robot_real pressed,
    robot_real *depth);

/* Whether a law by table, if there is one, rises from 0 on, and its numbers are finite. */
bool robot_law_is_one(const robot_region *region);

/* Force of two bodies that meet at 1 m/s times speed, and the speed of a force: first guesses. */
robot_real robot_two_body_force(const robot_region *region, robot_real mobility, robot_real speed);
robot_real robot_two_body_speed(const robot_region *region, robot_real mobility, robot_real force);

/*
 * Largest share of a limit that counts as kept: with what arms and bodies have, forces are within 2e-3 of the
 * right ones, in the worst of 100,000 within 1e-2.
 */
#define ROBOT_KEPT ROBOT_R(0.99)
/* Speed of a contact point that counts as rest: it can hardly be measured, m/s. */
#define ROBOT_AT_REST ROBOT_R(1e-6)

/*
 * Largest speed, at most `cap` where that is positive, up to which an impact keeps a limit: OK,
 * BOUNDED or another status.
 */
int robot_find_speed(const robot_region *region, const robot_params *p, robot_real limit,
    robot_real cap, robot_impact *impact, robot_safe_speed_t *found);

/* Largest force of an arrival by any of the motors that p stands for: OK, BOUNDED or another status. */
int robot_find_peak(const robot_region *region, const robot_params *p, robot_real speed,
    robot_impact *impact, robot_peak_force_t *out);

#if ROBOT_FRAMES > 0
/* Links, with the motion of a place in a frame in place of that of the package's own point. */
int robot_links_on(const robot_real q[ROBOT_JOINTS], int frame, const robot_real place[3],
    const robot_params *p, robot_links_t *links);
#endif

/* Largest force over all contacts of an impact at a speed. */
void robot_impact_run(robot_impact *impact, robot_real speed, robot_budget *budget,
    robot_peak *peak);

/* Modes of links whose motors drive or servo, and of loose ones; 0 or a status. */
int robot_driven_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes,
    robot_real *drift);
int robot_servo_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes,
    robot_real *drift);
int robot_free_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes);

/*
 * Mobility of the contact point with links alone, and with rotors alone, 1/kg; 0 or a status. Leaves L of the links'
 * mass M = L L', where loose modes look for it: in their `shape`, which they do not need else.
 */
int robot_mobilities(const robot_arrival *arrival, const robot_params *p, robot_matrix L, robot_real *links,
    robot_real *rotors);
/* The same with links and rotors as one; 0 if their mass is not positive definite. */
robot_real robot_together(const robot_arrival *arrival, const robot_params *p);

/* How a phase's dampers act on each other; returns the most that they damp, 1/s. */
robot_real robot_damping_rate(robot_phase *phase);
/* Takes from the contact point's velocity after steps what is damped in their other half. */
void robot_slowing(robot_phase *phase);
/* Lets fast modes stand, adds the body, and makes the steps of a phase that lasts `time`. */
void robot_phase_steps(const robot_impact *impact, robot_real time, robot_phase *phase);

/* L of A = L L' in place, below and on the diagonal; false unless A is positive definite. */
bool robot_cholesky(int size, robot_matrix A);
/* x = L^-1 x and x = L^-T x. */
void robot_forward(int size, robot_matrix L, robot_real *x);
void robot_backward(int size, robot_matrix L, robot_real *x);
/* Turns two vectors, a towards b, by an angle of such a cosine and sine, or of a tangent. */
void robot_turn(int size, robot_real c, robot_real s, robot_real *a, robot_real *b);
void robot_turn_by(int size, robot_real t, robot_real *a, robot_real *b);
/*
 * Tangent of the angle that leaves nothing of an entry `off` of a symmetric matrix (Jacobi): the later one of its
 * entries on the diagonal, which is more by `apart`, turns towards the earlier one.
 */
robot_real robot_tangent(robot_real apart, robot_real off);
/* Turns the rows of X, and A with them, until A = XKX' is diagonal (Jacobi); false if that does not end. */
bool robot_diagonalise(int size, robot_matrix A, robot_matrix X);
/*
 * Eigenvalues of a symmetric A, which is lost; turns vectors x to Q'x, of A = Q diag(values) Q', and keeps how
 * unless `turns` is NULL; false if that does not end. `small` is the square of an entry beside the diagonal, over
 * the product of its neighbours on it, that counts as none.
 */
bool robot_spectrum(int size, robot_real small, robot_matrix A, robot_real *values, int count, robot_vectors x,
    robot_turns *turns);
#if ROBOT_STRUCTURED
/* Q'x and Qx of two vectors. */
void robot_decompose(const robot_turns *turns, robot_real x[ROBOT_N], robot_real y[ROBOT_N]);
void robot_compose(const robot_turns *turns, robot_real x[ROBOT_N], robot_real y[ROBOT_N]);
#endif

#endif
