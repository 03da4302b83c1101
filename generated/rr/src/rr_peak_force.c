/* SPDX-License-Identifier: 0BSD */
/* Largest force of an impact of rr_ on a part of the body. */
#include "rr_impact.h"

int rr_find_peak(const rr_region *region, const rr_params *p, rr_real speed,
    rr_impact *impact, rr_peak_force_t *out)
{
    rr_budget budget = {p->steps, false, false, RR_REAL_MAX, NULL};
    rr_peak_force_t found = {RR_R(0.0), RR_R(0.0)};
    bool bounded = false;
    int first;
    int last;
    rr_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const int status = rr_impact_prepare(region, p, motors, -speed, impact);
        if (status != RR_OK) {
            return status;
        }
        rr_peak peak;
        rr_impact_run(impact, speed, &budget, &peak);
        if (impact->status != RR_OK) {
            return impact->status;
        }
        if (!peak.ended || peak.torn) {
            const rr_real bound = rr_bound(impact);
            if (!(bound > RR_R(0.0))) {
                return RR_UNRESOLVED;
            }
            bounded = true;
            peak.force = bound*speed;
        }
        if (peak.force > found.force) {
            found.force = peak.force;
            found.time = peak.time;
        }
    }
    if (!(rr_check_positive(&found.force, 1) == RR_OK && rr_all_finite(&found.time, 1))) {
        return RR_SINGULAR;
    }
    *out = found;
    return bounded ? RR_BOUNDED : RR_OK;
}

int rr_peak_force_at(const rr_real q[RR_JOINTS], int point, const rr_real n[3],
    rr_real speed, const rr_region *region, const rr_params *p, rr_peak_force_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    rr_impact impact;
    int status = rr_check_positive(&speed, 1);
    if (status == RR_OK) {
        status = rr_approach(q, point, n, region, p, &impact);
    }
    return status == RR_OK ? rr_find_peak(region, p, speed, &impact, out) : status;
}

int rr_peak_force(const rr_real q[RR_JOINTS], const rr_real n[3], rr_real speed,
    const rr_region *region, const rr_params *p, rr_peak_force_t *out)
{
    return rr_peak_force_at(q, RR_POINT_TIP, n, speed, region, p, out);
}
