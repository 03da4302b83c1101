/* SPDX-License-Identifier: 0BSD */
/* What peak_force and safe_speed of panda share; not for their users. */
#ifndef PANDA_IMPACT_H
#define PANDA_IMPACT_H

#include "panda_internal.h"

#define PANDA_MASSES PANDA_IMPACT_CHAIN_ORDER
#define PANDA_MODES (2*((PANDA_MASSES + 2)/2)) /* one for a body that gives way; even */
#define PANDA_LEVELS 3

typedef struct {
    panda_real mass[7]; /* kg; the contact force acts on the first */
    panda_real stiffness[7]; /* N/m; to the next, last to ground */
    panda_real velocity[7]; /* m/s; at first touch, for an approach of 1 m/s */
} panda_impact_chain_t;

/* Chain of 7 masses as it arrives at an impact; it may end before its last. */
int panda_impact_chain(
    const panda_real q[7],
    const panda_real n[3],
    const panda_params *p,
    panda_impact_chain_t *out);

/* A mode's step h: 2 - 2 cos(omega h), and what the force at the node does. */
typedef struct {
    panda_real kappa;
    panda_real middle;
} panda_mode_step;

/* Steps of one length, of all modes and of the node between skin and body. */
typedef struct {
    panda_real h;         /* step, s */
    panda_real rate;      /* the body's damping over it, N/m */
    panda_real soft;      /* what a force moves at once by the modes, m/N */
    panda_real hold[2];   /* compliance of the body for the two backward differences */
    panda_mode_step mode[PANDA_MODES];
    panda_real edge[PANDA_MODES]; /* what forces at both ends do */
} panda_level;

/*
 * Robot and body as modes that only meet in the contact force, ready to be stepped. All numbers
 * are for an approach of 1 m/s; spacing doubles from one level to the next.
 */
typedef struct {
    int modes; /* an even number */
    panda_real stiffness; /* k_h */
    panda_real damping; /* c_h */
    panda_real skin; /* k_f */
    panda_real mobility; /* of the contact, 1/kg */
    panda_real compliance; /* of modes that stand, m/N */
    panda_real rate2; /* of the contact point's vibration, squared, 1/s^2 */
    panda_real fastest; /* squared frequency, 1/s^2 */
    panda_real squared[PANDA_MODES]; /* frequency, 1/s^2 */
    panda_real weight[PANDA_MODES]; /* share of the mobility */
    panda_real velocity[PANDA_MODES]; /* share of the velocity at first touch */
    panda_real start[PANDA_MODES]; /* displacement at the first node */
    panda_real start_edge[PANDA_MODES]; /* share of the force there */
    panda_level level[PANDA_LEVELS + 1];
} panda_impact;

/* Prepares the impacts of a configuration, but for their steps; checks everything but the speed. */
int panda_impact_prepare(const panda_real q[7], const panda_real n[3],
    const panda_region *region, const panda_params *p, panda_impact *impact);

/* Chooses the steps; `rough` ones are about twice as long. */
void panda_impact_steps(panda_impact *impact, bool rough);

/* Largest force of an impact. */
typedef struct {
    panda_real force; /* N */
    panda_real time; /* since first touch, s */
    panda_real until; /* as long as forces of impacts at about this speed may be the largest, s */
    int nodes; /* it took */
} panda_impact_peak;

/* Integrates one impact until robot and body part, or to a time after which the force is small. */
int panda_impact_run(const panda_impact *impact, panda_real speed, panda_real until,
    panda_impact_peak *out);

#endif
