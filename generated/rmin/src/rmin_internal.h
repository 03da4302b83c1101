/* SPDX-License-Identifier: 0BSD */
/* What the sources of rmin share; not for their users. */
#ifndef RMIN_INTERNAL_H
#define RMIN_INTERNAL_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "rmin.h"

#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "rmin checks for numbers that are not finite: build it without -ffast-math"
#endif

#if defined(RMIN_USE_FLOAT)
#define RMIN_R(x) x##f
#define RMIN_F(function) function##f
#define RMIN_REAL_MAX FLT_MAX
#define RMIN_EPSILON FLT_EPSILON
#else
#define RMIN_R(x) x
#define RMIN_F(function) function
#define RMIN_REAL_MAX DBL_MAX
#define RMIN_EPSILON DBL_EPSILON
#endif

#define RMIN_SIN(x) RMIN_F(sin)(x)
#define RMIN_COS(x) RMIN_F(cos)(x)
#define RMIN_EXP(x) RMIN_F(exp)(x)
#define RMIN_LOG(x) RMIN_F(log)(x)
#define RMIN_SQRT(x) RMIN_F(sqrt)(x)
#define RMIN_FABS(x) RMIN_F(fabs)(x)
#define RMIN_FMIN(x, y) RMIN_F(fmin)(x, y)
#define RMIN_FMAX(x, y) RMIN_F(fmax)(x, y)
#define RMIN_COPYSIGN(x, y) RMIN_F(copysign)(x, y)
#define RMIN_CBRT(x) RMIN_F(cbrt)(x)
#define RMIN_POW(x, y) RMIN_F(pow)(x, y)

/* Sines s and cosines c of finite angles x. */
void rmin_sines_cosines(const rmin_real *x, int count, rmin_real *s, rmin_real *c);

/*
 * Whether all of up to a thousand numbers are finite: only then is the sum of a thousandth of each.
 * A comparison with a NaN is false.
 */
static inline bool rmin_all_finite(const rmin_real *x, int count)
{
    rmin_real sum = RMIN_R(0.0);
    for (int i = 0; i < count; ++i) {
        sum += RMIN_R(0.0009765625)*x[i];
    }
    return RMIN_FABS(sum) <= RMIN_REAL_MAX;
}

/* Status of inputs that must be greater than 0. */
static inline int rmin_check_positive(const rmin_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] > RMIN_R(0.0) && x[i] <= RMIN_REAL_MAX)) {
            return rmin_all_finite(&x[i], 1) ? RMIN_OUT_OF_RANGE : RMIN_NOT_FINITE;
        }
    }
    return RMIN_OK;
}

/* Status of inputs that must be 0 or greater. */
static inline int rmin_check_not_negative(const rmin_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= RMIN_R(0.0) && x[i] <= RMIN_REAL_MAX)) {
            return rmin_all_finite(&x[i], 1) ? RMIN_OUT_OF_RANGE : RMIN_NOT_FINITE;
        }
    }
    return RMIN_OK;
}

/* Status of inputs that must be from 0 to 1. */
static inline int rmin_check_share(const rmin_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= RMIN_R(0.0) && x[i] <= RMIN_R(1.0))) {
            return rmin_all_finite(&x[i], 1) ? RMIN_OUT_OF_RANGE : RMIN_NOT_FINITE;
        }
    }
    return RMIN_OK;
}

/* Status of inputs that may be any number. */
static inline int rmin_check_finite(const rmin_real *x, int count)
{
    return rmin_all_finite(x, count) ? RMIN_OK : RMIN_NOT_FINITE;
}

/* Unit vector u along n; scaled first, so that no square over- or underflows. */
static inline int rmin_unit_vector(const rmin_real n[3], rmin_real u[3])
{
    if (!rmin_all_finite(n, 3)) {
        return RMIN_NOT_FINITE;
    }
    const rmin_real xy = RMIN_FMAX(RMIN_FABS(n[0]), RMIN_FABS(n[1]));
    const rmin_real largest = RMIN_FMAX(xy, RMIN_FABS(n[2]));
    if (!(largest > RMIN_R(0.0))) {
        return RMIN_ZERO_DIRECTION;
    }
    const rmin_real x = n[0]/largest;
    const rmin_real y = n[1]/largest;
    const rmin_real z = n[2]/largest;
    const rmin_real scale = RMIN_R(1.0)/RMIN_SQRT(x*x + y*y + z*z);
    u[0] = x*scale;
    u[1] = y*scale;
    u[2] = z*scale;
    return RMIN_OK;
}

/* What the impacts' runtime knows of this robot. */
#define RMIN_N 4 /* independent joints */
#define RMIN_ELASTIC 0 /* a spring behind every motor */
#define RMIN_POTENTIAL 1 /* gravity, or springs of the model file */
#define RMIN_DAMPED 0 /* joints have damping of their own */
#define RMIN_STRUCTURED (RMIN_ELASTIC && !RMIN_POTENTIAL && !RMIN_DAMPED)
#define RMIN_REACH 2 /* directions in which motors move contact points */
#define RMIN_FASTEST RMIN_R(110000.0) /* squared joint velocity for 1 m/s: singular */
#define RMIN_LEAST_MOBILITY RMIN_R(6.67e-05) /* 1/kg; below: singular */

typedef struct {
    rmin_real M[4][4]; /* kg m^2; over the joints */
    rmin_real K[4][4]; /* N m/rad; of springs and gravity */
    rmin_real J[3][4]; /* m/rad; three rows a contact point, base axes */
} rmin_links_t;

/* Links as they arrive at an impact. */
int rmin_links(const rmin_real q[6], const rmin_params *p, rmin_links_t *out);

#define RMIN_FRAMES 0 /* frames of links in which contact points can be given */

extern const rmin_real rmin_directions[RMIN_REACH][3];
extern const bool rmin_has_motor[RMIN_N];
extern const int rmin_independent[RMIN_N];

#define RMIN_INDEPENDENT(i) (rmin_independent[i])
#define RMIN_GAIN(p, i) (rmin_has_motor[i] ? (p)->position_gain[RMIN_INDEPENDENT(i)] : RMIN_R(0.0))
#define RMIN_DAMPING_GAIN(p, i) (rmin_has_motor[i] ? (p)->damping_gain[RMIN_INDEPENDENT(i)] : RMIN_R(0.0))
#define RMIN_REACTION_TIME(p) ((p)->reaction_time)
#define RMIN_HORIZON(p) ((p)->horizon)
#define RMIN_LINKS_OF(q, p) q, p

#endif
