/* SPDX-License-Identifier: 0BSD */
/* A contact point of robot_ that is given at run time: a place in a frame of any of its links. */
#include "robot_impact.h"

/* Puts the motion of a place in a frame where the package's own point has its, three rows of J. */
static void put_in(const robot_frame_place *frame, const robot_real place[3],
    robot_real poses[ROBOT_N][12], robot_links_t *links)
{
    robot_real local[3];
    robot_real at[3];
    const robot_real *const pose = poses[frame->joint];
    for (int k = 0; k < 3; ++k) {
        const robot_real *const row = frame->rotation[k];
        local[k] = frame->position[k] + row[0]*place[0] + row[1]*place[1] + row[2]*place[2];
    }
    for (int k = 0; k < 3; ++k) {
        at[k] = pose[9 + k] + pose[3*k]*local[0] + pose[3*k + 1]*local[1] + pose[3*k + 2]*local[2];
    }
    for (int i = 0; i < ROBOT_N; ++i) {
        const robot_real *const joint = poses[i];
        const robot_real axis[3] = {joint[2], joint[5], joint[8]};
        const robot_real arm[3] = {at[0] - joint[9], at[1] - joint[10], at[2] - joint[11]};
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3;
            const int b = (k + 2) % 3;
            const robot_real way = robot_joint_slides[i] ? axis[k] : axis[a]*arm[b] - axis[b]*arm[a];
            links->J[k][i] = robot_joint_moves[i][frame->joint] ? way : ROBOT_R(0.0);
        }
    }
}

int robot_links_on(const robot_real q[ROBOT_JOINTS], int frame, const robot_real place[3],
    const robot_params *p, robot_links_t *links)
{
    robot_real poses[ROBOT_N][12];
    int status = frame >= 0 && frame < ROBOT_FRAMES ? ROBOT_OK : ROBOT_OUT_OF_RANGE;
    (void)p;
    if (status == ROBOT_OK) {
        status = robot_check_finite(place, 3);
    }
    if (status == ROBOT_OK) {
        status = robot_links(ROBOT_LINKS_OF(q, p), links);
    }
    if (status == ROBOT_OK) {
        status = robot_joint_frames(q, poses);
    }
    if (status == ROBOT_OK) {
        put_in(&robot_frame_places[frame], place, poses, links);
        status = robot_all_finite(&links->J[0][0], 3*ROBOT_N) ? ROBOT_OK : ROBOT_SINGULAR;
    }
    return status;
}

/* Checks and links of an impact of the place. */
static int approach_on(const robot_real *q, int frame, const robot_real *place, const robot_real *n,
    const robot_region *region, const robot_params *p, robot_impact *impact)
{
    int status = robot_check_impact(region, p);
    if (status == ROBOT_OK) {
        status = robot_links_on(q, frame, place, p, &impact->arrival.links);
    }
    if (status == ROBOT_OK) {
        status = robot_arrive(n, 0, &impact->arrival);
    }
    robot_impact_forget(impact);
    return status;
}

int robot_peak_force_on(const robot_real q[ROBOT_JOINTS], int frame, const robot_real place[3],
    const robot_real n[3], robot_real speed, const robot_region *region, const robot_params *p,
    robot_peak_force_t *out)
{
    if (q == NULL || place == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_impact impact;
    int status = robot_check_positive(&speed, 1);
    if (status == ROBOT_OK) {
        status = approach_on(q, frame, place, n, region, p, &impact);
    }
    return status == ROBOT_OK ? robot_find_peak(region, p, speed, &impact, out) : status;
}

int robot_safe_speed_on(const robot_real q[ROBOT_JOINTS], int frame, const robot_real place[3],
    const robot_real n[3], robot_real limit, const robot_region *region, const robot_params *p,
    robot_safe_speed_t *out)
{
    if (q == NULL || place == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_impact impact;
    int status = robot_check_positive(&limit, 1);
    if (status == ROBOT_OK) {
        status = approach_on(q, frame, place, n, region, p, &impact);
    }
    if (status != ROBOT_OK) {
        return status;
    }
    robot_safe_speed_t found;
    status = robot_find_speed(region, p, limit, ROBOT_R(0.0), &impact, &found);
    if (status == ROBOT_OK || status == ROBOT_BOUNDED) {
        *out = found;
    }
    return status;
}
