/* SPDX-License-Identifier: 0BSD */
/* What the sources of ur5e share; not for their users. */
#ifndef UR5E_INTERNAL_H
#define UR5E_INTERNAL_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "ur5e.h"

#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "ur5e checks for numbers that are not finite: build it without -ffast-math"
#endif

#if defined(UR5E_USE_FLOAT)
#define UR5E_R(x) x##f
#define UR5E_F(function) function##f
#define UR5E_REAL_MAX FLT_MAX
#else
#define UR5E_R(x) x
#define UR5E_F(function) function
#define UR5E_REAL_MAX DBL_MAX
#endif

#define UR5E_SIN(x) UR5E_F(sin)(x)
#define UR5E_COS(x) UR5E_F(cos)(x)
#define UR5E_EXP(x) UR5E_F(exp)(x)
#define UR5E_LOG(x) UR5E_F(log)(x)
#define UR5E_SQRT(x) UR5E_F(sqrt)(x)
#define UR5E_FABS(x) UR5E_F(fabs)(x)
#define UR5E_FMIN(x, y) UR5E_F(fmin)(x, y)
#define UR5E_FMAX(x, y) UR5E_F(fmax)(x, y)
#define UR5E_COPYSIGN(x, y) UR5E_F(copysign)(x, y)
#define UR5E_POW(x, y) UR5E_F(pow)(x, y)

/* Sines s and cosines c of finite angles x. */
#if defined(UR5E_USE_FLOAT)
void ur5e_sines_cosines(const float *x, int count, float *s, float *c);
#else
static inline void ur5e_sines_cosines(const double *x, int count, double *s, double *c)
{
    for (int i = 0; i < count; ++i) {
        s[i] = sin(x[i]);
        c[i] = cos(x[i]);
    }
}
#endif

/*
 * Whether all of up to a thousand numbers are finite: only then is the sum of a thousandth of each.
 * A comparison with a NaN is false.
 */
static inline bool ur5e_all_finite(const ur5e_real *x, int count)
{
    ur5e_real sum = UR5E_R(0.0);
    for (int i = 0; i < count; ++i) {
        sum += UR5E_R(0.0009765625)*x[i];
    }
    return UR5E_FABS(sum) <= UR5E_REAL_MAX;
}

/* Status of inputs that must be greater than 0. */
static inline int ur5e_check_positive(const ur5e_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] > UR5E_R(0.0) && x[i] <= UR5E_REAL_MAX)) {
            return ur5e_all_finite(&x[i], 1) ? UR5E_OUT_OF_RANGE : UR5E_NOT_FINITE;
        }
    }
    return UR5E_OK;
}

/* Status of inputs that must be 0 or greater. */
static inline int ur5e_check_not_negative(const ur5e_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= UR5E_R(0.0) && x[i] <= UR5E_REAL_MAX)) {
            return ur5e_all_finite(&x[i], 1) ? UR5E_OUT_OF_RANGE : UR5E_NOT_FINITE;
        }
    }
    return UR5E_OK;
}

/* Status of inputs that must be from 0 to 1. */
static inline int ur5e_check_share(const ur5e_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= UR5E_R(0.0) && x[i] <= UR5E_R(1.0))) {
            return ur5e_all_finite(&x[i], 1) ? UR5E_OUT_OF_RANGE : UR5E_NOT_FINITE;
        }
    }
    return UR5E_OK;
}

/* Status of inputs that may be any number. */
static inline int ur5e_check_finite(const ur5e_real *x, int count)
{
    return ur5e_all_finite(x, count) ? UR5E_OK : UR5E_NOT_FINITE;
}

/* Unit vector u along n; scaled first, so that no square over- or underflows. */
static inline int ur5e_unit_vector(const ur5e_real n[3], ur5e_real u[3])
{
    if (!ur5e_all_finite(n, 3)) {
        return UR5E_NOT_FINITE;
    }
    const ur5e_real xy = UR5E_FMAX(UR5E_FABS(n[0]), UR5E_FABS(n[1]));
    const ur5e_real largest = UR5E_FMAX(xy, UR5E_FABS(n[2]));
    if (!(largest > UR5E_R(0.0))) {
        return UR5E_ZERO_DIRECTION;
    }
    const ur5e_real x = n[0]/largest;
    const ur5e_real y = n[1]/largest;
    const ur5e_real z = n[2]/largest;
    const ur5e_real scale = UR5E_R(1.0)/UR5E_SQRT(x*x + y*y + z*z);
    u[0] = x*scale;
    u[1] = y*scale;
    u[2] = z*scale;
    return UR5E_OK;
}

#endif
