/* SPDX-License-Identifier: BSD-3-Clause */
/* What the shim's sources share. */
#ifndef ROBOT_PAGE_STEPS_H
#define ROBOT_PAGE_STEPS_H

#include "robot_impact.h"

/*
 * Follows an impact at a speed through its steps; `out` may be NULL. Returns the largest force from
 * half a second on, the largest of numbers where the steps do not do.
 */
robot_real robot_run_seen(robot_impact *impact, robot_real speed, int steps, robot_peak *peak,
    robot_follow_t *out);

#endif
