/* SPDX-License-Identifier: 0BSD */
/* Inputs and right results of panda, computed in 50 digits. */
#ifndef PANDA_GOLDEN_H
#define PANDA_GOLDEN_H

#include "panda.h"

#define PANDA_GOLDEN_CASES 12

typedef struct {
    panda_real q[7];
    panda_real n[3];
    panda_params p;
} panda_golden_input;

extern const panda_golden_input panda_golden_inputs[PANDA_GOLDEN_CASES];
extern const double panda_golden_mass_matrix[PANDA_GOLDEN_CASES][28];
extern const double panda_golden_jacobian[PANDA_GOLDEN_CASES][21];
extern const double panda_golden_generalised_mass_matrix[PANDA_GOLDEN_CASES][105];
extern const double panda_golden_stiffness_matrix[PANDA_GOLDEN_CASES][105];
extern const double panda_golden_contact_jacobian[PANDA_GOLDEN_CASES][14];
extern const double panda_golden_reflected_mass[PANDA_GOLDEN_CASES][1];
extern const double panda_golden_reduced_model[PANDA_GOLDEN_CASES][3];
extern const double panda_golden_chain[PANDA_GOLDEN_CASES][6];
extern const double panda_golden_osim[PANDA_GOLDEN_CASES][12];
extern const double panda_golden_giaf[PANDA_GOLDEN_CASES][2];
extern const double panda_golden_directional_giaf[PANDA_GOLDEN_CASES][1];
extern const double panda_golden_absorption_extremes[PANDA_GOLDEN_CASES][8];

typedef struct {
    panda_real q[7];
    panda_real n[3];
    panda_params p;
    int part;
    int clamped;
    panda_real speed;
    double force; /* right to 6 digits */
} panda_golden_impact;

extern const panda_golden_impact panda_golden_impacts[12];

#endif
