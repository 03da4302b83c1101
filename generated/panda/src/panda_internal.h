/* SPDX-License-Identifier: 0BSD */
/* What the sources of panda share; not for their users. */
#ifndef PANDA_INTERNAL_H
#define PANDA_INTERNAL_H

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "panda.h"

#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "panda checks for numbers that are not finite: build it without -ffast-math"
#endif

#if defined(PANDA_USE_FLOAT)
#define PANDA_R(x) x##f
#define PANDA_F(function) function##f
#define PANDA_REAL_MAX FLT_MAX
#define PANDA_EPSILON FLT_EPSILON
#else
#define PANDA_R(x) x
#define PANDA_F(function) function
#define PANDA_REAL_MAX DBL_MAX
#define PANDA_EPSILON DBL_EPSILON
#endif

#define PANDA_SIN(x) PANDA_F(sin)(x)
#define PANDA_COS(x) PANDA_F(cos)(x)
#define PANDA_EXP(x) PANDA_F(exp)(x)
#define PANDA_LOG(x) PANDA_F(log)(x)
#define PANDA_SQRT(x) PANDA_F(sqrt)(x)
#define PANDA_FABS(x) PANDA_F(fabs)(x)
#define PANDA_FMIN(x, y) PANDA_F(fmin)(x, y)
#define PANDA_FMAX(x, y) PANDA_F(fmax)(x, y)
#define PANDA_COPYSIGN(x, y) PANDA_F(copysign)(x, y)
#define PANDA_CBRT(x) PANDA_F(cbrt)(x)
#define PANDA_POW(x, y) PANDA_F(pow)(x, y)

/* Sines s and cosines c of finite angles x. */
void panda_sines_cosines(const panda_real *x, int count, panda_real *s, panda_real *c);

/* j inv(M + diag b) j'. */
void panda_inverse_mass(const panda_real M[28], const panda_real b[7], const panda_real j[7],
    panda_real out[1]);

/* J(q), column by column. */
void panda_jacobian_entries(const panda_real s[6], const panda_real c[6], panda_real out[21]);

/* M(q), row by row up to the diagonal. */
void panda_mass_entries(const panda_real s[6], const panda_real c[6], panda_real out[28]);

/* J inv(M + diag b) J', row by row up to the diagonal. */
void panda_mobility_entries(const panda_real M[28], const panda_real b[7], const panda_real j[21],
    panda_real out[6]);

/* inv(M + diag b) j', then j inv(M + diag b) j'. */
void panda_pushed_entries(const panda_real M[28], const panda_real b[7], const panda_real j[7],
    panda_real out[8]);

/* n'J(q). */
void panda_row_entries(const panda_real n[3], const panda_real s[7], const panda_real c[7],
    panda_real out[7]);

/*
 * Whether all of up to a thousand numbers are finite: only then is the sum of a thousandth of each.
 * A comparison with a NaN is false.
 */
static inline bool panda_all_finite(const panda_real *x, int count)
{
    panda_real sum = PANDA_R(0.0);
    for (int i = 0; i < count; ++i) {
        sum += PANDA_R(0.0009765625)*x[i];
    }
    return PANDA_FABS(sum) <= PANDA_REAL_MAX;
}

/* Status of inputs that must be greater than 0. */
static inline int panda_check_positive(const panda_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] > PANDA_R(0.0) && x[i] <= PANDA_REAL_MAX)) {
            return panda_all_finite(&x[i], 1) ? PANDA_OUT_OF_RANGE : PANDA_NOT_FINITE;
        }
    }
    return PANDA_OK;
}

/* Status of inputs that must be 0 or greater. */
static inline int panda_check_not_negative(const panda_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= PANDA_R(0.0) && x[i] <= PANDA_REAL_MAX)) {
            return panda_all_finite(&x[i], 1) ? PANDA_OUT_OF_RANGE : PANDA_NOT_FINITE;
        }
    }
    return PANDA_OK;
}

/* Status of inputs that must be from 0 to 1. */
static inline int panda_check_share(const panda_real *x, int count)
{
    for (int i = 0; i < count; ++i) {
        if (!(x[i] >= PANDA_R(0.0) && x[i] <= PANDA_R(1.0))) {
            return panda_all_finite(&x[i], 1) ? PANDA_OUT_OF_RANGE : PANDA_NOT_FINITE;
        }
    }
    return PANDA_OK;
}

/* Status of inputs that may be any number. */
static inline int panda_check_finite(const panda_real *x, int count)
{
    return panda_all_finite(x, count) ? PANDA_OK : PANDA_NOT_FINITE;
}

/* Unit vector u along n; scaled first, so that no square over- or underflows. */
static inline int panda_unit_vector(const panda_real n[3], panda_real u[3])
{
    if (!panda_all_finite(n, 3)) {
        return PANDA_NOT_FINITE;
    }
    const panda_real xy = PANDA_FMAX(PANDA_FABS(n[0]), PANDA_FABS(n[1]));
    const panda_real largest = PANDA_FMAX(xy, PANDA_FABS(n[2]));
    if (!(largest > PANDA_R(0.0))) {
        return PANDA_ZERO_DIRECTION;
    }
    const panda_real x = n[0]/largest;
    const panda_real y = n[1]/largest;
    const panda_real z = n[2]/largest;
    const panda_real scale = PANDA_R(1.0)/PANDA_SQRT(x*x + y*y + z*z);
    u[0] = x*scale;
    u[1] = y*scale;
    u[2] = z*scale;
    return PANDA_OK;
}

/* What the impacts' runtime knows of this robot. */
#define PANDA_N 7 /* independent joints */
#define PANDA_ELASTIC 1 /* a spring behind every motor */
#define PANDA_POTENTIAL 0 /* gravity, or springs of the model file */
#define PANDA_DAMPED 0 /* joints have damping of their own */
#define PANDA_STRUCTURED (PANDA_ELASTIC && !PANDA_POTENTIAL && !PANDA_DAMPED)
#define PANDA_REACH 3 /* directions in which motors move contact points */
#define PANDA_FASTEST PANDA_R(27000.0) /* squared joint velocity for 1 m/s: singular */
#define PANDA_LEAST_MOBILITY PANDA_R(5.88e-05) /* 1/kg; below: singular */

typedef struct {
    panda_real M[7][7]; /* kg m^2; over the joints */
    panda_real J[3][7]; /* m/rad; three rows a contact point, base axes */
} panda_links_t;

/* Links as they arrive at an impact. */
int panda_links(const panda_real q[7], panda_links_t *out);

#define PANDA_FRAMES 12 /* frames of links in which contact points can be given */
typedef struct {
    int joint; /* whose link it is fixed to */
    panda_real rotation[3][3];
    panda_real position[3]; /* m; both in the joint's frame */
} panda_frame_place;

/* Where the joints' frames are. */
int panda_joint_frames(const panda_real q[7], panda_real poses[7][12]);

extern const panda_frame_place panda_frame_places[PANDA_FRAMES];
extern const bool panda_joint_slides[PANDA_N];
extern const bool panda_joint_moves[PANDA_N][PANDA_N]; /* the link of another */

extern const panda_real panda_directions[PANDA_REACH][3];
extern const bool panda_has_motor[PANDA_N];

#define PANDA_INDEPENDENT(i) (i)
#define PANDA_SPRING(p, i) ((p)->joint_stiffness[PANDA_INDEPENDENT(i)])
#define PANDA_ROTOR(p, i) ((p)->rotor_inertia[PANDA_INDEPENDENT(i)])
#define PANDA_GAIN(p, i) (panda_has_motor[i] ? (p)->position_gain[PANDA_INDEPENDENT(i)] : PANDA_R(0.0))
#define PANDA_DAMPING_GAIN(p, i) (panda_has_motor[i] ? (p)->damping_gain[PANDA_INDEPENDENT(i)] : PANDA_R(0.0))
#define PANDA_REACTION_TIME(p) ((p)->reaction_time)
#define PANDA_HORIZON(p) ((p)->horizon)
#define PANDA_LINKS_OF(q, p) q

#endif
