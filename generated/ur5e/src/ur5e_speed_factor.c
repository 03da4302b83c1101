/* SPDX-License-Identifier: 0BSD */
/* By how much ur5e_ has to slow down so that no contact point hits too hard. */
#include "ur5e_impact.h"

/* What the search of the least factor knows. */
typedef struct {
    ur5e_impact impact;
    ur5e_real rates[UR5E_N];
    bool bounded;
    int point; /* of impact.arrival, -1 for none */
    ur5e_real speed; /* of that point, m/s */
    ur5e_speed_factor_over_t found;
} slowdown;

static int set_out(const ur5e_real q[UR5E_JOINTS], const ur5e_real dq[UR5E_JOINTS],
    const ur5e_params *p, slowdown *s)
{
    const ur5e_speed_factor_over_t nothing = {UR5E_R(1.0), -1, UR5E_R(0.0), UR5E_R(0.0)};
    s->found = nothing;
    s->bounded = false;
    s->point = -1;
    return ur5e_set_off(q, dq, p, s->rates, &s->impact.arrival);
}

/* Slows down until one point keeps the limit of one region. */
static int watch(const ur5e_region *region, const ur5e_params *p, int point, ur5e_real limit,
    int which, slowdown *s)
{
    if (s->point != point) {
        s->point = point;
        s->speed = ur5e_arrive_as_it_moves(point, s->rates, &s->impact.arrival);
        ur5e_impact_forget(&s->impact);
    }
    if (!(s->speed > UR5E_AT_REST)) {
        return UR5E_OK;
    }
    ur5e_safe_speed_t safe;
    const ur5e_real allowed = s->found.factor*s->speed;
    const int status = ur5e_find_speed(region, p, limit, allowed, &s->impact, &safe);
    if (status != UR5E_OK && status != UR5E_BOUNDED) {
        return status;
    }
    s->bounded = s->bounded || status == UR5E_BOUNDED;
    if (safe.speed < allowed || s->found.entry < 0) {
        s->found.factor = UR5E_FMIN(s->found.factor, safe.speed/s->speed);
        s->found.entry = which;
        s->found.speed = safe.speed;
        s->found.force = safe.force;
    }
    return UR5E_OK;
}

/* Status of what was found. */
static int said(const slowdown *s)
{
    const ur5e_real numbers[3] = {s->found.factor, s->found.speed, s->found.force};
    if (!(ur5e_check_share(numbers, 1) == UR5E_OK && ur5e_all_finite(numbers, 3))) {
        return UR5E_SINGULAR;
    }
    return s->bounded ? UR5E_BOUNDED : UR5E_OK;
}

int ur5e_speed_factor(const ur5e_real q[UR5E_JOINTS], const ur5e_real dq[UR5E_JOINTS],
    ur5e_real limit, const ur5e_region *region, const ur5e_params *p, ur5e_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    slowdown s;
    int status = ur5e_check_positive(&limit, 1);
    if (status == UR5E_OK) {
        status = ur5e_check_impact(region, p);
    }
    if (status == UR5E_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < UR5E_POINTS && status == UR5E_OK; ++point) {
        status = watch(region, p, point, limit, point, &s);
    }
    if (status == UR5E_OK) {
        status = said(&s);
    }
    if (status == UR5E_OK || status == UR5E_BOUNDED) {
        out->factor = s.found.factor;
        out->point = s.found.entry;
        out->speed = s.found.speed;
        out->force = s.found.force;
    }
    return status;
}

int ur5e_speed_factor_over(const ur5e_real q[UR5E_JOINTS], const ur5e_real dq[UR5E_JOINTS],
    const int points[], const ur5e_region regions[], const ur5e_real limits[], int count,
    const ur5e_params *p, ur5e_speed_factor_over_t *out)
{
    if (q == NULL || dq == NULL || points == NULL || regions == NULL || limits == NULL || p == NULL
        || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    slowdown s;
    int status = count > 0 ? UR5E_OK : UR5E_OUT_OF_RANGE;
    for (int i = 0; i < count && status == UR5E_OK; ++i) {
        status = ur5e_check_impact(&regions[i], p);
        if (status == UR5E_OK) {
            status = ur5e_check_positive(&limits[i], 1);
        }
        if (status == UR5E_OK && !(points[i] >= 0 && points[i] < UR5E_POINTS)) {
            status = UR5E_OUT_OF_RANGE;
        }
    }
    if (status == UR5E_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < UR5E_POINTS; ++point) { /* modes of a point serve all its regions */
        for (int i = 0; i < count && status == UR5E_OK; ++i) {
            if (points[i] == point) {
                status = watch(&regions[i], p, point, limits[i], i, &s);
            }
        }
    }
    if (status == UR5E_OK) {
        status = said(&s);
    }
    if (status == UR5E_OK || status == UR5E_BOUNDED) {
        *out = s.found;
    }
    return status;
}
