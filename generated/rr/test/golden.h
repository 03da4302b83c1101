/* SPDX-License-Identifier: 0BSD */
/* Inputs and right results of rr, computed in 50 digits. */
#ifndef RR_GOLDEN_H
#define RR_GOLDEN_H

#include "rr.h"

#define RR_GOLDEN_CASES 12

typedef struct {
    rr_real q[4];
    rr_real n[3];
    rr_params p;
    rr_real speed;
    rr_real restitution;
    rr_real other_mobility;
    rr_real duration;
} rr_golden_input;

extern const rr_golden_input rr_golden_inputs[RR_GOLDEN_CASES];
/* Right entries of each output, and what its errors are stated over. */
extern const double rr_golden_mass_matrix[RR_GOLDEN_CASES][11];
extern const double rr_golden_jacobian[RR_GOLDEN_CASES][13];
extern const double rr_golden_generalised_mass_matrix[RR_GOLDEN_CASES][11];
extern const double rr_golden_stiffness_matrix[RR_GOLDEN_CASES][11];
extern const double rr_golden_contact_jacobian[RR_GOLDEN_CASES][5];
extern const double rr_golden_reflected_mass[RR_GOLDEN_CASES][2];
extern const double rr_golden_reduced_model[RR_GOLDEN_CASES][6];
extern const double rr_golden_chain[RR_GOLDEN_CASES][8];
extern const double rr_golden_joint_impulse[RR_GOLDEN_CASES][17];

typedef struct {
    rr_real q[4];
    rr_real n[3];
    rr_params p;
    int part;
    int clamped;
    rr_real speed;
    double force; /* right to 6 digits */
} rr_golden_impact;

extern const rr_golden_impact rr_golden_impacts[12];

#endif
