/* SPDX-License-Identifier: 0BSD */
/* By how much robot_ has to slow down so that no contact point hits too hard. */
#include "robot_impact.h"

/* Speed of a contact point that counts as rest: it can hardly be measured. */
#define AT_REST ROBOT_R(1e-6)

/* Velocity of a contact point; returns its size. */
static robot_real velocity_of(const robot_links_t *links, int point, const robot_real *rates, robot_real v[3])
{
    for (int k = 0; k < 3; ++k) {
        v[k] = ROBOT_R(0.0);
        for (int i = 0; i < ROBOT_N; ++i) {
            v[k] += links->J[3*point + k][i]*rates[i];
        }
    }
    return ROBOT_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
}

/* Prepares the arrival of a point that moves at v with the joint velocities there are. */
static void arrive_as_it_moves(int point, const robot_real *rates, const robot_real v[3],
    robot_real speed, robot_arrival *arrival)
{
    for (int i = 0; i < ROBOT_N; ++i) {
        arrival->row[i] = ROBOT_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
}

int robot_speed_factor(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS],
    robot_real limit, const robot_region *region, const robot_params *p, robot_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    int status = robot_check_finite(dq, ROBOT_JOINTS);
    robot_impact impact;
    if (status == ROBOT_OK) {
        status = robot_check_positive(&limit, 1);
    }
    if (status == ROBOT_OK) {
        status = robot_check_impact(region, p);
    }
    if (status == ROBOT_OK) {
        status = robot_links(ROBOT_LINKS_OF(q, p), &impact.arrival.links);
    }
    if (status != ROBOT_OK) {
        return status;
    }
    robot_real rates[ROBOT_N];
    for (int i = 0; i < ROBOT_N; ++i) {
        rates[i] = dq[ROBOT_INDEPENDENT(i)];
    }
    robot_speed_factor_t found = {ROBOT_R(1.0), -1, ROBOT_R(0.0), ROBOT_R(0.0)};
    bool bounded = false;
    for (int point = 0; point < ROBOT_POINTS; ++point) {
        robot_real v[3];
        const robot_real speed = velocity_of(&impact.arrival.links, point, rates, v);
        if (!(speed > AT_REST)) {
            continue;
        }
        robot_safe_speed_t safe;
        arrive_as_it_moves(point, rates, v, speed, &impact.arrival);
        status = robot_find_speed(region, p, limit, found.factor*speed, &impact, &safe);
        if (status != ROBOT_OK && status != ROBOT_BOUNDED) {
            return status;
        }
        bounded = bounded || status == ROBOT_BOUNDED;
        if (safe.speed < found.factor*speed || found.point < 0) {
            found.factor = ROBOT_FMIN(found.factor, safe.speed/speed);
            found.point = point;
            found.speed = safe.speed;
            found.force = safe.force;
        }
    }
    const robot_real numbers[3] = {found.factor, found.speed, found.force};
    if (!(robot_check_share(numbers, 1) == ROBOT_OK && robot_all_finite(numbers, 3))) {
        return ROBOT_SINGULAR;
    }
    *out = found;
    return bounded ? ROBOT_BOUNDED : ROBOT_OK;
}
