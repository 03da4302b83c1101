/* SPDX-License-Identifier: 0BSD */
/* By how much rmin_ has to slow down so that no contact point hits too hard. */
#include "rmin_impact.h"

/* What the search of the least factor knows. */
typedef struct {
    rmin_impact impact;
    rmin_real rates[RMIN_N];
    bool bounded;
    int point; /* of impact.arrival, -1 for none */
    rmin_real speed; /* of that point, m/s */
    rmin_speed_factor_over_t found;
} slowdown;

static int set_out(const rmin_real q[RMIN_JOINTS], const rmin_real dq[RMIN_JOINTS],
    const rmin_params *p, slowdown *s)
{
    const rmin_speed_factor_over_t nothing = {RMIN_R(1.0), -1, RMIN_R(0.0), RMIN_R(0.0)};
    s->found = nothing;
    s->bounded = false;
    s->point = -1;
    return rmin_set_off(q, dq, p, s->rates, &s->impact.arrival);
}

/* Slows down until one point keeps the limit of one region. */
static int watch(const rmin_region *region, const rmin_params *p, int point, rmin_real limit,
    int which, slowdown *s)
{
    if (s->point != point) {
        s->point = point;
        s->speed = rmin_arrive_as_it_moves(point, s->rates, &s->impact.arrival);
        rmin_impact_forget(&s->impact);
    }
    if (!(s->speed > RMIN_AT_REST)) {
        return RMIN_OK;
    }
    rmin_safe_speed_t safe;
    const rmin_real allowed = s->found.factor*s->speed;
    const int status = rmin_find_speed(region, p, limit, allowed, &s->impact, &safe);
    if (status != RMIN_OK && status != RMIN_BOUNDED) {
        return status;
    }
    s->bounded = s->bounded || status == RMIN_BOUNDED;
    if (safe.speed < allowed || s->found.entry < 0) {
        s->found.factor = RMIN_FMIN(s->found.factor, safe.speed/s->speed);
        s->found.entry = which;
        s->found.speed = safe.speed;
        s->found.force = safe.force;
    }
    return RMIN_OK;
}

/* Status of what was found. */
static int said(const slowdown *s)
{
    const rmin_real numbers[3] = {s->found.factor, s->found.speed, s->found.force};
    if (!(rmin_check_share(numbers, 1) == RMIN_OK && rmin_all_finite(numbers, 3))) {
        return RMIN_SINGULAR;
    }
    return s->bounded ? RMIN_BOUNDED : RMIN_OK;
}

int rmin_speed_factor(const rmin_real q[RMIN_JOINTS], const rmin_real dq[RMIN_JOINTS],
    rmin_real limit, const rmin_region *region, const rmin_params *p, rmin_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    slowdown s;
    int status = rmin_check_positive(&limit, 1);
    if (status == RMIN_OK) {
        status = rmin_check_impact(region, p);
    }
    if (status == RMIN_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < RMIN_POINTS && status == RMIN_OK; ++point) {
        status = watch(region, p, point, limit, point, &s);
    }
    if (status == RMIN_OK) {
        status = said(&s);
    }
    if (status == RMIN_OK || status == RMIN_BOUNDED) {
        out->factor = s.found.factor;
        out->point = s.found.entry;
        out->speed = s.found.speed;
        out->force = s.found.force;
    }
    return status;
}

int rmin_speed_factor_over(const rmin_real q[RMIN_JOINTS], const rmin_real dq[RMIN_JOINTS],
    const int points[], const rmin_region regions[], const rmin_real limits[], int count,
    const rmin_params *p, rmin_speed_factor_over_t *out)
{
    if (q == NULL || dq == NULL || points == NULL || regions == NULL || limits == NULL || p == NULL
        || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    slowdown s;
    int status = count > 0 ? RMIN_OK : RMIN_OUT_OF_RANGE;
    for (int i = 0; i < count && status == RMIN_OK; ++i) {
        status = rmin_check_impact(&regions[i], p);
        if (status == RMIN_OK) {
            status = rmin_check_positive(&limits[i], 1);
        }
        if (status == RMIN_OK && !(points[i] >= 0 && points[i] < RMIN_POINTS)) {
            status = RMIN_OUT_OF_RANGE;
        }
    }
    if (status == RMIN_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < RMIN_POINTS; ++point) { /* modes of a point serve all its regions */
        for (int i = 0; i < count && status == RMIN_OK; ++i) {
            if (points[i] == point) {
                status = watch(&regions[i], p, point, limits[i], i, &s);
            }
        }
    }
    if (status == RMIN_OK) {
        status = said(&s);
    }
    if (status == RMIN_OK || status == RMIN_BOUNDED) {
        *out = s.found;
    }
    return status;
}
