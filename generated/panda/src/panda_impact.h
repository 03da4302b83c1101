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
#define PANDA_DAMPERS (PANDA_DAMPED ? PANDA_SYSTEM : PANDA_N) /* of the last ones of these */
#define PANDA_MODES (PANDA_SYSTEM + 1) /* one for a body that gives way */
#define PANDA_LEVELS 7 /* lengths of steps, each half the one before */

/* The robot about to touch at one of its points, along n. */
typedef struct {
    panda_links_t links;
    panda_real row[PANDA_N];   /* n'J */
    panda_real rates[PANDA_N]; /* joint velocities for an approach of 1 m/s */
} panda_arrival;

/* Matrices of up to PANDA_SYSTEM rows. */
typedef panda_real panda_matrix[PANDA_SYSTEM][PANDA_SYSTEM];

/* As many vectors of them. */
typedef panda_real panda_vectors[][PANDA_SYSTEM];

/* One rotation of two rows that follow each other: its cosine and sine. */
typedef struct {
    panda_real c, s;
} panda_rotation;

/*
 * Steps and rotations that find eigenvalues of N rows to four digits: of 110,000 compliances of seven joints none
 * took more than 14 and 54. What is not done by then fails.
 */
#define PANDA_MOST_QR (2*PANDA_N + 2)
#define PANDA_MOST_ROTATIONS (PANDA_N*(PANDA_N + 2))

/* Q of Q diag(values) Q', of N rows: reflections I - scale v v', and then rotations of steps. */
typedef struct {
    panda_real v[PANDA_N][PANDA_N], scale[PANDA_N];
    int steps, count;
    unsigned char first[PANDA_MOST_QR], last[PANDA_MOST_QR]; /* rows of each */
    panda_rotation by[PANDA_MOST_ROTATIONS];
} panda_turns;

/*
 * Motions of unit mass that do not act on each other: displacement of links and motors = shape amplitude. Where motors
 * have none of their own (driven) or are eliminated (free motors without gravity) it is that of deflections times the
 * root of their springs' stiffness, u = Q frequency amplitude, and Q is known by how it came about.
 */
typedef struct {
    int count;
    int rigid; /* the first ones have no frequency */
    panda_real fastest; /* largest squared frequency that is known, 1/s^2 */
    panda_real squared[PANDA_MODES]; /* frequency, 1/s^2 */
    panda_real noise[PANDA_MODES]; /* of these, where rounding may matter, 1/s^2 */
    panda_real row[PANDA_MODES]; /* what the contact point moves with each, 1/sqrt(kg) */
    panda_real start[PANDA_MODES]; /* rates at first touch of an approach of 1 m/s */
    int from[PANDA_MODES]; /* row of their shape, or column of Q */
    panda_real shape[PANDA_MODES][PANDA_SYSTEM];
#if PANDA_STRUCTURED
    panda_turns turns; /* Q */
#endif
} panda_modes;

/* One step of what a mode moves the contact point by, row amplitude: what it does by itself, and by a force. */
typedef struct {
    panda_real cosine, sine; /* cos(wh), sin(wh)/w */
    panda_real back; /* -w sin(wh) */
    panda_real push; /* row^2 (1 - cos(wh))/w^2: on the place, of a force that stays */
    panda_real late; /* row^2 (wh - sin(wh))/(w^3 h): the same of one that grows from none */
    panda_real kick; /* row^2 sin(wh)/w: on the velocity, of a force that stays; of one that grows it is push/h */
} panda_mode_step;

/* Steps of one length. */
typedef struct {
    panda_real h; /* s */
    panda_real relax; /* what is left of the body's own deflection after a step out of contact */
    panda_real per; /* 1/h */
    panda_real push, late, kick; /* of all modes, the kick less what dampers take of it within the step */
    panda_real grow; /* kick of a force that grows from none */
    panda_mode_step mode[PANDA_MODES];
} panda_level;

/* A time in which the motors follow one law. */
typedef struct {
    bool known; /* modes are those of this arrival; the body is one of them if it `has_body` */
    bool has_body;
    bool ready; /* steps are */
    panda_real blur; /* share of an approach that rounding may change */
    bool blurred; /* too few digits to integrate it */
    bool settles; /* motors do not push on and on, nothing else brings energy: see panda_settled.c */
    panda_modes modes; /* the first `active` ones move, the others stand, bent by the force */
    int active;
    panda_real compliance; /* of those that stand, m/N */
    panda_real reach; /* of all that vibrate, m/N */
    panda_real drift; /* velocity of the contact point that motors keep up, over the speed */
    bool damped; /* by joints of their own, or by a servo on its motors' rates, N m s/rad */
    panda_real damping[PANDA_DAMPERS];
    panda_real slows[PANDA_MODES]; /* half of what they do to the contact point by each mode's velocity, 1/s */
    panda_real together[PANDA_DAMPERS][PANDA_DAMPERS]; /* rate of one damper by an impulse on another, 1/(kg m^2) */
    int steps; /* of the longest level until the time is over */
    int longest_pressed; /* level of the longest step in contact */
    panda_level level[PANDA_LEVELS];
} panda_phase;

/* Smoothness below which a body's damper makes forces ripple with modes that steps pass over. */
#define PANDA_HARD PANDA_R(0.4)

/*
 * Smoothness above which a body hardly damps, so that errors grow from contact to contact, and the share of the limit
 * that counts there and before a hard damper: forces on such bodies were up to 2e-2 and 1.5e-2 (1.4e-2 at 0.26) too low
 * in inputs that a search climbed to. Parts of the human body are between. Nothing swings where motors hold the contact
 * point, and the body is held, too.
 */
#define PANDA_HARDLY PANDA_R(0.99)
#define PANDA_COUNTS_ELSEWHERE PANDA_R(0.985)

/* Everything that does not depend on the speed. */
typedef struct {
    panda_arrival arrival;
    const panda_region *region;
    const panda_params *p;
    int motors, led; /* what they do, and in the modes of the first phase */
    bool gives_way;
    panda_real mobility; /* of the contact, 1/kg */
    panda_real rotors; /* of rotors alone, all links being locked to them, 1/kg */
    panda_real hold; /* K: no energy E presses harder than sqrt(2 K E) */
    panda_real skin_rate; /* squared frequency of the contact with a stiff body, 1/s^2 */
    panda_real scale; /* of forces, N: what bends are measured by */
    panda_real smooth; /* 1, or less where the damper makes forces jump */
    int sure; /* contacts before forces are in doubt: errors grow from one to the next */
    int first, last; /* phases of an impact */
    int status; /* of what was prepared */
    panda_phase phase[2]; /* PANDA_LED and PANDA_LOOSE */
} panda_impact;

/* Phases: motors drive or servo, motors are free. */
#define PANDA_LED 0
#define PANDA_LOOSE 1

typedef struct panda_watch panda_watch;

/* Steps of the budget that a run takes before its first: it is prepared, and motors are let go. */
#define PANDA_STEPS_OF_RUN 7

/* What may be spent, and how exactly. */
typedef struct {
    int steps; /* that are left */
    bool rough; /* longer steps do */
    bool fine; /* only shorter ones do */
    panda_real stop_above; /* force after whose passing the rest does not matter, N */
    panda_watch *watch; /* who sees each step and ends the impact, or NULL; panda_state.h */
} panda_budget;

typedef struct {
    panda_real force; /* largest, N */
    panda_real later; /* the same of contacts in doubt */
    panda_real time; /* of the largest since first touch, s */
    int contact; /* in which contact, the first is 1 */
    int contacts; /* how many there were */
    bool ended; /* within the budget */
    bool torn; /* a law by table bent more over the shortest step than can be known: the force may be any */
} panda_peak;

/* Checks what says who hits whom, and how, but for the robot's own numbers. */
int panda_check_impact(const panda_region *region, const panda_params *p);

/* The contact point's row along n, and the joint velocities of least norm that move it along n. */
int panda_arrive(const panda_real n[3], int point, panda_arrival *arrival);

/* Links of a robot whose joints move, and the velocities of its independent joints. */
int panda_set_off(const panda_real q[PANDA_JOINTS], const panda_real dq[PANDA_JOINTS],
    const panda_params *p, panda_real rates[PANDA_N], panda_arrival *arrival);

/* Prepares the arrival of a point as it moves at joint velocities, along its way; returns its speed. */
panda_real panda_arrive_as_it_moves(int point, const panda_real rates[PANDA_N], panda_arrival *arrival);

/* Checks and links of an impact of one of the contact points. */
int panda_approach(const panda_real q[PANDA_JOINTS], int point, const panda_real n[3],
    const panda_region *region, const panda_params *p, panda_impact *impact);

/* To be called as impact->arrival changes: no modes are known. */
void panda_impact_forget(panda_impact *impact);

/*
 * Prepares impacts of impact->arrival with motors of one kind, not the bracket, for forces of about
 * a size (or, if that is negative, for a speed of its size).
 */
int panda_impact_prepare(const panda_region *region, const panda_params *p, int motors,
    panda_real force, panda_impact *impact);

/* Prepares what comes after the motors' release, once it is asked for. */
void panda_impact_let_go(panda_impact *impact);

/*
 * Twice the energy that an impact with loose motors can take, for 1 m/s: at most r'(M + B)r for joint
 * velocities r; where nothing but joints' springs pulls that of links, rotors and body as two masses.
 */
panda_real panda_twice_energy(const panda_impact *impact);
/* The first of these, r'(M + B)r. */
panda_real panda_twice_energy_of_arrival(const panda_arrival *arrival, const panda_params *p);

/* No force is larger than this times the speed, N s/m; 0 where none is known. */
panda_real panda_bound(const panda_impact *impact);
/* The same for a K and an energy of one's own, where there is a bound. */
panda_real panda_bound_by(const panda_impact *impact, panda_real hold, panda_real twice);

/* Least and largest kind of motors that parameters stand for: two for the bracket. */
void panda_kinds_of_motors(const panda_params *p, int *first, int *last);

/*
 * What is known of a region's law of contact: its depth under a force, twice the work done by then, and the
 * largest stiffness up to it.
 */
panda_real panda_law_depth(const panda_region *region, panda_real force);
panda_real panda_law_twice_work(const panda_region *region, panda_real force);
panda_real panda_law_stiffness(const panda_region *region, panda_real force);

/* Force of a law through points whose depth d makes hold d + soft f(d) = pressed > 0; and that depth. */
panda_real panda_law_press(const panda_region *region, panda_real hold, panda_real soft, panda_real pressed,
    panda_real *depth);

/* Whether a law by table, if there is one, rises from 0 on, and its numbers are finite. */
bool panda_law_is_one(const panda_region *region);

/* Force of two bodies that meet at 1 m/s times speed, and the speed of a force: first guesses. */
panda_real panda_two_body_force(const panda_region *region, panda_real mobility, panda_real speed);
panda_real panda_two_body_speed(const panda_region *region, panda_real mobility, panda_real force);

/*
 * Largest share of a limit that counts as kept: with what arms and bodies have, forces are within 2e-3 of the
 * right ones, in the worst of 100,000 within 1e-2.
 */
#define PANDA_KEPT PANDA_R(0.99)
/* Speed of a contact point that counts as rest: it can hardly be measured, m/s. */
#define PANDA_AT_REST PANDA_R(1e-6)

/*
 * Largest speed, at most `cap` where that is positive, up to which an impact keeps a limit: OK,
 * BOUNDED or another status.
 */
int panda_find_speed(const panda_region *region, const panda_params *p, panda_real limit,
    panda_real cap, panda_impact *impact, panda_safe_speed_t *found);

/* Largest force of an arrival by any of the motors that p stands for: OK, BOUNDED or another status. */
int panda_find_peak(const panda_region *region, const panda_params *p, panda_real speed,
    panda_impact *impact, panda_peak_force_t *out);

#if PANDA_FRAMES > 0
/* Links, with the motion of a place in a frame in place of that of the package's own point. */
int panda_links_on(const panda_real q[PANDA_JOINTS], int frame, const panda_real place[3],
    const panda_params *p, panda_links_t *links);
#endif

/* Largest force over all contacts of an impact at a speed. */
void panda_impact_run(panda_impact *impact, panda_real speed, panda_budget *budget,
    panda_peak *peak);

/* Modes of links whose motors drive or servo, and of loose ones; 0 or a status. */
int panda_driven_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift);
int panda_servo_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift);
int panda_free_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes);

/*
 * Mobility of the contact point with links alone, and with rotors alone, 1/kg; 0 or a status. Leaves L of the links'
 * mass M = L L', where loose modes look for it: in their `shape`, which they do not need else.
 */
int panda_mobilities(const panda_arrival *arrival, const panda_params *p, panda_matrix L, panda_real *links,
    panda_real *rotors);
/* The same with links and rotors as one; 0 if their mass is not positive definite. */
panda_real panda_together(const panda_arrival *arrival, const panda_params *p);

/* How a phase's dampers act on each other; returns the most that they damp, 1/s. */
panda_real panda_damping_rate(panda_phase *phase);
/* Takes from the contact point's velocity after steps what is damped in their other half. */
void panda_slowing(panda_phase *phase);
/* Lets fast modes stand, adds the body, and makes the steps of a phase that lasts `time`. */
void panda_phase_steps(const panda_impact *impact, panda_real time, panda_phase *phase);

/* L of A = L L' in place, below and on the diagonal; false unless A is positive definite. */
bool panda_cholesky(int size, panda_matrix A);
/* x = L^-1 x and x = L^-T x. */
void panda_forward(int size, panda_matrix L, panda_real *x);
void panda_backward(int size, panda_matrix L, panda_real *x);
/* Turns two vectors, a towards b, by an angle of such a cosine and sine, or of a tangent. */
void panda_turn(int size, panda_real c, panda_real s, panda_real *a, panda_real *b);
void panda_turn_by(int size, panda_real t, panda_real *a, panda_real *b);
/*
 * Tangent of the angle that leaves nothing of an entry `off` of a symmetric matrix (Jacobi): the later one of its
 * entries on the diagonal, which is more by `apart`, turns towards the earlier one.
 */
panda_real panda_tangent(panda_real apart, panda_real off);
/* Turns the rows of X, and A with them, until A = XKX' is diagonal (Jacobi); false if that does not end. */
bool panda_diagonalise(int size, panda_matrix A, panda_matrix X);
/*
 * Eigenvalues of a symmetric A, which is lost; turns vectors x to Q'x, of A = Q diag(values) Q', and keeps how
 * unless `turns` is NULL; false if that does not end. `small` is the square of an entry beside the diagonal, over
 * the product of its neighbours on it, that counts as none.
 */
bool panda_spectrum(int size, panda_real small, panda_matrix A, panda_real *values, int count, panda_vectors x,
    panda_turns *turns);
#if PANDA_STRUCTURED
/* Q'x and Qx of two vectors. */
void panda_decompose(const panda_turns *turns, panda_real x[PANDA_N], panda_real y[PANDA_N]);
void panda_compose(const panda_turns *turns, panda_real x[PANDA_N], panda_real y[PANDA_N]);
#endif

#endif
