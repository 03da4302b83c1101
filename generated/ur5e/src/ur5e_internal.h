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
#define UR5E_EPSILON FLT_EPSILON
#else
#define UR5E_R(x) x
#define UR5E_F(function) function
#define UR5E_REAL_MAX DBL_MAX
#define UR5E_EPSILON DBL_EPSILON
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
#define UR5E_CBRT(x) UR5E_F(cbrt)(x)
#define UR5E_POW(x, y) UR5E_F(pow)(x, y)

/* Sines s and cosines c of finite angles x. */
void ur5e_sines_cosines(const ur5e_real *x, int count, ur5e_real *s, ur5e_real *c);

/* j inv(M + diag b) j'. */
void ur5e_inverse_mass(const ur5e_real M[21], const ur5e_real b[6], const ur5e_real j[6], ur5e_real
    out[1]);

/* J(q), column by column. */
void ur5e_jacobian_entries(const ur5e_real s[5], const ur5e_real c[5], ur5e_real out[18]);

/* M(q), row by row up to the diagonal. */
void ur5e_mass_entries(const ur5e_real s[5], const ur5e_real c[5], ur5e_real out[21]);

/* J inv(M + diag b) J', row by row up to the diagonal. */
void ur5e_mobility_entries(const ur5e_real M[21], const ur5e_real b[6], const ur5e_real j[18],
    ur5e_real out[6]);

/* inv(M + diag b) j', then j inv(M + diag b) j'. */
void ur5e_pushed_entries(const ur5e_real M[21], const ur5e_real b[6], const ur5e_real j[6],
    ur5e_real out[7]);

/* n'J(q). */
void ur5e_row_entries(const ur5e_real n[3], const ur5e_real s[6], const ur5e_real c[6], ur5e_real
    out[6]);

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

/* What the impacts' runtime knows of this robot. */
#define UR5E_N 6 /* independent joints */
#define UR5E_ELASTIC 1 /* a spring behind every motor */
#define UR5E_POTENTIAL 0 /* gravity, or springs of the model file */
#define UR5E_DAMPED 0 /* joints have damping of their own */
#define UR5E_STRUCTURED (UR5E_ELASTIC && !UR5E_POTENTIAL && !UR5E_DAMPED)
#define UR5E_REACH 3 /* directions in which motors move contact points */
#define UR5E_FASTEST UR5E_R(16000.0) /* squared joint velocity for 1 m/s: singular */
#define UR5E_LEAST_MOBILITY UR5E_R(5.56e-05) /* 1/kg; below: singular */

typedef struct {
    ur5e_real M[6][6]; /* kg m^2; over the joints */
    ur5e_real J[3][6]; /* m/rad; three rows a contact point, base axes */
} ur5e_links_t;

/* Links as they arrive at an impact. */
int ur5e_links(const ur5e_real q[6], ur5e_links_t *out);

#define UR5E_FRAMES 7 /* frames of links in which contact points can be given */
typedef struct {
    int joint; /* whose link it is fixed to */
    ur5e_real rotation[3][3];
    ur5e_real position[3]; /* m; both in the joint's frame */
} ur5e_frame_place;

/* Where the joints' frames are. */
int ur5e_joint_frames(const ur5e_real q[6], ur5e_real poses[6][12]);

extern const ur5e_frame_place ur5e_frame_places[UR5E_FRAMES];
extern const bool ur5e_joint_slides[UR5E_N];
extern const bool ur5e_joint_moves[UR5E_N][UR5E_N]; /* the link of another */

extern const ur5e_real ur5e_directions[UR5E_REACH][3];
extern const bool ur5e_has_motor[UR5E_N];

#define UR5E_INDEPENDENT(i) (i)
#define UR5E_SPRING(p, i) ((p)->joint_stiffness[UR5E_INDEPENDENT(i)])
#define UR5E_ROTOR(p, i) ((p)->rotor_inertia[UR5E_INDEPENDENT(i)])
#define UR5E_GAIN(p, i) (ur5e_has_motor[i] ? (p)->position_gain[UR5E_INDEPENDENT(i)] : UR5E_R(0.0))
#define UR5E_DAMPING_GAIN(p, i) (ur5e_has_motor[i] ? (p)->damping_gain[UR5E_INDEPENDENT(i)] : UR5E_R(0.0))
#define UR5E_REACTION_TIME(p) ((p)->reaction_time)
#define UR5E_HORIZON(p) ((p)->horizon)
#define UR5E_LINKS_OF(q, p) q

#endif
