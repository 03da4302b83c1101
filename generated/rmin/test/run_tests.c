/* SPDX-License-Identifier: 0BSD */
/* Compares rmin with its golden results and feeds it bad inputs; 1 on failure. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "golden.h"

#if defined(RMIN_USE_FLOAT)
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

static int is_same(rmin_real a, rmin_real b)
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
    const char *const name = "rmin_mass_matrix";
    rmin_real M[4][4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_inputs); ++k) {
        const rmin_golden_input *const in = &rmin_golden_inputs[k];
        const double *right = rmin_golden_mass_matrix[k];
        expect(rmin_mass_matrix(in->q, M) == RMIN_OK,
               name, "status of a golden case");
        {
            double found[10];
            size_t at = 0;
            for (size_t i = 0; i < 4; ++i) {
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

    rmin_golden_input in = rmin_golden_inputs[0];
    memset(&M, 0xA5, sizeof M);
    in.q[0] = (rmin_real)NAN;
    expect(rmin_mass_matrix(in.q, M) == RMIN_NOT_FINITE,
           name, "q is not a number");
    in = rmin_golden_inputs[0];
    in.q[5] = (rmin_real)INFINITY;
    expect(rmin_mass_matrix(in.q, M) == RMIN_NOT_FINITE,
           name, "q is infinite");
    in = rmin_golden_inputs[0];
    expect(rmin_mass_matrix(NULL, M) == RMIN_NULL_POINTER,
           name, "q is NULL");
    expect(rmin_mass_matrix(in.q, NULL) == RMIN_NULL_POINTER,
           name, "M is NULL");
    expect(is_untouched(&M, sizeof M),
           name, "nothing written for bad inputs");
}

static void test_jacobian(void)
{
    const char *const name = "rmin_jacobian";
    rmin_real J[3][4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_inputs); ++k) {
        const rmin_golden_input *const in = &rmin_golden_inputs[k];
        const double *right = rmin_golden_jacobian[k];
        expect(rmin_jacobian(in->q, J) == RMIN_OK,
               name, "status of a golden case");
        {
            double found[12];
            size_t at = 0;
            for (size_t i = 0; i < 3; ++i) {
                for (size_t j = 0; j < 4; ++j) {
                    found[at++] = (double)J[i][j];
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 3e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rmin_golden_input in = rmin_golden_inputs[0];
    memset(&J, 0xA5, sizeof J);
    in.q[0] = (rmin_real)NAN;
    expect(rmin_jacobian(in.q, J) == RMIN_NOT_FINITE,
           name, "q is not a number");
    in = rmin_golden_inputs[0];
    in.q[5] = (rmin_real)INFINITY;
    expect(rmin_jacobian(in.q, J) == RMIN_NOT_FINITE,
           name, "q is infinite");
    in = rmin_golden_inputs[0];
    expect(rmin_jacobian(NULL, J) == RMIN_NULL_POINTER,
           name, "q is NULL");
    expect(rmin_jacobian(in.q, NULL) == RMIN_NULL_POINTER,
           name, "J is NULL");
    expect(is_untouched(&J, sizeof J),
           name, "nothing written for bad inputs");
}

static void test_generalised_mass_matrix(void)
{
    const char *const name = "rmin_generalised_mass_matrix";
    rmin_real M0[4][4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_inputs); ++k) {
        const rmin_golden_input *const in = &rmin_golden_inputs[k];
        const double *right = rmin_golden_generalised_mass_matrix[k];
        expect(rmin_generalised_mass_matrix(in->q, &in->p, M0) == RMIN_OK,
               name, "status of a golden case");
        {
            double found[10];
            size_t at = 0;
            for (size_t i = 0; i < 4; ++i) {
                for (size_t j = 0; j < i + 1; ++j) {
                    found[at++] = (double)M0[i][j];
                    expect(is_same(M0[i][j], M0[j][i]),
                           name, "M0 is symmetric");
                }
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 3e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rmin_golden_input in = rmin_golden_inputs[0];
    memset(&M0, 0xA5, sizeof M0);
    in.q[0] = (rmin_real)NAN;
    expect(rmin_generalised_mass_matrix(in.q, &in.p, M0) == RMIN_NOT_FINITE,
           name, "q is not a number");
    in = rmin_golden_inputs[0];
    in.q[5] = (rmin_real)INFINITY;
    expect(rmin_generalised_mass_matrix(in.q, &in.p, M0) == RMIN_NOT_FINITE,
           name, "q is infinite");
    in = rmin_golden_inputs[0];
    ++in.p.layout;
    expect(rmin_generalised_mass_matrix(in.q, &in.p, M0) == RMIN_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rmin_golden_inputs[0];
    in.p.rotor_inertia[0] = (rmin_real)NAN;
    expect(rmin_generalised_mass_matrix(in.q, &in.p, M0) == RMIN_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rmin_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(rmin_generalised_mass_matrix(in.q, &in.p, M0) == RMIN_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rmin_golden_inputs[0];
    expect(rmin_generalised_mass_matrix(NULL, &in.p, M0) == RMIN_NULL_POINTER,
           name, "q is NULL");
    expect(rmin_generalised_mass_matrix(in.q, NULL, M0) == RMIN_NULL_POINTER,
           name, "p is NULL");
    expect(rmin_generalised_mass_matrix(in.q, &in.p, NULL) == RMIN_NULL_POINTER,
           name, "M0 is NULL");
    expect(is_untouched(&M0, sizeof M0),
           name, "nothing written for bad inputs");
}

static void test_stiffness_matrix(void)
{
    const char *const name = "rmin_stiffness_matrix";
    rmin_real K0[4][4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_inputs); ++k) {
        const rmin_golden_input *const in = &rmin_golden_inputs[k];
        const double *right = rmin_golden_stiffness_matrix[k];
        expect(rmin_stiffness_matrix(in->q, &in->p, K0) == RMIN_OK,
               name, "status of a golden case");
        {
            double found[10];
            size_t at = 0;
            for (size_t i = 0; i < 4; ++i) {
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

    rmin_golden_input in = rmin_golden_inputs[0];
    memset(&K0, 0xA5, sizeof K0);
    in.q[0] = (rmin_real)NAN;
    expect(rmin_stiffness_matrix(in.q, &in.p, K0) == RMIN_NOT_FINITE,
           name, "q is not a number");
    in = rmin_golden_inputs[0];
    in.q[5] = (rmin_real)INFINITY;
    expect(rmin_stiffness_matrix(in.q, &in.p, K0) == RMIN_NOT_FINITE,
           name, "q is infinite");
    in = rmin_golden_inputs[0];
    ++in.p.layout;
    expect(rmin_stiffness_matrix(in.q, &in.p, K0) == RMIN_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rmin_golden_inputs[0];
    in.p.position_gain[0] = (rmin_real)NAN;
    expect(rmin_stiffness_matrix(in.q, &in.p, K0) == RMIN_NOT_FINITE,
           name, "position_gain is not a number");
    in = rmin_golden_inputs[0];
    in.p.position_gain[5] = -1.0;
    expect(rmin_stiffness_matrix(in.q, &in.p, K0) == RMIN_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = rmin_golden_inputs[0];
    expect(rmin_stiffness_matrix(NULL, &in.p, K0) == RMIN_NULL_POINTER,
           name, "q is NULL");
    expect(rmin_stiffness_matrix(in.q, NULL, K0) == RMIN_NULL_POINTER,
           name, "p is NULL");
    expect(rmin_stiffness_matrix(in.q, &in.p, NULL) == RMIN_NULL_POINTER,
           name, "K0 is NULL");
    expect(is_untouched(&K0, sizeof K0),
           name, "nothing written for bad inputs");
}

static void test_contact_jacobian(void)
{
    const char *const name = "rmin_contact_jacobian";
    rmin_real J_c[4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_inputs); ++k) {
        const rmin_golden_input *const in = &rmin_golden_inputs[k];
        const double *right = rmin_golden_contact_jacobian[k];
        expect(rmin_contact_jacobian(in->q, in->n, J_c) == RMIN_OK,
               name, "status of a golden case");
        {
            double found[4];
            for (size_t i = 0; i < 4; ++i) {
                found[i] = (double)J_c[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 3e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rmin_golden_input in = rmin_golden_inputs[0];
    memset(&J_c, 0xA5, sizeof J_c);
    in.q[0] = (rmin_real)NAN;
    expect(rmin_contact_jacobian(in.q, in.n, J_c) == RMIN_NOT_FINITE,
           name, "q is not a number");
    in = rmin_golden_inputs[0];
    in.q[5] = (rmin_real)INFINITY;
    expect(rmin_contact_jacobian(in.q, in.n, J_c) == RMIN_NOT_FINITE,
           name, "q is infinite");
    in = rmin_golden_inputs[0];
    in.n[1] = (rmin_real)NAN;
    expect(rmin_contact_jacobian(in.q, in.n, J_c) == RMIN_NOT_FINITE,
           name, "n is not a number");
    in = rmin_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rmin_contact_jacobian(in.q, in.n, J_c) == RMIN_ZERO_DIRECTION,
           name, "n is zero");
    in = rmin_golden_inputs[0];
    expect(rmin_contact_jacobian(NULL, in.n, J_c) == RMIN_NULL_POINTER,
           name, "q is NULL");
    expect(rmin_contact_jacobian(in.q, NULL, J_c) == RMIN_NULL_POINTER,
           name, "n is NULL");
    expect(rmin_contact_jacobian(in.q, in.n, NULL) == RMIN_NULL_POINTER,
           name, "J_c is NULL");
    expect(is_untouched(&J_c, sizeof J_c),
           name, "nothing written for bad inputs");
}

static void test_reflected_mass(void)
{
    const char *const name = "rmin_reflected_mass";
    rmin_real m_c;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_inputs); ++k) {
        const rmin_golden_input *const in = &rmin_golden_inputs[k];
        const double *right = rmin_golden_reflected_mass[k];
        expect(rmin_reflected_mass(in->q, in->n, &in->p, &m_c) == RMIN_OK,
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

    rmin_golden_input in = rmin_golden_inputs[0];
    memset(&m_c, 0xA5, sizeof m_c);
    in.q[0] = (rmin_real)NAN;
    expect(rmin_reflected_mass(in.q, in.n, &in.p, &m_c) == RMIN_NOT_FINITE,
           name, "q is not a number");
    in = rmin_golden_inputs[0];
    in.q[5] = (rmin_real)INFINITY;
    expect(rmin_reflected_mass(in.q, in.n, &in.p, &m_c) == RMIN_NOT_FINITE,
           name, "q is infinite");
    in = rmin_golden_inputs[0];
    ++in.p.layout;
    expect(rmin_reflected_mass(in.q, in.n, &in.p, &m_c) == RMIN_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rmin_golden_inputs[0];
    in.n[1] = (rmin_real)NAN;
    expect(rmin_reflected_mass(in.q, in.n, &in.p, &m_c) == RMIN_NOT_FINITE,
           name, "n is not a number");
    in = rmin_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rmin_reflected_mass(in.q, in.n, &in.p, &m_c) == RMIN_ZERO_DIRECTION,
           name, "n is zero");
    in = rmin_golden_inputs[0];
    in.p.rotor_inertia[0] = (rmin_real)NAN;
    expect(rmin_reflected_mass(in.q, in.n, &in.p, &m_c) == RMIN_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rmin_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(rmin_reflected_mass(in.q, in.n, &in.p, &m_c) == RMIN_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rmin_golden_inputs[0];
    expect(rmin_reflected_mass(NULL, in.n, &in.p, &m_c) == RMIN_NULL_POINTER,
           name, "q is NULL");
    expect(rmin_reflected_mass(in.q, NULL, &in.p, &m_c) == RMIN_NULL_POINTER,
           name, "n is NULL");
    expect(rmin_reflected_mass(in.q, in.n, NULL, &m_c) == RMIN_NULL_POINTER,
           name, "p is NULL");
    expect(rmin_reflected_mass(in.q, in.n, &in.p, NULL) == RMIN_NULL_POINTER,
           name, "m_c is NULL");
    expect(is_untouched(&m_c, sizeof m_c),
           name, "nothing written for bad inputs");
}

static void test_reduced_model(void)
{
    const char *const name = "rmin_reduced_model";
    rmin_reduced_model_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_inputs); ++k) {
        const rmin_golden_input *const in = &rmin_golden_inputs[k];
        const double *right = rmin_golden_reduced_model[k];
        expect(rmin_reduced_model(in->q, in->n, &in->p, &out) == RMIN_OK,
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
    const double bound = BOUND(1e-12, 7e-05);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rmin_golden_input in = rmin_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (rmin_real)NAN;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "q is not a number");
    in = rmin_golden_inputs[0];
    in.q[5] = (rmin_real)INFINITY;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "q is infinite");
    in = rmin_golden_inputs[0];
    ++in.p.layout;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rmin_golden_inputs[0];
    in.n[1] = (rmin_real)NAN;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "n is not a number");
    in = rmin_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_ZERO_DIRECTION,
           name, "n is zero");
    in = rmin_golden_inputs[0];
    in.p.rotor_inertia[0] = (rmin_real)NAN;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rmin_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rmin_golden_inputs[0];
    in.p.position_gain[0] = (rmin_real)NAN;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "position_gain is not a number");
    in = rmin_golden_inputs[0];
    in.p.position_gain[5] = -1.0;
    expect(rmin_reduced_model(in.q, in.n, &in.p, &out) == RMIN_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = rmin_golden_inputs[0];
    expect(rmin_reduced_model(NULL, in.n, &in.p, &out) == RMIN_NULL_POINTER,
           name, "q is NULL");
    expect(rmin_reduced_model(in.q, NULL, &in.p, &out) == RMIN_NULL_POINTER,
           name, "n is NULL");
    expect(rmin_reduced_model(in.q, in.n, NULL, &out) == RMIN_NULL_POINTER,
           name, "p is NULL");
    expect(rmin_reduced_model(in.q, in.n, &in.p, NULL) == RMIN_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_chain(void)
{
    const char *const name = "rmin_chain";
    rmin_chain_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_inputs); ++k) {
        const rmin_golden_input *const in = &rmin_golden_inputs[k];
        const double *right = rmin_golden_chain[k];
        expect(rmin_chain(in->q, in->n, &in->p, &out) == RMIN_OK,
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
    const double bound = BOUND(1e-12, 0.0003);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rmin_golden_input in = rmin_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (rmin_real)NAN;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "q is not a number");
    in = rmin_golden_inputs[0];
    in.q[5] = (rmin_real)INFINITY;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "q is infinite");
    in = rmin_golden_inputs[0];
    ++in.p.layout;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rmin_golden_inputs[0];
    in.n[1] = (rmin_real)NAN;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "n is not a number");
    in = rmin_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_ZERO_DIRECTION,
           name, "n is zero");
    in = rmin_golden_inputs[0];
    in.p.rotor_inertia[0] = (rmin_real)NAN;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rmin_golden_inputs[0];
    in.p.rotor_inertia[5] = -1.0;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rmin_golden_inputs[0];
    in.p.position_gain[0] = (rmin_real)NAN;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_NOT_FINITE,
           name, "position_gain is not a number");
    in = rmin_golden_inputs[0];
    in.p.position_gain[5] = -1.0;
    expect(rmin_chain(in.q, in.n, &in.p, &out) == RMIN_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = rmin_golden_inputs[0];
    expect(rmin_chain(NULL, in.n, &in.p, &out) == RMIN_NULL_POINTER,
           name, "q is NULL");
    expect(rmin_chain(in.q, NULL, &in.p, &out) == RMIN_NULL_POINTER,
           name, "n is NULL");
    expect(rmin_chain(in.q, in.n, NULL, &out) == RMIN_NULL_POINTER,
           name, "p is NULL");
    expect(rmin_chain(in.q, in.n, &in.p, NULL) == RMIN_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_configuration(void)
{
    const char *const name = "rmin_configuration";
    rmin_real q[6];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_motors); ++k) {
        const rmin_real *const motors = rmin_golden_motors[k];
        expect(rmin_configuration(motors, NULL, q) == RMIN_OK, name, "status of a golden case");
        for (int again = 0; again < 2; ++again) {
            double found[6];
            for (size_t i = 0; i < 6; ++i) {
                found[i] = (double)q[i];
            }
            worst = fmax(worst, error_of(found, rmin_golden_configurations[k], 6));
            expect(rmin_configuration(motors, q, q) == RMIN_OK, name, "status from its own result");
        }
    }
    const double bound = BOUND(1e-12, 7e-07);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rmin_real motors[2];
    memcpy(motors, rmin_golden_motors[0], sizeof motors);
    rmin_real last[6];
    memcpy(last, q, sizeof q);
    memset(q, 0xA5, sizeof q);
    expect(rmin_configuration(NULL, last, q) == RMIN_NULL_POINTER, name, "motors is NULL");
    expect(rmin_configuration(motors, last, NULL) == RMIN_NULL_POINTER, name, "q is NULL");
    last[5] = (rmin_real)INFINITY;
    expect(rmin_configuration(motors, last, q) == RMIN_NOT_FINITE, name, "start is infinite");
    motors[0] = (rmin_real)NAN;
    expect(rmin_configuration(motors, NULL, q) == RMIN_NOT_FINITE, name, "a motor is not a number");
    motors[0] = (rmin_real)1e6;
    expect(rmin_configuration(motors, NULL, q) == RMIN_NO_EQUILIBRIUM, name, "out of reach");
    expect(is_untouched(q, sizeof q), name, "nothing written for bad inputs");
}

/* What a golden impact hits. */
static int golden_region(const rmin_golden_impact *in, rmin_region *region)
{
    return rmin_body_region(in->part, in->clamped, region);
}

static void test_impacts(void)
{
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rmin_golden_impacts); ++k) {
        const rmin_golden_impact *const in = &rmin_golden_impacts[k];
        rmin_region region;
        rmin_peak_force_t peak = {0, 0};
        rmin_peak_force_t again = {0, 0};
        rmin_safe_speed_t safe = {0, 0};
        expect(golden_region(in, &region) == RMIN_OK, "rmin_body_region", "status");
        const int found = rmin_peak_force(in->q, in->n, in->speed, &region, &in->p, &peak);
        if (found == RMIN_BOUNDED) { /* a servo that float has too few digits for */
            expect((double)peak.force >= in->force, "rmin_peak_force", "bound of a golden impact");
            continue;
        }
        expect(found == RMIN_OK, "rmin_peak_force", "status of a golden impact");
        worst = fmax(worst, fabs((double)peak.force/in->force - 1.0));
        expect(peak.time > 0, "rmin_peak_force", "time of the peak");
        const int kept = rmin_safe_speed(in->q, in->n, peak.force, &region, &in->p, &safe);
        expect(kept == RMIN_OK || kept == RMIN_BOUNDED, "rmin_safe_speed", "status of a golden impact");
        expect(rmin_peak_force(in->q, in->n, safe.speed, &region, &in->p, &again) == RMIN_OK
                   && again.force <= peak.force,
               "rmin_safe_speed", "force at the speed found");
        expect(safe.force <= peak.force && safe.speed > 0, "rmin_safe_speed", "is safe");

        rmin_params few = in->p;
        few.steps = 3;
        const int status = rmin_peak_force(in->q, in->n, in->speed, &region, &few, &again);
        expect(status == RMIN_UNRESOLVED || (status == RMIN_BOUNDED && (double)again.force >= in->force),
               "rmin_peak_force", "bound when steps are used up");
    }
    const double bound = 0.002;
    printf("%-40s error %.1e, bound %.1e\n", "rmin_peak_force", worst, bound);
    expect(worst <= bound, "rmin_peak_force", "error within its bound");
}

static void test_bad_impacts(void)
{
    const rmin_golden_impact in = rmin_golden_impacts[0];
    rmin_region good;
    rmin_peak_force_t peak;
    rmin_safe_speed_t safe;
    memset(&peak, 0xA5, sizeof peak);
    memset(&safe, 0xA5, sizeof safe);
    expect(rmin_body_region(-1, 0, &good) == RMIN_OUT_OF_RANGE, "rmin_body_region", "no such part");
    expect(rmin_body_region(12, 0, &good) == RMIN_OUT_OF_RANGE, "rmin_body_region", "no such part");
    expect(rmin_body_region(0, 0, NULL) == RMIN_NULL_POINTER, "rmin_body_region", "NULL");
    expect(rmin_body_region(0, 0, &good) == RMIN_OK, "rmin_body_region", "status");
    expect(rmin_peak_force(in.q, in.n, 0, &good, &in.p, &peak) == RMIN_OUT_OF_RANGE,
           "rmin_peak_force", "speed or limit is zero");
    expect(rmin_safe_speed(in.q, in.n, 0, &good, &in.p, &safe) == RMIN_OUT_OF_RANGE,
           "rmin_safe_speed", "speed or limit is zero");
    expect(rmin_peak_force(in.q, in.n, -1, &good, &in.p, &peak) == RMIN_OUT_OF_RANGE,
           "rmin_peak_force", "speed or limit is negative");
    expect(rmin_safe_speed(in.q, in.n, -1, &good, &in.p, &safe) == RMIN_OUT_OF_RANGE,
           "rmin_safe_speed", "speed or limit is negative");
    expect(rmin_peak_force(in.q, in.n, (rmin_real)NAN, &good, &in.p, &peak) == RMIN_NOT_FINITE,
           "rmin_peak_force", "speed or limit is not a number");
    expect(rmin_safe_speed(in.q, in.n, (rmin_real)NAN, &good, &in.p, &safe) == RMIN_NOT_FINITE,
           "rmin_safe_speed", "speed or limit is not a number");
    expect(rmin_peak_force(in.q, in.n, 1, NULL, &in.p, &peak) == RMIN_NULL_POINTER,
           "rmin_peak_force", "region is NULL");
    expect(rmin_safe_speed(in.q, in.n, 1, NULL, &in.p, &safe) == RMIN_NULL_POINTER,
           "rmin_safe_speed", "region is NULL");

    {
        rmin_region bad = good;
        bad.stiffness = 0;
    expect(rmin_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == RMIN_OUT_OF_RANGE,
               "rmin_peak_force", "stiffness is 0");
        expect(rmin_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == RMIN_OUT_OF_RANGE,
               "rmin_safe_speed", "stiffness is 0");

    }
    {
        rmin_region bad = good;
        bad.damping = -1;
    expect(rmin_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == RMIN_OUT_OF_RANGE,
               "rmin_peak_force", "damping is -1");
        expect(rmin_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == RMIN_OUT_OF_RANGE,
               "rmin_safe_speed", "damping is -1");

    }
    {
        rmin_region bad = good;
        bad.effective_mass = 0;
    expect(rmin_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == RMIN_OUT_OF_RANGE,
               "rmin_peak_force", "effective_mass is 0");
        expect(rmin_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == RMIN_OUT_OF_RANGE,
               "rmin_safe_speed", "effective_mass is 0");

    }
    {
        rmin_region bad = good;
        bad.hertz_stiffness = (rmin_real)INFINITY;
    expect(rmin_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == RMIN_NOT_FINITE,
               "rmin_peak_force", "hertz_stiffness is (rmin_real)INFINITY");
        expect(rmin_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == RMIN_NOT_FINITE,
               "rmin_safe_speed", "hertz_stiffness is (rmin_real)INFINITY");

    }
    {
        rmin_golden_impact bad = in;
        bad.p.layout = 0;
        expect(rmin_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RMIN_FOREIGN_PARAMS,
               "rmin_peak_force", "layout is 0");
    }
    {
        rmin_golden_impact bad = in;
        bad.p.horizon = 0;
        expect(rmin_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RMIN_OUT_OF_RANGE,
               "rmin_peak_force", "horizon is 0");
    }
    {
        rmin_golden_impact bad = in;
        bad.p.reaction_time = -1;
        expect(rmin_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RMIN_OUT_OF_RANGE,
               "rmin_peak_force", "reaction_time is -1");
    }
    {
        rmin_golden_impact bad = in;
        bad.p.motors = 4;
        expect(rmin_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RMIN_OUT_OF_RANGE,
               "rmin_peak_force", "motors is 4");
    }
    {
        rmin_golden_impact bad = in;
        bad.p.steps = 0;
        expect(rmin_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RMIN_OUT_OF_RANGE,
               "rmin_peak_force", "steps is 0");
    }
    const rmin_real nowhere[3] = {0, 0, 0};
    expect(rmin_peak_force(in.q, nowhere, 1, &good, &in.p, &peak) == RMIN_ZERO_DIRECTION,
           "rmin_peak_force", "n is zero");
    expect(is_untouched(&peak, sizeof peak) && is_untouched(&safe, sizeof safe), "impacts", "nothing written for bad inputs");
}

#define POSES LENGTH(rmin_golden_impacts)

/* The best of some poses, one call of rmin_peak_force after the other; -1 if none is usable. */
static int best_of(const rmin_real poses[][6], int count, const unsigned char *allowed,
    const rmin_golden_impact *in, const rmin_region *region, rmin_real *force)
{
    int best = -1;
    for (int i = 0; i < count; ++i) {
        rmin_peak_force_t peak;
        if (allowed[i] != 0 && rmin_peak_force(poses[i], in->n, in->speed, region, &in->p, &peak) == RMIN_OK
            && (best < 0 || peak.force < *force)) {
            best = i;
            *force = peak.force;
        }
    }
    return best;
}

static void check_selection(const rmin_real poses[][6], int count, const rmin_golden_impact *in)
{
    unsigned char allowed[12];
    rmin_region region;
    rmin_selection_t found;
    rmin_selection_t rest;
    rmin_real force = 0;
    rmin_real next = 0;
    memset(allowed, 1, sizeof allowed);
    expect(golden_region(in, &region) == RMIN_OK, "rmin_body_region", "status");
    const int best = best_of(poses, count, allowed, in, &region, &force);
    if (best < 0) { /* all are bounded */
        return;
    }
    expect(rmin_select_configuration(poses, count, NULL, in->n, in->speed, &region, &in->p, &found) == RMIN_OK,
           "rmin_select_configuration", "status");
    expect(found.best == best && is_same(found.force, force), "rmin_select_configuration", "is the best");
    allowed[best] = 0;
    const int second = best_of(poses, count, allowed, in, &region, &next);
    expect(found.second == second && is_same(found.margin, second < 0 ? 0 : next - force), "rmin_select_configuration", "second best");
    const int others = rmin_select_configuration(poses, count, allowed, in->n, in->speed, &region, &in->p, &rest);
    expect(second < 0 ? others == RMIN_SINGULAR
                      : others == RMIN_OK && rest.best == second && rest.usable == found.usable - 1,
           "rmin_select_configuration", "leaves out what is not allowed");
    memset(allowed, 0, sizeof allowed);
    memset(&rest, 0xA5, sizeof rest);
    expect(rmin_select_configuration(poses, count, allowed, in->n, in->speed, &region, &in->p, &rest) == RMIN_SINGULAR
               && rmin_select_configuration(poses, 0, NULL, in->n, in->speed, &region, &in->p, &rest) == RMIN_SINGULAR,
           "rmin_select_configuration", "no pose is left");
    expect(rmin_select_configuration(NULL, 1, NULL, in->n, in->speed, &region, &in->p, &rest) == RMIN_NULL_POINTER
               && rmin_select_configuration(poses, count, NULL, in->n, 0, &region, &in->p, &rest) == RMIN_OUT_OF_RANGE,
           "rmin_select_configuration", "bad inputs");
    expect(is_untouched(&rest, sizeof rest), "rmin_select_configuration", "nothing written for bad inputs");
}

static void test_selection(void)
{
    static rmin_real poses[POSES][6];
    for (size_t k = 0; k < POSES; ++k) {
        memcpy(poses[k], rmin_golden_impacts[k].q, sizeof poses[k]);
    }
    for (size_t k = 0; k < POSES; ++k) {
        const rmin_golden_impact *const in = &rmin_golden_impacts[k];
        check_selection((const rmin_real (*)[6])poses, (int)POSES, in);
        check_selection(rmin_candidates, RMIN_CANDIDATES, in);
    }
}

static void test_common(void)
{
    rmin_params p;
    expect(rmin_default_params(&p) == RMIN_OK,
           "rmin_default_params", "status");
    expect(rmin_default_params(NULL) == RMIN_NULL_POINTER,
           "rmin_default_params", "NULL");
    rmin_params other;
    memset(&other, 0xA5, sizeof other);
    expect(rmin_fill_params(&other, RMIN_LAYOUT + 4u) == RMIN_FOREIGN_PARAMS,
           "rmin_fill_params", "other layout");
    expect(is_untouched(&other, sizeof other), "rmin_fill_params", "nothing written for bad inputs");
    expect(strcmp(rmin_version(), RMIN_VERSION) == 0, "rmin_version", "is the header's");
    expect(strcmp(rmin_model_digest(), RMIN_MODEL_DIGEST) == 0, "rmin_model_digest", "is the header's");
    for (int status = -1; status <= 11; ++status) {
        expect(strlen(rmin_status_text(status)) > 0, "rmin_status_text", "has a text");
    }
    expect(strcmp(rmin_status_text(11), rmin_status_text(RMIN_OK)) != 0,
           "rmin_status_text", "unknown status");
}

int main(void)
{
    test_common();
    test_configuration();
    test_mass_matrix();
    test_jacobian();
    test_generalised_mass_matrix();
    test_stiffness_matrix();
    test_contact_jacobian();
    test_reflected_mass();
    test_reduced_model();
    test_chain();
    test_impacts();
    test_bad_impacts();
    test_selection();
    printf(failures == 0 ? "all passed\n" : "%d failed\n", failures);
    return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
