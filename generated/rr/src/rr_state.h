/* SPDX-License-Identifier: 0BSD */
/* Where an impact of rr_ is, and a step of it; not for its users. */
#ifndef RR_STATE_H
#define RR_STATE_H

#include "rr_impact.h"

typedef struct {
    rr_impact *impact;
    const rr_phase *phase;
    rr_real speed;
    rr_real scale; /* of forces, N */
    int level;
    int ticks; /* of the shortest step, until the phase is over */
    rr_real time;
    rr_real drifted; /* by the motors, m */
    rr_real amplitude[RR_MODES], rate[RR_MODES];
    bool touching;
    int past; /* steps since the touch */
    rr_real h, h_before, x; /* last steps, contact point */
    rr_real bump; /* what the bend adds to the force on average of the last step */
    rr_real f, rise; /* force, and by how much it grew in the last step */
    rr_real u, u_before, root; /* deformation of the skin; root of its depth */
    rr_real rest; /* deflection of the body out of contact */
    rr_real depth; /* of the skin at the largest force so far */
} rr_state;

/* A step on trial. */
typedef struct {
    rr_real amplitude[RR_MODES], rate[RR_MODES];
    rr_real x, v; /* of the contact point without the force at the end */
    rr_real f, bump, base, share; /* force at the end; what its bend adds on the way */
    rr_real u, root;
} rr_trial;

/* A servo's damping over a time, to second order: rate -= time S'DS (rate - what it is led by). */
void rr_damp(const rr_phase *phase, rr_real speed, rr_real time, rr_real *rate);

/* Moves all modes by a step without forces. */
void rr_glide(const rr_state *s, rr_trial *t);

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
void rr_press(const rr_state *s, rr_trial *t);

/* Takes the step: forces that are linear over it, with the mean of what the bend adds. */
void rr_take(const rr_trial *t, rr_state *s);

/* Goes over from motors that drive or servo to loose ones. */
void rr_release(rr_state *s);

/*
 * Whether no later force exceeds the largest so far: proven, but for a share by which the energy may
 * exceed what that takes.
 */
bool rr_is_settled(const rr_state *s, rr_real force, rr_real share);

#endif
