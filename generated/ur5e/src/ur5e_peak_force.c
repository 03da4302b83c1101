/* SPDX-License-Identifier: 0BSD */
/* Largest force of an impact of ur5e_ on a part of the body. */
#include "ur5e_impact.h"

int ur5e_find_peak(const ur5e_region *region, const ur5e_params *p, ur5e_real speed,
    ur5e_impact *impact, ur5e_peak_force_t *out)
{
    ur5e_budget budget = {p->steps, false, false, UR5E_REAL_MAX, NULL};
    ur5e_peak_force_t found = {UR5E_R(0.0), UR5E_R(0.0)};
    bool bounded = false;
    int first;
    int last;
    ur5e_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const int status = ur5e_impact_prepare(region, p, motors, -speed, impact);
        if (status != UR5E_OK) {
            return status;
        }
        ur5e_peak peak;
        ur5e_impact_run(impact, speed, &budget, &peak);
        if (impact->status != UR5E_OK) {
            return impact->status;
        }
        if (!peak.ended || peak.torn) {
            const ur5e_real bound = ur5e_bound(impact);
            if (!(bound > UR5E_R(0.0))) {
                return UR5E_UNRESOLVED;
            }
            bounded = true;
            peak.force = bound*speed;
        }
        if (peak.force > found.force) {
            found.force = peak.force;
            found.time = peak.time;
        }
    }
    if (!(ur5e_check_positive(&found.force, 1) == UR5E_OK && ur5e_all_finite(&found.time, 1))) {
        return UR5E_SINGULAR;
    }
    *out = found;
    return bounded ? UR5E_BOUNDED : UR5E_OK;
}

int ur5e_peak_force_at(const ur5e_real q[UR5E_JOINTS], int point, const ur5e_real n[3],
    ur5e_real speed, const ur5e_region *region, const ur5e_params *p, ur5e_peak_force_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_impact impact;
    int status = ur5e_check_positive(&speed, 1);
    if (status == UR5E_OK) {
        status = ur5e_approach(q, point, n, region, p, &impact);
    }
    return status == UR5E_OK ? ur5e_find_peak(region, p, speed, &impact, out) : status;
}

int ur5e_peak_force(const ur5e_real q[UR5E_JOINTS], const ur5e_real n[3], ur5e_real speed,
    const ur5e_region *region, const ur5e_params *p, ur5e_peak_force_t *out)
{
    return ur5e_peak_force_at(q, UR5E_POINT_TIP, n, speed, region, p, out);
}
