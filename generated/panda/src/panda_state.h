/* SPDX-License-Identifier: 0BSD */
/* Where an impact of panda_ is, and a step of it; not for its users. */
#ifndef PANDA_STATE_H
#define PANDA_STATE_H

#include "panda_impact.h"

/* What the next step takes of those before it, and of its own length. */
typedef struct {
    panda_real ratio; /* of its length to the last one's */
    panda_real share, whole, before; /* of the bend, see panda_press */
    panda_real u, u_before, u_third; /* in c u' */
    panda_real stays, grows; /* by how much less a force presses that stays, and more one that has not grown yet */
    panda_real hold, soft, yields; /* depth hold + soft f = what presses; x gives way by yields f */
    panda_real per_hold, cubic; /* of Hertz's law, see root_of */
} panda_pace;

/* What each mode moves the contact point by, m, and how fast. */
typedef struct {
    panda_real place[PANDA_MODES], rate[PANDA_MODES];
} panda_motion;

/* The force over a step, on average and by how much it grew, which modes are yet to feel. */
typedef struct {
    const panda_level *level;
    panda_real mean, rise;
} panda_due;

/* A mode's place after the force of a step, and its velocity; slope is the force's rise over the step's length. */
static inline panda_real panda_felt_place(
    const panda_mode_step *step, panda_real place, panda_real mean, panda_real rise)
{
    return place - step->push*mean - step->late*rise;
}

static inline panda_real panda_felt_rate(
    const panda_mode_step *step, panda_real rate, panda_real mean, panda_real slope)
{
    return rate - step->kick*mean - step->push*slope;
}

typedef struct {
    panda_impact *impact;
    const panda_region *region;
    const panda_phase *phase;
    panda_real speed;
    bool all_count; /* forces below the largest so far, too */
    panda_real scale; /* of forces, N */
    const panda_level *step; /* of the next one's length */
    int level;
    int even; /* steps in a row of this length */
    panda_pace pace;
    int ticks; /* of the shortest step, until the phase is over */
    panda_real time;
    panda_real drift, drifted; /* by the motors, m/s and m */
    panda_motion *motion, *trial; /* at the last node, but for what is due; and after a step on trial */
    panda_motion motions[2]; /* where they are */
    panda_due due;
    panda_real owed; /* time for which rates are still to be damped, half the last step, s */
    bool touching;
    int past; /* steps since the touch */
    panda_real h, h_before, per, x; /* last steps, contact point */
    panda_real bump, bent; /* what the bend adds to the force on average of the last step; the bend as it matters */
    panda_real f, rise; /* force, and by how much it grew in the last step */
    panda_real u, u_before, u_third; /* deformation of the skin and of what stands */
    panda_real now, root; /* depth of the skin, and its root under Hertz's law */
    panda_real rest; /* deflection of the body out of contact */
    panda_real depth; /* of the skin at the largest force so far */
    panda_real swings; /* most that modes that stand add to the force as they swing, N */
} panda_state;

/* Until when forces of a contact count that began before 0.5 s; later ones count until they end, s. */
#define PANDA_COUNTS_UNTIL PANDA_R(0.6)

/* What is looked for in the steps of an impact that goes on after its peak. */
struct panda_watch {
    panda_real matters; /* force that may still come, N */
    panda_real depth; /* of the skin under it, m */
    bool slower; /* whether slower speeds matter, so that later contacts count earlier */
    panda_real apart; /* when robot and body last were so, s; 0 for never */
    bool settled; /* no force that matters can come */
    panda_real late; /* the largest force from 0.5 s on, N */
    panda_real before, last; /* forces of the last steps, N */
};

/* Notes a step that was taken: the late force; says whether none that matters can come. */
bool panda_pass(const panda_state *s, panda_watch *watch);

/* A step on trial. */
typedef struct {
    panda_real x, v; /* of the contact point without the force at the end */
    panda_real f, bump, mean; /* force at the end; what its bend adds; force on average, less half its rise */
    panda_real u, depth, root;
} panda_trial;

/* Goes over to the steps of a phase, the first of a level. */
void panda_phase_begin(const panda_phase *phase, int level, panda_state *s);

/* Damping of joints and of a servo over a time, to second order: rate -= time S'DS (rate - what it is led by). */
void panda_damp(const panda_phase *phase, panda_real speed, panda_real time, panda_real *rate);
/* Rates of modes after the force that is due, damped until halfway through the next step. */
void panda_damp_ahead(const panda_state *s, panda_real *rate);
/* What of the contact point's velocity is damped in the other half of a step on trial. */
panda_real panda_owed_slip(const panda_state *s);

/* Moves all modes by a step, on trial, without a force of its own. */
void panda_glide(panda_state *s, panda_trial *t);

/* Lets modes feel what is due. */
void panda_feel(panda_state *s);

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
void panda_press(panda_state *s, panda_trial *t);

/*
 * Largest force of a law through points within the step, as if it did not slow down robot and body more on the
 * way: a law that gets stiff between two nodes may press hard there and show at neither.
 */
panda_real panda_force_between(panda_state *s, const panda_trial *t);

/* What the damper's force at the end may be off where the skin gets stiff within the step, as u' is a difference. */
panda_real panda_slip_off(const panda_state *s, const panda_trial *t);

/* Takes the step: its force, `mean` less half its rise on average, is due. */
void panda_take(panda_state *s, panda_real mean, panda_real rise);

/* Goes over from motors that drive or servo to loose ones. */
void panda_release(panda_state *s);

/*
 * Whether no later force exceeds one, the present one being less, under which the skin is so deep: proven,
 * but for a share by which the energy may exceed what that takes.
 */
bool panda_is_settled(const panda_state *s, panda_real force, panda_real depth, panda_real share);

#endif
