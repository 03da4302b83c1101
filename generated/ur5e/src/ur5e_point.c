/* SPDX-License-Identifier: 0BSD */
/* A contact point of ur5e_ that is given at run time: a place in a frame of any of its links. */
#include "ur5e_impact.h"

/* Puts the motion of a place in a frame where the package's own point has its, three rows of J. */
static void put_in(const ur5e_frame_place *frame, const ur5e_real place[3],
    ur5e_real poses[UR5E_N][12], ur5e_links_t *links)
{
    ur5e_real local[3];
    ur5e_real at[3];
    const ur5e_real *const pose = poses[frame->joint];
    for (int k = 0; k < 3; ++k) {
        const ur5e_real *const row = frame->rotation[k];
        local[k] = frame->position[k] + row[0]*place[0] + row[1]*place[1] + row[2]*place[2];
    }
    for (int k = 0; k < 3; ++k) {
        at[k] = pose[9 + k] + pose[3*k]*local[0] + pose[3*k + 1]*local[1] + pose[3*k + 2]*local[2];
    }
    for (int i = 0; i < UR5E_N; ++i) {
        const ur5e_real *const joint = poses[i];
        const ur5e_real axis[3] = {joint[2], joint[5], joint[8]};
        const ur5e_real arm[3] = {at[0] - joint[9], at[1] - joint[10], at[2] - joint[11]};
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3;
            const int b = (k + 2) % 3;
            const ur5e_real way = ur5e_joint_slides[i] ? axis[k] : axis[a]*arm[b] - axis[b]*arm[a];
            links->J[k][i] = ur5e_joint_moves[i][frame->joint] ? way : UR5E_R(0.0);
        }
    }
}

int ur5e_links_on(const ur5e_real q[UR5E_JOINTS], int frame, const ur5e_real place[3],
    const ur5e_params *p, ur5e_links_t *links)
{
    ur5e_real poses[UR5E_N][12];
    int status = frame >= 0 && frame < UR5E_FRAMES ? UR5E_OK : UR5E_OUT_OF_RANGE;
    (void)p;
    if (status == UR5E_OK) {
        status = ur5e_check_finite(place, 3);
    }
    if (status == UR5E_OK) {
        status = ur5e_links(UR5E_LINKS_OF(q, p), links);
    }
    if (status == UR5E_OK) {
        status = ur5e_joint_frames(q, poses);
    }
    if (status == UR5E_OK) {
        put_in(&ur5e_frame_places[frame], place, poses, links);
        status = ur5e_all_finite(&links->J[0][0], 3*UR5E_N) ? UR5E_OK : UR5E_SINGULAR;
    }
    return status;
}

/* Checks and links of an impact of the place. */
static int approach_on(const ur5e_real *q, int frame, const ur5e_real *place, const ur5e_real *n,
    const ur5e_region *region, const ur5e_params *p, ur5e_impact *impact)
{
    int status = ur5e_check_impact(region, p);
    if (status == UR5E_OK) {
        status = ur5e_links_on(q, frame, place, p, &impact->arrival.links);
    }
    if (status == UR5E_OK) {
        status = ur5e_arrive(n, 0, &impact->arrival);
    }
    ur5e_impact_forget(impact);
    return status;
}

int ur5e_peak_force_on(const ur5e_real q[UR5E_JOINTS], int frame, const ur5e_real place[3],
    const ur5e_real n[3], ur5e_real speed, const ur5e_region *region, const ur5e_params *p,
    ur5e_peak_force_t *out)
{
    if (q == NULL || place == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_impact impact;
    int status = ur5e_check_positive(&speed, 1);
    if (status == UR5E_OK) {
        status = approach_on(q, frame, place, n, region, p, &impact);
    }
    return status == UR5E_OK ? ur5e_find_peak(region, p, speed, &impact, out) : status;
}

int ur5e_safe_speed_on(const ur5e_real q[UR5E_JOINTS], int frame, const ur5e_real place[3],
    const ur5e_real n[3], ur5e_real limit, const ur5e_region *region, const ur5e_params *p,
    ur5e_safe_speed_t *out)
{
    if (q == NULL || place == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_impact impact;
    int status = ur5e_check_positive(&limit, 1);
    if (status == UR5E_OK) {
        status = approach_on(q, frame, place, n, region, p, &impact);
    }
    if (status != UR5E_OK) {
        return status;
    }
    ur5e_safe_speed_t found;
    status = ur5e_find_speed(region, p, limit, UR5E_R(0.0), &impact, &found);
    if (status == UR5E_OK || status == UR5E_BOUNDED) {
        *out = found;
    }
    return status;
}
