/* SPDX-License-Identifier: 0BSD */
/* Where an impact of rmin_ is, and a step of it; not for its users. */
#ifndef RMIN_STATE_H
#define RMIN_STATE_H

#include "rmin_impact.h"

/* What the next step takes of those before it, and of its own length. */
typedef struct {
    rmin_real ratio; /* of its length to the last one's */
    rmin_real share, whole, before; /* of the bend, see rmin_press */
    rmin_real u, u_before, u_third; /* in c u' */
    rmin_real stays, grows; /* by how much less a force presses that stays, and more one that has not grown yet */
    rmin_real hold, soft, yields; /* depth hold + soft f = what presses; x gives way by yields f */
    rmin_real per_hold, cubic; /* of Hertz's law, see root_of */
} rmin_pace;

/* What each mode moves the contact point by, m, and how fast. */
typedef struct {
    rmin_real place[RMIN_MODES], rate[RMIN_MODES];
} rmin_motion;

/* The force over a step, on average and by how much it grew, which modes are yet to feel. */
typedef struct {
    const rmin_level *level;
    rmin_real mean, rise;
} rmin_due;

/* A mode's place after the force of a step, and its velocity; slope is the force's rise over the step's length. */
static inline rmin_real rmin_felt_place(
    const rmin_mode_step *step, rmin_real place, rmin_real mean, rmin_real rise)
{
    return place - step->push*mean - step->late*rise;
}

static inline rmin_real rmin_felt_rate(
    const rmin_mode_step *step, rmin_real rate, rmin_real mean, rmin_real slope)
{
    return rate - step->kick*mean - step->push*slope;
}

typedef struct {
    rmin_impact *impact;
    const rmin_region *region;
    const rmin_phase *phase;
    rmin_real speed;
    bool all_count; /* forces below the largest so far, too */
    rmin_real scale; /* of forces, N */
    const rmin_level *step; /* of the next one's length */
    int level;
    int even; /* steps in a row of this length */
    rmin_pace pace;
    int ticks; /* of the shortest step, until the phase is over */
    rmin_real time;
    rmin_real drift, drifted; /* by the motors, m/s and m */
    rmin_motion *motion, *trial; /* at the last node, but for what is due; and after a step on trial */
    rmin_motion motions[2]; /* where they are */
    rmin_due due;
    rmin_real owed; /* time for which rates are still to be damped, half the last step, s */
    bool touching;
    int past; /* steps since the touch */
    rmin_real h, h_before, per, x; /* last steps, contact point */
    rmin_real bump, bent; /* what the bend adds to the force on average of the last step; the bend as it matters */
    rmin_real f, rise; /* force, and by how much it grew in the last step */
    rmin_real u, u_before, u_third; /* deformation of the skin and of what stands */
    rmin_real now, root; /* depth of the skin, and its root under Hertz's law */
    rmin_real rest; /* deflection of the body out of contact */
    rmin_real depth; /* of the skin at the largest force so far */
    rmin_real swings; /* most that modes that stand add to the force as they swing, N */
} rmin_state;

/* Until when forces of a contact count that began before 0.5 s; later ones count until they end, s. */
#define RMIN_COUNTS_UNTIL RMIN_R(0.6)

/* What is looked for in the steps of an impact that goes on after its peak. */
struct rmin_watch {
    rmin_real matters; /* force that may still come, N */
    rmin_real depth; /* of the skin under it, m */
    bool slower; /* whether slower speeds matter, so that later contacts count earlier */
    rmin_real apart; /* when robot and body last were so, s; 0 for never */
    bool settled; /* no force that matters can come */
    rmin_real late; /* the largest force from 0.5 s on, N */
    rmin_real before, last; /* forces of the last steps, N */
};

/* Notes a step that was taken: the late force; says whether none that matters can come. */
bool rmin_pass(const rmin_state *s, rmin_watch *watch);

/* A step on trial. */
typedef struct {
    rmin_real x, v; /* of the contact point without the force at the end */
    rmin_real f, bump, mean; /* force at the end; what its bend adds; force on average, less half its rise */
    rmin_real u, depth, root;
} rmin_trial;

/* Goes over to the steps of a phase, the first of a level. */
void rmin_phase_begin(const rmin_phase *phase, int level, rmin_state *s);

/* Damping of joints and of a servo over a time, to second order: rate -= time S'DS (rate - what it is led by). */
void rmin_damp(const rmin_phase *phase, rmin_real speed, rmin_real time, rmin_real *rate);
/* Rates of modes after the force that is due, damped until halfway through the next step. */
void rmin_damp_ahead(const rmin_state *s, rmin_real *rate);
/* What of the contact point's velocity is damped in the other half of a step on trial. */
rmin_real rmin_owed_slip(const rmin_state *s);

/* Moves all modes by a step, on trial, without a force of its own. */
void rmin_glide(rmin_state *s, rmin_trial *t);

/* Lets modes feel what is due. */
void rmin_feel(rmin_state *s);

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
void rmin_press(rmin_state *s, rmin_trial *t);

/*
 * Largest force of a law through points within the step, as if it did not slow down robot and body more on the
 * way: a law that gets stiff between two nodes may press hard there and show at neither.
 */
rmin_real rmin_force_between(rmin_state *s, const rmin_trial *t);

/* What the damper's force at the end may be off where the skin gets stiff within the step, as u' is a difference. */
rmin_real rmin_slip_off(const rmin_state *s, const rmin_trial *t);

/* Takes the step: its force, `mean` less half its rise on average, is due. */
void rmin_take(rmin_state *s, rmin_real mean, rmin_real rise);

/* Goes over from motors that drive or servo to loose ones. */
void rmin_release(rmin_state *s);

/*
 * Whether no later force exceeds one, the present one being less, under which the skin is so deep: proven,
 * but for a share by which the energy may exceed what that takes.
 */
bool rmin_is_settled(const rmin_state *s, rmin_real force, rmin_real depth, rmin_real share);

#endif
