/* SPDX-License-Identifier: 0BSD */
/* What the sources of rr share; not for their users. */
#ifndef RR_INTERNAL_H
#define RR_INTERNAL_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "rr.h"

#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "rr checks for numbers that are not finite: build it without -ffast-math"
#endif

#if defined(RR_USE_FLOAT)
#define RR_R(x) x##f
#define RR_F(function) function##f
#define RR_REAL_MAX FLT_MAX
#define RR_EPSILON FLT_EPSILON
#else
#define RR_R(x) x
#define RR_F(function) function
#define RR_REAL_MAX DBL_MAX
#define RR_EPSILON DBL_EPSILON
#endif

#define RR_SIN(x) RR_F(sin)(x)
#define RR_COS(x) RR_F(cos)(x)
#define RR_EXP(x) RR_F(exp)(x)
#define RR_LOG(x) RR_F(log)(x)
#define RR_SQRT(x) RR_F(sqrt)(x)
#define RR_FABS(x) RR_F(fabs)(x)
#define RR_FMIN(x, y) RR_F(fmin)(x, y)
#define RR_FMAX(x, y) RR_F(fmax)(x, y)
#define RR_COPYSIGN(x, y) RR_F(copysign)(x, y)
#define RR_CBRT(x) RR_F(cbrt)(x)
#define RR_POW(x, y) RR_F(pow)(x, y)

/* Sines s and cosines c of finite angles x. */
void rr_sines_cosines(const rr_real *x, int count, rr_real *s, rr_real *c);

/* inv(M + diag b) j', then j inv(M + diag b) j'. */
void rr_pushed_entries(const rr_real M[10], const rr_real b[4], const rr_real j[4], rr_real out[5]);

/*
 * Whether all of up to a thousand numbers are finite: only then is the sum of a thousandth of each.
 * A comparison with a NaN is false.
 */
static inline bool rr_all_finite(const rr_real *x, int count)
{
    rr_real sum = RR_R(0.0);
    for (int i = 0; i < count; ++i) {
        sum += RR_R(0.0009765625)*x[i];
    }
    return RR_FABS(sum) <= RR_REAL_MAX;
}

/* Status of inputs that must be greater than 0. */
static inline int rr_check_positive(const rr_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] > RR_R(0.0) && x[i] <= RR_REAL_MAX)) {
            return rr_all_finite(&x[i], 1) ? RR_OUT_OF_RANGE : RR_NOT_FINITE;
        }
    }
    return RR_OK;
}

/* Status of inputs that must be 0 or greater. */
static inline int rr_check_not_negative(const rr_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= RR_R(0.0) && x[i] <= RR_REAL_MAX)) {
            return rr_all_finite(&x[i], 1) ? RR_OUT_OF_RANGE : RR_NOT_FINITE;
        }
    }
    return RR_OK;
}

/* Status of inputs that must be from 0 to 1. */
static inline int rr_check_share(const rr_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= RR_R(0.0) && x[i] <= RR_R(1.0))) {
            return rr_all_finite(&x[i], 1) ? RR_OUT_OF_RANGE : RR_NOT_FINITE;
        }
    }
    return RR_OK;
}

/* Status of inputs that may be any number. */
static inline int rr_check_finite(const rr_real *x, int count)
{
    return rr_all_finite(x, count) ? RR_OK : RR_NOT_FINITE;
}

/* Unit vector u along n; scaled first, so that no square over- or underflows. */
static inline int rr_unit_vector(const rr_real n[3], rr_real u[3])
{
    if (!rr_all_finite(n, 3)) {
        return RR_NOT_FINITE;
    }
    const rr_real xy = RR_FMAX(RR_FABS(n[0]), RR_FABS(n[1]));
    const rr_real largest = RR_FMAX(xy, RR_FABS(n[2]));
    if (!(largest > RR_R(0.0))) {
        return RR_ZERO_DIRECTION;
    }
    const rr_real x = n[0]/largest;
    const rr_real y = n[1]/largest;
    const rr_real z = n[2]/largest;
    const rr_real scale = RR_R(1.0)/RR_SQRT(x*x + y*y + z*z);
    u[0] = x*scale;
    u[1] = y*scale;
    u[2] = z*scale;
    return RR_OK;
}

/* What the impacts' runtime knows of this robot. */
#define RR_N 4 /* independent joints */
#define RR_ELASTIC 0 /* a spring behind every motor */
#define RR_POTENTIAL 1 /* gravity, or springs of the model file */
#define RR_DAMPED 0 /* joints have damping of their own */
#define RR_STRUCTURED (RR_ELASTIC && !RR_POTENTIAL && !RR_DAMPED)
#define RR_REACH 2 /* directions in which motors move contact points */
#define RR_FASTEST RR_R(10000.0) /* squared joint velocity for 1 m/s: singular */
#define RR_LEAST_MOBILITY RR_R(3.85e-05) /* 1/kg; below: singular */

typedef struct {
    rr_real M[4][4]; /* kg m^2; over the joints */
    rr_real K[4][4]; /* N m/rad; of springs and gravity */
    rr_real J[3][4]; /* m/rad; three rows a contact point, base axes */
} rr_links_t;

/* Links as they arrive at an impact. */
int rr_links(const rr_real q[4], const rr_params *p, rr_links_t *out);

#define RR_FRAMES 6 /* frames of links in which contact points can be given */
typedef struct {
    int joint; /* whose link it is fixed to */
    rr_real rotation[3][3];
    rr_real position[3]; /* m; both in the joint's frame */
} rr_frame_place;

/* Where the joints' frames are. */
int rr_joint_frames(const rr_real q[4], rr_real poses[4][12]);

extern const rr_frame_place rr_frame_places[RR_FRAMES];
extern const bool rr_joint_slides[RR_N];
extern const bool rr_joint_moves[RR_N][RR_N]; /* the link of another */

extern const rr_real rr_directions[RR_REACH][3];
extern const bool rr_has_motor[RR_N];

#define RR_INDEPENDENT(i) (i)
#define RR_GAIN(p, i) (rr_has_motor[i] ? (p)->position_gain[RR_INDEPENDENT(i)] : RR_R(0.0))
#define RR_DAMPING_GAIN(p, i) (rr_has_motor[i] ? (p)->damping_gain[RR_INDEPENDENT(i)] : RR_R(0.0))
#define RR_REACTION_TIME(p) ((p)->reaction_time)
#define RR_HORIZON(p) ((p)->horizon)
#define RR_LINKS_OF(q, p) q, p

#endif
