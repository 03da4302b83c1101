/* SPDX-License-Identifier: 0BSD */
/* By how much rmin_ has to slow down so that no contact point hits too hard. */
#include "rmin_impact.h"

/* Speed of a contact point that counts as rest: it can hardly be measured. */
#define AT_REST RMIN_R(1e-6)

/* Velocity of a contact point; returns its size. */
static rmin_real velocity_of(const rmin_links_t *links, int point, const rmin_real *rates, rmin_real v[3])
{
    for (int k = 0; k < 3; ++k) {
        v[k] = RMIN_R(0.0);
        for (int i = 0; i < RMIN_N; ++i) {
            v[k] += links->J[3*point + k][i]*rates[i];
        }
    }
    return RMIN_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
}

/* Prepares the arrival of a point that moves at v with the joint velocities there are. */
static void arrive_as_it_moves(int point, const rmin_real *rates, const rmin_real v[3],
    rmin_real speed, rmin_arrival *arrival)
{
    for (int i = 0; i < RMIN_N; ++i) {
        arrival->row[i] = RMIN_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
}

int rmin_speed_factor(const rmin_real q[RMIN_JOINTS], const rmin_real dq[RMIN_JOINTS],
    rmin_real limit, const rmin_region *region, const rmin_params *p, rmin_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    int status = rmin_check_finite(dq, RMIN_JOINTS);
    rmin_impact impact;
    if (status == RMIN_OK) {
        status = rmin_check_positive(&limit, 1);
    }
    if (status == RMIN_OK) {
        status = rmin_check_impact(region, p);
    }
    if (status == RMIN_OK) {
        status = rmin_links(RMIN_LINKS_OF(q, p), &impact.arrival.links);
    }
    if (status != RMIN_OK) {
        return status;
    }
    rmin_real rates[RMIN_N];
    for (int i = 0; i < RMIN_N; ++i) {
        rates[i] = dq[RMIN_INDEPENDENT(i)];
    }
    rmin_speed_factor_t found = {RMIN_R(1.0), -1, RMIN_R(0.0), RMIN_R(0.0)};
    bool bounded = false;
    for (int point = 0; point < RMIN_POINTS; ++point) {
        rmin_real v[3];
        const rmin_real speed = velocity_of(&impact.arrival.links, point, rates, v);
        if (!(speed > AT_REST)) {
            continue;
        }
        rmin_safe_speed_t safe;
        arrive_as_it_moves(point, rates, v, speed, &impact.arrival);
        status = rmin_find_speed(region, p, limit, found.factor*speed, &impact, &safe);
        if (status != RMIN_OK && status != RMIN_BOUNDED) {
            return status;
        }
        bounded = bounded || status == RMIN_BOUNDED;
        if (safe.speed < found.factor*speed || found.point < 0) {
            found.factor = RMIN_FMIN(found.factor, safe.speed/speed);
            found.point = point;
            found.speed = safe.speed;
            found.force = safe.force;
        }
    }
    const rmin_real numbers[3] = {found.factor, found.speed, found.force};
    if (!(rmin_check_share(numbers, 1) == RMIN_OK && rmin_all_finite(numbers, 3))) {
        return RMIN_SINGULAR;
    }
    *out = found;
    return bounded ? RMIN_BOUNDED : RMIN_OK;
}
