/* SPDX-License-Identifier: 0BSD */
/* Where an impact of robot_ is, and a step of it; not for its users. */
#ifndef ROBOT_STATE_H
#define ROBOT_STATE_H

#include "robot_impact.h"

/* What the next step takes of those before it, and of its own length. */
typedef struct {
    robot_real ratio; /* of its length to the last one's */
    robot_real share, whole, before; /* of the bend, see robot_press */
    robot_real u, u_before, u_third; /* in c u' */
    robot_real stays, grows; /* by how much less a force presses that stays, and more one that has not grown yet */
    robot_real hold, soft, yields; /* depth hold + soft f = what presses; x gives way by yields f */
    robot_real per_hold, cubic; /* of Hertz's law, see root_of */
} robot_pace;

/* What each mode moves the contact point by, m, and how fast. */
typedef struct {
    robot_real place[ROBOT_MODES], rate[ROBOT_MODES];
} robot_motion;

/* The force over a step, on average and by how much it grew, which modes are yet to feel. */
typedef struct {
    const robot_level *level;
    robot_real mean, rise;
} robot_due;

/* A mode's place after the force of a step, and its velocity; slope is the force's rise over the step's length. */
static inline robot_real robot_felt_place(
    const robot_mode_step *step, robot_real place, robot_real mean, robot_real rise)
{
    return place - step->push*mean - step->late*rise;
}

static inline robot_real robot_felt_rate(
    const robot_mode_step *step, robot_real rate, robot_real mean, robot_real slope)
{
    return rate - step->kick*mean - step->push*slope;
}

typedef struct {
    robot_impact *impact;
    const robot_region *region;
    const robot_phase *phase;
    robot_real speed;
    bool all_count; /* forces below the largest so far, too */
    robot_real scale; /* of forces, N */
    const robot_level *step; /* of the next one's length */
    int level;
    int even; /* steps in a row of this length */
    robot_pace pace;
    int ticks; /* of the shortest step, until the phase is over */
    robot_real time;
    robot_real drift, drifted; /* by the motors, m/s and m */
    robot_motion *motion, *trial; /* at the last node, but for what is due; and after a step on trial */
    robot_motion motions[2]; /* where they are */
    robot_due due;
    robot_real owed; /* time for which rates are still to be damped, half the last step, s */
    bool touching;
    int past; /* steps since the touch */
    robot_real h, h_before, per, x; /* last steps, contact point */
    robot_real bump, bent; /* what the bend adds to the force on average of the last step; the bend as it matters */
    robot_real f, rise; /* force, and by how much it grew in the last step */
    robot_real u, u_before, u_third; /* deformation of the skin and of what stands */
    robot_real now, root; /* depth of the skin, and its root under Hertz's law */
    robot_real rest; /* deflection of the body out of contact */
    robot_real depth; /* of the skin at the largest force so far */
    robot_real swings; /* most that modes that stand add to the force as they swing, N */
} robot_state;

/* Until when forces of a contact count that began before 0.5 s; later ones count until they end, s. */
#define ROBOT_COUNTS_UNTIL ROBOT_R(0.6)

/* What is looked for in the steps of an impact that goes on after its peak. */
struct robot_watch {
    robot_real matters; /* force that may still come, N */
    robot_real depth; /* of the skin under it, m */
    bool slower; /* whether slower speeds matter, so that later contacts count earlier */
    robot_real apart; /* when robot and body last were so, s; 0 for never */
    bool settled; /* no force that matters can come */
    robot_real late; /* the largest force from 0.5 s on, N */
    robot_real before, last; /* forces of the last steps, N */
};

/* Notes a step that was taken: the late force; says whether none that matters can come. */
bool robot_pass(const robot_state *s, robot_watch *watch);

/* A step on trial. */
typedef struct {
    robot_real x, v; /* of the contact point without the force at the end */
    robot_real f, bump, mean; /* force at the end; what its bend adds; force on average, less half its rise */
    robot_real u, depth, root;
} robot_trial;

/* Goes over to the steps of a phase, the first of a level. */
void robot_phase_begin(const robot_phase *phase, int level, robot_state *s);

/* Damping of joints and of a servo over a time, to second order: rate -= time S'DS (rate - what it is led by). */
void robot_damp(const robot_phase *phase, robot_real speed, robot_real time, robot_real *rate);
/* Rates of modes after the force that is due, damped until halfway through the next step. */
void robot_damp_ahead(const robot_state *s, robot_real *rate);
/* What of the contact point's velocity is damped in the other half of a step on trial. */
robot_real robot_owed_slip(const robot_state *s);

/* Moves all modes by a step, on trial, without a force of its own. */
void robot_glide(robot_state *s, robot_trial *t);

/* Lets modes feel what is due. */
void robot_feel(robot_state *s);

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
void robot_press(robot_state *s, robot_trial *t);

/*
 * Largest force of a law through points within the step, as if it did not slow down robot and body more on the
 * way: a law that gets stiff between two nodes may press hard there and show at neither.
 */
robot_real robot_force_between(robot_state *s, const robot_trial *t);

/* What the damper's force at the end may be off where the skin gets stiff within the step, as u' is a difference. */
robot_real robot_slip_off(const robot_state *s, const robot_trial *t);

/* Takes the step: its force, `mean` less half its rise on average, is due. */
void robot_take(robot_state *s, robot_real mean, robot_real rise);

/* Goes over from motors that drive or servo to loose ones. */
void robot_release(robot_state *s);

/*
 * Whether no later force exceeds one, the present one being less, under which the skin is so deep: proven,
 * but for a share by which the energy may exceed what that takes.
 */
bool robot_is_settled(const robot_state *s, robot_real force, robot_real depth, robot_real share);

#endif
