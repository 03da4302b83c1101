/* SPDX-License-Identifier: 0BSD */
/* By how much rr_ has to slow down so that no contact point hits too hard. */
#include "rr_impact.h"

/* What the search of the least factor knows. */
typedef struct {
    rr_impact impact;
    rr_real rates[RR_N];
    bool bounded;
    int point; /* of impact.arrival, -1 for none */
    rr_real speed; /* of that point, m/s */
    rr_speed_factor_over_t found;
} slowdown;

static int set_out(const rr_real q[RR_JOINTS], const rr_real dq[RR_JOINTS],
    const rr_params *p, slowdown *s)
{
    const rr_speed_factor_over_t nothing = {RR_R(1.0), -1, RR_R(0.0), RR_R(0.0)};
    s->found = nothing;
    s->bounded = false;
    s->point = -1;
    return rr_set_off(q, dq, p, s->rates, &s->impact.arrival);
}

/* Slows down until one point keeps the limit of one region. */
static int watch(const rr_region *region, const rr_params *p, int point, rr_real limit,
    int which, slowdown *s)
{
    if (s->point != point) {
        s->point = point;
        s->speed = rr_arrive_as_it_moves(point, s->rates, &s->impact.arrival);
        rr_impact_forget(&s->impact);
    }
    if (!(s->speed > RR_AT_REST)) {
        return RR_OK;
    }
    rr_safe_speed_t safe;
    const rr_real allowed = s->found.factor*s->speed;
    const int status = rr_find_speed(region, p, limit, allowed, &s->impact, &safe);
    if (status != RR_OK && status != RR_BOUNDED) {
        return status;
    }
    s->bounded = s->bounded || status == RR_BOUNDED;
    if (safe.speed < allowed || s->found.entry < 0) {
        s->found.factor = RR_FMIN(s->found.factor, safe.speed/s->speed);
        s->found.entry = which;
        s->found.speed = safe.speed;
        s->found.force = safe.force;
    }
    return RR_OK;
}

/* Status of what was found. */
static int said(const slowdown *s)
{
    const rr_real numbers[3] = {s->found.factor, s->found.speed, s->found.force};
    if (!(rr_check_share(numbers, 1) == RR_OK && rr_all_finite(numbers, 3))) {
        return RR_SINGULAR;
    }
    return s->bounded ? RR_BOUNDED : RR_OK;
}

int rr_speed_factor(const rr_real q[RR_JOINTS], const rr_real dq[RR_JOINTS],
    rr_real limit, const rr_region *region, const rr_params *p, rr_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    slowdown s;
    int status = rr_check_positive(&limit, 1);
    if (status == RR_OK) {
        status = rr_check_impact(region, p);
    }
    if (status == RR_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < RR_POINTS && status == RR_OK; ++point) {
        status = watch(region, p, point, limit, point, &s);
    }
    if (status == RR_OK) {
        status = said(&s);
    }
    if (status == RR_OK || status == RR_BOUNDED) {
        out->factor = s.found.factor;
        out->point = s.found.entry;
        out->speed = s.found.speed;
        out->force = s.found.force;
    }
    return status;
}

int rr_speed_factor_over(const rr_real q[RR_JOINTS], const rr_real dq[RR_JOINTS],
    const int points[], const rr_region regions[], const rr_real limits[], int count,
    const rr_params *p, rr_speed_factor_over_t *out)
{
    if (q == NULL || dq == NULL || points == NULL || regions == NULL || limits == NULL || p == NULL
        || out == NULL) {
        return RR_NULL_POINTER;
    }
    slowdown s;
    int status = count > 0 ? RR_OK : RR_OUT_OF_RANGE;
    for (int i = 0; i < count && status == RR_OK; ++i) {
        status = rr_check_impact(&regions[i], p);
        if (status == RR_OK) {
            status = rr_check_positive(&limits[i], 1);
        }
        if (status == RR_OK && !(points[i] >= 0 && points[i] < RR_POINTS)) {
            status = RR_OUT_OF_RANGE;
        }
    }
    if (status == RR_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < RR_POINTS; ++point) { /* modes of a point serve all its regions */
        for (int i = 0; i < count && status == RR_OK; ++i) {
            if (points[i] == point) {
                status = watch(&regions[i], p, point, limits[i], i, &s);
            }
        }
    }
    if (status == RR_OK) {
        status = said(&s);
    }
    if (status == RR_OK || status == RR_BOUNDED) {
        *out = s.found;
    }
    return status;
}
