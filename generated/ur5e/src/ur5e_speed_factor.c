/* SPDX-License-Identifier: 0BSD */
/* By how much ur5e_ has to slow down so that no contact point hits too hard. */
#include "ur5e_impact.h"

/* Speed of a contact point that counts as rest: it can hardly be measured. */
#define AT_REST UR5E_R(1e-6)

/* Velocity of a contact point; returns its size. */
static ur5e_real velocity_of(const ur5e_links_t *links, int point, const ur5e_real *rates, ur5e_real v[3])
{
    for (int k = 0; k < 3; ++k) {
        v[k] = UR5E_R(0.0);
        for (int i = 0; i < UR5E_N; ++i) {
            v[k] += links->J[3*point + k][i]*rates[i];
        }
    }
    return UR5E_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
}

/* Prepares the arrival of a point that moves at v with the joint velocities there are. */
static void arrive_as_it_moves(int point, const ur5e_real *rates, const ur5e_real v[3],
    ur5e_real speed, ur5e_arrival *arrival)
{
    for (int i = 0; i < UR5E_N; ++i) {
        arrival->row[i] = UR5E_R(0.0);
        for (int k = 0; k < 3; ++k) {
            arrival->row[i] += v[k]/speed*arrival->links.J[3*point + k][i];
        }
        arrival->rates[i] = rates[i]/speed;
    }
}

int ur5e_speed_factor(const ur5e_real q[UR5E_JOINTS], const ur5e_real dq[UR5E_JOINTS],
    ur5e_real limit, const ur5e_region *region, const ur5e_params *p, ur5e_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    int status = ur5e_check_finite(dq, UR5E_JOINTS);
    ur5e_impact impact;
    if (status == UR5E_OK) {
        status = ur5e_check_positive(&limit, 1);
    }
    if (status == UR5E_OK) {
        status = ur5e_check_impact(region, p);
    }
    if (status == UR5E_OK) {
        status = ur5e_links(UR5E_LINKS_OF(q, p), &impact.arrival.links);
    }
    if (status != UR5E_OK) {
        return status;
    }
    ur5e_real rates[UR5E_N];
    for (int i = 0; i < UR5E_N; ++i) {
        rates[i] = dq[UR5E_INDEPENDENT(i)];
    }
    ur5e_speed_factor_t found = {UR5E_R(1.0), -1, UR5E_R(0.0), UR5E_R(0.0)};
    bool bounded = false;
    for (int point = 0; point < UR5E_POINTS; ++point) {
        ur5e_real v[3];
        const ur5e_real speed = velocity_of(&impact.arrival.links, point, rates, v);
        if (!(speed > AT_REST)) {
            continue;
        }
        ur5e_safe_speed_t safe;
        arrive_as_it_moves(point, rates, v, speed, &impact.arrival);
        status = ur5e_find_speed(region, p, limit, found.factor*speed, &impact, &safe);
        if (status != UR5E_OK && status != UR5E_BOUNDED) {
            return status;
        }
        bounded = bounded || status == UR5E_BOUNDED;
        if (safe.speed < found.factor*speed || found.point < 0) {
            found.factor = UR5E_FMIN(found.factor, safe.speed/speed);
            found.point = point;
            found.speed = safe.speed;
            found.force = safe.force;
        }
    }
    const ur5e_real numbers[3] = {found.factor, found.speed, found.force};
    if (!(ur5e_check_share(numbers, 1) == UR5E_OK && ur5e_all_finite(numbers, 3))) {
        return UR5E_SINGULAR;
    }
    *out = found;
    return bounded ? UR5E_BOUNDED : UR5E_OK;
}
