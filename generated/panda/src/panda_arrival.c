/* SPDX-License-Identifier: 0BSD */
/* Robot_ about to touch. */
#include "panda_impact.h"

/* Squared share of n that may point where motors never move the contact point. */
#define OUTSIDE PANDA_R(1e-6)
/*
 * Most that the velocity may be off n where motors can hardly move the contact point that way: aside, too, which tells
 * where they cannot and a pivot of rounding says that they can.
 */
#define ASTRAY PANDA_R(1e-3)
/* Share of all squared motions of the contact point from which on no pivot is weak enough for that. */
#define WEAK PANDA_R(1e-3)
/* Share of all squared motions of the contact point below which a pivot is rounding of their sums. */
#define ROUNDING (PANDA_R(8.0)*PANDA_EPSILON)
#define MOST_STEPS 1000000

int panda_check_impact(const panda_region *region, const panda_params *p)
{
    if (p->layout != PANDA_LAYOUT) {
        return PANDA_FOREIGN_PARAMS;
    }
    panda_real positive[4 + 2*PANDA_N];
    panda_real others[2 + 2*PANDA_N]; /* not negative */
    int count = 4;
    positive[0] = region->stiffness;
    positive[1] = region->law != NULL ? PANDA_R(1.0) : region->hertz_stiffness;
    positive[2] = region->clamped != 0 ? PANDA_R(1.0) : region->effective_mass;
    positive[3] = PANDA_HORIZON(p);
    others[0] = region->damping;
    others[1] = PANDA_REACTION_TIME(p);
    for (int i = 0; i < PANDA_N; ++i) {
        others[2 + 2*i] = PANDA_GAIN(p, i);
        others[3 + 2*i] = PANDA_DAMPING_GAIN(p, i);
#if PANDA_ELASTIC
        positive[count] = PANDA_SPRING(p, i);
        positive[count + 1] = PANDA_ROTOR(p, i);
        count += 2;
#endif
    }
    int status = panda_check_positive(positive, count);
    if (status == PANDA_OK) {
        status = panda_check_not_negative(others, 2 + 2*PANDA_N);
    }
    if (status != PANDA_OK) {
        return status;
    }
    const bool motion = p->motors >= PANDA_MOTORS_FREE_OR_DRIVEN && p->motors <= PANDA_MOTORS_SERVO
        && p->steps > 0 && p->steps <= MOST_STEPS;
    return motion && panda_law_is_one(region) ? PANDA_OK : PANDA_OUT_OF_RANGE;
}

int panda_arrive(const panda_real n[3], int point, panda_arrival *arrival)
{
    panda_real u[3];
    const int status = panda_unit_vector(n, u);
    if (status != PANDA_OK) {
        return status;
    }
    const panda_real (*const J)[PANDA_N] = (const panda_real (*)[PANDA_N])&arrival->links.J[3*point];
    panda_matrix square;
    panda_real moved[PANDA_REACH][PANDA_N];
    panda_real share[PANDA_SYSTEM];
    panda_real wanted[PANDA_REACH];
    panda_real within = PANDA_R(0.0);
    panda_real whole = PANDA_R(0.0); /* of which a pivot of rounding is no motion */
    for (int i = 0; i < PANDA_N; ++i) {
        arrival->row[i] = u[0]*J[0][i] + u[1]*J[1][i] + u[2]*J[2][i];
    }
    for (int k = 0; k < PANDA_REACH; ++k) {
        const panda_real *const d = panda_directions[k];
        share[k] = d[0]*u[0] + d[1]*u[1] + d[2]*u[2];
        wanted[k] = share[k];
        within += share[k]*share[k];
        for (int i = 0; i < PANDA_N; ++i) {
            moved[k][i] = panda_has_motor[i] ? d[0]*J[0][i] + d[1]*J[1][i] + d[2]*J[2][i] : PANDA_R(0.0);
        }
        for (int l = 0; l <= k; ++l) {
            panda_real sum = PANDA_R(0.0);
            for (int i = 0; i < PANDA_N; ++i) {
                sum += moved[k][i]*moved[l][i];
            }
            square[k][l] = sum;
            square[l][k] = sum;
        }
        whole += square[k][k];
    }
    if (!(within > PANDA_R(1.0) - OUTSIDE) || !panda_cholesky(PANDA_REACH, square)) {
        return PANDA_SINGULAR;
    }
    panda_real least = whole;
    for (int k = 0; k < PANDA_REACH; ++k) {
        least = PANDA_FMIN(least, square[k][k]*square[k][k]);
    }
    if (!(least > ROUNDING*whole)) {
        return PANDA_SINGULAR;
    }
    panda_forward(PANDA_REACH, square, share);
    panda_backward(PANDA_REACH, square, share);
    panda_real fast = PANDA_R(0.0);
    panda_real astray = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        panda_real rate = PANDA_R(0.0);
        for (int k = 0; k < PANDA_REACH; ++k) {
            rate += moved[k][i]*share[k];
        }
        arrival->rates[i] = rate;
        fast += rate*rate;
    }
    for (int k = 0; k < PANDA_REACH && least < WEAK*whole; ++k) {
        panda_real missed = wanted[k];
        for (int i = 0; i < PANDA_N; ++i) {
            missed -= moved[k][i]*arrival->rates[i];
        }
        astray += missed*missed;
    }
    return fast < PANDA_FASTEST && astray < ASTRAY*ASTRAY ? PANDA_OK : PANDA_SINGULAR;
}

int panda_set_off(const panda_real q[PANDA_JOINTS], const panda_real dq[PANDA_JOINTS],
    const panda_params *p, panda_real rates[PANDA_N], panda_arrival *arrival)
{
    const int status = panda_check_finite(dq, PANDA_JOINTS);
    for (int i = 0; i < PANDA_N; ++i) {
        rates[i] = dq[PANDA_INDEPENDENT(i)];
    }
    (void)q;
    (void)p;
    return status == PANDA_OK ? panda_links(PANDA_LINKS_OF(q, p), &arrival->links) : status;
}

panda_real panda_arrive_as_it_moves(int point, const panda_real rates[PANDA_N], panda_arrival *arrival)
{
    panda_real v[3];
    for (int k = 0; k < 3; ++k) {
        v[k] = PANDA_R(0.0);
        for (int i = 0; i < PANDA_N; ++i) {
            v[k] += arrival->links.J[3*point + k][i]*rates[i];
        }
    }
    const panda_real speed = PANDA_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
    for (int i = 0; i < PANDA_N && speed > PANDA_R(0.0); ++i) {
        arrival->row[i] = PANDA_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
    return speed;
}

void panda_kinds_of_motors(const panda_params *p, int *first, int *last)
{
    const bool both = p->motors == PANDA_MOTORS_FREE_OR_DRIVEN;
    *first = both ? PANDA_MOTORS_FREE : p->motors;
    *last = both ? PANDA_MOTORS_DRIVEN : p->motors;
}

int panda_approach(const panda_real q[PANDA_JOINTS], int point, const panda_real n[3],
    const panda_region *region, const panda_params *p, panda_impact *impact)
{
    int status = panda_check_impact(region, p);
    if (status == PANDA_OK && !(point >= 0 && point < PANDA_POINTS)) {
        status = PANDA_OUT_OF_RANGE;
    }
    if (status == PANDA_OK) {
        status = panda_links(PANDA_LINKS_OF(q, p), &impact->arrival.links);
    }
    if (status == PANDA_OK) {
        status = panda_arrive(n, point, &impact->arrival);
    }
    panda_impact_forget(impact);
    return status;
}
