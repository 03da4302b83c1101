/* SPDX-License-Identifier: 0BSD */
/* Where an impact of rr_ is, and a step of it; not for its users. */
#ifndef RR_STATE_H
#define RR_STATE_H

#include "rr_impact.h"

/* What the next step takes of those before it, and of its own length. */
typedef struct {
    rr_real ratio; /* of its length to the last one's */
    rr_real share, whole, before; /* of the bend, see rr_press */
    rr_real u, u_before, u_third; /* in c u' */
    rr_real stays, grows; /* by how much less a force presses that stays, and more one that has not grown yet */
    rr_real hold, soft, yields; /* depth hold + soft f = what presses; x gives way by yields f */
    rr_real per_hold, cubic; /* of Hertz's law, see root_of */
} rr_pace;

/* What each mode moves the contact point by, m, and how fast. */
typedef struct {
    rr_real place[RR_MODES], rate[RR_MODES];
} rr_motion;

/* The force over a step, on average and by how much it grew, which modes are yet to feel. */
typedef struct {
    const rr_level *level;
    rr_real mean, rise;
} rr_due;

/* A mode's place after the force of a step, and its velocity; slope is the force's rise over the step's length. */
static inline rr_real rr_felt_place(
    const rr_mode_step *step, rr_real place, rr_real mean, rr_real rise)
{
    return place - step->push*mean - step->late*rise;
}

static inline rr_real rr_felt_rate(
    const rr_mode_step *step, rr_real rate, rr_real mean, rr_real slope)
{
    return rate - step->kick*mean - step->push*slope;
}

typedef struct {
    rr_impact *impact;
    const rr_region *region;
    const rr_phase *phase;
    rr_real speed;
    bool all_count; /* forces below the largest so far, too */
    rr_real scale; /* of forces, N */
    const rr_level *step; /* of the next one's length */
    int level;
    int even; /* steps in a row of this length */
    rr_pace pace;
    int ticks; /* of the shortest step, until the phase is over */
    rr_real time;
    rr_real drift, drifted; /* by the motors, m/s and m */
    rr_motion *motion, *trial; /* at the last node, but for what is due; and after a step on trial */
    rr_motion motions[2]; /* where they are */
    rr_due due;
    rr_real owed; /* time for which rates are still to be damped, half the last step, s */
    bool touching;
    int past; /* steps since the touch */
    rr_real h, h_before, per, x; /* last steps, contact point */
    rr_real bump, bent; /* what the bend adds to the force on average of the last step; the bend as it matters */
    rr_real f, rise; /* force, and by how much it grew in the last step */
    rr_real u, u_before, u_third; /* deformation of the skin and of what stands */
    rr_real now, root; /* depth of the skin, and its root under Hertz's law */
    rr_real rest; /* deflection of the body out of contact */
    rr_real depth; /* of the skin at the largest force so far */
    rr_real swings; /* most that modes that stand add to the force as they swing, N */
} rr_state;

/* Until when forces of a contact count that began before 0.5 s; later ones count until they end, s. */
#define RR_COUNTS_UNTIL RR_R(0.6)

/* What is looked for in the steps of an impact that goes on after its peak. */
struct rr_watch {
    rr_real matters; /* force that may still come, N */
    rr_real depth; /* of the skin under it, m */
    bool slower; /* whether slower speeds matter, so that later contacts count earlier */
    rr_real apart; /* when robot and body last were so, s; 0 for never */
    bool settled; /* no force that matters can come */
    rr_real late; /* the largest force from 0.5 s on, N */
    rr_real before, last; /* forces of the last steps, N */
};

/* Notes a step that was taken: the late force; says whether none that matters can come. */
bool rr_pass(const rr_state *s, rr_watch *watch);

/* A step on trial. */
typedef struct {
    rr_real x, v; /* of the contact point without the force at the end */
    rr_real f, bump, mean; /* force at the end; what its bend adds; force on average, less half its rise */
    rr_real u, depth, root;
} rr_trial;

/* Goes over to the steps of a phase, the first of a level. */
void rr_phase_begin(const rr_phase *phase, int level, rr_state *s);

/* Damping of joints and of a servo over a time, to second order: rate -= time S'DS (rate - what it is led by). */
void rr_damp(const rr_phase *phase, rr_real speed, rr_real time, rr_real *rate);
/* Rates of modes after the force that is due, damped until halfway through the next step. */
void rr_damp_ahead(const rr_state *s, rr_real *rate);
/* What of the contact point's velocity is damped in the other half of a step on trial. */
rr_real rr_owed_slip(const rr_state *s);

/* Moves all modes by a step, on trial, without a force of its own. */
void rr_glide(rr_state *s, rr_trial *t);

/* Lets modes feel what is due. */
void rr_feel(rr_state *s);

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
void rr_press(rr_state *s, rr_trial *t);

/*
 * Largest force of a law through points within the step, as if it did not slow down robot and body more on the
 * way: a law that gets stiff between two nodes may press hard there and show at neither.
 */
rr_real rr_force_between(rr_state *s, const rr_trial *t);

/* What the damper's force at the end may be off where the skin gets stiff within the step, as u' is a difference. */
rr_real rr_slip_off(const rr_state *s, const rr_trial *t);

/* Takes the step: its force, `mean` less half its rise on average, is due. */
void rr_take(rr_state *s, rr_real mean, rr_real rise);

/* Goes over from motors that drive or servo to loose ones. */
void rr_release(rr_state *s);

/*
 * Whether no later force exceeds one, the present one being less, under which the skin is so deep: proven,
 * but for a share by which the energy may exceed what that takes.
 */
bool rr_is_settled(const rr_state *s, rr_real force, rr_real depth, rr_real share);

#endif
