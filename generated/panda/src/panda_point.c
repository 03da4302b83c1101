/* SPDX-License-Identifier: 0BSD */
/* A contact point of panda_ that is given at run time: a place in a frame of any of its links. */
#include "panda_impact.h"

/* Puts the motion of a place in a frame where the package's own point has its, three rows of J. */
static void put_in(const panda_frame_place *frame, const panda_real place[3],
    panda_real poses[PANDA_N][12], panda_links_t *links)
{
    panda_real local[3];
    panda_real at[3];
    const panda_real *const pose = poses[frame->joint];
    for (int k = 0; k < 3; ++k) {
        const panda_real *const row = frame->rotation[k];
        local[k] = frame->position[k] + row[0]*place[0] + row[1]*place[1] + row[2]*place[2];
    }
    for (int k = 0; k < 3; ++k) {
        at[k] = pose[9 + k] + pose[3*k]*local[0] + pose[3*k + 1]*local[1] + pose[3*k + 2]*local[2];
    }
    for (int i = 0; i < PANDA_N; ++i) {
        const panda_real *const joint = poses[i];
        const panda_real axis[3] = {joint[2], joint[5], joint[8]};
        const panda_real arm[3] = {at[0] - joint[9], at[1] - joint[10], at[2] - joint[11]};
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3;
            const int b = (k + 2) % 3;
            const panda_real way = panda_joint_slides[i] ? axis[k] : axis[a]*arm[b] - axis[b]*arm[a];
            links->J[k][i] = panda_joint_moves[i][frame->joint] ? way : PANDA_R(0.0);
        }
    }
}

int panda_links_on(const panda_real q[PANDA_JOINTS], int frame, const panda_real place[3],
    const panda_params *p, panda_links_t *links)
{
    panda_real poses[PANDA_N][12];
    int status = frame >= 0 && frame < PANDA_FRAMES ? PANDA_OK : PANDA_OUT_OF_RANGE;
    (void)p;
    if (status == PANDA_OK) {
        status = panda_check_finite(place, 3);
    }
    if (status == PANDA_OK) {
        status = panda_links(PANDA_LINKS_OF(q, p), links);
    }
    if (status == PANDA_OK) {
        status = panda_joint_frames(q, poses);
    }
    if (status == PANDA_OK) {
        put_in(&panda_frame_places[frame], place, poses, links);
        status = panda_all_finite(&links->J[0][0], 3*PANDA_N) ? PANDA_OK : PANDA_SINGULAR;
    }
    return status;
}

/* Checks and links of an impact of the place. */
static int approach_on(const panda_real *q, int frame, const panda_real *place, const panda_real *n,
    const panda_region *region, const panda_params *p, panda_impact *impact)
{
    int status = panda_check_impact(region, p);
    if (status == PANDA_OK) {
        status = panda_links_on(q, frame, place, p, &impact->arrival.links);
    }
    if (status == PANDA_OK) {
        status = panda_arrive(n, 0, &impact->arrival);
    }
    panda_impact_forget(impact);
    return status;
}

int panda_peak_force_on(const panda_real q[PANDA_JOINTS], int frame, const panda_real place[3],
    const panda_real n[3], panda_real speed, const panda_region *region, const panda_params *p,
    panda_peak_force_t *out)
{
    if (q == NULL || place == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_impact impact;
    int status = panda_check_positive(&speed, 1);
    if (status == PANDA_OK) {
        status = approach_on(q, frame, place, n, region, p, &impact);
    }
    return status == PANDA_OK ? panda_find_peak(region, p, speed, &impact, out) : status;
}

int panda_safe_speed_on(const panda_real q[PANDA_JOINTS], int frame, const panda_real place[3],
    const panda_real n[3], panda_real limit, const panda_region *region, const panda_params *p,
    panda_safe_speed_t *out)
{
    if (q == NULL || place == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_impact impact;
    int status = panda_check_positive(&limit, 1);
    if (status == PANDA_OK) {
        status = approach_on(q, frame, place, n, region, p, &impact);
    }
    if (status != PANDA_OK) {
        return status;
    }
    panda_safe_speed_t found;
    status = panda_find_speed(region, p, limit, PANDA_R(0.0), &impact, &found);
    if (status == PANDA_OK || status == PANDA_BOUNDED) {
        *out = found;
    }
    return status;
}
