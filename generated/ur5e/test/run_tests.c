/* SPDX-License-Identifier: 0BSD */
/* Compares ur5e with its golden results and feeds it bad inputs; 1 on failure. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "golden.h"

#if defined(UR5E_USE_FLOAT)
#define BOUND(in_double, in_float) (in_float)
#else
#define BOUND(in_double, in_float) (in_double)
#endif

#define LENGTH(array) (sizeof(array)/sizeof((array)[0]))

static int failures = 0;

static void expect(int holds, const char *function, const char *what)
{
    if (!holds) {
        ++failures;
        printf("FAILED %s: %s\n", function, what);
    }
}

/* Largest difference over the scale that follows the right entries. */
static double error_of(const double *found, const double *right, size_t count)
{
    double difference = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double d = fabs(found[i] - right[i]);
        difference = d <= difference ? difference : d;
    }
    return difference > 0.0 ? difference/right[count] : 0.0;
}

static int is_same(ur5e_real a, ur5e_real b)
{
    return a >= b && a <= b;
}

/* 1 if memory still holds the pattern that it was filled with. */
static int is_untouched(const void *memory, size_t size)
{
    const unsigned char *bytes = memory;
    for (size_t i = 0; i < size; ++i) {
        if (bytes[i] != 0xA5u) {
            return 0;
        }
    }
    return 1;
}

static void test_mass_matrix(void)
{
    const char *const name = "ur5e_mass_matrix";
    ur5e_real M[6][6];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_mass_matrix[k];
        expect(ur5e_mass_matrix(in->q, M) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[21];
            size_t at = 0;
            for (size_t i = 0; i < 6; ++i) {
                for (size_t j = 0; j < i + 1; ++j) {
                    found[at++] = (double)M[i][j];
                    expect(is_same(M[i][j], M[j][i]),
                           name, "M is symmetric");
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 2e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&M, 0xA5, sizeof M);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_mass_matrix(in.q, M) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_mass_matrix(in.q, M) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    expect(ur5e_mass_matrix(NULL, M) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_mass_matrix(in.q, NULL) == UR5E_NULL_POINTER,
           name, "M is NULL");
    expect(is_untouched(&M, sizeof M),
           name, "nothing written for bad inputs");
}

static void test_jacobian(void)
{
    const char *const name = "ur5e_jacobian";
    ur5e_real J[3][6];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_jacobian[k];
        expect(ur5e_jacobian(in->q, J) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[18];
            size_t at = 0;
            for (size_t i = 0; i < 3; ++i) {
                for (size_t j = 0; j < 6; ++j) {
                    found[at++] = (double)J[i][j];
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 2e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&J, 0xA5, sizeof J);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_jacobian(in.q, J) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_jacobian(in.q, J) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    expect(ur5e_jacobian(NULL, J) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_jacobian(in.q, NULL) == UR5E_NULL_POINTER,
           name, "J is NULL");
    expect(is_untouched(&J, sizeof J),
           name, "nothing written for bad inputs");
}

static void test_generalised_mass_matrix(void)
{
    const char *const name = "ur5e_generalised_mass_matrix";
    ur5e_real M0[12][12];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_generalised_mass_matrix[k];
        expect(ur5e_generalised_mass_matrix(in->q, &in->p, M0) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[78];
            size_t at = 0;
            for (size_t i = 0; i < 12; ++i) {
                for (size_t j = 0; j < i + 1; ++j) {
                    found[at++] = (double)M0[i][j];
                    expect(is_same(M0[i][j], M0[j][i]),
                           name, "M0 is symmetric");
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 9e-07);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&M0, 0xA5, sizeof M0);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_generalised_mass_matrix(in.q, &in.p, M0) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_generalised_mass_matrix(in.q, &in.p, M0) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_generalised_mass_matrix(in.q, &in.p, M0) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_generalised_mass_matrix(in.q, &in.p, M0) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_generalised_mass_matrix(in.q, &in.p, M0) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_generalised_mass_matrix(in.q, &in.p, M0) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_generalised_mass_matrix(NULL, &in.p, M0) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_generalised_mass_matrix(in.q, NULL, M0) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_generalised_mass_matrix(in.q, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "M0 is NULL");
    expect(is_untouched(&M0, sizeof M0),
           name, "nothing written for bad inputs");
}

static void test_stiffness_matrix(void)
{
    const char *const name = "ur5e_stiffness_matrix";
    ur5e_real K0[12][12];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_stiffness_matrix[k];
        expect(ur5e_stiffness_matrix(in->q, &in->p, K0) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[78];
            size_t at = 0;
            for (size_t i = 0; i < 12; ++i) {
                for (size_t j = 0; j < i + 1; ++j) {
                    found[at++] = (double)K0[i][j];
                    expect(is_same(K0[i][j], K0[j][i]),
                           name, "K0 is symmetric");
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 5e-07);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&K0, 0xA5, sizeof K0);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_stiffness_matrix(in.q, &in.p, K0) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_stiffness_matrix(in.q, &in.p, K0) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_stiffness_matrix(in.q, &in.p, K0) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[0] = (ur5e_real)NAN;
    expect(ur5e_stiffness_matrix(in.q, &in.p, K0) == UR5E_NOT_FINITE,
           name, "joint_stiffness is not a number");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[5] = -1.0;
    expect(ur5e_stiffness_matrix(in.q, &in.p, K0) == UR5E_OUT_OF_RANGE,
           name, "joint_stiffness is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[5] = 0.0;
    expect(ur5e_stiffness_matrix(in.q, &in.p, K0) == UR5E_OUT_OF_RANGE,
           name, "joint_stiffness is 0.0");
    in = ur5e_golden_inputs[0];
    in.p.position_gain[0] = (ur5e_real)NAN;
    expect(ur5e_stiffness_matrix(in.q, &in.p, K0) == UR5E_NOT_FINITE,
           name, "position_gain is not a number");
    in = ur5e_golden_inputs[0];
    in.p.position_gain[5] = -1.0;
    expect(ur5e_stiffness_matrix(in.q, &in.p, K0) == UR5E_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_stiffness_matrix(NULL, &in.p, K0) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_stiffness_matrix(in.q, NULL, K0) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_stiffness_matrix(in.q, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "K0 is NULL");
    expect(is_untouched(&K0, sizeof K0),
           name, "nothing written for bad inputs");
}

static void test_contact_jacobian(void)
{
    const char *const name = "ur5e_contact_jacobian";
    ur5e_real J_c[12];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_contact_jacobian[k];
        expect(ur5e_contact_jacobian(in->q, in->n, J_c) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[12];
            for (size_t i = 0; i < 12; ++i) {
                found[i] = (double)J_c[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 3e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&J_c, 0xA5, sizeof J_c);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_contact_jacobian(in.q, in.n, J_c) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_contact_jacobian(in.q, in.n, J_c) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    in.n[1] = (ur5e_real)NAN;
    expect(ur5e_contact_jacobian(in.q, in.n, J_c) == UR5E_NOT_FINITE,
           name, "n is not a number");
    in = ur5e_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(ur5e_contact_jacobian(in.q, in.n, J_c) == UR5E_ZERO_DIRECTION,
           name, "n is zero");
    in = ur5e_golden_inputs[0];
    expect(ur5e_contact_jacobian(NULL, in.n, J_c) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_contact_jacobian(in.q, NULL, J_c) == UR5E_NULL_POINTER,
           name, "n is NULL");
    expect(ur5e_contact_jacobian(in.q, in.n, NULL) == UR5E_NULL_POINTER,
           name, "J_c is NULL");
    expect(is_untouched(&J_c, sizeof J_c),
           name, "nothing written for bad inputs");
}

static void test_reflected_mass(void)
{
    const char *const name = "ur5e_reflected_mass";
    ur5e_real m_c;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_reflected_mass[k];
        expect(ur5e_reflected_mass(in->q, in->n, &m_c) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)m_c;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 4e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&m_c, 0xA5, sizeof m_c);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_reflected_mass(in.q, in.n, &m_c) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_reflected_mass(in.q, in.n, &m_c) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    in.n[1] = (ur5e_real)NAN;
    expect(ur5e_reflected_mass(in.q, in.n, &m_c) == UR5E_NOT_FINITE,
           name, "n is not a number");
    in = ur5e_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(ur5e_reflected_mass(in.q, in.n, &m_c) == UR5E_ZERO_DIRECTION,
           name, "n is zero");
    in = ur5e_golden_inputs[0];
    expect(ur5e_reflected_mass(NULL, in.n, &m_c) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_reflected_mass(in.q, NULL, &m_c) == UR5E_NULL_POINTER,
           name, "n is NULL");
    expect(ur5e_reflected_mass(in.q, in.n, NULL) == UR5E_NULL_POINTER,
           name, "m_c is NULL");
    expect(is_untouched(&m_c, sizeof m_c),
           name, "nothing written for bad inputs");
}

static void test_reduced_model(void)
{
    const char *const name = "ur5e_reduced_model";
    ur5e_reduced_model_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_reduced_model[k];
        expect(ur5e_reduced_model(in->q, in->n, &in->p, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)out.m_c;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[1];
            found[0] = (double)out.k_r;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[1];
            found[0] = (double)out.m_a;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 2e-05);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.n[1] = (ur5e_real)NAN;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "n is not a number");
    in = ur5e_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_ZERO_DIRECTION,
           name, "n is zero");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[0] = (ur5e_real)NAN;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "joint_stiffness is not a number");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[5] = -1.0;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "joint_stiffness is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[5] = 0.0;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "joint_stiffness is 0.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    in.p.position_gain[0] = (ur5e_real)NAN;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "position_gain is not a number");
    in = ur5e_golden_inputs[0];
    in.p.position_gain[5] = -1.0;
    expect(ur5e_reduced_model(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_reduced_model(NULL, in.n, &in.p, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_reduced_model(in.q, NULL, &in.p, &out) == UR5E_NULL_POINTER,
           name, "n is NULL");
    expect(ur5e_reduced_model(in.q, in.n, NULL, &out) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_reduced_model(in.q, in.n, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_chain(void)
{
    const char *const name = "ur5e_chain";
    ur5e_chain_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_chain[k];
        expect(ur5e_chain(in->q, in->n, &in->p, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[3];
            for (size_t i = 0; i < 3; ++i) {
                found[i] = (double)out.mass[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[3];
            for (size_t i = 0; i < 3; ++i) {
                found[i] = (double)out.stiffness[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(3e-12, 0.007);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.n[1] = (ur5e_real)NAN;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "n is not a number");
    in = ur5e_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_ZERO_DIRECTION,
           name, "n is zero");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[0] = (ur5e_real)NAN;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "joint_stiffness is not a number");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[5] = -1.0;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "joint_stiffness is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.joint_stiffness[5] = 0.0;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "joint_stiffness is 0.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    in.p.position_gain[0] = (ur5e_real)NAN;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_NOT_FINITE,
           name, "position_gain is not a number");
    in = ur5e_golden_inputs[0];
    in.p.position_gain[5] = -1.0;
    expect(ur5e_chain(in.q, in.n, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_chain(NULL, in.n, &in.p, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_chain(in.q, NULL, &in.p, &out) == UR5E_NULL_POINTER,
           name, "n is NULL");
    expect(ur5e_chain(in.q, in.n, NULL, &out) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_chain(in.q, in.n, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_osim(void)
{
    const char *const name = "ur5e_osim";
    ur5e_osim_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_osim[k];
        expect(ur5e_osim(in->q, &in->p, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[6];
            size_t at = 0;
            for (size_t i = 0; i < 3; ++i) {
                for (size_t j = 0; j < i + 1; ++j) {
                    found[at++] = (double)out.Lambda[i][j];
                    expect(is_same(out.Lambda[i][j], out.Lambda[j][i]),
                           name, "Lambda is symmetric");
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[6];
            size_t at = 0;
            for (size_t i = 0; i < 3; ++i) {
                for (size_t j = 0; j < i + 1; ++j) {
                    found[at++] = (double)out.Lambda_F[i][j];
                    expect(is_same(out.Lambda_F[i][j], out.Lambda_F[j][i]),
                           name, "Lambda_F is symmetric");
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 0.0002);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_osim(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_osim(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_osim(in.q, &in.p, &out) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_osim(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_osim(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_osim(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_osim(NULL, &in.p, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_osim(in.q, NULL, &out) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_osim(in.q, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_giaf(void)
{
    const char *const name = "ur5e_giaf";
    ur5e_giaf_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_giaf[k];
        expect(ur5e_giaf(in->q, &in->p, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)out.giaf;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[1];
            found[0] = (double)out.giif;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 2e-05);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_giaf(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_giaf(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_giaf(in.q, &in.p, &out) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_giaf(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_giaf(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_giaf(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_giaf(NULL, &in.p, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_giaf(in.q, NULL, &out) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_giaf(in.q, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_directional_giaf(void)
{
    const char *const name = "ur5e_directional_giaf";
    ur5e_real giaf;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_directional_giaf[k];
        expect(ur5e_directional_giaf(in->q, in->n, &in->p, &giaf) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)giaf;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 2e-05);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&giaf, 0xA5, sizeof giaf);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, &giaf) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, &giaf) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, &giaf) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.n[1] = (ur5e_real)NAN;
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, &giaf) == UR5E_NOT_FINITE,
           name, "n is not a number");
    in = ur5e_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, &giaf) == UR5E_ZERO_DIRECTION,
           name, "n is zero");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, &giaf) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, &giaf) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, &giaf) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_directional_giaf(NULL, in.n, &in.p, &giaf) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_directional_giaf(in.q, NULL, &in.p, &giaf) == UR5E_NULL_POINTER,
           name, "n is NULL");
    expect(ur5e_directional_giaf(in.q, in.n, NULL, &giaf) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_directional_giaf(in.q, in.n, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "giaf is NULL");
    expect(is_untouched(&giaf, sizeof giaf),
           name, "nothing written for bad inputs");
}

static void test_absorption_extremes(void)
{
    const char *const name = "ur5e_absorption_extremes";
    ur5e_absorption_extremes_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_absorption_extremes[k];
        expect(ur5e_absorption_extremes(in->q, &in->p, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)out.least;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[1];
            found[0] = (double)out.greatest;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[3];
            for (size_t i = 0; i < 3; ++i) {
                found[i] = (double)out.least_direction[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[3];
            for (size_t i = 0; i < 3; ++i) {
                found[i] = (double)out.greatest_direction[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 7e-05);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_absorption_extremes(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_absorption_extremes(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_absorption_extremes(in.q, &in.p, &out) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_absorption_extremes(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_absorption_extremes(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_absorption_extremes(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_absorption_extremes(NULL, &in.p, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_absorption_extremes(in.q, NULL, &out) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_absorption_extremes(in.q, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_manipulability(void)
{
    const char *const name = "ur5e_manipulability";
    ur5e_manipulability_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_manipulability[k];
        expect(ur5e_manipulability(in->q, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)out.omega_m;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[6];
            size_t at = 0;
            for (size_t i = 0; i < 3; ++i) {
                for (size_t j = 0; j < i + 1; ++j) {
                    found[at++] = (double)out.JJ[i][j];
                    expect(is_same(out.JJ[i][j], out.JJ[j][i]),
                           name, "JJ is symmetric");
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 3e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_manipulability(in.q, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_manipulability(in.q, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    expect(ur5e_manipulability(NULL, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_manipulability(in.q, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_force_measure(void)
{
    const char *const name = "ur5e_force_measure";
    ur5e_real omega_f;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_force_measure[k];
        expect(ur5e_force_measure(in->q, &omega_f) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)omega_f;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 8e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&omega_f, 0xA5, sizeof omega_f);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_force_measure(in.q, &omega_f) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_force_measure(in.q, &omega_f) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    expect(ur5e_force_measure(NULL, &omega_f) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_force_measure(in.q, NULL) == UR5E_NULL_POINTER,
           name, "omega_f is NULL");
    expect(is_untouched(&omega_f, sizeof omega_f),
           name, "nothing written for bad inputs");
}

static void test_impact_measure(void)
{
    const char *const name = "ur5e_impact_measure";
    ur5e_impact_measure_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_impact_measure[k];
        expect(ur5e_impact_measure(in->q, &in->p, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)out.omega_di;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[6];
            size_t at = 0;
            for (size_t i = 0; i < 3; ++i) {
                for (size_t j = 0; j < i + 1; ++j) {
                    found[at++] = (double)out.E[i][j];
                    expect(is_same(out.E[i][j], out.E[j][i]),
                           name, "E is symmetric");
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 6e-05);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_impact_measure(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_impact_measure(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_impact_measure(in.q, &in.p, &out) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_impact_measure(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_impact_measure(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_impact_measure(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_impact_measure(NULL, &in.p, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_impact_measure(in.q, NULL, &out) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_impact_measure(in.q, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_rotor_influence(void)
{
    const char *const name = "ur5e_rotor_influence";
    ur5e_rotor_influence_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_rotor_influence[k];
        expect(ur5e_rotor_influence(in->q, &in->p, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[6];
            for (size_t i = 0; i < 6; ++i) {
                found[i] = (double)out.by_rotor[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[6];
            for (size_t i = 0; i < 6; ++i) {
                found[i] = (double)out.by_gear[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 0.0002);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_rotor_influence(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_rotor_influence(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_rotor_influence(in.q, &in.p, &out) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_rotor_influence(in.q, &in.p, &out) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_rotor_influence(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_rotor_influence(in.q, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_rotor_influence(NULL, &in.p, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_rotor_influence(in.q, NULL, &out) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_rotor_influence(in.q, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_single_joint_giaf(void)
{
    const char *const name = "ur5e_single_joint_giaf";
    ur5e_real giaf[6];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_single_joint_giaf[k];
        expect(ur5e_single_joint_giaf(in->q, &in->p, giaf) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[6];
            for (size_t i = 0; i < 6; ++i) {
                found[i] = (double)giaf[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 9e-05);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&giaf, 0xA5, sizeof giaf);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_single_joint_giaf(in.q, &in.p, giaf) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_single_joint_giaf(in.q, &in.p, giaf) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_single_joint_giaf(in.q, &in.p, giaf) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_single_joint_giaf(in.q, &in.p, giaf) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_single_joint_giaf(in.q, &in.p, giaf) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_single_joint_giaf(in.q, &in.p, giaf) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_single_joint_giaf(NULL, &in.p, giaf) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_single_joint_giaf(in.q, NULL, giaf) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_single_joint_giaf(in.q, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "giaf is NULL");
    expect(is_untouched(&giaf, sizeof giaf),
           name, "nothing written for bad inputs");
}

static void test_joint_impulse(void)
{
    const char *const name = "ur5e_joint_impulse";
    ur5e_joint_impulse_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_joint_impulse[k];
        expect(ur5e_joint_impulse(in->q, in->n, in->speed, in->restitution, in->other_mobility, &in->p, &out) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)out.contact;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[6];
            for (size_t i = 0; i < 6; ++i) {
                found[i] = (double)out.joints[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[6];
            for (size_t i = 0; i < 6; ++i) {
                found[i] = (double)out.gears[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[6];
            for (size_t i = 0; i < 6; ++i) {
                found[i] = (double)out.velocity_change[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 5e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    ++in.p.layout;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = ur5e_golden_inputs[0];
    in.n[1] = (ur5e_real)NAN;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NOT_FINITE,
           name, "n is not a number");
    in = ur5e_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_ZERO_DIRECTION,
           name, "n is zero");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[0] = (ur5e_real)NAN;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = ur5e_golden_inputs[0];
    in.p.rotor_inertia[5] = 0.0;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "rotor_inertia is 0.0");
    in = ur5e_golden_inputs[0];
    in.speed = (ur5e_real)NAN;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NOT_FINITE,
           name, "speed is not a number");
    in = ur5e_golden_inputs[0];
    in.speed = -1.0;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "speed is -1.0");
    in = ur5e_golden_inputs[0];
    in.speed = 0.0;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "speed is 0.0");
    in = ur5e_golden_inputs[0];
    in.restitution = (ur5e_real)NAN;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NOT_FINITE,
           name, "restitution is not a number");
    in = ur5e_golden_inputs[0];
    in.restitution = -1.0;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "restitution is -1.0");
    in = ur5e_golden_inputs[0];
    in.restitution = 2.0;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "restitution is 2.0");
    in = ur5e_golden_inputs[0];
    in.other_mobility = (ur5e_real)NAN;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NOT_FINITE,
           name, "other_mobility is not a number");
    in = ur5e_golden_inputs[0];
    in.other_mobility = -1.0;
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_OUT_OF_RANGE,
           name, "other_mobility is -1.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_joint_impulse(NULL, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_joint_impulse(in.q, NULL, in.speed, in.restitution, in.other_mobility, &in.p, &out) == UR5E_NULL_POINTER,
           name, "n is NULL");
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, NULL, &out) == UR5E_NULL_POINTER,
           name, "p is NULL");
    expect(ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, NULL) == UR5E_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_linear_error(void)
{
    const char *const name = "ur5e_linear_error";
    ur5e_real error;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_inputs); ++k) {
        const ur5e_golden_input *const in = &ur5e_golden_inputs[k];
        const double *right = ur5e_golden_linear_error[k];
        expect(ur5e_linear_error(in->q, in->n, in->speed, in->duration, &error) == UR5E_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)error;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 0.0001);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    ur5e_golden_input in = ur5e_golden_inputs[0];
    memset(&error, 0xA5, sizeof error);
    in.q[0] = (ur5e_real)NAN;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_NOT_FINITE,
           name, "q is not a number");
    in = ur5e_golden_inputs[0];
    in.q[5] = (ur5e_real)INFINITY;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_NOT_FINITE,
           name, "q is infinite");
    in = ur5e_golden_inputs[0];
    in.n[1] = (ur5e_real)NAN;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_NOT_FINITE,
           name, "n is not a number");
    in = ur5e_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_ZERO_DIRECTION,
           name, "n is zero");
    in = ur5e_golden_inputs[0];
    in.speed = (ur5e_real)NAN;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_NOT_FINITE,
           name, "speed is not a number");
    in = ur5e_golden_inputs[0];
    in.speed = -1.0;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_OUT_OF_RANGE,
           name, "speed is -1.0");
    in = ur5e_golden_inputs[0];
    in.speed = 0.0;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_OUT_OF_RANGE,
           name, "speed is 0.0");
    in = ur5e_golden_inputs[0];
    in.duration = (ur5e_real)NAN;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_NOT_FINITE,
           name, "duration is not a number");
    in = ur5e_golden_inputs[0];
    in.duration = -1.0;
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error) == UR5E_OUT_OF_RANGE,
           name, "duration is -1.0");
    in = ur5e_golden_inputs[0];
    expect(ur5e_linear_error(NULL, in.n, in.speed, in.duration, &error) == UR5E_NULL_POINTER,
           name, "q is NULL");
    expect(ur5e_linear_error(in.q, NULL, in.speed, in.duration, &error) == UR5E_NULL_POINTER,
           name, "n is NULL");
    expect(ur5e_linear_error(in.q, in.n, in.speed, in.duration, NULL) == UR5E_NULL_POINTER,
           name, "error is NULL");
    expect(is_untouched(&error, sizeof error),
           name, "nothing written for bad inputs");
}

/* What a golden impact hits. */
static int golden_region(const ur5e_golden_impact *in, ur5e_region *region)
{
    return ur5e_body_region(in->part, in->clamped, region);
}

static void test_impacts(void)
{
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(ur5e_golden_impacts); ++k) {
        const ur5e_golden_impact *const in = &ur5e_golden_impacts[k];
        ur5e_region region;
        ur5e_peak_force_t peak = {0, 0};
        ur5e_peak_force_t again = {0, 0};
        ur5e_safe_speed_t safe = {0, 0};
        expect(golden_region(in, &region) == UR5E_OK, "ur5e_body_region", "status");
        const int found = ur5e_peak_force(in->q, in->n, in->speed, &region, &in->p, &peak);
        if (found == UR5E_BOUNDED) { /* a servo that float has too few digits for */
            expect((double)peak.force >= in->force, "ur5e_peak_force", "bound of a golden impact");
            continue;
        }
        expect(found == UR5E_OK, "ur5e_peak_force", "status of a golden impact");
        worst = fmax(worst, fabs((double)peak.force/in->force - 1.0));
        expect(peak.time > 0, "ur5e_peak_force", "time of the peak");
        const int kept = ur5e_safe_speed(in->q, in->n, peak.force, &region, &in->p, &safe);
        expect(kept == UR5E_OK || kept == UR5E_BOUNDED, "ur5e_safe_speed", "status of a golden impact");
        expect(ur5e_peak_force(in->q, in->n, safe.speed, &region, &in->p, &again) == UR5E_OK
                   && again.force <= peak.force,
               "ur5e_safe_speed", "force at the speed found");
        expect(safe.force <= peak.force && safe.speed > 0, "ur5e_safe_speed", "is safe");

        ur5e_params few = in->p;
        few.steps = 3;
        const int status = ur5e_peak_force(in->q, in->n, in->speed, &region, &few, &again);
        expect(status == UR5E_UNRESOLVED || (status == UR5E_BOUNDED && (double)again.force >= in->force),
               "ur5e_peak_force", "bound when steps are used up");
    }
    const double bound = 0.002;
    printf("%-40s error %.1e, bound %.1e\n", "ur5e_peak_force", worst, bound);
    expect(worst <= bound, "ur5e_peak_force", "error within its bound");
}

static void test_bad_impacts(void)
{
    const ur5e_golden_impact in = ur5e_golden_impacts[0];
    ur5e_region good;
    ur5e_peak_force_t peak;
    ur5e_safe_speed_t safe;
    memset(&peak, 0xA5, sizeof peak);
    memset(&safe, 0xA5, sizeof safe);
    expect(ur5e_body_region(-1, 0, &good) == UR5E_OUT_OF_RANGE, "ur5e_body_region", "no such part");
    expect(ur5e_body_region(12, 0, &good) == UR5E_OUT_OF_RANGE, "ur5e_body_region", "no such part");
    expect(ur5e_body_region(0, 0, NULL) == UR5E_NULL_POINTER, "ur5e_body_region", "NULL");
    expect(ur5e_body_region(0, 0, &good) == UR5E_OK, "ur5e_body_region", "status");
    expect(ur5e_peak_force(in.q, in.n, 0, &good, &in.p, &peak) == UR5E_OUT_OF_RANGE,
           "ur5e_peak_force", "speed or limit is zero");
    expect(ur5e_safe_speed(in.q, in.n, 0, &good, &in.p, &safe) == UR5E_OUT_OF_RANGE,
           "ur5e_safe_speed", "speed or limit is zero");
    expect(ur5e_peak_force(in.q, in.n, -1, &good, &in.p, &peak) == UR5E_OUT_OF_RANGE,
           "ur5e_peak_force", "speed or limit is negative");
    expect(ur5e_safe_speed(in.q, in.n, -1, &good, &in.p, &safe) == UR5E_OUT_OF_RANGE,
           "ur5e_safe_speed", "speed or limit is negative");
    expect(ur5e_peak_force(in.q, in.n, (ur5e_real)NAN, &good, &in.p, &peak) == UR5E_NOT_FINITE,
           "ur5e_peak_force", "speed or limit is not a number");
    expect(ur5e_safe_speed(in.q, in.n, (ur5e_real)NAN, &good, &in.p, &safe) == UR5E_NOT_FINITE,
           "ur5e_safe_speed", "speed or limit is not a number");
    expect(ur5e_peak_force(in.q, in.n, 1, NULL, &in.p, &peak) == UR5E_NULL_POINTER,
           "ur5e_peak_force", "region is NULL");
    expect(ur5e_safe_speed(in.q, in.n, 1, NULL, &in.p, &safe) == UR5E_NULL_POINTER,
           "ur5e_safe_speed", "region is NULL");

    {
        ur5e_region bad = good;
        bad.stiffness = 0;
    expect(ur5e_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == UR5E_OUT_OF_RANGE,
               "ur5e_peak_force", "stiffness is 0");
        expect(ur5e_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == UR5E_OUT_OF_RANGE,
               "ur5e_safe_speed", "stiffness is 0");

    }
    {
        ur5e_region bad = good;
        bad.damping = -1;
    expect(ur5e_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == UR5E_OUT_OF_RANGE,
               "ur5e_peak_force", "damping is -1");
        expect(ur5e_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == UR5E_OUT_OF_RANGE,
               "ur5e_safe_speed", "damping is -1");

    }
    {
        ur5e_region bad = good;
        bad.effective_mass = 0;
    expect(ur5e_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == UR5E_OUT_OF_RANGE,
               "ur5e_peak_force", "effective_mass is 0");
        expect(ur5e_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == UR5E_OUT_OF_RANGE,
               "ur5e_safe_speed", "effective_mass is 0");

    }
    {
        ur5e_region bad = good;
        bad.hertz_stiffness = (ur5e_real)INFINITY;
    expect(ur5e_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == UR5E_NOT_FINITE,
               "ur5e_peak_force", "hertz_stiffness is (ur5e_real)INFINITY");
        expect(ur5e_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == UR5E_NOT_FINITE,
               "ur5e_safe_speed", "hertz_stiffness is (ur5e_real)INFINITY");

    }
    {
        ur5e_golden_impact bad = in;
        bad.p.layout = 0;
        expect(ur5e_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == UR5E_FOREIGN_PARAMS,
               "ur5e_peak_force", "layout is 0");
    }
    {
        ur5e_golden_impact bad = in;
        bad.p.horizon = 0;
        expect(ur5e_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == UR5E_OUT_OF_RANGE,
               "ur5e_peak_force", "horizon is 0");
    }
    {
        ur5e_golden_impact bad = in;
        bad.p.reaction_time = -1;
        expect(ur5e_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == UR5E_OUT_OF_RANGE,
               "ur5e_peak_force", "reaction_time is -1");
    }
    {
        ur5e_golden_impact bad = in;
        bad.p.motors = 4;
        expect(ur5e_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == UR5E_OUT_OF_RANGE,
               "ur5e_peak_force", "motors is 4");
    }
    {
        ur5e_golden_impact bad = in;
        bad.p.steps = 0;
        expect(ur5e_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == UR5E_OUT_OF_RANGE,
               "ur5e_peak_force", "steps is 0");
    }
    const ur5e_real nowhere[3] = {0, 0, 0};
    expect(ur5e_peak_force(in.q, nowhere, 1, &good, &in.p, &peak) == UR5E_ZERO_DIRECTION,
           "ur5e_peak_force", "n is zero");
    expect(is_untouched(&peak, sizeof peak) && is_untouched(&safe, sizeof safe), "impacts", "nothing written for bad inputs");
}

#define POSES LENGTH(ur5e_golden_impacts)

/* The best of some poses, one call of ur5e_peak_force after the other; -1 if none is usable. */
static int best_of(const ur5e_real poses[][6], int count, const unsigned char *allowed,
    const ur5e_golden_impact *in, const ur5e_region *region, ur5e_real *force)
{
    int best = -1;
    for (int i = 0; i < count; ++i) {
        ur5e_peak_force_t peak;
        if (allowed[i] != 0 && ur5e_peak_force(poses[i], in->n, in->speed, region, &in->p, &peak) == UR5E_OK
            && (best < 0 || peak.force < *force)) {
            best = i;
            *force = peak.force;
        }
    }
    return best;
}

static void check_selection(const ur5e_real poses[][6], int count, const ur5e_golden_impact *in)
{
    unsigned char allowed[12];
    ur5e_region region;
    ur5e_selection_t found;
    ur5e_selection_t rest;
    ur5e_real force = 0;
    ur5e_real next = 0;
    memset(allowed, 1, sizeof allowed);
    expect(golden_region(in, &region) == UR5E_OK, "ur5e_body_region", "status");
    const int best = best_of(poses, count, allowed, in, &region, &force);
    if (best < 0) { /* all are bounded */
        return;
    }
    expect(ur5e_select_configuration(poses, count, NULL, in->n, in->speed, &region, &in->p, &found) == UR5E_OK,
           "ur5e_select_configuration", "status");
    expect(found.best == best && is_same(found.force, force), "ur5e_select_configuration", "is the best");
    allowed[best] = 0;
    const int second = best_of(poses, count, allowed, in, &region, &next);
    expect(found.second == second && is_same(found.margin, second < 0 ? 0 : next - force), "ur5e_select_configuration", "second best");
    const int others = ur5e_select_configuration(poses, count, allowed, in->n, in->speed, &region, &in->p, &rest);
    expect(second < 0 ? others == UR5E_SINGULAR
                      : others == UR5E_OK && rest.best == second && rest.usable == found.usable - 1,
           "ur5e_select_configuration", "leaves out what is not allowed");
    memset(allowed, 0, sizeof allowed);
    memset(&rest, 0xA5, sizeof rest);
    expect(ur5e_select_configuration(poses, count, allowed, in->n, in->speed, &region, &in->p, &rest) == UR5E_SINGULAR
               && ur5e_select_configuration(poses, 0, NULL, in->n, in->speed, &region, &in->p, &rest) == UR5E_SINGULAR,
           "ur5e_select_configuration", "no pose is left");
    expect(ur5e_select_configuration(NULL, 1, NULL, in->n, in->speed, &region, &in->p, &rest) == UR5E_NULL_POINTER
               && ur5e_select_configuration(poses, count, NULL, in->n, 0, &region, &in->p, &rest) == UR5E_OUT_OF_RANGE,
           "ur5e_select_configuration", "bad inputs");
    expect(is_untouched(&rest, sizeof rest), "ur5e_select_configuration", "nothing written for bad inputs");
}

static void test_selection(void)
{
    static ur5e_real poses[POSES][6];
    for (size_t k = 0; k < POSES; ++k) {
        memcpy(poses[k], ur5e_golden_impacts[k].q, sizeof poses[k]);
    }
    for (size_t k = 0; k < POSES; ++k) {
        const ur5e_golden_impact *const in = &ur5e_golden_impacts[k];
        check_selection((const ur5e_real (*)[6])poses, (int)POSES, in);
    }
}

static void test_common(void)
{
    ur5e_params p;
    expect(ur5e_default_params(&p) == UR5E_OK,
           "ur5e_default_params", "status");
    expect(ur5e_default_params(NULL) == UR5E_NULL_POINTER,
           "ur5e_default_params", "NULL");
    ur5e_params other;
    memset(&other, 0xA5, sizeof other);
    expect(ur5e_fill_params(&other, UR5E_LAYOUT + 4u) == UR5E_FOREIGN_PARAMS,
           "ur5e_fill_params", "other layout");
    expect(is_untouched(&other, sizeof other), "ur5e_fill_params", "nothing written for bad inputs");
    expect(strcmp(ur5e_version(), UR5E_VERSION) == 0, "ur5e_version", "is the header's");
    expect(strcmp(ur5e_model_digest(), UR5E_MODEL_DIGEST) == 0, "ur5e_model_digest", "is the header's");
    for (int status = -1; status <= 11; ++status) {
        expect(strlen(ur5e_status_text(status)) > 0, "ur5e_status_text", "has a text");
    }
    expect(strcmp(ur5e_status_text(11), ur5e_status_text(UR5E_OK)) != 0,
           "ur5e_status_text", "unknown status");
}

int main(void)
{
    test_common();
    test_mass_matrix();
    test_jacobian();
    test_generalised_mass_matrix();
    test_stiffness_matrix();
    test_contact_jacobian();
    test_reflected_mass();
    test_reduced_model();
    test_chain();
    test_osim();
    test_giaf();
    test_directional_giaf();
    test_absorption_extremes();
    test_manipulability();
    test_force_measure();
    test_impact_measure();
    test_rotor_influence();
    test_single_joint_giaf();
    test_joint_impulse();
    test_linear_error();
    test_impacts();
    test_bad_impacts();
    test_selection();
    printf(failures == 0 ? "all passed\n" : "%d failed\n", failures);
    return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
