/* SPDX-License-Identifier: 0BSD */
/* Robot_ about to touch. */
#include "rmin_impact.h"

/* Squared share of n that may point where motors never move the contact point. */
#define OUTSIDE RMIN_R(1e-6)
/*
 * Most that the velocity may be off n where motors can hardly move the contact point that way: aside, too, which tells
 * where they cannot and a pivot of rounding says that they can.
 */
#define ASTRAY RMIN_R(1e-3)
/* Share of all squared motions of the contact point from which on no pivot is weak enough for that. */
#define WEAK RMIN_R(1e-3)
/* Share of all squared motions of the contact point below which a pivot is rounding of their sums. */
#define ROUNDING (RMIN_R(8.0)*RMIN_EPSILON)
#define MOST_STEPS 1000000

int rmin_check_impact(const rmin_region *region, const rmin_params *p)
{
    if (p->layout != RMIN_LAYOUT) {
        return RMIN_FOREIGN_PARAMS;
    }
    rmin_real positive[4 + 2*RMIN_N];
    rmin_real others[2 + 2*RMIN_N]; /* not negative */
    int count = 4;
    positive[0] = region->stiffness;
    positive[1] = region->law != NULL ? RMIN_R(1.0) : region->hertz_stiffness;
    positive[2] = region->clamped != 0 ? RMIN_R(1.0) : region->effective_mass;
    positive[3] = RMIN_HORIZON(p);
    others[0] = region->damping;
    others[1] = RMIN_REACTION_TIME(p);
    for (int i = 0; i < RMIN_N; ++i) {
        others[2 + 2*i] = RMIN_GAIN(p, i);
        others[3 + 2*i] = RMIN_DAMPING_GAIN(p, i);
#if RMIN_ELASTIC
        positive[count] = RMIN_SPRING(p, i);
        positive[count + 1] = RMIN_ROTOR(p, i);
        count += 2;
#endif
    }
    int status = rmin_check_positive(positive, count);
    if (status == RMIN_OK) {
        status = rmin_check_not_negative(others, 2 + 2*RMIN_N);
    }
    if (status != RMIN_OK) {
        return status;
    }
    const bool motion = p->motors >= RMIN_MOTORS_FREE_OR_DRIVEN && p->motors <= RMIN_MOTORS_SERVO
        && p->steps > 0 && p->steps <= MOST_STEPS;
    return motion && rmin_law_is_one(region) ? RMIN_OK : RMIN_OUT_OF_RANGE;
}

int rmin_arrive(const rmin_real n[3], int point, rmin_arrival *arrival)
{
    rmin_real u[3];
    const int status = rmin_unit_vector(n, u);
    if (status != RMIN_OK) {
        return status;
    }
    const rmin_real (*const J)[RMIN_N] = (const rmin_real (*)[RMIN_N])&arrival->links.J[3*point];
    rmin_matrix square;
    rmin_real moved[RMIN_REACH][RMIN_N];
    rmin_real share[RMIN_SYSTEM];
    rmin_real wanted[RMIN_REACH];
    rmin_real within = RMIN_R(0.0);
    rmin_real whole = RMIN_R(0.0); /* of which a pivot of rounding is no motion */
    for (int i = 0; i < RMIN_N; ++i) {
        arrival->row[i] = u[0]*J[0][i] + u[1]*J[1][i] + u[2]*J[2][i];
    }
    for (int k = 0; k < RMIN_REACH; ++k) {
        const rmin_real *const d = rmin_directions[k];
        share[k] = d[0]*u[0] + d[1]*u[1] + d[2]*u[2];
        wanted[k] = share[k];
        within += share[k]*share[k];
        for (int i = 0; i < RMIN_N; ++i) {
            moved[k][i] = rmin_has_motor[i] ? d[0]*J[0][i] + d[1]*J[1][i] + d[2]*J[2][i] : RMIN_R(0.0);
        }
        for (int l = 0; l <= k; ++l) {
            rmin_real sum = RMIN_R(0.0);
            for (int i = 0; i < RMIN_N; ++i) {
                sum += moved[k][i]*moved[l][i];
            }
            square[k][l] = sum;
            square[l][k] = sum;
        }
        whole += square[k][k];
    }
    if (!(within > RMIN_R(1.0) - OUTSIDE) || !rmin_cholesky(RMIN_REACH, square)) {
        return RMIN_SINGULAR;
    }
    rmin_real least = whole;
    for (int k = 0; k < RMIN_REACH; ++k) {
        least = RMIN_FMIN(least, square[k][k]*square[k][k]);
    }
    if (!(least > ROUNDING*whole)) {
        return RMIN_SINGULAR;
    }
    rmin_forward(RMIN_REACH, square, share);
    rmin_backward(RMIN_REACH, square, share);
    rmin_real fast = RMIN_R(0.0);
    rmin_real astray = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        rmin_real rate = RMIN_R(0.0);
        for (int k = 0; k < RMIN_REACH; ++k) {
            rate += moved[k][i]*share[k];
        }
        arrival->rates[i] = rate;
        fast += rate*rate;
    }
    for (int k = 0; k < RMIN_REACH && least < WEAK*whole; ++k) {
        rmin_real missed = wanted[k];
        for (int i = 0; i < RMIN_N; ++i) {
            missed -= moved[k][i]*arrival->rates[i];
        }
        astray += missed*missed;
    }
    return fast < RMIN_FASTEST && astray < ASTRAY*ASTRAY ? RMIN_OK : RMIN_SINGULAR;
}

int rmin_set_off(const rmin_real q[RMIN_JOINTS], const rmin_real dq[RMIN_JOINTS],
    const rmin_params *p, rmin_real rates[RMIN_N], rmin_arrival *arrival)
{
    const int status = rmin_check_finite(dq, RMIN_JOINTS);
    for (int i = 0; i < RMIN_N; ++i) {
        rates[i] = dq[RMIN_INDEPENDENT(i)];
    }
    (void)q;
    (void)p;
    return status == RMIN_OK ? rmin_links(RMIN_LINKS_OF(q, p), &arrival->links) : status;
}

rmin_real rmin_arrive_as_it_moves(int point, const rmin_real rates[RMIN_N], rmin_arrival *arrival)
{
    rmin_real v[3];
    for (int k = 0; k < 3; ++k) {
        v[k] = RMIN_R(0.0);
        for (int i = 0; i < RMIN_N; ++i) {
            v[k] += arrival->links.J[3*point + k][i]*rates[i];
        }
    }
    const rmin_real speed = RMIN_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
    for (int i = 0; i < RMIN_N && speed > RMIN_R(0.0); ++i) {
        arrival->row[i] = RMIN_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
    return speed;
}

void rmin_kinds_of_motors(const rmin_params *p, int *first, int *last)
{
    const bool both = p->motors == RMIN_MOTORS_FREE_OR_DRIVEN;
    *first = both ? RMIN_MOTORS_FREE : p->motors;
    *last = both ? RMIN_MOTORS_DRIVEN : p->motors;
}

int rmin_approach(const rmin_real q[RMIN_JOINTS], int point, const rmin_real n[3],
    const rmin_region *region, const rmin_params *p, rmin_impact *impact)
{
    int status = rmin_check_impact(region, p);
    if (status == RMIN_OK && !(point >= 0 && point < RMIN_POINTS)) {
        status = RMIN_OUT_OF_RANGE;
    }
    if (status == RMIN_OK) {
        status = rmin_links(RMIN_LINKS_OF(q, p), &impact->arrival.links);
    }
    if (status == RMIN_OK) {
        status = rmin_arrive(n, point, &impact->arrival);
    }
    rmin_impact_forget(impact);
    return status;
}
