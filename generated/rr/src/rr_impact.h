/* SPDX-License-Identifier: 0BSD */
/* What peak_force and safe_speed of rr share; not for their users. */
#ifndef RR_IMPACT_H
#define RR_IMPACT_H

#include "rr_internal.h"

#define RR_MASSES RR_IMPACT_CHAIN_ORDER
#define RR_MODES (2*((RR_MASSES + 2)/2)) /* one for a body that gives way; even */
#define RR_LEVELS 3

typedef struct {
    rr_real mass[4]; /* kg; the contact force acts on the first */
    rr_real stiffness[4]; /* N/m; to the next, last to ground */
    rr_real velocity[4]; /* m/s; at first touch, for an approach of 1 m/s */
} rr_impact_chain_t;

/* Chain of 4 masses as it arrives at an impact; it may end before its last. */
int rr_impact_chain(
    const rr_real q[4],
    const rr_real n[3],
    const rr_params *p,
    rr_impact_chain_t *out);

/* A mode's step h: 2 - 2 cos(omega h), and what the force at the node does. */
typedef struct {
    rr_real kappa;
    rr_real middle;
} rr_mode_step;

/* Steps of one length, of all modes and of the node between skin and body. */
typedef struct {
    rr_real h;         /* step, s */
    rr_real rate;      /* the body's damping over it, N/m */
    rr_real soft;      /* what a force moves at once by the modes, m/N */
    rr_real hold[2];   /* compliance of the body for the two backward differences */
    rr_mode_step mode[RR_MODES];
    rr_real edge[RR_MODES]; /* what forces at both ends do */
} rr_level;

/*
 * Robot and body as modes that only meet in the contact force, ready to be stepped. All numbers
 * are for an approach of 1 m/s; spacing doubles from one level to the next.
 */
typedef struct {
    int modes; /* an even number */
    rr_real stiffness; /* k_h */
    rr_real damping; /* c_h */
    rr_real skin; /* k_f */
    rr_real mobility; /* of the contact, 1/kg */
    rr_real compliance; /* of modes that stand, m/N */
    rr_real rate2; /* of the contact point's vibration, squared, 1/s^2 */
    rr_real fastest; /* squared frequency, 1/s^2 */
    rr_real squared[RR_MODES]; /* frequency, 1/s^2 */
    rr_real weight[RR_MODES]; /* share of the mobility */
    rr_real velocity[RR_MODES]; /* share of the velocity at first touch */
    rr_real start[RR_MODES]; /* displacement at the first node */
    rr_real start_edge[RR_MODES]; /* share of the force there */
    rr_level level[RR_LEVELS + 1];
} rr_impact;

/* Prepares the impacts of a configuration, but for their steps; checks everything but the speed. */
int rr_impact_prepare(const rr_real q[4], const rr_real n[3],
    const rr_region *region, const rr_params *p, rr_impact *impact);

/* Chooses the steps; `rough` ones are about twice as long. */
void rr_impact_steps(rr_impact *impact, bool rough);

/* Largest force of an impact. */
typedef struct {
    rr_real force; /* N */
    rr_real time; /* since first touch, s */
    rr_real until; /* as long as forces of impacts at about this speed may be the largest, s */
    int nodes; /* it took */
} rr_impact_peak;

/* Integrates one impact until robot and body part, or to a time after which the force is small. */
int rr_impact_run(const rr_impact *impact, rr_real speed, rr_real until,
    rr_impact_peak *out);

#endif
