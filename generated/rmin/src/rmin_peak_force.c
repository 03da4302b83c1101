/* SPDX-License-Identifier: 0BSD */
/* Largest force of an impact of rmin_ on a part of the body. */
#include "rmin_impact.h"

int rmin_find_peak(const rmin_region *region, const rmin_params *p, rmin_real speed,
    rmin_impact *impact, rmin_peak_force_t *out)
{
    rmin_budget budget = {p->steps, false, false, RMIN_REAL_MAX, NULL};
    rmin_peak_force_t found = {RMIN_R(0.0), RMIN_R(0.0)};
    bool bounded = false;
    int first;
    int last;
    rmin_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const int status = rmin_impact_prepare(region, p, motors, -speed, impact);
        if (status != RMIN_OK) {
            return status;
        }
        rmin_peak peak;
        rmin_impact_run(impact, speed, &budget, &peak);
        if (impact->status != RMIN_OK) {
            return impact->status;
        }
        if (!peak.ended || peak.torn) {
            const rmin_real bound = rmin_bound(impact);
            if (!(bound > RMIN_R(0.0))) {
                return RMIN_UNRESOLVED;
            }
            bounded = true;
            peak.force = bound*speed;
        }
        if (peak.force > found.force) {
            found.force = peak.force;
            found.time = peak.time;
        }
    }
    if (!(rmin_check_positive(&found.force, 1) == RMIN_OK && rmin_all_finite(&found.time, 1))) {
        return RMIN_SINGULAR;
    }
    *out = found;
    return bounded ? RMIN_BOUNDED : RMIN_OK;
}

int rmin_peak_force_at(const rmin_real q[RMIN_JOINTS], int point, const rmin_real n[3],
    rmin_real speed, const rmin_region *region, const rmin_params *p, rmin_peak_force_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    rmin_impact impact;
    int status = rmin_check_positive(&speed, 1);
    if (status == RMIN_OK) {
        status = rmin_approach(q, point, n, region, p, &impact);
    }
    return status == RMIN_OK ? rmin_find_peak(region, p, speed, &impact, out) : status;
}

int rmin_peak_force(const rmin_real q[RMIN_JOINTS], const rmin_real n[3], rmin_real speed,
    const rmin_region *region, const rmin_params *p, rmin_peak_force_t *out)
{
    return rmin_peak_force_at(q, RMIN_POINT_TIP, n, speed, region, p, out);
}
