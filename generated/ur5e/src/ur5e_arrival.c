/* SPDX-License-Identifier: 0BSD */
/* Robot_ about to touch. */
#include "ur5e_impact.h"

/* Squared share of n that may point where motors never move the contact point. */
#define OUTSIDE UR5E_R(1e-6)
/*
 * Most that the velocity may be off n where motors can hardly move the contact point that way: aside, too, which tells
 * where they cannot and a pivot of rounding says that they can.
 */
#define ASTRAY UR5E_R(1e-3)
/* Share of all squared motions of the contact point from which on no pivot is weak enough for that. */
#define WEAK UR5E_R(1e-3)
/* Share of all squared motions of the contact point below which a pivot is rounding of their sums. */
#define ROUNDING (UR5E_R(8.0)*UR5E_EPSILON)
#define MOST_STEPS 1000000

int ur5e_check_impact(const ur5e_region *region, const ur5e_params *p)
{
    if (p->layout != UR5E_LAYOUT) {
        return UR5E_FOREIGN_PARAMS;
    }
    ur5e_real positive[4 + 2*UR5E_N];
    ur5e_real others[2 + 2*UR5E_N]; /* not negative */
    int count = 4;
    positive[0] = region->stiffness;
    positive[1] = region->law != NULL ? UR5E_R(1.0) : region->hertz_stiffness;
    positive[2] = region->clamped != 0 ? UR5E_R(1.0) : region->effective_mass;
    positive[3] = UR5E_HORIZON(p);
    others[0] = region->damping;
    others[1] = UR5E_REACTION_TIME(p);
    for (int i = 0; i < UR5E_N; ++i) {
        others[2 + 2*i] = UR5E_GAIN(p, i);
        others[3 + 2*i] = UR5E_DAMPING_GAIN(p, i);
#if UR5E_ELASTIC
        positive[count] = UR5E_SPRING(p, i);
        positive[count + 1] = UR5E_ROTOR(p, i);
        count += 2;
#endif
    }
    int status = ur5e_check_positive(positive, count);
    if (status == UR5E_OK) {
        status = ur5e_check_not_negative(others, 2 + 2*UR5E_N);
    }
    if (status != UR5E_OK) {
        return status;
    }
    const bool motion = p->motors >= UR5E_MOTORS_FREE_OR_DRIVEN && p->motors <= UR5E_MOTORS_SERVO
        && p->steps > 0 && p->steps <= MOST_STEPS;
    return motion && ur5e_law_is_one(region) ? UR5E_OK : UR5E_OUT_OF_RANGE;
}

int ur5e_arrive(const ur5e_real n[3], int point, ur5e_arrival *arrival)
{
    ur5e_real u[3];
    const int status = ur5e_unit_vector(n, u);
    if (status != UR5E_OK) {
        return status;
    }
    const ur5e_real (*const J)[UR5E_N] = (const ur5e_real (*)[UR5E_N])&arrival->links.J[3*point];
    ur5e_matrix square;
    ur5e_real moved[UR5E_REACH][UR5E_N];
    ur5e_real share[UR5E_SYSTEM];
    ur5e_real wanted[UR5E_REACH];
    ur5e_real within = UR5E_R(0.0);
    ur5e_real whole = UR5E_R(0.0); /* of which a pivot of rounding is no motion */
    for (int i = 0; i < UR5E_N; ++i) {
        arrival->row[i] = u[0]*J[0][i] + u[1]*J[1][i] + u[2]*J[2][i];
    }
    for (int k = 0; k < UR5E_REACH; ++k) {
        const ur5e_real *const d = ur5e_directions[k];
        share[k] = d[0]*u[0] + d[1]*u[1] + d[2]*u[2];
        wanted[k] = share[k];
        within += share[k]*share[k];
        for (int i = 0; i < UR5E_N; ++i) {
            moved[k][i] = ur5e_has_motor[i] ? d[0]*J[0][i] + d[1]*J[1][i] + d[2]*J[2][i] : UR5E_R(0.0);
        }
        for (int l = 0; l <= k; ++l) {
            ur5e_real sum = UR5E_R(0.0);
            for (int i = 0; i < UR5E_N; ++i) {
                sum += moved[k][i]*moved[l][i];
            }
            square[k][l] = sum;
            square[l][k] = sum;
        }
        whole += square[k][k];
    }
    if (!(within > UR5E_R(1.0) - OUTSIDE) || !ur5e_cholesky(UR5E_REACH, square)) {
        return UR5E_SINGULAR;
    }
    ur5e_real least = whole;
    for (int k = 0; k < UR5E_REACH; ++k) {
        least = UR5E_FMIN(least, square[k][k]*square[k][k]);
    }
    if (!(least > ROUNDING*whole)) {
        return UR5E_SINGULAR;
    }
    ur5e_forward(UR5E_REACH, square, share);
    ur5e_backward(UR5E_REACH, square, share);
    ur5e_real fast = UR5E_R(0.0);
    ur5e_real astray = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        ur5e_real rate = UR5E_R(0.0);
        for (int k = 0; k < UR5E_REACH; ++k) {
            rate += moved[k][i]*share[k];
        }
        arrival->rates[i] = rate;
        fast += rate*rate;
    }
    for (int k = 0; k < UR5E_REACH && least < WEAK*whole; ++k) {
        ur5e_real missed = wanted[k];
        for (int i = 0; i < UR5E_N; ++i) {
            missed -= moved[k][i]*arrival->rates[i];
        }
        astray += missed*missed;
    }
    return fast < UR5E_FASTEST && astray < ASTRAY*ASTRAY ? UR5E_OK : UR5E_SINGULAR;
}

int ur5e_set_off(const ur5e_real q[UR5E_JOINTS], const ur5e_real dq[UR5E_JOINTS],
    const ur5e_params *p, ur5e_real rates[UR5E_N], ur5e_arrival *arrival)
{
    const int status = ur5e_check_finite(dq, UR5E_JOINTS);
    for (int i = 0; i < UR5E_N; ++i) {
        rates[i] = dq[UR5E_INDEPENDENT(i)];
    }
    (void)q;
    (void)p;
    return status == UR5E_OK ? ur5e_links(UR5E_LINKS_OF(q, p), &arrival->links) : status;
}

ur5e_real ur5e_arrive_as_it_moves(int point, const ur5e_real rates[UR5E_N], ur5e_arrival *arrival)
{
    ur5e_real v[3];
    for (int k = 0; k < 3; ++k) {
        v[k] = UR5E_R(0.0);
        for (int i = 0; i < UR5E_N; ++i) {
            v[k] += arrival->links.J[3*point + k][i]*rates[i];
        }
    }
    const ur5e_real speed = UR5E_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
    for (int i = 0; i < UR5E_N && speed > UR5E_R(0.0); ++i) {
        arrival->row[i] = UR5E_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
    return speed;
}

void ur5e_kinds_of_motors(const ur5e_params *p, int *first, int *last)
{
    const bool both = p->motors == UR5E_MOTORS_FREE_OR_DRIVEN;
    *first = both ? UR5E_MOTORS_FREE : p->motors;
    *last = both ? UR5E_MOTORS_DRIVEN : p->motors;
}

int ur5e_approach(const ur5e_real q[UR5E_JOINTS], int point, const ur5e_real n[3],
    const ur5e_region *region, const ur5e_params *p, ur5e_impact *impact)
{
    int status = ur5e_check_impact(region, p);
    if (status == UR5E_OK && !(point >= 0 && point < UR5E_POINTS)) {
        status = UR5E_OUT_OF_RANGE;
    }
    if (status == UR5E_OK) {
        status = ur5e_links(UR5E_LINKS_OF(q, p), &impact->arrival.links);
    }
    if (status == UR5E_OK) {
        status = ur5e_arrive(n, point, &impact->arrival);
    }
    ur5e_impact_forget(impact);
    return status;
}
