/* SPDX-License-Identifier: 0BSD */
/* By how much panda_ has to slow down so that no contact point hits too hard. */
#include "panda_impact.h"

/* What the search of the least factor knows. */
typedef struct {
    panda_impact impact;
    panda_real rates[PANDA_N];
    bool bounded;
    int point; /* of impact.arrival, -1 for none */
    panda_real speed; /* of that point, m/s */
    panda_speed_factor_over_t found;
} slowdown;

static int set_out(const panda_real q[PANDA_JOINTS], const panda_real dq[PANDA_JOINTS],
    const panda_params *p, slowdown *s)
{
    const panda_speed_factor_over_t nothing = {PANDA_R(1.0), -1, PANDA_R(0.0), PANDA_R(0.0)};
    s->found = nothing;
    s->bounded = false;
    s->point = -1;
    return panda_set_off(q, dq, p, s->rates, &s->impact.arrival);
}

/* Slows down until one point keeps the limit of one region. */
static int watch(const panda_region *region, const panda_params *p, int point, panda_real limit,
    int which, slowdown *s)
{
    if (s->point != point) {
        s->point = point;
        s->speed = panda_arrive_as_it_moves(point, s->rates, &s->impact.arrival);
        panda_impact_forget(&s->impact);
    }
    if (!(s->speed > PANDA_AT_REST)) {
        return PANDA_OK;
    }
    panda_safe_speed_t safe;
    const panda_real allowed = s->found.factor*s->speed;
    const int status = panda_find_speed(region, p, limit, allowed, &s->impact, &safe);
    if (status != PANDA_OK && status != PANDA_BOUNDED) {
        return status;
    }
    s->bounded = s->bounded || status == PANDA_BOUNDED;
    if (safe.speed < allowed || s->found.entry < 0) {
        s->found.factor = PANDA_FMIN(s->found.factor, safe.speed/s->speed);
        s->found.entry = which;
        s->found.speed = safe.speed;
        s->found.force = safe.force;
    }
    return PANDA_OK;
}

/* Status of what was found. */
static int said(const slowdown *s)
{
    const panda_real numbers[3] = {s->found.factor, s->found.speed, s->found.force};
    if (!(panda_check_share(numbers, 1) == PANDA_OK && panda_all_finite(numbers, 3))) {
        return PANDA_SINGULAR;
    }
    return s->bounded ? PANDA_BOUNDED : PANDA_OK;
}

int panda_speed_factor(const panda_real q[PANDA_JOINTS], const panda_real dq[PANDA_JOINTS],
    panda_real limit, const panda_region *region, const panda_params *p, panda_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    slowdown s;
    int status = panda_check_positive(&limit, 1);
    if (status == PANDA_OK) {
        status = panda_check_impact(region, p);
    }
    if (status == PANDA_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < PANDA_POINTS && status == PANDA_OK; ++point) {
        status = watch(region, p, point, limit, point, &s);
    }
    if (status == PANDA_OK) {
        status = said(&s);
    }
    if (status == PANDA_OK || status == PANDA_BOUNDED) {
        out->factor = s.found.factor;
        out->point = s.found.entry;
        out->speed = s.found.speed;
        out->force = s.found.force;
    }
    return status;
}

int panda_speed_factor_over(const panda_real q[PANDA_JOINTS], const panda_real dq[PANDA_JOINTS],
    const int points[], const panda_region regions[], const panda_real limits[], int count,
    const panda_params *p, panda_speed_factor_over_t *out)
{
    if (q == NULL || dq == NULL || points == NULL || regions == NULL || limits == NULL || p == NULL
        || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    slowdown s;
    int status = count > 0 ? PANDA_OK : PANDA_OUT_OF_RANGE;
    for (int i = 0; i < count && status == PANDA_OK; ++i) {
        status = panda_check_impact(&regions[i], p);
        if (status == PANDA_OK) {
            status = panda_check_positive(&limits[i], 1);
        }
        if (status == PANDA_OK && !(points[i] >= 0 && points[i] < PANDA_POINTS)) {
            status = PANDA_OUT_OF_RANGE;
        }
    }
    if (status == PANDA_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < PANDA_POINTS; ++point) { /* modes of a point serve all its regions */
        for (int i = 0; i < count && status == PANDA_OK; ++i) {
            if (points[i] == point) {
                status = watch(&regions[i], p, point, limits[i], i, &s);
            }
        }
    }
    if (status == PANDA_OK) {
        status = said(&s);
    }
    if (status == PANDA_OK || status == PANDA_BOUNDED) {
        *out = s.found;
    }
    return status;
}
