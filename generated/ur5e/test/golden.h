/* SPDX-License-Identifier: 0BSD */
/* Inputs and right results of ur5e, computed in 50 digits. */
#ifndef UR5E_GOLDEN_H
#define UR5E_GOLDEN_H

#include "ur5e.h"

#define UR5E_GOLDEN_CASES 12

typedef struct {
    ur5e_real q[6];
    ur5e_real n[3];
    ur5e_params p;
} ur5e_golden_input;

extern const ur5e_golden_input ur5e_golden_inputs[UR5E_GOLDEN_CASES];
extern const double ur5e_golden_mass_matrix[UR5E_GOLDEN_CASES][21];
extern const double ur5e_golden_jacobian[UR5E_GOLDEN_CASES][18];
extern const double ur5e_golden_generalised_mass_matrix[UR5E_GOLDEN_CASES][78];
extern const double ur5e_golden_stiffness_matrix[UR5E_GOLDEN_CASES][78];
extern const double ur5e_golden_contact_jacobian[UR5E_GOLDEN_CASES][12];
extern const double ur5e_golden_reflected_mass[UR5E_GOLDEN_CASES][1];
extern const double ur5e_golden_reduced_model[UR5E_GOLDEN_CASES][3];
extern const double ur5e_golden_chain[UR5E_GOLDEN_CASES][6];
extern const double ur5e_golden_osim[UR5E_GOLDEN_CASES][12];
extern const double ur5e_golden_giaf[UR5E_GOLDEN_CASES][2];
extern const double ur5e_golden_directional_giaf[UR5E_GOLDEN_CASES][1];
extern const double ur5e_golden_absorption_extremes[UR5E_GOLDEN_CASES][8];

typedef struct {
    ur5e_real q[6];
    ur5e_real n[3];
    ur5e_params p;
    int part;
    int clamped;
    ur5e_real speed;
    double force; /* right to 6 digits */
} ur5e_golden_impact;

extern const ur5e_golden_impact ur5e_golden_impacts[12];

#endif
