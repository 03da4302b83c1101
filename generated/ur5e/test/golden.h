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
    ur5e_real speed;
    ur5e_real restitution;
    ur5e_real other_mobility;
    ur5e_real duration;
} ur5e_golden_input;

extern const ur5e_golden_input ur5e_golden_inputs[UR5E_GOLDEN_CASES];
/* Right entries of each output, and what its errors are stated over. */
extern const double ur5e_golden_mass_matrix[UR5E_GOLDEN_CASES][22];
extern const double ur5e_golden_jacobian[UR5E_GOLDEN_CASES][19];
extern const double ur5e_golden_generalised_mass_matrix[UR5E_GOLDEN_CASES][79];
extern const double ur5e_golden_stiffness_matrix[UR5E_GOLDEN_CASES][79];
extern const double ur5e_golden_contact_jacobian[UR5E_GOLDEN_CASES][13];
extern const double ur5e_golden_reflected_mass[UR5E_GOLDEN_CASES][2];
extern const double ur5e_golden_reduced_model[UR5E_GOLDEN_CASES][6];
extern const double ur5e_golden_chain[UR5E_GOLDEN_CASES][8];
extern const double ur5e_golden_osim[UR5E_GOLDEN_CASES][14];
extern const double ur5e_golden_giaf[UR5E_GOLDEN_CASES][4];
extern const double ur5e_golden_directional_giaf[UR5E_GOLDEN_CASES][2];
extern const double ur5e_golden_absorption_extremes[UR5E_GOLDEN_CASES][12];
extern const double ur5e_golden_manipulability[UR5E_GOLDEN_CASES][9];
extern const double ur5e_golden_force_measure[UR5E_GOLDEN_CASES][2];
extern const double ur5e_golden_impact_measure[UR5E_GOLDEN_CASES][9];
extern const double ur5e_golden_rotor_influence[UR5E_GOLDEN_CASES][14];
extern const double ur5e_golden_single_joint_giaf[UR5E_GOLDEN_CASES][7];
extern const double ur5e_golden_joint_impulse[UR5E_GOLDEN_CASES][23];
extern const double ur5e_golden_linear_error[UR5E_GOLDEN_CASES][2];

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
