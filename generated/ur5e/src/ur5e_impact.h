/* SPDX-License-Identifier: 0BSD */
/*
 * An impact of ur5e_ on a part of the body; not for its users.
 *
 * The robot is a sum of modes that only meet in the contact force. While motors drive (or servo) the
 * modes are those of links whose motors do; once motors are released they are those of links, springs
 * and rotors. Each mode's step is exact for a force that is linear over the step.
 * README.md of the package and docs/impacts-in-c.md of softimpact derive all of it.
 */
#ifndef UR5E_IMPACT_H
#define UR5E_IMPACT_H

#include "ur5e_internal.h"

#if UR5E_ELASTIC
#define UR5E_SYSTEM (2*UR5E_N) /* links, then motors */
#else
#define UR5E_SYSTEM UR5E_N
#endif
#define UR5E_DAMPERS (UR5E_DAMPED ? UR5E_SYSTEM : UR5E_N) /* of the last ones of these */
#define UR5E_MODES (UR5E_SYSTEM + 1) /* one for a body that gives way */
#define UR5E_LEVELS 7 /* lengths of steps, each half the one before */

/* The robot about to touch at one of its points, along n. */
typedef struct {
    ur5e_links_t links;
    ur5e_real row[UR5E_N];   /* n'J */
    ur5e_real rates[UR5E_N]; /* joint velocities for an approach of 1 m/s */
} ur5e_arrival;

/* Matrices of up to UR5E_SYSTEM rows. */
typedef ur5e_real ur5e_matrix[UR5E_SYSTEM][UR5E_SYSTEM];

/* As many vectors of them. */
typedef ur5e_real ur5e_vectors[][UR5E_SYSTEM];

/* One rotation of two rows that follow each other: its cosine and sine. */
typedef struct {
    ur5e_real c, s;
} ur5e_rotation;

/*
 * Steps and rotations that find eigenvalues of N rows to four digits: of 110,000 compliances of seven joints none
 * took more than 14 and 54. What is not done by then fails.
 */
#define UR5E_MOST_QR (2*UR5E_N + 2)
#define UR5E_MOST_ROTATIONS (UR5E_N*(UR5E_N + 2))

/* Q of Q diag(values) Q', of N rows: reflections I - scale v v', and then rotations of steps. */
typedef struct {
    ur5e_real v[UR5E_N][UR5E_N], scale[UR5E_N];
    int steps, count;
    unsigned char first[UR5E_MOST_QR], last[UR5E_MOST_QR]; /* rows of each */
    ur5e_rotation by[UR5E_MOST_ROTATIONS];
} ur5e_turns;

/*
 * Motions of unit mass that do not act on each other: displacement of links and motors = shape amplitude. Where motors
 * have none of their own (driven) or are eliminated (free motors without gravity) it is that of deflections times the
 * root of their springs' stiffness, u = Q frequency amplitude, and Q is known by how it came about.
 */
typedef struct {
    int count;
    int rigid; /* the first ones have no frequency */
    ur5e_real fastest; /* largest squared frequency that is known, 1/s^2 */
    ur5e_real squared[UR5E_MODES]; /* frequency, 1/s^2 */
    ur5e_real noise[UR5E_MODES]; /* of these, where rounding may matter, 1/s^2 */
    ur5e_real row[UR5E_MODES]; /* what the contact point moves with each, 1/sqrt(kg) */
    ur5e_real start[UR5E_MODES]; /* rates at first touch of an approach of 1 m/s */
    int from[UR5E_MODES]; /* row of their shape, or column of Q */
    ur5e_real shape[UR5E_MODES][UR5E_SYSTEM];
#if UR5E_STRUCTURED
    ur5e_turns turns; /* Q */
#endif
} ur5e_modes;

/* One step of what a mode moves the contact point by, row amplitude: what it does by itself, and by a force. */
typedef struct {
    ur5e_real cosine, sine; /* cos(wh), sin(wh)/w */
    ur5e_real back; /* -w sin(wh) */
    ur5e_real push; /* row^2 (1 - cos(wh))/w^2: on the place, of a force that stays */
    ur5e_real late; /* row^2 (wh - sin(wh))/(w^3 h): the same of one that grows from none */
    ur5e_real kick; /* row^2 sin(wh)/w: on the velocity, of a force that stays; of one that grows it is push/h */
} ur5e_mode_step;

/* Steps of one length. */
typedef struct {
    ur5e_real h; /* s */
    ur5e_real relax; /* what is left of the body's own deflection after a step out of contact */
    ur5e_real per; /* 1/h */
    ur5e_real push, late, kick; /* of all modes, the kick less what dampers take of it within the step */
    ur5e_real grow; /* kick of a force that grows from none */
    ur5e_mode_step mode[UR5E_MODES];
} ur5e_level;

/* A time in which the motors follow one law. */
typedef struct {
    bool known; /* modes are those of this arrival; the body is one of them if it `has_body` */
    bool has_body;
    bool ready; /* steps are */
    ur5e_real blur; /* share of an approach that rounding may change */
    bool blurred; /* too few digits to integrate it */
    bool settles; /* motors do not push on and on, nothing else brings energy: see ur5e_settled.c */
    ur5e_modes modes; /* the first `active` ones move, the others stand, bent by the force */
    int active;
    ur5e_real compliance; /* of those that stand, m/N */
    ur5e_real reach; /* of all that vibrate, m/N */
    ur5e_real drift; /* velocity of the contact point that motors keep up, over the speed */
    bool damped; /* by joints of their own, or by a servo on its motors' rates, N m s/rad */
    ur5e_real damping[UR5E_DAMPERS];
    ur5e_real slows[UR5E_MODES]; /* half of what they do to the contact point by each mode's velocity, 1/s */
    ur5e_real together[UR5E_DAMPERS][UR5E_DAMPERS]; /* rate of one damper by an impulse on another, 1/(kg m^2) */
    int steps; /* of the longest level until the time is over */
    int longest_pressed; /* level of the longest step in contact */
    ur5e_level level[UR5E_LEVELS];
} ur5e_phase;

/* Smoothness below which a body's damper makes forces ripple with modes that steps pass over. */
#define UR5E_HARD UR5E_R(0.4)

/*
 * Smoothness above which a body hardly damps, so that errors grow from contact to contact, and the share of the limit
 * that counts there and before a hard damper: forces on such bodies were up to 2e-2 and 1.5e-2 (1.4e-2 at 0.26) too low
 * in inputs that a search climbed to. Parts of the human body are between. Nothing swings where motors hold the contact
 * point, and the body is held, too.
 */
#define UR5E_HARDLY UR5E_R(0.99)
#define UR5E_COUNTS_ELSEWHERE UR5E_R(0.985)

/* Everything that does not depend on the speed. */
typedef struct {
    ur5e_arrival arrival;
    const ur5e_region *region;
    const ur5e_params *p;
    int motors, led; /* what they do, and in the modes of the first phase */
    bool gives_way;
    ur5e_real mobility; /* of the contact, 1/kg */
    ur5e_real rotors; /* of rotors alone, all links being locked to them, 1/kg */
    ur5e_real hold; /* K: no energy E presses harder than sqrt(2 K E) */
    ur5e_real skin_rate; /* squared frequency of the contact with a stiff body, 1/s^2 */
    ur5e_real scale; /* of forces, N: what bends are measured by */
    ur5e_real smooth; /* 1, or less where the damper makes forces jump */
    int sure; /* contacts before forces are in doubt: errors grow from one to the next */
    int first, last; /* phases of an impact */
    int status; /* of what was prepared */
    ur5e_phase phase[2]; /* UR5E_LED and UR5E_LOOSE */
} ur5e_impact;

/* Phases: motors drive or servo, motors are free. */
#define UR5E_LED 0
#define UR5E_LOOSE 1

typedef struct ur5e_watch ur5e_watch;

/* Steps of the budget that a run takes before its first: it is prepared, and motors are let go. */
#define UR5E_STEPS_OF_RUN 7

/* What may be spent, and how exactly. */
typedef struct {
    int steps; /* that are left */
    bool rough; /* longer steps do */
    bool fine; /* only shorter ones do */
    ur5e_real stop_above; /* force after whose passing the rest does not matter, N */
    ur5e_watch *watch; /* who sees each step and ends the impact, or NULL; ur5e_state.h */
} ur5e_budget;

typedef struct {
    ur5e_real force; /* largest, N */
    ur5e_real later; /* the same of contacts in doubt */
    ur5e_real time; /* of the largest since first touch, s */
    int contact; /* in which contact, the first is 1 */
    int contacts; /* how many there were */
    bool ended; /* within the budget */
    bool torn; /* a law by table bent more over the shortest step than can be known: the force may be any */
} ur5e_peak;

/* Checks what says who hits whom, and how, but for the robot's own numbers. */
int ur5e_check_impact(const ur5e_region *region, const ur5e_params *p);

/* The contact point's row along n, and the joint velocities of least norm that move it along n. */
int ur5e_arrive(const ur5e_real n[3], int point, ur5e_arrival *arrival);

/* Links of a robot whose joints move, and the velocities of its independent joints. */
int ur5e_set_off(const ur5e_real q[UR5E_JOINTS], const ur5e_real dq[UR5E_JOINTS],
    const ur5e_params *p, ur5e_real rates[UR5E_N], ur5e_arrival *arrival);

/* Prepares the arrival of a point as it moves at joint velocities, along its way; returns its speed. */
ur5e_real ur5e_arrive_as_it_moves(int point, const ur5e_real rates[UR5E_N], ur5e_arrival *arrival);

/* Checks and links of an impact of one of the contact points. */
int ur5e_approach(const ur5e_real q[UR5E_JOINTS], int point, const ur5e_real n[3],
    const ur5e_region *region, const ur5e_params *p, ur5e_impact *impact);

/* To be called as impact->arrival changes: no modes are known. */
void ur5e_impact_forget(ur5e_impact *impact);

/*
 * Prepares impacts of impact->arrival with motors of one kind, not the bracket, for forces of about
 * a size (or, if that is negative, for a speed of its size).
 */
int ur5e_impact_prepare(const ur5e_region *region, const ur5e_params *p, int motors,
    ur5e_real force, ur5e_impact *impact);

/* Prepares what comes after the motors' release, once it is asked for. */
void ur5e_impact_let_go(ur5e_impact *impact);

/*
 * Twice the energy that an impact with loose motors can take, for 1 m/s: at most r'(M + B)r for joint
 * velocities r; where nothing but joints' springs pulls that of links, rotors and body as two masses.
 */
ur5e_real ur5e_twice_energy(const ur5e_impact *impact);
/* The first of these, r'(M + B)r. */
ur5e_real ur5e_twice_energy_of_arrival(const ur5e_arrival *arrival, const ur5e_params *p);

/* No force is larger than this times the speed, N s/m; 0 where none is known. */
ur5e_real ur5e_bound(const ur5e_impact *impact);
/* The same for a K and an energy of one's own, where there is a bound. */
ur5e_real ur5e_bound_by(const ur5e_impact *impact, ur5e_real hold, ur5e_real twice);

/* Least and largest kind of motors that parameters stand for: two for the bracket. */
void ur5e_kinds_of_motors(const ur5e_params *p, int *first, int *last);

/*
 * What is known of a region's law of contact: its depth under a force, twice the work done by then, and the
 * largest stiffness up to it.
 */
ur5e_real ur5e_law_depth(const ur5e_region *region, ur5e_real force);
ur5e_real ur5e_law_twice_work(const ur5e_region *region, ur5e_real force);
ur5e_real ur5e_law_stiffness(const ur5e_region *region, ur5e_real force);

/* Force of a law through points whose depth d makes hold d + soft f(d) = pressed > 0; and that depth. */
ur5e_real ur5e_law_press(const ur5e_region *region, ur5e_real hold, ur5e_real soft, ur5e_real pressed,
    ur5e_real *depth);

/* Whether a law by table, if there is one, rises from 0 on, and its numbers are finite. */
bool ur5e_law_is_one(const ur5e_region *region);

/* Force of two bodies that meet at 1 m/s times speed, and the speed of a force: first guesses. */
ur5e_real ur5e_two_body_force(const ur5e_region *region, ur5e_real mobility, ur5e_real speed);
ur5e_real ur5e_two_body_speed(const ur5e_region *region, ur5e_real mobility, ur5e_real force);

/*
 * Largest share of a limit that counts as kept: with what arms and bodies have, forces are within 2e-3 of the
 * right ones, in the worst of 100,000 within 1e-2.
 */
#define UR5E_KEPT UR5E_R(0.99)
/* Speed of a contact point that counts as rest: it can hardly be measured, m/s. */
#define UR5E_AT_REST UR5E_R(1e-6)

/*
 * Largest speed, at most `cap` where that is positive, up to which an impact keeps a limit: OK,
 * BOUNDED or another status.
 */
int ur5e_find_speed(const ur5e_region *region, const ur5e_params *p, ur5e_real limit,
    ur5e_real cap, ur5e_impact *impact, ur5e_safe_speed_t *found);

/* Largest force of an arrival by any of the motors that p stands for: OK, BOUNDED or another status. */
int ur5e_find_peak(const ur5e_region *region, const ur5e_params *p, ur5e_real speed,
    ur5e_impact *impact, ur5e_peak_force_t *out);

#if UR5E_FRAMES > 0
/* Links, with the motion of a place in a frame in place of that of the package's own point. */
int ur5e_links_on(const ur5e_real q[UR5E_JOINTS], int frame, const ur5e_real place[3],
    const ur5e_params *p, ur5e_links_t *links);
#endif

/* Largest force over all contacts of an impact at a speed. */
void ur5e_impact_run(ur5e_impact *impact, ur5e_real speed, ur5e_budget *budget,
    ur5e_peak *peak);

/* Modes of links whose motors drive or servo, and of loose ones; 0 or a status. */
int ur5e_driven_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real *drift);
int ur5e_servo_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real *drift);
int ur5e_free_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes);

/*
 * Mobility of the contact point with links alone, and with rotors alone, 1/kg; 0 or a status. Leaves L of the links'
 * mass M = L L', where loose modes look for it: in their `shape`, which they do not need else.
 */
int ur5e_mobilities(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_matrix L, ur5e_real *links,
    ur5e_real *rotors);
/* The same with links and rotors as one; 0 if their mass is not positive definite. */
ur5e_real ur5e_together(const ur5e_arrival *arrival, const ur5e_params *p);

/* How a phase's dampers act on each other; returns the most that they damp, 1/s. */
ur5e_real ur5e_damping_rate(ur5e_phase *phase);
/* Takes from the contact point's velocity after steps what is damped in their other half. */
void ur5e_slowing(ur5e_phase *phase);
/* Lets fast modes stand, adds the body, and makes the steps of a phase that lasts `time`. */
void ur5e_phase_steps(const ur5e_impact *impact, ur5e_real time, ur5e_phase *phase);

/* L of A = L L' in place, below and on the diagonal; false unless A is positive definite. */
bool ur5e_cholesky(int size, ur5e_matrix A);
/* x = L^-1 x and x = L^-T x. */
void ur5e_forward(int size, ur5e_matrix L, ur5e_real *x);
void ur5e_backward(int size, ur5e_matrix L, ur5e_real *x);
/* Turns two vectors, a towards b, by an angle of such a cosine and sine, or of a tangent. */
void ur5e_turn(int size, ur5e_real c, ur5e_real s, ur5e_real *a, ur5e_real *b);
void ur5e_turn_by(int size, ur5e_real t, ur5e_real *a, ur5e_real *b);
/*
 * Tangent of the angle that leaves nothing of an entry `off` of a symmetric matrix (Jacobi): the later one of its
 * entries on the diagonal, which is more by `apart`, turns towards the earlier one.
 */
ur5e_real ur5e_tangent(ur5e_real apart, ur5e_real off);
/* Turns the rows of X, and A with them, until A = XKX' is diagonal (Jacobi); false if that does not end. */
bool ur5e_diagonalise(int size, ur5e_matrix A, ur5e_matrix X);
/*
 * Eigenvalues of a symmetric A, which is lost; turns vectors x to Q'x, of A = Q diag(values) Q', and keeps how
 * unless `turns` is NULL; false if that does not end. `small` is the square of an entry beside the diagonal, over
 * the product of its neighbours on it, that counts as none.
 */
bool ur5e_spectrum(int size, ur5e_real small, ur5e_matrix A, ur5e_real *values, int count, ur5e_vectors x,
    ur5e_turns *turns);
#if UR5E_STRUCTURED
/* Q'x and Qx of two vectors. */
void ur5e_decompose(const ur5e_turns *turns, ur5e_real x[UR5E_N], ur5e_real y[UR5E_N]);
void ur5e_compose(const ur5e_turns *turns, ur5e_real x[UR5E_N], ur5e_real y[UR5E_N]);
#endif

#endif
