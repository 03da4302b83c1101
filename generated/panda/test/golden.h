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
    panda_real speed;
    panda_real restitution;
    panda_real other_mobility;
    panda_real duration;
} panda_golden_input;

extern const panda_golden_input panda_golden_inputs[PANDA_GOLDEN_CASES];
/* Right entries of each output, and what its errors are stated over. */
extern const double panda_golden_mass_matrix[PANDA_GOLDEN_CASES][29];
extern const double panda_golden_jacobian[PANDA_GOLDEN_CASES][22];
extern const double panda_golden_generalised_mass_matrix[PANDA_GOLDEN_CASES][106];
extern const double panda_golden_stiffness_matrix[PANDA_GOLDEN_CASES][106];
extern const double panda_golden_contact_jacobian[PANDA_GOLDEN_CASES][15];
extern const double panda_golden_reflected_mass[PANDA_GOLDEN_CASES][2];
extern const double panda_golden_reduced_model[PANDA_GOLDEN_CASES][6];
extern const double panda_golden_chain[PANDA_GOLDEN_CASES][8];
extern const double panda_golden_osim[PANDA_GOLDEN_CASES][14];
extern const double panda_golden_giaf[PANDA_GOLDEN_CASES][4];
extern const double panda_golden_directional_giaf[PANDA_GOLDEN_CASES][2];
extern const double panda_golden_absorption_extremes[PANDA_GOLDEN_CASES][12];
extern const double panda_golden_manipulability[PANDA_GOLDEN_CASES][9];
extern const double panda_golden_force_measure[PANDA_GOLDEN_CASES][2];
extern const double panda_golden_impact_measure[PANDA_GOLDEN_CASES][9];
extern const double panda_golden_rotor_influence[PANDA_GOLDEN_CASES][16];
extern const double panda_golden_single_joint_giaf[PANDA_GOLDEN_CASES][8];
extern const double panda_golden_joint_impulse[PANDA_GOLDEN_CASES][26];
extern const double panda_golden_linear_error[PANDA_GOLDEN_CASES][2];

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
