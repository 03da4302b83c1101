/* SPDX-License-Identifier: 0BSD */
/* Robot_ about to touch. */
#include "robot_impact.h"

/* Squared share of n that may point where motors never move the contact point. */
#define OUTSIDE ROBOT_R(1e-6)
/*
 * Most that the velocity may be off n where motors can hardly move the contact point that way: aside, too, which tells
 * where they cannot and a pivot of rounding says that they can.
 */
#define ASTRAY ROBOT_R(1e-3)
/* Share of all squared motions of the contact point from which on no pivot is weak enough for that. */
#define WEAK ROBOT_R(1e-3)
/* Share of all squared motions of the contact point below which a pivot is rounding of their sums. */
#define ROUNDING (ROBOT_R(8.0)*ROBOT_EPSILON)
#define MOST_STEPS 1000000

int robot_check_impact(const robot_region *region, const robot_params *p)
{
    if (p->layout != ROBOT_LAYOUT) {
        return ROBOT_FOREIGN_PARAMS;
    }
    robot_real positive[4 + 2*ROBOT_N];
    robot_real others[2 + 2*ROBOT_N]; /* not negative */
    int count = 4;
    positive[0] = region->stiffness;
    positive[1] = region->law != NULL ? ROBOT_R(1.0) : region->hertz_stiffness;
    positive[2] = region->clamped != 0 ? ROBOT_R(1.0) : region->effective_mass;
    positive[3] = ROBOT_HORIZON(p);
    others[0] = region->damping;
    others[1] = ROBOT_REACTION_TIME(p);
    for (int i = 0; i < ROBOT_N; ++i) {
        others[2 + 2*i] = ROBOT_GAIN(p, i);
        others[3 + 2*i] = ROBOT_DAMPING_GAIN(p, i);
#if ROBOT_ELASTIC
        positive[count] = ROBOT_SPRING(p, i);
        positive[count + 1] = ROBOT_ROTOR(p, i);
        count += 2;
#endif
    }
    int status = robot_check_positive(positive, count);
    if (status == ROBOT_OK) {
        status = robot_check_not_negative(others, 2 + 2*ROBOT_N);
    }
    if (status != ROBOT_OK) {
        return status;
    }
    const bool motion = p->motors >= ROBOT_MOTORS_FREE_OR_DRIVEN && p->motors <= ROBOT_MOTORS_SERVO
        && p->steps > 0 && p->steps <= MOST_STEPS;
    return motion && robot_law_is_one(region) ? ROBOT_OK : ROBOT_OUT_OF_RANGE;
}

int robot_arrive(const robot_real n[3], int point, robot_arrival *arrival)
{
    robot_real u[3];
    const int status = robot_unit_vector(n, u);
    if (status != ROBOT_OK) {
        return status;
    }
    const robot_real (*const J)[ROBOT_N] = (const robot_real (*)[ROBOT_N])&arrival->links.J[3*point];
    robot_matrix square;
    robot_real moved[ROBOT_REACH][ROBOT_N];
    robot_real share[ROBOT_SYSTEM];
    robot_real wanted[ROBOT_REACH];
    robot_real within = ROBOT_R(0.0);
    robot_real whole = ROBOT_R(0.0); /* of which a pivot of rounding is no motion */
    for (int i = 0; i < ROBOT_N; ++i) {
        arrival->row[i] = u[0]*J[0][i] + u[1]*J[1][i] + u[2]*J[2][i];
    }
    for (int k = 0; k < ROBOT_REACH; ++k) {
        const robot_real *const d = robot_directions[k];
        share[k] = d[0]*u[0] + d[1]*u[1] + d[2]*u[2];
        wanted[k] = share[k];
        within += share[k]*share[k];
        for (int i = 0; i < ROBOT_N; ++i) {
            moved[k][i] = robot_has_motor[i] ? d[0]*J[0][i] + d[1]*J[1][i] + d[2]*J[2][i] : ROBOT_R(0.0);
        }
        for (int l = 0; l <= k; ++l) {
            robot_real sum = ROBOT_R(0.0);
            for (int i = 0; i < ROBOT_N; ++i) {
                sum += moved[k][i]*moved[l][i];
            }
            square[k][l] = sum;
            square[l][k] = sum;
        }
        whole += square[k][k];
    }
    if (!(within > ROBOT_R(1.0) - OUTSIDE) || !robot_cholesky(ROBOT_REACH, square)) {
        return ROBOT_SINGULAR;
    }
    robot_real least = whole;
    for (int k = 0; k < ROBOT_REACH; ++k) {
        least = ROBOT_FMIN(least, square[k][k]*square[k][k]);
    }
    if (!(least > ROUNDING*whole)) {
        return ROBOT_SINGULAR;
    }
    robot_forward(ROBOT_REACH, square, share);
    robot_backward(ROBOT_REACH, square, share);
    robot_real fast = ROBOT_R(0.0);
    robot_real astray = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        robot_real rate = ROBOT_R(0.0);
        for (int k = 0; k < ROBOT_REACH; ++k) {
            rate += moved[k][i]*share[k];
        }
        arrival->rates[i] = rate;
        fast += rate*rate;
    }
    for (int k = 0; k < ROBOT_REACH && least < WEAK*whole; ++k) {
        robot_real missed = wanted[k];
        for (int i = 0; i < ROBOT_N; ++i) {
            missed -= moved[k][i]*arrival->rates[i];
        }
        astray += missed*missed;
    }
    return fast < ROBOT_FASTEST && astray < ASTRAY*ASTRAY ? ROBOT_OK : ROBOT_SINGULAR;
}

int robot_set_off(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS],
    const robot_params *p, robot_real rates[ROBOT_N], robot_arrival *arrival)
{
    const int status = robot_check_finite(dq, ROBOT_JOINTS);
    for (int i = 0; i < ROBOT_N; ++i) {
        rates[i] = dq[ROBOT_INDEPENDENT(i)];
    }
    (void)q;
    (void)p;
    return status == ROBOT_OK ? robot_links(ROBOT_LINKS_OF(q, p), &arrival->links) : status;
}

robot_real robot_arrive_as_it_moves(int point, const robot_real rates[ROBOT_N], robot_arrival *arrival)
{
    robot_real v[3];
    for (int k = 0; k < 3; ++k) {
        v[k] = ROBOT_R(0.0);
        for (int i = 0; i < ROBOT_N; ++i) {
            v[k] += arrival->links.J[3*point + k][i]*rates[i];
        }
    }
    const robot_real speed = ROBOT_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
    for (int i = 0; i < ROBOT_N && speed > ROBOT_R(0.0); ++i) {
        arrival->row[i] = ROBOT_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
    return speed;
}

void robot_kinds_of_motors(const robot_params *p, int *first, int *last)
{
    const bool both = p->motors == ROBOT_MOTORS_FREE_OR_DRIVEN;
    *first = both ? ROBOT_MOTORS_FREE : p->motors;
    *last = both ? ROBOT_MOTORS_DRIVEN : p->motors;
}

int robot_approach(const robot_real q[ROBOT_JOINTS], int point, const robot_real n[3],
    const robot_region *region, const robot_params *p, robot_impact *impact)
{
    int status = robot_check_impact(region, p);
    if (status == ROBOT_OK && !(point >= 0 && point < ROBOT_POINTS)) {
        status = ROBOT_OUT_OF_RANGE;
    }
    if (status == ROBOT_OK) {
        status = robot_links(ROBOT_LINKS_OF(q, p), &impact->arrival.links);
    }
    if (status == ROBOT_OK) {
        status = robot_arrive(n, point, &impact->arrival);
    }
    robot_impact_forget(impact);
    return status;
}
