/* SPDX-License-Identifier: 0BSD */
/* The pose of rmin_ whose impact hurts least. */
#include "rmin_impact.h"

int rmin_select_configuration(const rmin_real poses[][RMIN_JOINTS], int count,
    const unsigned char *allowed, const rmin_real n[3], rmin_real speed, const rmin_region *region,
    const rmin_params *p, rmin_selection_t *out)
{
    if (poses == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    rmin_selection_t found = {-1, -1, 0, RMIN_R(0.0), RMIN_R(0.0)};
    rmin_real second_force = RMIN_R(0.0);
    for (int i = 0; i < count; ++i) {
        if (allowed != NULL && allowed[i] == 0) {
            continue;
        }
        rmin_peak_force_t peak;
        const int status = rmin_peak_force(poses[i], n, speed, region, p, &peak);
        if (status == RMIN_SINGULAR || status == RMIN_UNRESOLVED || status == RMIN_BOUNDED) {
            continue;
        }
        if (status != RMIN_OK) {
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
        return RMIN_SINGULAR;
    }
    if (found.second >= 0) {
        found.margin = second_force - found.force;
    }
    *out = found;
    return RMIN_OK;
}
