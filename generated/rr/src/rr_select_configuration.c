/* SPDX-License-Identifier: 0BSD */
/* The pose of rr_ whose impact hurts least. */
#include "rr_impact.h"

int rr_select_configuration(const rr_real poses[][RR_JOINTS], int count,
    const unsigned char *allowed, const rr_real n[3], rr_real speed, const rr_region *region,
    const rr_params *p, rr_selection_t *out)
{
    if (poses == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    rr_selection_t found = {-1, -1, 0, RR_R(0.0), RR_R(0.0)};
    rr_real second_force = RR_R(0.0);
    for (int i = 0; i < count; ++i) {
        if (allowed != NULL && allowed[i] == 0) {
            continue;
        }
        rr_peak_force_t peak;
        const int status = rr_peak_force(poses[i], n, speed, region, p, &peak);
        if (status == RR_SINGULAR || status == RR_UNRESOLVED || status == RR_BOUNDED) {
            continue;
        }
        if (status != RR_OK) {
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
        return RR_SINGULAR;
    }
    if (found.second >= 0) {
        found.margin = second_force - found.force;
    }
    *out = found;
    return RR_OK;
}
