/* SPDX-License-Identifier: 0BSD */
/* Largest force of an impact of panda_ on a part of the body. */
#include "panda_impact.h"

int panda_find_peak(const panda_region *region, const panda_params *p, panda_real speed,
    panda_impact *impact, panda_peak_force_t *out)
{
    panda_budget budget = {p->steps, false, false, PANDA_REAL_MAX, NULL};
    panda_peak_force_t found = {PANDA_R(0.0), PANDA_R(0.0)};
    bool bounded = false;
    int first;
    int last;
    panda_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const int status = panda_impact_prepare(region, p, motors, -speed, impact);
        if (status != PANDA_OK) {
            return status;
        }
        panda_peak peak;
        panda_impact_run(impact, speed, &budget, &peak);
        if (impact->status != PANDA_OK) {
            return impact->status;
        }
        if (!peak.ended || peak.torn) {
            const panda_real bound = panda_bound(impact);
            if (!(bound > PANDA_R(0.0))) {
                return PANDA_UNRESOLVED;
            }
            bounded = true;
            peak.force = bound*speed;
        }
        if (peak.force > found.force) {
            found.force = peak.force;
            found.time = peak.time;
        }
    }
    if (!(panda_check_positive(&found.force, 1) == PANDA_OK && panda_all_finite(&found.time, 1))) {
        return PANDA_SINGULAR;
    }
    *out = found;
    return bounded ? PANDA_BOUNDED : PANDA_OK;
}

int panda_peak_force_at(const panda_real q[PANDA_JOINTS], int point, const panda_real n[3],
    panda_real speed, const panda_region *region, const panda_params *p, panda_peak_force_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_impact impact;
    int status = panda_check_positive(&speed, 1);
    if (status == PANDA_OK) {
        status = panda_approach(q, point, n, region, p, &impact);
    }
    return status == PANDA_OK ? panda_find_peak(region, p, speed, &impact, out) : status;
}

int panda_peak_force(const panda_real q[PANDA_JOINTS], const panda_real n[3], panda_real speed,
    const panda_region *region, const panda_params *p, panda_peak_force_t *out)
{
    return panda_peak_force_at(q, PANDA_POINT_TIP, n, speed, region, p, out);
}
