/* SPDX-License-Identifier: 0BSD */
/*
 * An impact of rr_ on a part of the body; not for its users.
 *
 * The robot is a sum of modes that only meet in the contact force. While motors drive (or servo) the
 * modes are those of links whose motors do; once motors are released they are those of links, springs
 * and rotors. Each mode's step is exact for a force that is linear over the step.
 * README.md of the package and docs/impacts-in-c.md of softimpact derive all of it.
 */
#ifndef RR_IMPACT_H
#define RR_IMPACT_H

#include "rr_internal.h"

#if RR_ELASTIC
#define RR_SYSTEM (2*RR_N) /* links, then motors */
#else
#define RR_SYSTEM RR_N
#endif
#define RR_DAMPERS (RR_DAMPED ? RR_SYSTEM : RR_N) /* of the last ones of these */
#define RR_MODES (RR_SYSTEM + 1) /* one for a body that gives way */
#define RR_LEVELS 7 /* lengths of steps, each half the one before */

/* The robot about to touch at one of its points, along n. */
typedef struct {
    rr_links_t links;
    rr_real row[RR_N];   /* n'J */
    rr_real rates[RR_N]; /* joint velocities for an approach of 1 m/s */
} rr_arrival;

/* Matrices of up to RR_SYSTEM rows. */
typedef rr_real rr_matrix[RR_SYSTEM][RR_SYSTEM];

/* As many vectors of them. */
typedef rr_real rr_vectors[][RR_SYSTEM];

/* One rotation of two rows that follow each other: its cosine and sine. */
typedef struct {
    rr_real c, s;
} rr_rotation;

/*
 * Steps and rotations that find eigenvalues of N rows to four digits: of 110,000 compliances of seven joints none
 * took more than 14 and 54. What is not done by then fails.
 */
#define RR_MOST_QR (2*RR_N + 2)
#define RR_MOST_ROTATIONS (RR_N*(RR_N + 2))

/* Q of Q diag(values) Q', of N rows: reflections I - scale v v', and then rotations of steps. */
typedef struct {
    rr_real v[RR_N][RR_N], scale[RR_N];
    int steps, count;
    unsigned char first[RR_MOST_QR], last[RR_MOST_QR]; /* rows of each */
    rr_rotation by[RR_MOST_ROTATIONS];
} rr_turns;

/*
 * Motions of unit mass that do not act on each other: displacement of links and motors = shape amplitude. Where motors
 * have none of their own (driven) or are eliminated (free motors without gravity) it is that of deflections times the
 * root of their springs' stiffness, u = Q frequency amplitude, and Q is known by how it came about.
 */
typedef struct {
    int count;
    int rigid; /* the first ones have no frequency */
    rr_real fastest; /* largest squared frequency that is known, 1/s^2 */
    rr_real squared[RR_MODES]; /* frequency, 1/s^2 */
    rr_real noise[RR_MODES]; /* of these, where rounding may matter, 1/s^2 */
    rr_real row[RR_MODES]; /* what the contact point moves with each, 1/sqrt(kg) */
    rr_real start[RR_MODES]; /* rates at first touch of an approach of 1 m/s */
    int from[RR_MODES]; /* row of their shape, or column of Q */
    rr_real shape[RR_MODES][RR_SYSTEM];
#if RR_STRUCTURED
    rr_turns turns; /* Q */
#endif
} rr_modes;

/* One step of what a mode moves the contact point by, row amplitude: what it does by itself, and by a force. */
typedef struct {
    rr_real cosine, sine; /* cos(wh), sin(wh)/w */
    rr_real back; /* -w sin(wh) */
    rr_real push; /* row^2 (1 - cos(wh))/w^2: on the place, of a force that stays */
    rr_real late; /* row^2 (wh - sin(wh))/(w^3 h): the same of one that grows from none */
    rr_real kick; /* row^2 sin(wh)/w: on the velocity, of a force that stays; of one that grows it is push/h */
} rr_mode_step;

/* Steps of one length. */
typedef struct {
    rr_real h; /* s */
    rr_real relax; /* what is left of the body's own deflection after a step out of contact */
    rr_real per; /* 1/h */
    rr_real push, late, kick; /* of all modes, the kick less what dampers take of it within the step */
    rr_real grow; /* kick of a force that grows from none */
    rr_mode_step mode[RR_MODES];
} rr_level;

/* A time in which the motors follow one law. */
typedef struct {
    bool known; /* modes are those of this arrival; the body is one of them if it `has_body` */
    bool has_body;
    bool ready; /* steps are */
    rr_real blur; /* share of an approach that rounding may change */
    bool blurred; /* too few digits to integrate it */
    bool settles; /* motors do not push on and on, nothing else brings energy: see rr_settled.c */
    rr_modes modes; /* the first `active` ones move, the others stand, bent by the force */
    int active;
    rr_real compliance; /* of those that stand, m/N */
    rr_real reach; /* of all that vibrate, m/N */
    rr_real drift; /* velocity of the contact point that motors keep up, over the speed */
    bool damped; /* by joints of their own, or by a servo on its motors' rates, N m s/rad */
    rr_real damping[RR_DAMPERS];
    rr_real slows[RR_MODES]; /* half of what they do to the contact point by each mode's velocity, 1/s */
    rr_real together[RR_DAMPERS][RR_DAMPERS]; /* rate of one damper by an impulse on another, 1/(kg m^2) */
    int steps; /* of the longest level until the time is over */
    int longest_pressed; /* level of the longest step in contact */
    rr_level level[RR_LEVELS];
} rr_phase;

/* Smoothness below which a body's damper makes forces ripple with modes that steps pass over. */
#define RR_HARD RR_R(0.4)

/*
 * Smoothness above which a body hardly damps, so that errors grow from contact to contact, and the share of the limit
 * that counts there and before a hard damper: forces on such bodies were up to 2e-2 and 1.5e-2 (1.4e-2 at 0.26) too low
 * in inputs that a search climbed to. Parts of the human body are between. Nothing swings where motors hold the contact
 * point, and the body is held, too.
 */
#define RR_HARDLY RR_R(0.99)
#define RR_COUNTS_ELSEWHERE RR_R(0.985)

/* Everything that does not depend on the speed. */
typedef struct {
    rr_arrival arrival;
    const rr_region *region;
    const rr_params *p;
    int motors, led; /* what they do, and in the modes of the first phase */
    bool gives_way;
    rr_real mobility; /* of the contact, 1/kg */
    rr_real rotors; /* of rotors alone, all links being locked to them, 1/kg */
    rr_real hold; /* K: no energy E presses harder than sqrt(2 K E) */
    rr_real skin_rate; /* squared frequency of the contact with a stiff body, 1/s^2 */
    rr_real scale; /* of forces, N: what bends are measured by */
    rr_real smooth; /* 1, or less where the damper makes forces jump */
    int sure; /* contacts before forces are in doubt: errors grow from one to the next */
    int first, last; /* phases of an impact */
    int status; /* of what was prepared */
    rr_phase phase[2]; /* RR_LED and RR_LOOSE */
} rr_impact;

/* Phases: motors drive or servo, motors are free. */
#define RR_LED 0
#define RR_LOOSE 1

typedef struct rr_watch rr_watch;

/* Steps of the budget that a run takes before its first: it is prepared, and motors are let go. */
#define RR_STEPS_OF_RUN 7

/* What may be spent, and how exactly. */
typedef struct {
    int steps; /* that are left */
    bool rough; /* longer steps do */
    bool fine; /* only shorter ones do */
    rr_real stop_above; /* force after whose passing the rest does not matter, N */
    rr_watch *watch; /* who sees each step and ends the impact, or NULL; rr_state.h */
} rr_budget;

typedef struct {
    rr_real force; /* largest, N */
    rr_real later; /* the same of contacts in doubt */
    rr_real time; /* of the largest since first touch, s */
    int contact; /* in which contact, the first is 1 */
    int contacts; /* how many there were */
    bool ended; /* within the budget */
    bool torn; /* a law by table bent more over the shortest step than can be known: the force may be any */
} rr_peak;

/* Checks what says who hits whom, and how, but for the robot's own numbers. */
int rr_check_impact(const rr_region *region, const rr_params *p);

/* The contact point's row along n, and the joint velocities of least norm that move it along n. */
int rr_arrive(const rr_real n[3], int point, rr_arrival *arrival);

/* Links of a robot whose joints move, and the velocities of its independent joints. */
int rr_set_off(const rr_real q[RR_JOINTS], const rr_real dq[RR_JOINTS],
    const rr_params *p, rr_real rates[RR_N], rr_arrival *arrival);

/* Prepares the arrival of a point as it moves at joint velocities, along its way; returns its speed. */
rr_real rr_arrive_as_it_moves(int point, const rr_real rates[RR_N], rr_arrival *arrival);

/* Checks and links of an impact of one of the contact points. */
int rr_approach(const rr_real q[RR_JOINTS], int point, const rr_real n[3],
    const rr_region *region, const rr_params *p, rr_impact *impact);

/* To be called as impact->arrival changes: no modes are known. */
void rr_impact_forget(rr_impact *impact);

/*
 * Prepares impacts of impact->arrival with motors of one kind, not the bracket, for forces of about
 * a size (or, if that is negative, for a speed of its size).
 */
int rr_impact_prepare(const rr_region *region, const rr_params *p, int motors,
    rr_real force, rr_impact *impact);

/* Prepares what comes after the motors' release, once it is asked for. */
void rr_impact_let_go(rr_impact *impact);

/*
 * Twice the energy that an impact with loose motors can take, for 1 m/s: at most r'(M + B)r for joint
 * velocities r; where nothing but joints' springs pulls that of links, rotors and body as two masses.
 */
rr_real rr_twice_energy(const rr_impact *impact);
/* The first of these, r'(M + B)r. */
rr_real rr_twice_energy_of_arrival(const rr_arrival *arrival, const rr_params *p);

/* No force is larger than this times the speed, N s/m; 0 where none is known. */
rr_real rr_bound(const rr_impact *impact);
/* The same for a K and an energy of one's own, where there is a bound. */
rr_real rr_bound_by(const rr_impact *impact, rr_real hold, rr_real twice);

/* Least and largest kind of motors that parameters stand for: two for the bracket. */
void rr_kinds_of_motors(const rr_params *p, int *first, int *last);

/*
 * What is known of a region's law of contact: its depth under a force, twice the work done by then, and the
 * largest stiffness up to it.
 */
rr_real rr_law_depth(const rr_region *region, rr_real force);
rr_real rr_law_twice_work(const rr_region *region, rr_real force);
rr_real rr_law_stiffness(const rr_region *region, rr_real force);

/* Force of a law through points whose depth d makes hold d + soft f(d) = pressed > 0; and that depth. */
rr_real rr_law_press(const rr_region *region, rr_real hold, rr_real soft, rr_real pressed,
    rr_real *depth);

/* Whether a law by table, if there is one, rises from 0 on, and its numbers are finite. */
bool rr_law_is_one(const rr_region *region);

/* Force of two bodies that meet at 1 m/s times speed, and the speed of a force: first guesses. */
rr_real rr_two_body_force(const rr_region *region, rr_real mobility, rr_real speed);
rr_real rr_two_body_speed(const rr_region *region, rr_real mobility, rr_real force);

/*
 * Largest share of a limit that counts as kept: with what arms and bodies have, forces are within 2e-3 of the
 * right ones, in the worst of 100,000 within 1e-2.
 */
#define RR_KEPT RR_R(0.99)
/* Speed of a contact point that counts as rest: it can hardly be measured, m/s. */
#define RR_AT_REST RR_R(1e-6)

/*
 * Largest speed, at most `cap` where that is positive, up to which an impact keeps a limit: OK,
 * BOUNDED or another status.
 */
int rr_find_speed(const rr_region *region, const rr_params *p, rr_real limit,
    rr_real cap, rr_impact *impact, rr_safe_speed_t *found);

/* Largest force of an arrival by any of the motors that p stands for: OK, BOUNDED or another status. */
int rr_find_peak(const rr_region *region, const rr_params *p, rr_real speed,
    rr_impact *impact, rr_peak_force_t *out);

#if RR_FRAMES > 0
/* Links, with the motion of a place in a frame in place of that of the package's own point. */
int rr_links_on(const rr_real q[RR_JOINTS], int frame, const rr_real place[3],
    const rr_params *p, rr_links_t *links);
#endif

/* Largest force over all contacts of an impact at a speed. */
void rr_impact_run(rr_impact *impact, rr_real speed, rr_budget *budget,
    rr_peak *peak);

/* Modes of links whose motors drive or servo, and of loose ones; 0 or a status. */
int rr_driven_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes,
    rr_real *drift);
int rr_servo_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes,
    rr_real *drift);
int rr_free_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes);

/*
 * Mobility of the contact point with links alone, and with rotors alone, 1/kg; 0 or a status. Leaves L of the links'
 * mass M = L L', where loose modes look for it: in their `shape`, which they do not need else.
 */
int rr_mobilities(const rr_arrival *arrival, const rr_params *p, rr_matrix L, rr_real *links,
    rr_real *rotors);
/* The same with links and rotors as one; 0 if their mass is not positive definite. */
rr_real rr_together(const rr_arrival *arrival, const rr_params *p);

/* How a phase's dampers act on each other; returns the most that they damp, 1/s. */
rr_real rr_damping_rate(rr_phase *phase);
/* Takes from the contact point's velocity after steps what is damped in their other half. */
void rr_slowing(rr_phase *phase);
/* Lets fast modes stand, adds the body, and makes the steps of a phase that lasts `time`. */
void rr_phase_steps(const rr_impact *impact, rr_real time, rr_phase *phase);

/* L of A = L L' in place, below and on the diagonal; false unless A is positive definite. */
bool rr_cholesky(int size, rr_matrix A);
/* x = L^-1 x and x = L^-T x. */
void rr_forward(int size, rr_matrix L, rr_real *x);
void rr_backward(int size, rr_matrix L, rr_real *x);
/* Turns two vectors, a towards b, by an angle of such a cosine and sine, or of a tangent. */
void rr_turn(int size, rr_real c, rr_real s, rr_real *a, rr_real *b);
void rr_turn_by(int size, rr_real t, rr_real *a, rr_real *b);
/*
 * Tangent of the angle that leaves nothing of an entry `off` of a symmetric matrix (Jacobi): the later one of its
 * entries on the diagonal, which is more by `apart`, turns towards the earlier one.
 */
rr_real rr_tangent(rr_real apart, rr_real off);
/* Turns the rows of X, and A with them, until A = XKX' is diagonal (Jacobi); false if that does not end. */
bool rr_diagonalise(int size, rr_matrix A, rr_matrix X);
/*
 * Eigenvalues of a symmetric A, which is lost; turns vectors x to Q'x, of A = Q diag(values) Q', and keeps how
 * unless `turns` is NULL; false if that does not end. `small` is the square of an entry beside the diagonal, over
 * the product of its neighbours on it, that counts as none.
 */
bool rr_spectrum(int size, rr_real small, rr_matrix A, rr_real *values, int count, rr_vectors x,
    rr_turns *turns);
#if RR_STRUCTURED
/* Q'x and Qx of two vectors. */
void rr_decompose(const rr_turns *turns, rr_real x[RR_N], rr_real y[RR_N]);
void rr_compose(const rr_turns *turns, rr_real x[RR_N], rr_real y[RR_N]);
#endif

#endif
