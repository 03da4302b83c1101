/* SPDX-License-Identifier: 0BSD */
/* By how much robot_ has to slow down so that no contact point hits too hard. */
#include "robot_impact.h"

/* What the search of the least factor knows. */
typedef struct {
    robot_impact impact;
    robot_real rates[ROBOT_N];
    bool bounded;
    int point; /* of impact.arrival, -1 for none */
    robot_real speed; /* of that point, m/s */
    robot_speed_factor_over_t found;
} slowdown;

static int set_out(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS],
    const robot_params *p, slowdown *s)
{
    const robot_speed_factor_over_t nothing = {ROBOT_R(1.0), -1, ROBOT_R(0.0), ROBOT_R(0.0)};
    s->found = nothing;
    s->bounded = false;
    s->point = -1;
    return robot_set_off(q, dq, p, s->rates, &s->impact.arrival);
}

/* Slows down until one point keeps the limit of one region. */
static int watch(const robot_region *region, const robot_params *p, int point, robot_real limit,
    int which, slowdown *s)
{
    if (s->point != point) {
        s->point = point;
        s->speed = robot_arrive_as_it_moves(point, s->rates, &s->impact.arrival);
        robot_impact_forget(&s->impact);
    }
    if (!(s->speed > ROBOT_AT_REST)) {
        return ROBOT_OK;
    }
    robot_safe_speed_t safe;
    const robot_real allowed = s->found.factor*s->speed;
    const int status = robot_find_speed(region, p, limit, allowed, &s->impact, &safe);
    if (status != ROBOT_OK && status != ROBOT_BOUNDED) {
        return status;
    }
    s->bounded = s->bounded || status == ROBOT_BOUNDED;
    if (safe.speed < allowed || s->found.entry < 0) {
        s->found.factor = ROBOT_FMIN(s->found.factor, safe.speed/s->speed);
        s->found.entry = which;
        s->found.speed = safe.speed;
        s->found.force = safe.force;
    }
    return ROBOT_OK;
}

/* Status of what was found. */
static int said(const slowdown *s)
{
    const robot_real numbers[3] = {s->found.factor, s->found.speed, s->found.force};
    if (!(robot_check_share(numbers, 1) == ROBOT_OK && robot_all_finite(numbers, 3))) {
        return ROBOT_SINGULAR;
    }
    return s->bounded ? ROBOT_BOUNDED : ROBOT_OK;
}

int robot_speed_factor(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS],
    robot_real limit, const robot_region *region, const robot_params *p, robot_speed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    slowdown s;
    int status = robot_check_positive(&limit, 1);
    if (status == ROBOT_OK) {
        status = robot_check_impact(region, p);
    }
    if (status == ROBOT_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < ROBOT_POINTS && status == ROBOT_OK; ++point) {
        status = watch(region, p, point, limit, point, &s);
    }
    if (status == ROBOT_OK) {
        status = said(&s);
    }
    if (status == ROBOT_OK || status == ROBOT_BOUNDED) {
        out->factor = s.found.factor;
        out->point = s.found.entry;
        out->speed = s.found.speed;
        out->force = s.found.force;
    }
    return status;
}

int robot_speed_factor_over(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS],
    const int points[], const robot_region regions[], const robot_real limits[], int count,
    const robot_params *p, robot_speed_factor_over_t *out)
{
    if (q == NULL || dq == NULL || points == NULL || regions == NULL || limits == NULL || p == NULL
        || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    slowdown s;
    int status = count > 0 ? ROBOT_OK : ROBOT_OUT_OF_RANGE;
    for (int i = 0; i < count && status == ROBOT_OK; ++i) {
        status = robot_check_impact(&regions[i], p);
        if (status == ROBOT_OK) {
            status = robot_check_positive(&limits[i], 1);
        }
        if (status == ROBOT_OK && !(points[i] >= 0 && points[i] < ROBOT_POINTS)) {
            status = ROBOT_OUT_OF_RANGE;
        }
    }
    if (status == ROBOT_OK) {
        status = set_out(q, dq, p, &s);
    }
    for (int point = 0; point < ROBOT_POINTS; ++point) { /* modes of a point serve all its regions */
        for (int i = 0; i < count && status == ROBOT_OK; ++i) {
            if (points[i] == point) {
                status = watch(&regions[i], p, point, limits[i], i, &s);
            }
        }
    }
    if (status == ROBOT_OK) {
        status = said(&s);
    }
    if (status == ROBOT_OK || status == ROBOT_BOUNDED) {
        *out = s.found;
    }
    return status;
}
