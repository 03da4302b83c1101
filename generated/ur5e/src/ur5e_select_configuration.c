/* SPDX-License-Identifier: 0BSD */
/* The pose of ur5e_ whose impact hurts least. */
#include "ur5e_impact.h"

int ur5e_select_configuration(const ur5e_real poses[][UR5E_JOINTS], int count,
    const unsigned char *allowed, const ur5e_real n[3], ur5e_real speed, const ur5e_region *region,
    const ur5e_params *p, ur5e_selection_t *out)
{
    if (poses == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_selection_t found = {-1, -1, 0, UR5E_R(0.0), UR5E_R(0.0)};
    ur5e_real second_force = UR5E_R(0.0);
    for (int i = 0; i < count; ++i) {
        if (allowed != NULL && allowed[i] == 0) {
            continue;
        }
        ur5e_peak_force_t peak;
        const int status = ur5e_peak_force(poses[i], n, speed, region, p, &peak);
        if (status == UR5E_SINGULAR || status == UR5E_UNRESOLVED || status == UR5E_BOUNDED) {
            continue;
        }
        if (status != UR5E_OK) {
            return status;
        }
        ++found.usable;
        if (found.best < 0 || peak.force < found.force) {
            found.second = found.best;
            second_force = found.force;
            found.best = i;
            found.force = peak.force;
        } else {
            const bool is_second = found.second < 0 || peak.force < second_force;
            found.second = is_second ? i : found.second;
            second_force = is_second ? peak.force : second_force;
        }
    }
    if (found.best < 0) {
        return UR5E_SINGULAR;
    }
    if (found.second >= 0) {
        found.margin = second_force - found.force;
    }
    *out = found;
    return UR5E_OK;
}
