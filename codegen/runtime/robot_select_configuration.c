/* SPDX-License-Identifier: 0BSD */
/* The pose of robot_ whose impact hurts least. */
#include "robot_impact.h"

int robot_select_configuration(const robot_real poses[][ROBOT_JOINTS], int count,
    const unsigned char *allowed, const robot_real n[3], robot_real speed, const robot_region *region,
    const robot_params *p, robot_selection_t *out)
{
    if (poses == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_selection_t found = {-1, -1, 0, ROBOT_R(0.0), ROBOT_R(0.0)};
    robot_real second_force = ROBOT_R(0.0);
    for (int i = 0; i < count; ++i) {
        if (allowed != NULL && allowed[i] == 0) {
            continue;
        }
        robot_peak_force_t peak;
        const int status = robot_peak_force(poses[i], n, speed, region, p, &peak);
        if (status == ROBOT_SINGULAR || status == ROBOT_UNRESOLVED || status == ROBOT_BOUNDED) {
            continue;
        }
        if (status != ROBOT_OK) {
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
        return ROBOT_SINGULAR;
    }
    if (found.second >= 0) {
        found.margin = second_force - found.force;
    }
    *out = found;
    return ROBOT_OK;
}
