/* SPDX-License-Identifier: 0BSD */
/* The pose of panda_ whose impact hurts least. */
#include "panda_impact.h"

int panda_select_configuration(const panda_real poses[][PANDA_JOINTS], int count,
    const unsigned char *allowed, const panda_real n[3], panda_real speed, const panda_region *region,
    const panda_params *p, panda_selection_t *out)
{
    if (poses == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_selection_t found = {-1, -1, 0, PANDA_R(0.0), PANDA_R(0.0)};
    panda_real second_force = PANDA_R(0.0);
    for (int i = 0; i < count; ++i) {
        if (allowed != NULL && allowed[i] == 0) {
            continue;
        }
        panda_peak_force_t peak;
        const int status = panda_peak_force(poses[i], n, speed, region, p, &peak);
        if (status == PANDA_SINGULAR || status == PANDA_UNRESOLVED || status == PANDA_BOUNDED) {
            continue;
        }
        if (status != PANDA_OK) {
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
        return PANDA_SINGULAR;
    }
    if (found.second >= 0) {
        found.margin = second_force - found.force;
    }
    *out = found;
    return PANDA_OK;
}
