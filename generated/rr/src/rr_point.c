/* SPDX-License-Identifier: 0BSD */
/* A contact point of rr_ that is given at run time: a place in a frame of any of its links. */
#include "rr_impact.h"

/* Puts the motion of a place in a frame where the package's own point has its, three rows of J. */
static void put_in(const rr_frame_place *frame, const rr_real place[3],
    rr_real poses[RR_N][12], rr_links_t *links)
{
    rr_real local[3];
    rr_real at[3];
    const rr_real *const pose = poses[frame->joint];
    for (int k = 0; k < 3; ++k) {
        const rr_real *const row = frame->rotation[k];
        local[k] = frame->position[k] + row[0]*place[0] + row[1]*place[1] + row[2]*place[2];
    }
    for (int k = 0; k < 3; ++k) {
        at[k] = pose[9 + k] + pose[3*k]*local[0] + pose[3*k + 1]*local[1] + pose[3*k + 2]*local[2];
    }
    for (int i = 0; i < RR_N; ++i) {
        const rr_real *const joint = poses[i];
        const rr_real axis[3] = {joint[2], joint[5], joint[8]};
        const rr_real arm[3] = {at[0] - joint[9], at[1] - joint[10], at[2] - joint[11]};
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3;
            const int b = (k + 2) % 3;
            const rr_real way = rr_joint_slides[i] ? axis[k] : axis[a]*arm[b] - axis[b]*arm[a];
            links->J[k][i] = rr_joint_moves[i][frame->joint] ? way : RR_R(0.0);
        }
    }
}

int rr_links_on(const rr_real q[RR_JOINTS], int frame, const rr_real place[3],
    const rr_params *p, rr_links_t *links)
{
    rr_real poses[RR_N][12];
    int status = frame >= 0 && frame < RR_FRAMES ? RR_OK : RR_OUT_OF_RANGE;
    (void)p;
    if (status == RR_OK) {
        status = rr_check_finite(place, 3);
    }
    if (status == RR_OK) {
        status = rr_links(RR_LINKS_OF(q, p), links);
    }
    if (status == RR_OK) {
        status = rr_joint_frames(q, poses);
    }
    if (status == RR_OK) {
        put_in(&rr_frame_places[frame], place, poses, links);
        status = rr_all_finite(&links->J[0][0], 3*RR_N) ? RR_OK : RR_SINGULAR;
    }
    return status;
}

/* Checks and links of an impact of the place. */
static int approach_on(const rr_real *q, int frame, const rr_real *place, const rr_real *n,
    const rr_region *region, const rr_params *p, rr_impact *impact)
{
    int status = rr_check_impact(region, p);
    if (status == RR_OK) {
        status = rr_links_on(q, frame, place, p, &impact->arrival.links);
    }
    if (status == RR_OK) {
        status = rr_arrive(n, 0, &impact->arrival);
    }
    rr_impact_forget(impact);
    return status;
}

int rr_peak_force_on(const rr_real q[RR_JOINTS], int frame, const rr_real place[3],
    const rr_real n[3], rr_real speed, const rr_region *region, const rr_params *p,
    rr_peak_force_t *out)
{
    if (q == NULL || place == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    rr_impact impact;
    int status = rr_check_positive(&speed, 1);
    if (status == RR_OK) {
        status = approach_on(q, frame, place, n, region, p, &impact);
    }
    return status == RR_OK ? rr_find_peak(region, p, speed, &impact, out) : status;
}

int rr_safe_speed_on(const rr_real q[RR_JOINTS], int frame, const rr_real place[3],
    const rr_real n[3], rr_real limit, const rr_region *region, const rr_params *p,
    rr_safe_speed_t *out)
{
    if (q == NULL || place == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    rr_impact impact;
    int status = rr_check_positive(&limit, 1);
    if (status == RR_OK) {
        status = approach_on(q, frame, place, n, region, p, &impact);
    }
    if (status != RR_OK) {
        return status;
    }
    rr_safe_speed_t found;
    status = rr_find_speed(region, p, limit, RR_R(0.0), &impact, &found);
    if (status == RR_OK || status == RR_BOUNDED) {
        *out = found;
    }
    return status;
}
