/* SPDX-License-Identifier: 0BSD */
/* Compares rr with its golden results and feeds it bad inputs; 1 on failure. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "golden.h"

#if defined(RR_USE_FLOAT)
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

static int is_same(rr_real a, rr_real b)
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
    const char *const name = "rr_mass_matrix";
    rr_real M[4][4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_mass_matrix[k];
        expect(rr_mass_matrix(in->q, M) == RR_OK,
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
    const double bound = BOUND(1e-12, 5e-07);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rr_golden_input in = rr_golden_inputs[0];
    memset(&M, 0xA5, sizeof M);
    in.q[0] = (rr_real)NAN;
    expect(rr_mass_matrix(in.q, M) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_mass_matrix(in.q, M) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    expect(rr_mass_matrix(NULL, M) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_mass_matrix(in.q, NULL) == RR_NULL_POINTER,
           name, "M is NULL");
    expect(is_untouched(&M, sizeof M),
           name, "nothing written for bad inputs");
}

static void test_jacobian(void)
{
    const char *const name = "rr_jacobian";
    rr_real J[3][4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_jacobian[k];
        expect(rr_jacobian(in->q, J) == RR_OK,
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
    const double bound = BOUND(1e-12, 9e-07);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rr_golden_input in = rr_golden_inputs[0];
    memset(&J, 0xA5, sizeof J);
    in.q[0] = (rr_real)NAN;
    expect(rr_jacobian(in.q, J) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_jacobian(in.q, J) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    expect(rr_jacobian(NULL, J) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_jacobian(in.q, NULL) == RR_NULL_POINTER,
           name, "J is NULL");
    expect(is_untouched(&J, sizeof J),
           name, "nothing written for bad inputs");
}

static void test_generalised_mass_matrix(void)
{
    const char *const name = "rr_generalised_mass_matrix";
    rr_real M0[4][4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_generalised_mass_matrix[k];
        expect(rr_generalised_mass_matrix(in->q, &in->p, M0) == RR_OK,
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
    const double bound = BOUND(1e-12, 5e-07);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rr_golden_input in = rr_golden_inputs[0];
    memset(&M0, 0xA5, sizeof M0);
    in.q[0] = (rr_real)NAN;
    expect(rr_generalised_mass_matrix(in.q, &in.p, M0) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_generalised_mass_matrix(in.q, &in.p, M0) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    ++in.p.layout;
    expect(rr_generalised_mass_matrix(in.q, &in.p, M0) == RR_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[0] = (rr_real)NAN;
    expect(rr_generalised_mass_matrix(in.q, &in.p, M0) == RR_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[3] = -1.0;
    expect(rr_generalised_mass_matrix(in.q, &in.p, M0) == RR_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rr_golden_inputs[0];
    expect(rr_generalised_mass_matrix(NULL, &in.p, M0) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_generalised_mass_matrix(in.q, NULL, M0) == RR_NULL_POINTER,
           name, "p is NULL");
    expect(rr_generalised_mass_matrix(in.q, &in.p, NULL) == RR_NULL_POINTER,
           name, "M0 is NULL");
    expect(is_untouched(&M0, sizeof M0),
           name, "nothing written for bad inputs");
}

static void test_stiffness_matrix(void)
{
    const char *const name = "rr_stiffness_matrix";
    rr_real K0[4][4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_stiffness_matrix[k];
        expect(rr_stiffness_matrix(in->q, &in->p, K0) == RR_OK,
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

    rr_golden_input in = rr_golden_inputs[0];
    memset(&K0, 0xA5, sizeof K0);
    in.q[0] = (rr_real)NAN;
    expect(rr_stiffness_matrix(in.q, &in.p, K0) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_stiffness_matrix(in.q, &in.p, K0) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    ++in.p.layout;
    expect(rr_stiffness_matrix(in.q, &in.p, K0) == RR_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rr_golden_inputs[0];
    in.p.position_gain[0] = (rr_real)NAN;
    expect(rr_stiffness_matrix(in.q, &in.p, K0) == RR_NOT_FINITE,
           name, "position_gain is not a number");
    in = rr_golden_inputs[0];
    in.p.position_gain[3] = -1.0;
    expect(rr_stiffness_matrix(in.q, &in.p, K0) == RR_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = rr_golden_inputs[0];
    expect(rr_stiffness_matrix(NULL, &in.p, K0) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_stiffness_matrix(in.q, NULL, K0) == RR_NULL_POINTER,
           name, "p is NULL");
    expect(rr_stiffness_matrix(in.q, &in.p, NULL) == RR_NULL_POINTER,
           name, "K0 is NULL");
    expect(is_untouched(&K0, sizeof K0),
           name, "nothing written for bad inputs");
}

static void test_contact_jacobian(void)
{
    const char *const name = "rr_contact_jacobian";
    rr_real J_c[4];
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_contact_jacobian[k];
        expect(rr_contact_jacobian(in->q, in->n, J_c) == RR_OK,
               name, "status of a golden case");
        {
            double found[4];
            for (size_t i = 0; i < 4; ++i) {
                found[i] = (double)J_c[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 7e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rr_golden_input in = rr_golden_inputs[0];
    memset(&J_c, 0xA5, sizeof J_c);
    in.q[0] = (rr_real)NAN;
    expect(rr_contact_jacobian(in.q, in.n, J_c) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_contact_jacobian(in.q, in.n, J_c) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    in.n[1] = (rr_real)NAN;
    expect(rr_contact_jacobian(in.q, in.n, J_c) == RR_NOT_FINITE,
           name, "n is not a number");
    in = rr_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rr_contact_jacobian(in.q, in.n, J_c) == RR_ZERO_DIRECTION,
           name, "n is zero");
    in = rr_golden_inputs[0];
    expect(rr_contact_jacobian(NULL, in.n, J_c) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_contact_jacobian(in.q, NULL, J_c) == RR_NULL_POINTER,
           name, "n is NULL");
    expect(rr_contact_jacobian(in.q, in.n, NULL) == RR_NULL_POINTER,
           name, "J_c is NULL");
    expect(is_untouched(&J_c, sizeof J_c),
           name, "nothing written for bad inputs");
}

static void test_reflected_mass(void)
{
    const char *const name = "rr_reflected_mass";
    rr_real m_c;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_reflected_mass[k];
        expect(rr_reflected_mass(in->q, in->n, &in->p, &m_c) == RR_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)m_c;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 9e-06);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rr_golden_input in = rr_golden_inputs[0];
    memset(&m_c, 0xA5, sizeof m_c);
    in.q[0] = (rr_real)NAN;
    expect(rr_reflected_mass(in.q, in.n, &in.p, &m_c) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_reflected_mass(in.q, in.n, &in.p, &m_c) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    ++in.p.layout;
    expect(rr_reflected_mass(in.q, in.n, &in.p, &m_c) == RR_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rr_golden_inputs[0];
    in.n[1] = (rr_real)NAN;
    expect(rr_reflected_mass(in.q, in.n, &in.p, &m_c) == RR_NOT_FINITE,
           name, "n is not a number");
    in = rr_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rr_reflected_mass(in.q, in.n, &in.p, &m_c) == RR_ZERO_DIRECTION,
           name, "n is zero");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[0] = (rr_real)NAN;
    expect(rr_reflected_mass(in.q, in.n, &in.p, &m_c) == RR_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[3] = -1.0;
    expect(rr_reflected_mass(in.q, in.n, &in.p, &m_c) == RR_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rr_golden_inputs[0];
    expect(rr_reflected_mass(NULL, in.n, &in.p, &m_c) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_reflected_mass(in.q, NULL, &in.p, &m_c) == RR_NULL_POINTER,
           name, "n is NULL");
    expect(rr_reflected_mass(in.q, in.n, NULL, &m_c) == RR_NULL_POINTER,
           name, "p is NULL");
    expect(rr_reflected_mass(in.q, in.n, &in.p, NULL) == RR_NULL_POINTER,
           name, "m_c is NULL");
    expect(is_untouched(&m_c, sizeof m_c),
           name, "nothing written for bad inputs");
}

static void test_reduced_model(void)
{
    const char *const name = "rr_reduced_model";
    rr_reduced_model_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_reduced_model[k];
        expect(rr_reduced_model(in->q, in->n, &in->p, &out) == RR_OK,
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

    rr_golden_input in = rr_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (rr_real)NAN;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    ++in.p.layout;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rr_golden_inputs[0];
    in.n[1] = (rr_real)NAN;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "n is not a number");
    in = rr_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_ZERO_DIRECTION,
           name, "n is zero");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[0] = (rr_real)NAN;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[3] = -1.0;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rr_golden_inputs[0];
    in.p.position_gain[0] = (rr_real)NAN;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "position_gain is not a number");
    in = rr_golden_inputs[0];
    in.p.position_gain[3] = -1.0;
    expect(rr_reduced_model(in.q, in.n, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = rr_golden_inputs[0];
    expect(rr_reduced_model(NULL, in.n, &in.p, &out) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_reduced_model(in.q, NULL, &in.p, &out) == RR_NULL_POINTER,
           name, "n is NULL");
    expect(rr_reduced_model(in.q, in.n, NULL, &out) == RR_NULL_POINTER,
           name, "p is NULL");
    expect(rr_reduced_model(in.q, in.n, &in.p, NULL) == RR_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_chain(void)
{
    const char *const name = "rr_chain";
    rr_chain_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_chain[k];
        expect(rr_chain(in->q, in->n, &in->p, &out) == RR_OK,
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

    rr_golden_input in = rr_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (rr_real)NAN;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    ++in.p.layout;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rr_golden_inputs[0];
    in.n[1] = (rr_real)NAN;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "n is not a number");
    in = rr_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_ZERO_DIRECTION,
           name, "n is zero");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[0] = (rr_real)NAN;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[3] = -1.0;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rr_golden_inputs[0];
    in.p.position_gain[0] = (rr_real)NAN;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_NOT_FINITE,
           name, "position_gain is not a number");
    in = rr_golden_inputs[0];
    in.p.position_gain[3] = -1.0;
    expect(rr_chain(in.q, in.n, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "position_gain is -1.0");
    in = rr_golden_inputs[0];
    expect(rr_chain(NULL, in.n, &in.p, &out) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_chain(in.q, NULL, &in.p, &out) == RR_NULL_POINTER,
           name, "n is NULL");
    expect(rr_chain(in.q, in.n, NULL, &out) == RR_NULL_POINTER,
           name, "p is NULL");
    expect(rr_chain(in.q, in.n, &in.p, NULL) == RR_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

static void test_joint_impulse(void)
{
    const char *const name = "rr_joint_impulse";
    rr_joint_impulse_t out;
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_inputs); ++k) {
        const rr_golden_input *const in = &rr_golden_inputs[k];
        const double *right = rr_golden_joint_impulse[k];
        expect(rr_joint_impulse(in->q, in->n, in->speed, in->restitution, in->other_mobility, &in->p, &out) == RR_OK,
               name, "status of a golden case");
        {
            double found[1];
            found[0] = (double)out.contact;
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[4];
            for (size_t i = 0; i < 4; ++i) {
                found[i] = (double)out.joints[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[4];
            for (size_t i = 0; i < 4; ++i) {
                found[i] = (double)out.gears[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
            right += LENGTH(found) + 1;
        }
        {
            double found[4];
            for (size_t i = 0; i < 4; ++i) {
                found[i] = (double)out.velocity_change[i];
            }
            worst = fmax(worst, error_of(found, right, LENGTH(found)));
        }
    }
    const double bound = BOUND(1e-12, 2e-05);
    printf("%-40s error %.1e, bound %.1e\n", name, worst, bound);
    expect(worst <= bound, name, "error within its bound");

    rr_golden_input in = rr_golden_inputs[0];
    memset(&out, 0xA5, sizeof out);
    in.q[0] = (rr_real)NAN;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NOT_FINITE,
           name, "q is not a number");
    in = rr_golden_inputs[0];
    in.q[3] = (rr_real)INFINITY;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NOT_FINITE,
           name, "q is infinite");
    in = rr_golden_inputs[0];
    ++in.p.layout;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_FOREIGN_PARAMS,
           name, "p is of another layout");
    in = rr_golden_inputs[0];
    in.n[1] = (rr_real)NAN;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NOT_FINITE,
           name, "n is not a number");
    in = rr_golden_inputs[0];
    in.n[0] = in.n[1] = in.n[2] = 0;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_ZERO_DIRECTION,
           name, "n is zero");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[0] = (rr_real)NAN;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NOT_FINITE,
           name, "rotor_inertia is not a number");
    in = rr_golden_inputs[0];
    in.p.rotor_inertia[3] = -1.0;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "rotor_inertia is -1.0");
    in = rr_golden_inputs[0];
    in.speed = (rr_real)NAN;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NOT_FINITE,
           name, "speed is not a number");
    in = rr_golden_inputs[0];
    in.speed = -1.0;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "speed is -1.0");
    in = rr_golden_inputs[0];
    in.speed = 0.0;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "speed is 0.0");
    in = rr_golden_inputs[0];
    in.restitution = (rr_real)NAN;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NOT_FINITE,
           name, "restitution is not a number");
    in = rr_golden_inputs[0];
    in.restitution = -1.0;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "restitution is -1.0");
    in = rr_golden_inputs[0];
    in.restitution = 2.0;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "restitution is 2.0");
    in = rr_golden_inputs[0];
    in.other_mobility = (rr_real)NAN;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NOT_FINITE,
           name, "other_mobility is not a number");
    in = rr_golden_inputs[0];
    in.other_mobility = -1.0;
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_OUT_OF_RANGE,
           name, "other_mobility is -1.0");
    in = rr_golden_inputs[0];
    expect(rr_joint_impulse(NULL, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NULL_POINTER,
           name, "q is NULL");
    expect(rr_joint_impulse(in.q, NULL, in.speed, in.restitution, in.other_mobility, &in.p, &out) == RR_NULL_POINTER,
           name, "n is NULL");
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, NULL, &out) == RR_NULL_POINTER,
           name, "p is NULL");
    expect(rr_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, NULL) == RR_NULL_POINTER,
           name, "out is NULL");
    expect(is_untouched(&out, sizeof out),
           name, "nothing written for bad inputs");
}

/* What a golden impact hits. */
static int golden_region(const rr_golden_impact *in, rr_region *region)
{
    return rr_body_region(in->part, in->clamped, region);
}

static void test_impacts(void)
{
    double worst = 0.0;
    for (size_t k = 0; k < LENGTH(rr_golden_impacts); ++k) {
        const rr_golden_impact *const in = &rr_golden_impacts[k];
        rr_region region;
        rr_peak_force_t peak = {0, 0};
        rr_peak_force_t again = {0, 0};
        rr_safe_speed_t safe = {0, 0};
        expect(golden_region(in, &region) == RR_OK, "rr_body_region", "status");
        const int found = rr_peak_force(in->q, in->n, in->speed, &region, &in->p, &peak);
        if (found == RR_BOUNDED) { /* a servo that float has too few digits for */
            expect((double)peak.force >= in->force, "rr_peak_force", "bound of a golden impact");
            continue;
        }
        expect(found == RR_OK, "rr_peak_force", "status of a golden impact");
        worst = fmax(worst, fabs((double)peak.force/in->force - 1.0));
        expect(peak.time > 0, "rr_peak_force", "time of the peak");
        const int kept = rr_safe_speed(in->q, in->n, peak.force, &region, &in->p, &safe);
        expect(kept == RR_OK || kept == RR_BOUNDED, "rr_safe_speed", "status of a golden impact");
        expect(rr_peak_force(in->q, in->n, safe.speed, &region, &in->p, &again) == RR_OK
                   && again.force <= peak.force,
               "rr_safe_speed", "force at the speed found");
        expect(safe.force <= peak.force && safe.speed > 0, "rr_safe_speed", "is safe");

        rr_params few = in->p;
        few.steps = 3;
        const int status = rr_peak_force(in->q, in->n, in->speed, &region, &few, &again);
        expect(status == RR_UNRESOLVED || (status == RR_BOUNDED && (double)again.force >= in->force),
               "rr_peak_force", "bound when steps are used up");
    }
    const double bound = 0.002;
    printf("%-40s error %.1e, bound %.1e\n", "rr_peak_force", worst, bound);
    expect(worst <= bound, "rr_peak_force", "error within its bound");
}

static void test_bad_impacts(void)
{
    const rr_golden_impact in = rr_golden_impacts[0];
    rr_region good;
    rr_peak_force_t peak;
    rr_safe_speed_t safe;
    memset(&peak, 0xA5, sizeof peak);
    memset(&safe, 0xA5, sizeof safe);
    expect(rr_body_region(-1, 0, &good) == RR_OUT_OF_RANGE, "rr_body_region", "no such part");
    expect(rr_body_region(12, 0, &good) == RR_OUT_OF_RANGE, "rr_body_region", "no such part");
    expect(rr_body_region(0, 0, NULL) == RR_NULL_POINTER, "rr_body_region", "NULL");
    expect(rr_body_region(0, 0, &good) == RR_OK, "rr_body_region", "status");
    expect(rr_peak_force(in.q, in.n, 0, &good, &in.p, &peak) == RR_OUT_OF_RANGE,
           "rr_peak_force", "speed or limit is zero");
    expect(rr_safe_speed(in.q, in.n, 0, &good, &in.p, &safe) == RR_OUT_OF_RANGE,
           "rr_safe_speed", "speed or limit is zero");
    expect(rr_peak_force(in.q, in.n, -1, &good, &in.p, &peak) == RR_OUT_OF_RANGE,
           "rr_peak_force", "speed or limit is negative");
    expect(rr_safe_speed(in.q, in.n, -1, &good, &in.p, &safe) == RR_OUT_OF_RANGE,
           "rr_safe_speed", "speed or limit is negative");
    expect(rr_peak_force(in.q, in.n, (rr_real)NAN, &good, &in.p, &peak) == RR_NOT_FINITE,
           "rr_peak_force", "speed or limit is not a number");
    expect(rr_safe_speed(in.q, in.n, (rr_real)NAN, &good, &in.p, &safe) == RR_NOT_FINITE,
           "rr_safe_speed", "speed or limit is not a number");
    expect(rr_peak_force(in.q, in.n, 1, NULL, &in.p, &peak) == RR_NULL_POINTER,
           "rr_peak_force", "region is NULL");
    expect(rr_safe_speed(in.q, in.n, 1, NULL, &in.p, &safe) == RR_NULL_POINTER,
           "rr_safe_speed", "region is NULL");

    {
        rr_region bad = good;
        bad.stiffness = 0;
    expect(rr_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == RR_OUT_OF_RANGE,
               "rr_peak_force", "stiffness is 0");
        expect(rr_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == RR_OUT_OF_RANGE,
               "rr_safe_speed", "stiffness is 0");

    }
    {
        rr_region bad = good;
        bad.damping = -1;
    expect(rr_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == RR_OUT_OF_RANGE,
               "rr_peak_force", "damping is -1");
        expect(rr_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == RR_OUT_OF_RANGE,
               "rr_safe_speed", "damping is -1");

    }
    {
        rr_region bad = good;
        bad.effective_mass = 0;
    expect(rr_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == RR_OUT_OF_RANGE,
               "rr_peak_force", "effective_mass is 0");
        expect(rr_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == RR_OUT_OF_RANGE,
               "rr_safe_speed", "effective_mass is 0");

    }
    {
        rr_region bad = good;
        bad.hertz_stiffness = (rr_real)INFINITY;
    expect(rr_peak_force(in.q, in.n, 1, &bad, &in.p, &peak) == RR_NOT_FINITE,
               "rr_peak_force", "hertz_stiffness is (rr_real)INFINITY");
        expect(rr_safe_speed(in.q, in.n, 1, &bad, &in.p, &safe) == RR_NOT_FINITE,
               "rr_safe_speed", "hertz_stiffness is (rr_real)INFINITY");

    }
    {
        rr_golden_impact bad = in;
        bad.p.layout = 0;
        expect(rr_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RR_FOREIGN_PARAMS,
               "rr_peak_force", "layout is 0");
    }
    {
        rr_golden_impact bad = in;
        bad.p.horizon = 0;
        expect(rr_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RR_OUT_OF_RANGE,
               "rr_peak_force", "horizon is 0");
    }
    {
        rr_golden_impact bad = in;
        bad.p.reaction_time = -1;
        expect(rr_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RR_OUT_OF_RANGE,
               "rr_peak_force", "reaction_time is -1");
    }
    {
        rr_golden_impact bad = in;
        bad.p.motors = 4;
        expect(rr_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RR_OUT_OF_RANGE,
               "rr_peak_force", "motors is 4");
    }
    {
        rr_golden_impact bad = in;
        bad.p.steps = 0;
        expect(rr_peak_force(bad.q, bad.n, 1, &good, &bad.p, &peak) == RR_OUT_OF_RANGE,
               "rr_peak_force", "steps is 0");
    }
    const rr_real nowhere[3] = {0, 0, 0};
    expect(rr_peak_force(in.q, nowhere, 1, &good, &in.p, &peak) == RR_ZERO_DIRECTION,
           "rr_peak_force", "n is zero");
    expect(is_untouched(&peak, sizeof peak) && is_untouched(&safe, sizeof safe), "impacts", "nothing written for bad inputs");
}

#define POSES LENGTH(rr_golden_impacts)

/* The best of some poses, one call of rr_peak_force after the other; -1 if none is usable. */
static int best_of(const rr_real poses[][4], int count, const unsigned char *allowed,
    const rr_golden_impact *in, const rr_region *region, rr_real *force)
{
    int best = -1;
    for (int i = 0; i < count; ++i) {
        rr_peak_force_t peak;
        if (allowed[i] != 0 && rr_peak_force(poses[i], in->n, in->speed, region, &in->p, &peak) == RR_OK
            && (best < 0 || peak.force < *force)) {
            best = i;
            *force = peak.force;
        }
    }
    return best;
}

static void check_selection(const rr_real poses[][4], int count, const rr_golden_impact *in)
{
    unsigned char allowed[12];
    rr_region region;
    rr_selection_t found;
    rr_selection_t rest;
    rr_real force = 0;
    rr_real next = 0;
    memset(allowed, 1, sizeof allowed);
    expect(golden_region(in, &region) == RR_OK, "rr_body_region", "status");
    const int best = best_of(poses, count, allowed, in, &region, &force);
    if (best < 0) { /* all are bounded */
        return;
    }
    expect(rr_select_configuration(poses, count, NULL, in->n, in->speed, &region, &in->p, &found) == RR_OK,
           "rr_select_configuration", "status");
    expect(found.best == best && is_same(found.force, force), "rr_select_configuration", "is the best");
    allowed[best] = 0;
    const int second = best_of(poses, count, allowed, in, &region, &next);
    expect(found.second == second && is_same(found.margin, second < 0 ? 0 : next - force), "rr_select_configuration", "second best");
    const int others = rr_select_configuration(poses, count, allowed, in->n, in->speed, &region, &in->p, &rest);
    expect(second < 0 ? others == RR_SINGULAR
                      : others == RR_OK && rest.best == second && rest.usable == found.usable - 1,
           "rr_select_configuration", "leaves out what is not allowed");
    memset(allowed, 0, sizeof allowed);
    memset(&rest, 0xA5, sizeof rest);
    expect(rr_select_configuration(poses, count, allowed, in->n, in->speed, &region, &in->p, &rest) == RR_SINGULAR
               && rr_select_configuration(poses, 0, NULL, in->n, in->speed, &region, &in->p, &rest) == RR_SINGULAR,
           "rr_select_configuration", "no pose is left");
    expect(rr_select_configuration(NULL, 1, NULL, in->n, in->speed, &region, &in->p, &rest) == RR_NULL_POINTER
               && rr_select_configuration(poses, count, NULL, in->n, 0, &region, &in->p, &rest) == RR_OUT_OF_RANGE,
           "rr_select_configuration", "bad inputs");
    expect(is_untouched(&rest, sizeof rest), "rr_select_configuration", "nothing written for bad inputs");
}

static void test_selection(void)
{
    static rr_real poses[POSES][4];
    for (size_t k = 0; k < POSES; ++k) {
        memcpy(poses[k], rr_golden_impacts[k].q, sizeof poses[k]);
    }
    for (size_t k = 0; k < POSES; ++k) {
        const rr_golden_impact *const in = &rr_golden_impacts[k];
        check_selection((const rr_real (*)[4])poses, (int)POSES, in);
    }
}

static void test_common(void)
{
    rr_params p;
    expect(rr_default_params(&p) == RR_OK,
           "rr_default_params", "status");
    expect(rr_default_params(NULL) == RR_NULL_POINTER,
           "rr_default_params", "NULL");
    rr_params other;
    memset(&other, 0xA5, sizeof other);
    expect(rr_fill_params(&other, RR_LAYOUT + 4u) == RR_FOREIGN_PARAMS,
           "rr_fill_params", "other layout");
    expect(is_untouched(&other, sizeof other), "rr_fill_params", "nothing written for bad inputs");
    expect(strcmp(rr_version(), RR_VERSION) == 0, "rr_version", "is the header's");
    expect(strcmp(rr_model_digest(), RR_MODEL_DIGEST) == 0, "rr_model_digest", "is the header's");
    for (int status = -1; status <= 11; ++status) {
        expect(strlen(rr_status_text(status)) > 0, "rr_status_text", "has a text");
    }
    expect(strcmp(rr_status_text(11), rr_status_text(RR_OK)) != 0,
           "rr_status_text", "unknown status");
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
    test_joint_impulse();
    test_impacts();
    test_bad_impacts();
    test_selection();
    printf(failures == 0 ? "all passed\n" : "%d failed\n", failures);
    return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
