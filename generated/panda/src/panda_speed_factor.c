/* SPDX-License-Identifier: 0BSD */
/* By how much panda_ has to slow down so that no contact point hits too hard. */
#include "panda_impact.h"

/* Speed of a contact point that counts as rest: it can hardly be measured. */
#define AT_REST PANDA_R(1e-6)

/* Velocity of a contact point; returns its size. */
static panda_real velocity_of(const panda_links_t *links, int point, const panda_real *rates, panda_real v[3])
{
    for (int k = 0; k < 3; ++k) {
        v[k] = PANDA_R(0.0);
        for (int i = 0; i < PANDA_N; ++i) {
            v[k] += links->J[3*point + k][i]*rates[i];
        }
    }
    return PANDA_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
}

/* Prepares the arrival of a point that moves at v with the joint velocities there are. */
static void arrive_as_it_moves(int point, const panda_real *rates, const panda_real v[3],
    panda_real speed, panda_arrival *arrival)
{
    for (int i = 0; i < PANDA_N; ++i) {
        arrival->row[i] = PANDA_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
}

int panda_speed_factor(const panda_real q[PANDA_JOINTS], const panda_real dq[PANDA_JOINTS],
    panda_real limit, const panda_region *region, const panda_params *p, panda_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    int status = panda_check_finite(dq, PANDA_JOINTS);
    panda_impact impact;
    if (status == PANDA_OK) {
        status = panda_check_positive(&limit, 1);
    }
    if (status == PANDA_OK) {
        status = panda_check_impact(region, p);
    }
    if (status == PANDA_OK) {
        status = panda_links(PANDA_LINKS_OF(q, p), &impact.arrival.links);
    }
    if (status != PANDA_OK) {
        return status;
    }
    panda_real rates[PANDA_N];
    for (int i = 0; i < PANDA_N; ++i) {
        rates[i] = dq[PANDA_INDEPENDENT(i)];
    }
    panda_speed_factor_t found = {PANDA_R(1.0), -1, PANDA_R(0.0), PANDA_R(0.0)};
    bool bounded = false;
    for (int point = 0; point < PANDA_POINTS; ++point) {
        panda_real v[3];
        const panda_real speed = velocity_of(&impact.arrival.links, point, rates, v);
        if (!(speed > AT_REST)) {
            continue;
        }
        panda_safe_speed_t safe;
        arrive_as_it_moves(point, rates, v, speed, &impact.arrival);
        status = panda_find_speed(region, p, limit, found.factor*speed, &impact, &safe);
        if (status != PANDA_OK && status != PANDA_BOUNDED) {
            return status;
        }
        bounded = bounded || status == PANDA_BOUNDED;
        if (safe.speed < found.factor*speed || found.point < 0) {
            found.factor = PANDA_FMIN(found.factor, safe.speed/speed);
            found.point = point;
            found.speed = safe.speed;
            found.force = safe.force;
        }
    }
    const panda_real numbers[3] = {found.factor, found.speed, found.force};
    if (!(panda_check_share(numbers, 1) == PANDA_OK && panda_all_finite(numbers, 3))) {
        return PANDA_SINGULAR;
    }
    *out = found;
    return bounded ? PANDA_BOUNDED : PANDA_OK;
}
