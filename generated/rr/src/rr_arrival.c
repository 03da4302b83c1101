/* SPDX-License-Identifier: 0BSD */
/* Robot_ about to touch. */
#include "rr_impact.h"

/* Squared share of n that may point where motors never move the contact point. */
#define OUTSIDE RR_R(1e-6)
/*
 * Most that the velocity may be off n where motors can hardly move the contact point that way: aside, too, which tells
 * where they cannot and a pivot of rounding says that they can.
 */
#define ASTRAY RR_R(1e-3)
/* Share of all squared motions of the contact point from which on no pivot is weak enough for that. */
#define WEAK RR_R(1e-3)
/* Share of all squared motions of the contact point below which a pivot is rounding of their sums. */
#define ROUNDING (RR_R(8.0)*RR_EPSILON)
#define MOST_STEPS 1000000

int rr_check_impact(const rr_region *region, const rr_params *p)
{
    if (p->layout != RR_LAYOUT) {
        return RR_FOREIGN_PARAMS;
    }
    rr_real positive[4 + 2*RR_N];
    rr_real others[2 + 2*RR_N]; /* not negative */
    int count = 4;
    positive[0] = region->stiffness;
    positive[1] = region->law != NULL ? RR_R(1.0) : region->hertz_stiffness;
    positive[2] = region->clamped != 0 ? RR_R(1.0) : region->effective_mass;
    positive[3] = RR_HORIZON(p);
    others[0] = region->damping;
    others[1] = RR_REACTION_TIME(p);
    for (int i = 0; i < RR_N; ++i) {
        others[2 + 2*i] = RR_GAIN(p, i);
        others[3 + 2*i] = RR_DAMPING_GAIN(p, i);
#if RR_ELASTIC
        positive[count] = RR_SPRING(p, i);
        positive[count + 1] = RR_ROTOR(p, i);
        count += 2;
#endif
    }
    int status = rr_check_positive(positive, count);
    if (status == RR_OK) {
        status = rr_check_not_negative(others, 2 + 2*RR_N);
    }
    if (status != RR_OK) {
        return status;
    }
    const bool motion = p->motors >= RR_MOTORS_FREE_OR_DRIVEN && p->motors <= RR_MOTORS_SERVO
        && p->steps > 0 && p->steps <= MOST_STEPS;
    return motion && rr_law_is_one(region) ? RR_OK : RR_OUT_OF_RANGE;
}

int rr_arrive(const rr_real n[3], int point, rr_arrival *arrival)
{
    rr_real u[3];
    const int status = rr_unit_vector(n, u);
    if (status != RR_OK) {
        return status;
    }
    const rr_real (*const J)[RR_N] = (const rr_real (*)[RR_N])&arrival->links.J[3*point];
    rr_matrix square;
    rr_real moved[RR_REACH][RR_N];
    rr_real share[RR_SYSTEM];
    rr_real wanted[RR_REACH];
    rr_real within = RR_R(0.0);
    rr_real whole = RR_R(0.0); /* of which a pivot of rounding is no motion */
    for (int i = 0; i < RR_N; ++i) {
        arrival->row[i] = u[0]*J[0][i] + u[1]*J[1][i] + u[2]*J[2][i];
    }
    for (int k = 0; k < RR_REACH; ++k) {
        const rr_real *const d = rr_directions[k];
        share[k] = d[0]*u[0] + d[1]*u[1] + d[2]*u[2];
        wanted[k] = share[k];
        within += share[k]*share[k];
        for (int i = 0; i < RR_N; ++i) {
            moved[k][i] = rr_has_motor[i] ? d[0]*J[0][i] + d[1]*J[1][i] + d[2]*J[2][i] : RR_R(0.0);
        }
        for (int l = 0; l <= k; ++l) {
            rr_real sum = RR_R(0.0);
            for (int i = 0; i < RR_N; ++i) {
                sum += moved[k][i]*moved[l][i];
            }
            square[k][l] = sum;
            square[l][k] = sum;
        }
        whole += square[k][k];
    }
    if (!(within > RR_R(1.0) - OUTSIDE) || !rr_cholesky(RR_REACH, square)) {
        return RR_SINGULAR;
    }
    rr_real least = whole;
    for (int k = 0; k < RR_REACH; ++k) {
        least = RR_FMIN(least, square[k][k]*square[k][k]);
    }
    if (!(least > ROUNDING*whole)) {
        return RR_SINGULAR;
    }
    rr_forward(RR_REACH, square, share);
    rr_backward(RR_REACH, square, share);
    rr_real fast = RR_R(0.0);
    rr_real astray = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        rr_real rate = RR_R(0.0);
        for (int k = 0; k < RR_REACH; ++k) {
            rate += moved[k][i]*share[k];
        }
        arrival->rates[i] = rate;
        fast += rate*rate;
    }
    for (int k = 0; k < RR_REACH && least < WEAK*whole; ++k) {
        rr_real missed = wanted[k];
        for (int i = 0; i < RR_N; ++i) {
            missed -= moved[k][i]*arrival->rates[i];
        }
        astray += missed*missed;
    }
    return fast < RR_FASTEST && astray < ASTRAY*ASTRAY ? RR_OK : RR_SINGULAR;
}

int rr_set_off(const rr_real q[RR_JOINTS], const rr_real dq[RR_JOINTS],
    const rr_params *p, rr_real rates[RR_N], rr_arrival *arrival)
{
    const int status = rr_check_finite(dq, RR_JOINTS);
    for (int i = 0; i < RR_N; ++i) {
        rates[i] = dq[RR_INDEPENDENT(i)];
    }
    (void)q;
    (void)p;
    return status == RR_OK ? rr_links(RR_LINKS_OF(q, p), &arrival->links) : status;
}

rr_real rr_arrive_as_it_moves(int point, const rr_real rates[RR_N], rr_arrival *arrival)
{
    rr_real v[3];
    for (int k = 0; k < 3; ++k) {
        v[k] = RR_R(0.0);
        for (int i = 0; i < RR_N; ++i) {
            v[k] += arrival->links.J[3*point + k][i]*rates[i];
        }
    }
    const rr_real speed = RR_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
    for (int i = 0; i < RR_N && speed > RR_R(0.0); ++i) {
        arrival->row[i] = RR_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
    return speed;
}

void rr_kinds_of_motors(const rr_params *p, int *first, int *last)
{
    const bool both = p->motors == RR_MOTORS_FREE_OR_DRIVEN;
    *first = both ? RR_MOTORS_FREE : p->motors;
    *last = both ? RR_MOTORS_DRIVEN : p->motors;
}

int rr_approach(const rr_real q[RR_JOINTS], int point, const rr_real n[3],
    const rr_region *region, const rr_params *p, rr_impact *impact)
{
    int status = rr_check_impact(region, p);
    if (status == RR_OK && !(point >= 0 && point < RR_POINTS)) {
        status = RR_OUT_OF_RANGE;
    }
    if (status == RR_OK) {
        status = rr_links(RR_LINKS_OF(q, p), &impact->arrival.links);
    }
    if (status == RR_OK) {
        status = rr_arrive(n, point, &impact->arrival);
    }
    rr_impact_forget(impact);
    return status;
}
