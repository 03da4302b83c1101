/* SPDX-License-Identifier: 0BSD */
/* Where an impact of ur5e_ is, and a step of it; not for its users. */
#ifndef UR5E_STATE_H
#define UR5E_STATE_H

#include "ur5e_impact.h"

/* What the next step takes of those before it, and of its own length. */
typedef struct {
    ur5e_real ratio; /* of its length to the last one's */
    ur5e_real share, whole, before; /* of the bend, see ur5e_press */
    ur5e_real u, u_before, u_third; /* in c u' */
    ur5e_real stays, grows; /* by how much less a force presses that stays, and more one that has not grown yet */
    ur5e_real hold, soft, yields; /* depth hold + soft f = what presses; x gives way by yields f */
    ur5e_real per_hold, cubic; /* of Hertz's law, see root_of */
} ur5e_pace;

/* What each mode moves the contact point by, m, and how fast. */
typedef struct {
    ur5e_real place[UR5E_MODES], rate[UR5E_MODES];
} ur5e_motion;

/* The force over a step, on average and by how much it grew, which modes are yet to feel. */
typedef struct {
    const ur5e_level *level;
    ur5e_real mean, rise;
} ur5e_due;

/* A mode's place after the force of a step, and its velocity; slope is the force's rise over the step's length. */
static inline ur5e_real ur5e_felt_place(
    const ur5e_mode_step *step, ur5e_real place, ur5e_real mean, ur5e_real rise)
{
    return place - step->push*mean - step->late*rise;
}

static inline ur5e_real ur5e_felt_rate(
    const ur5e_mode_step *step, ur5e_real rate, ur5e_real mean, ur5e_real slope)
{
    return rate - step->kick*mean - step->push*slope;
}

typedef struct {
    ur5e_impact *impact;
    const ur5e_region *region;
    const ur5e_phase *phase;
    ur5e_real speed;
    bool all_count; /* forces below the largest so far, too */
    ur5e_real scale; /* of forces, N */
    const ur5e_level *step; /* of the next one's length */
    int level;
    int even; /* steps in a row of this length */
    ur5e_pace pace;
    int ticks; /* of the shortest step, until the phase is over */
    ur5e_real time;
    ur5e_real drift, drifted; /* by the motors, m/s and m */
    ur5e_motion *motion, *trial; /* at the last node, but for what is due; and after a step on trial */
    ur5e_motion motions[2]; /* where they are */
    ur5e_due due;
    ur5e_real owed; /* time for which rates are still to be damped, half the last step, s */
    bool touching;
    int past; /* steps since the touch */
    ur5e_real h, h_before, per, x; /* last steps, contact point */
    ur5e_real bump, bent; /* what the bend adds to the force on average of the last step; the bend as it matters */
    ur5e_real f, rise; /* force, and by how much it grew in the last step */
    ur5e_real u, u_before, u_third; /* deformation of the skin and of what stands */
    ur5e_real now, root; /* depth of the skin, and its root under Hertz's law */
    ur5e_real rest; /* deflection of the body out of contact */
    ur5e_real depth; /* of the skin at the largest force so far */
    ur5e_real swings; /* most that modes that stand add to the force as they swing, N */
} ur5e_state;

/* Until when forces of a contact count that began before 0.5 s; later ones count until they end, s. */
#define UR5E_COUNTS_UNTIL UR5E_R(0.6)

/* What is looked for in the steps of an impact that goes on after its peak. */
struct ur5e_watch {
    ur5e_real matters; /* force that may still come, N */
    ur5e_real depth; /* of the skin under it, m */
    bool slower; /* whether slower speeds matter, so that later contacts count earlier */
    ur5e_real apart; /* when robot and body last were so, s; 0 for never */
    bool settled; /* no force that matters can come */
    ur5e_real late; /* the largest force from 0.5 s on, N */
    ur5e_real before, last; /* forces of the last steps, N */
};

/* Notes a step that was taken: the late force; says whether none that matters can come. */
bool ur5e_pass(const ur5e_state *s, ur5e_watch *watch);

/* A step on trial. */
typedef struct {
    ur5e_real x, v; /* of the contact point without the force at the end */
    ur5e_real f, bump, mean; /* force at the end; what its bend adds; force on average, less half its rise */
    ur5e_real u, depth, root;
} ur5e_trial;

/* Goes over to the steps of a phase, the first of a level. */
void ur5e_phase_begin(const ur5e_phase *phase, int level, ur5e_state *s);

/* Damping of joints and of a servo over a time, to second order: rate -= time S'DS (rate - what it is led by). */
void ur5e_damp(const ur5e_phase *phase, ur5e_real speed, ur5e_real time, ur5e_real *rate);
/* Rates of modes after the force that is due, damped until halfway through the next step. */
void ur5e_damp_ahead(const ur5e_state *s, ur5e_real *rate);
/* What of the contact point's velocity is damped in the other half of a step on trial. */
ur5e_real ur5e_owed_slip(const ur5e_state *s);

/* Moves all modes by a step, on trial, without a force of its own. */
void ur5e_glide(ur5e_state *s, ur5e_trial *t);

/* Lets modes feel what is due. */
void ur5e_feel(ur5e_state *s);

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
void ur5e_press(ur5e_state *s, ur5e_trial *t);

/*
 * Largest force of a law through points within the step, as if it did not slow down robot and body more on the
 * way: a law that gets stiff between two nodes may press hard there and show at neither.
 */
ur5e_real ur5e_force_between(ur5e_state *s, const ur5e_trial *t);

/* What the damper's force at the end may be off where the skin gets stiff within the step, as u' is a difference. */
ur5e_real ur5e_slip_off(const ur5e_state *s, const ur5e_trial *t);

/* Takes the step: its force, `mean` less half its rise on average, is due. */
void ur5e_take(ur5e_state *s, ur5e_real mean, ur5e_real rise);

/* Goes over from motors that drive or servo to loose ones. */
void ur5e_release(ur5e_state *s);

/*
 * Whether no later force exceeds one, the present one being less, under which the skin is so deep: proven,
 * but for a share by which the energy may exceed what that takes.
 */
bool ur5e_is_settled(const ur5e_state *s, ur5e_real force, ur5e_real depth, ur5e_real share);

#endif
