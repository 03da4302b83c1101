/* SPDX-License-Identifier: 0BSD */
/* Largest force of an impact of robot_ on a part of the body. */
#include "robot_impact.h"

int robot_find_peak(const robot_region *region, const robot_params *p, robot_real speed,
    robot_impact *impact, robot_peak_force_t *out)
{
    robot_budget budget = {p->steps, false, false, ROBOT_REAL_MAX, NULL};
    robot_peak_force_t found = {ROBOT_R(0.0), ROBOT_R(0.0)};
    bool bounded = false;
    int first;
    int last;
    robot_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const int status = robot_impact_prepare(region, p, motors, -speed, impact);
        if (status != ROBOT_OK) {
            return status;
        }
        robot_peak peak;
        robot_impact_run(impact, speed, &budget, &peak);
        if (impact->status != ROBOT_OK) {
            return impact->status;
        }
        if (!peak.ended || peak.torn) {
            const robot_real bound = robot_bound(impact);
            if (!(bound > ROBOT_R(0.0))) {
                return ROBOT_UNRESOLVED;
            }
            bounded = true;
            peak.force = bound*speed;
        }
        if (peak.force > found.force) {
            found.force = peak.force;
            found.time = peak.time;
        }
    }
    if (!(robot_check_positive(&found.force, 1) == ROBOT_OK && robot_all_finite(&found.time, 1))) {
        return ROBOT_SINGULAR;
    }
    *out = found;
    return bounded ? ROBOT_BOUNDED : ROBOT_OK;
}

int robot_peak_force_at(const robot_real q[ROBOT_JOINTS], int point, const robot_real n[3],
    robot_real speed, const robot_region *region, const robot_params *p, robot_peak_force_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_impact impact;
    int status = robot_check_positive(&speed, 1);
    if (status == ROBOT_OK) {
        status = robot_approach(q, point, n, region, p, &impact);
    }
    return status == ROBOT_OK ? robot_find_peak(region, p, speed, &impact, out) : status;
}

int robot_peak_force(const robot_real q[ROBOT_JOINTS], const robot_real n[3], robot_real speed,
    const robot_region *region, const robot_params *p, robot_peak_force_t *out)
{
    return robot_peak_force_at(q, ROBOT_POINT_TIP, n, speed, region, p, out);
}
