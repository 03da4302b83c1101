/* SPDX-License-Identifier: 0BSD */
/* Where an impact of panda_ is, and a step of it; not for its users. */
#ifndef PANDA_STATE_H
#define PANDA_STATE_H

#include "panda_impact.h"

typedef struct {
    panda_impact *impact;
    const panda_phase *phase;
    panda_real speed;
    panda_real scale; /* of forces, N */
    int level;
    int ticks; /* of the shortest step, until the phase is over */
    panda_real time;
    panda_real drifted; /* by the motors, m */
    panda_real amplitude[PANDA_MODES], rate[PANDA_MODES];
    bool touching;
    int past; /* steps since the touch */
    panda_real h, h_before, x; /* last steps, contact point */
    panda_real bump; /* what the bend adds to the force on average of the last step */
    panda_real f, rise; /* force, and by how much it grew in the last step */
    panda_real u, u_before, root; /* deformation of the skin; root of its depth */
    panda_real rest; /* deflection of the body out of contact */
    panda_real depth; /* of the skin at the largest force so far */
} panda_state;

/* A step on trial. */
typedef struct {
    panda_real amplitude[PANDA_MODES], rate[PANDA_MODES];
    panda_real x, v; /* of the contact point without the force at the end */
    panda_real f, bump, base, share; /* force at the end; what its bend adds on the way */
    panda_real u, root;
} panda_trial;

/* A servo's damping over a time, to second order: rate -= time S'DS (rate - what it is led by). */
void panda_damp(const panda_phase *phase, panda_real speed, panda_real time, panda_real *rate);

/* Moves all modes by a step without forces. */
void panda_glide(const panda_state *s, panda_trial *t);

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
void panda_press(const panda_state *s, panda_trial *t);

/* Takes the step: forces that are linear over it, with the mean of what the bend adds. */
void panda_take(const panda_trial *t, panda_state *s);

/* Goes over from motors that drive or servo to loose ones. */
void panda_release(panda_state *s);

/*
 * Whether no later force exceeds the largest so far: proven, but for a share by which the energy may
 * exceed what that takes.
 */
bool panda_is_settled(const panda_state *s, panda_real force, panda_real share);

#endif
