/* SPDX-License-Identifier: 0BSD */
/* Inputs and right results of rmin, computed in 50 digits. */
#ifndef RMIN_GOLDEN_H
#define RMIN_GOLDEN_H

#include "rmin.h"

#define RMIN_GOLDEN_CASES 12

typedef struct {
    rmin_real q[6];
    rmin_real n[3];
    rmin_params p;
    rmin_real speed;
    rmin_real restitution;
    rmin_real other_mobility;
    rmin_real duration;
} rmin_golden_input;

extern const rmin_golden_input rmin_golden_inputs[RMIN_GOLDEN_CASES];

#define RMIN_GOLDEN_CONFIGURATIONS 12

extern const rmin_real rmin_golden_motors[RMIN_GOLDEN_CONFIGURATIONS][2];
extern const double rmin_golden_configurations[RMIN_GOLDEN_CONFIGURATIONS][7];

/* Right entries of each output, and what its errors are stated over. */
extern const double rmin_golden_mass_matrix[RMIN_GOLDEN_CASES][11];
extern const double rmin_golden_jacobian[RMIN_GOLDEN_CASES][13];
extern const double rmin_golden_generalised_mass_matrix[RMIN_GOLDEN_CASES][11];
extern const double rmin_golden_stiffness_matrix[RMIN_GOLDEN_CASES][11];
extern const double rmin_golden_contact_jacobian[RMIN_GOLDEN_CASES][5];
extern const double rmin_golden_reflected_mass[RMIN_GOLDEN_CASES][2];
extern const double rmin_golden_reduced_model[RMIN_GOLDEN_CASES][6];
extern const double rmin_golden_chain[RMIN_GOLDEN_CASES][8];

typedef struct {
    rmin_real q[6];
    rmin_real n[3];
    rmin_params p;
    int part;
    int clamped;
    rmin_real speed;
    double force; /* right to 6 digits */
} rmin_golden_impact;

extern const rmin_golden_impact rmin_golden_impacts[12];

#endif
