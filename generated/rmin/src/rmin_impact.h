/* SPDX-License-Identifier: 0BSD */
/* What peak_force and safe_speed of rmin share; not for their users. */
#ifndef RMIN_IMPACT_H
#define RMIN_IMPACT_H

#include "rmin_internal.h"

#define RMIN_MASSES RMIN_IMPACT_CHAIN_ORDER
#define RMIN_MODES (2*((RMIN_MASSES + 2)/2)) /* one for a body that gives way; even */
#define RMIN_LEVELS 3

typedef struct {
    rmin_real mass[3]; /* kg; the contact force acts on the first */
    rmin_real stiffness[3]; /* N/m; to the next, last to ground */
    rmin_real velocity[3]; /* m/s; at first touch, for an approach of 1 m/s */
} rmin_impact_chain_t;

/* Chain of 3 masses as it arrives at an impact; it may end before its last. */
int rmin_impact_chain(
    const rmin_real q[6],
    const rmin_real n[3],
    const rmin_params *p,
    rmin_impact_chain_t *out);

/* A mode's step h: 2 - 2 cos(omega h), and what the force at the node does. */
typedef struct {
    rmin_real kappa;
    rmin_real middle;
} rmin_mode_step;

/* Steps of one length, of all modes and of the node between skin and body. */
typedef struct {
    rmin_real h;         /* step, s */
    rmin_real rate;      /* the body's damping over it, N/m */
    rmin_real soft;      /* what a force moves at once by the modes, m/N */
    rmin_real hold[2];   /* compliance of the body for the two backward differences */
    rmin_mode_step mode[RMIN_MODES];
    rmin_real edge[RMIN_MODES]; /* what forces at both ends do */
} rmin_level;

/*
 * Robot and body as modes that only meet in the contact force, ready to be stepped. All numbers
 * are for an approach of 1 m/s; spacing doubles from one level to the next.
 */
typedef struct {
    int modes; /* an even number */
    rmin_real stiffness; /* k_h */
    rmin_real damping; /* c_h */
    rmin_real skin; /* k_f */
    rmin_real mobility; /* of the contact, 1/kg */
    rmin_real compliance; /* of modes that stand, m/N */
    rmin_real rate2; /* of the contact point's vibration, squared, 1/s^2 */
    rmin_real fastest; /* squared frequency, 1/s^2 */
    rmin_real squared[RMIN_MODES]; /* frequency, 1/s^2 */
    rmin_real weight[RMIN_MODES]; /* share of the mobility */
    rmin_real velocity[RMIN_MODES]; /* share of the velocity at first touch */
    rmin_real start[RMIN_MODES]; /* displacement at the first node */
    rmin_real start_edge[RMIN_MODES]; /* share of the force there */
    rmin_level level[RMIN_LEVELS + 1];
} rmin_impact;

/* Prepares the impacts of a configuration, but for their steps; checks everything but the speed. */
int rmin_impact_prepare(const rmin_real q[6], const rmin_real n[3],
    const rmin_region *region, const rmin_params *p, rmin_impact *impact);

/* Chooses the steps; `rough` ones are about twice as long. */
void rmin_impact_steps(rmin_impact *impact, bool rough);

/* Largest force of an impact. */
typedef struct {
    rmin_real force; /* N */
    rmin_real time; /* since first touch, s */
    rmin_real until; /* as long as forces of impacts at about this speed may be the largest, s */
    int nodes; /* it took */
} rmin_impact_peak;

/* Integrates one impact until robot and body part, or to a time after which the force is small. */
int rmin_impact_run(const rmin_impact *impact, rmin_real speed, rmin_real until,
    rmin_impact_peak *out);

#endif
