/* SPDX-License-Identifier: 0BSD */
/* What peak_force and safe_speed of ur5e share; not for their users. */
#ifndef UR5E_IMPACT_H
#define UR5E_IMPACT_H

#include "ur5e_internal.h"

#define UR5E_MASSES UR5E_IMPACT_CHAIN_ORDER
#define UR5E_MODES (2*((UR5E_MASSES + 2)/2)) /* one for a body that gives way; even */
#define UR5E_LEVELS 3

typedef struct {
    ur5e_real mass[7]; /* kg; the contact force acts on the first */
    ur5e_real stiffness[7]; /* N/m; to the next, last to ground */
    ur5e_real velocity[7]; /* m/s; at first touch, for an approach of 1 m/s */
} ur5e_impact_chain_t;

/* Chain of 7 masses as it arrives at an impact; it may end before its last. */
int ur5e_impact_chain(
    const ur5e_real q[6],
    const ur5e_real n[3],
    const ur5e_params *p,
    ur5e_impact_chain_t *out);

/* A mode's step h: 2 - 2 cos(omega h), and what the force at the node does. */
typedef struct {
    ur5e_real kappa;
    ur5e_real middle;
} ur5e_mode_step;

/* Steps of one length, of all modes and of the node between skin and body. */
typedef struct {
    ur5e_real h;         /* step, s */
    ur5e_real rate;      /* the body's damping over it, N/m */
    ur5e_real soft;      /* what a force moves at once by the modes, m/N */
    ur5e_real hold[2];   /* compliance of the body for the two backward differences */
    ur5e_mode_step mode[UR5E_MODES];
    ur5e_real edge[UR5E_MODES]; /* what forces at both ends do */
} ur5e_level;

/*
 * Robot and body as modes that only meet in the contact force, ready to be stepped. All numbers
 * are for an approach of 1 m/s; spacing doubles from one level to the next.
 */
typedef struct {
    int modes; /* an even number */
    ur5e_real stiffness; /* k_h */
    ur5e_real damping; /* c_h */
    ur5e_real skin; /* k_f */
    ur5e_real mobility; /* of the contact, 1/kg */
    ur5e_real compliance; /* of modes that stand, m/N */
    ur5e_real rate2; /* of the contact point's vibration, squared, 1/s^2 */
    ur5e_real fastest; /* squared frequency, 1/s^2 */
    ur5e_real squared[UR5E_MODES]; /* frequency, 1/s^2 */
    ur5e_real weight[UR5E_MODES]; /* share of the mobility */
    ur5e_real velocity[UR5E_MODES]; /* share of the velocity at first touch */
    ur5e_real start[UR5E_MODES]; /* displacement at the first node */
    ur5e_real start_edge[UR5E_MODES]; /* share of the force there */
    ur5e_level level[UR5E_LEVELS + 1];
} ur5e_impact;

/* Prepares the impacts of a configuration, but for their steps; checks everything but the speed. */
int ur5e_impact_prepare(const ur5e_real q[6], const ur5e_real n[3],
    const ur5e_region *region, const ur5e_params *p, ur5e_impact *impact);

/* Chooses the steps; `rough` ones are about twice as long. */
void ur5e_impact_steps(ur5e_impact *impact, bool rough);

/* Largest force of an impact. */
typedef struct {
    ur5e_real force; /* N */
    ur5e_real time; /* since first touch, s */
    ur5e_real until; /* as long as forces of impacts at about this speed may be the largest, s */
    int nodes; /* it took */
} ur5e_impact_peak;

/* Integrates one impact until robot and body part, or to a time after which the force is small. */
int ur5e_impact_run(const ur5e_impact *impact, ur5e_real speed, ur5e_real until,
    ur5e_impact_peak *out);

#endif
