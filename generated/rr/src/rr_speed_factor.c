/* SPDX-License-Identifier: 0BSD */
/* By how much rr_ has to slow down so that no contact point hits too hard. */
#include "rr_impact.h"

/* Speed of a contact point that counts as rest: it can hardly be measured. */
#define AT_REST RR_R(1e-6)

/* Velocity of a contact point; returns its size. */
static rr_real velocity_of(const rr_links_t *links, int point, const rr_real *rates, rr_real v[3])
{
    for (int k = 0; k < 3; ++k) {
        v[k] = RR_R(0.0);
        for (int i = 0; i < RR_N; ++i) {
            v[k] += links->J[3*point + k][i]*rates[i];
        }
    }
    return RR_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
}

/* Prepares the arrival of a point that moves at v with the joint velocities there are. */
static void arrive_as_it_moves(int point, const rr_real *rates, const rr_real v[3],
    rr_real speed, rr_arrival *arrival)
{
    for (int i = 0; i < RR_N; ++i) {
        arrival->row[i] = RR_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
}

int rr_speed_factor(const rr_real q[RR_JOINTS], const rr_real dq[RR_JOINTS],
    rr_real limit, const rr_region *region, const rr_params *p, rr_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    int status = rr_check_finite(dq, RR_JOINTS);
    rr_impact impact;
    if (status == RR_OK) {
        status = rr_check_positive(&limit, 1);
    }
    if (status == RR_OK) {
        status = rr_check_impact(region, p);
    }
    if (status == RR_OK) {
        status = rr_links(RR_LINKS_OF(q, p), &impact.arrival.links);
    }
    if (status != RR_OK) {
        return status;
    }
    rr_real rates[RR_N];
    for (int i = 0; i < RR_N; ++i) {
        rates[i] = dq[RR_INDEPENDENT(i)];
    }
    rr_speed_factor_t found = {RR_R(1.0), -1, RR_R(0.0), RR_R(0.0)};
    bool bounded = false;
    for (int point = 0; point < RR_POINTS; ++point) {
        rr_real v[3];
        const rr_real speed = velocity_of(&impact.arrival.links, point, rates, v);
        if (!(speed > AT_REST)) {
            continue;
        }
        rr_safe_speed_t safe;
        arrive_as_it_moves(point, rates, v, speed, &impact.arrival);
        status = rr_find_speed(region, p, limit, found.factor*speed, &impact, &safe);
        if (status != RR_OK && status != RR_BOUNDED) {
            return status;
        }
        bounded = bounded || status == RR_BOUNDED;
        if (safe.speed < found.factor*speed || found.point < 0) {
            found.factor = RR_FMIN(found.factor, safe.speed/speed);
            found.point = point;
            found.speed = safe.speed;
            found.force = safe.force;
        }
    }
    const rr_real numbers[3] = {found.factor, found.speed, found.force};
    if (!(rr_check_share(numbers, 1) == RR_OK && rr_all_finite(numbers, 3))) {
        return RR_SINGULAR;
    }
    *out = found;
    return bounded ? RR_BOUNDED : RR_OK;
}
