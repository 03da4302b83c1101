/* SPDX-License-Identifier: 0BSD */
/* What presses on a clamped body once the quasi-static limit counts, and speeds that keep both limits. */
#include "robot_state.h"

/* Until when it is looked where slower speeds matter, s: contacts that began late may come a little earlier there. */
#define AGAIN_UNTIL ROBOT_R(0.62)
/* Halvings of a speed that presses too hard. */
#define SLOWER 14
/*
 * Share of a limit that counts where the law of contact is a table: forces that swing about what presses fell by up to
 * 7 % as the speed rose, between the shares that are tried.
 */
#define KEPT_OF_TABLES ROBOT_R(0.9)
/*
 * Share of a limit that no later force may reach if slower speeds need not be looked at: motions by Hertz's law grow
 * nearly with the speed, so what parts for good at one does at slower ones.
 */
#define CALM ROBOT_R(0.5)
/* What steps err by, as a share of the peak, which they are fitted to: far smaller late forces were 1.8e-3 off. */
#define OF_PEAK ROBOT_R(2e-3)
/* Else shares of the speed that are tried: arms may bounce past 0.5 s at slower speeds and not at that one. */
#define SHARES 10

/* An impact that is followed until 0.6 s. */
typedef struct {
    robot_params p;
    robot_impact impact;
    robot_budget budget;
    robot_watch watch;
    bool bounded; /* some force is a bound */
    bool calm; /* what was asked last cannot press harder at slower speeds */
    robot_real peak; /* force of what was asked last, N */
} robot_pressing;

/*
 * Largest force from 0.5 s on; less than `matters`, or nothing, if it is proven that none exceeds that. The
 * largest of numbers where that is not known.
 */
static robot_real pressed_by(robot_pressing *k, robot_real speed, robot_real matters)
{
    robot_peak peak;
    k->watch.matters = matters;
    k->watch.depth = robot_law_depth(k->impact.region, matters);
    k->watch.apart = ROBOT_R(0.0);
    k->watch.settled = false;
    k->watch.late = ROBOT_R(0.0);
    k->watch.before = ROBOT_R(0.0);
    k->watch.last = ROBOT_R(0.0);
    k->budget.watch = &k->watch;
    robot_impact_run(&k->impact, speed, &k->budget, &peak);
    k->peak = peak.force;
    if (peak.ended && !peak.torn) {
        return k->watch.late;
    }
    const robot_real bound = k->impact.status == ROBOT_OK ? robot_bound(&k->impact) : ROBOT_R(0.0);
    k->bounded = true;
    return bound > ROBOT_R(0.0) ? bound*speed : ROBOT_REAL_MAX;
}

/* Whether what presses keeps a limit at a speed, by any motors; false where that is not known. */
static bool keeps(robot_pressing *k, const robot_region *region, robot_real speed, robot_real limit)
{
    int first;
    int last;
    robot_kinds_of_motors(&k->p, &first, &last);
    bool kept = true;
    k->watch.slower = true;
    k->calm = region->law == NULL;
    for (int motors = first; motors <= last && kept; ++motors) {
        kept = robot_impact_prepare(region, &k->p, motors, limit, &k->impact) == ROBOT_OK;
        const robot_real late = kept ? pressed_by(k, speed, CALM*limit) : ROBOT_REAL_MAX;
        const robot_real counts = k->impact.smooth > ROBOT_HARDLY ? ROBOT_COUNTS_ELSEWHERE : ROBOT_R(1.0);
        kept = late <= ROBOT_KEPT*counts*limit - OF_PEAK*k->peak;
        k->calm = kept && k->calm && k->watch.settled && k->watch.late <= CALM*limit;
    }
    return kept;
}

static void prepare_pressing(const robot_params *p, robot_real until, robot_pressing *k)
{
    k->p = *p;
    k->p.horizon = ROBOT_FMAX(ROBOT_HORIZON(p), until);
    k->budget.steps = p->steps;
    k->budget.rough = false;
    k->budget.fine = false;
    k->budget.stop_above = ROBOT_REAL_MAX;
    k->budget.watch = NULL;
    k->watch.slower = false;
    k->bounded = false;
    k->calm = false;
    k->peak = ROBOT_R(0.0);
}

/* A speed at which a proven bound keeps a limit; 0 if there is none. */
static robot_real bounded_speed(robot_pressing *k, const robot_region *region, robot_real limit)
{
    int first;
    int last;
    robot_kinds_of_motors(&k->p, &first, &last);
    robot_real most = ROBOT_R(0.0);
    bool is_known = true;
    for (int motors = first; motors <= last && is_known; ++motors) {
        is_known = robot_impact_prepare(region, &k->p, motors, limit, &k->impact) == ROBOT_OK;
        const robot_real bound = is_known ? robot_bound(&k->impact) : ROBOT_R(0.0);
        is_known = bound > ROBOT_R(0.0);
        most = ROBOT_FMAX(most, bound);
    }
    return is_known ? ROBOT_KEPT*limit/most : ROBOT_R(0.0);
}

/* The largest speed up to one at which and, as far as it is looked, below which what presses keeps a limit; or 0. */
static robot_real slow_down(robot_pressing *k, const robot_region *region, robot_real speed, robot_real limit)
{
    static const robot_real shares[SHARES] = {ROBOT_R(0.03), ROBOT_R(0.06), ROBOT_R(0.1), ROBOT_R(0.17), ROBOT_R(0.25),
        ROBOT_R(0.35), ROBOT_R(0.48), ROBOT_R(0.62), ROBOT_R(0.76), ROBOT_R(0.9)};
    robot_real low = ROBOT_R(0.0);
    robot_real high = speed;
    bool calm = false;
    if (keeps(k, region, speed, limit)) {
        low = speed;
        calm = k->calm;
    }
    for (int i = 0; i < SLOWER && low < speed; ++i) {
        const robot_real middle = ROBOT_R(0.5)*(low + high);
        k->budget.steps = k->p.steps;
        if (keeps(k, region, middle, limit)) {
            low = middle;
            calm = k->calm;
        } else {
            high = middle;
        }
    }
    const robot_real found = low;
    for (int i = 0; i < SHARES && !calm && found > ROBOT_R(0.0); ++i) {
        k->budget.steps = k->p.steps;
        if (!keeps(k, region, shares[i]*found, limit)) {
            low = i > 0 ? shares[i - 1]*found : ROBOT_R(0.0);
            break;
        }
    }
    return low > ROBOT_R(0.0) ? low : ROBOT_FMIN(speed, bounded_speed(k, region, limit));
}

int robot_pressing_force_at(const robot_real q[ROBOT_JOINTS], int point, const robot_real n[3],
    robot_real speed, const robot_region *region, const robot_params *p, robot_real *force)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || force == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_pressing k;
    int status = robot_check_positive(&speed, 1);
    if (status == ROBOT_OK) {
        status = robot_approach(q, point, n, region, p, &k.impact);
    }
    if (status != ROBOT_OK) {
        return status;
    }
    prepare_pressing(p, ROBOT_COUNTS_UNTIL, &k);
    robot_real found = ROBOT_R(0.0);
    int first;
    int last;
    robot_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last && region->clamped != 0; ++motors) {
        status = robot_impact_prepare(region, &k.p, motors, -speed, &k.impact);
        if (status != ROBOT_OK) {
            return status;
        }
        found = ROBOT_FMAX(found, pressed_by(&k, speed, ROBOT_R(0.0)));
        if (k.impact.status != ROBOT_OK) {
            return k.impact.status;
        }
    }
    if (!(found < ROBOT_REAL_MAX)) {
        return ROBOT_UNRESOLVED;
    }
    *force = found;
    return k.bounded ? ROBOT_BOUNDED : ROBOT_OK;
}

/* Checks for limits of both kinds. */
static int check_limits(const robot_region *region)
{
    const robot_real limits[2] = {region->force_limit, region->quasi_static_limit};
    return robot_check_positive(limits, region->clamped != 0 ? 2 : 1);
}

/* Largest speed up to a cap, where that is positive, that keeps all limits of a region. */
static int find_allowed(const robot_region *region, const robot_params *p, robot_real cap, robot_pressing *k,
    robot_allowed_speed_t *found)
{
    robot_safe_speed_t safe;
    const int status = robot_find_speed(region, p, region->force_limit, cap, &k->impact, &safe);
    if (status == ROBOT_OK || status == ROBOT_BOUNDED) {
        found->speed = safe.speed;
        found->force = safe.force;
        if (region->clamped != 0) {
            prepare_pressing(p, AGAIN_UNTIL, k);
            const robot_real share = region->law == NULL ? ROBOT_R(1.0) : KEPT_OF_TABLES;
            found->speed = slow_down(k, region, safe.speed, share*region->quasi_static_limit);
        }
        found->pressed = found->speed < safe.speed ? 1 : 0;
    }
    return status;
}

int robot_allowed_speed_at(const robot_real q[ROBOT_JOINTS], int point, const robot_real n[3],
    const robot_region *region, const robot_params *p, robot_allowed_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_pressing k;
    robot_allowed_speed_t found;
    int status = check_limits(region);
    if (status == ROBOT_OK) {
        status = robot_approach(q, point, n, region, p, &k.impact);
    }
    if (status == ROBOT_OK) {
        status = find_allowed(region, p, ROBOT_R(0.0), &k, &found);
    }
    if (status != ROBOT_OK && status != ROBOT_BOUNDED) {
        return status;
    }
    if (!(found.speed > ROBOT_R(0.0))) {
        return ROBOT_UNRESOLVED;
    }
    *out = found;
    return status;
}

int robot_allowed_factor(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS],
    const robot_region *region, const robot_params *p, robot_allowed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_pressing k;
    robot_real rates[ROBOT_N];
    robot_allowed_factor_t found = {ROBOT_R(1.0), -1, ROBOT_R(0.0), ROBOT_R(0.0), 0};
    bool bounded = false;
    int status = check_limits(region);
    if (status == ROBOT_OK) {
        status = robot_check_impact(region, p);
    }
    if (status == ROBOT_OK) {
        status = robot_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    for (int point = 0; point < ROBOT_POINTS && status == ROBOT_OK; ++point) {
        const robot_real speed = robot_arrive_as_it_moves(point, rates, &k.impact.arrival);
        robot_allowed_speed_t allowed = {speed, ROBOT_R(0.0), 0};
        robot_impact_forget(&k.impact);
        if (speed > ROBOT_AT_REST) {
            status = find_allowed(region, p, found.factor*speed, &k, &allowed);
            bounded = bounded || status == ROBOT_BOUNDED;
            status = status == ROBOT_BOUNDED ? ROBOT_OK : status;
        }
        if (speed > ROBOT_AT_REST && status == ROBOT_OK
            && (allowed.speed < found.factor*speed || found.point < 0)) {
            found.factor = ROBOT_FMIN(found.factor, allowed.speed/speed);
            found.point = point;
            found.speed = allowed.speed;
            found.force = allowed.force;
            found.pressed = allowed.pressed;
            status = allowed.speed > ROBOT_R(0.0) ? ROBOT_OK : ROBOT_UNRESOLVED;
        }
    }
    const robot_real numbers[3] = {found.factor, found.speed, found.force};
    if (status == ROBOT_OK && !robot_all_finite(numbers, 3)) {
        status = ROBOT_SINGULAR;
    }
    if (status != ROBOT_OK) {
        return status;
    }
    *out = found;
    return bounded ? ROBOT_BOUNDED : ROBOT_OK;
}

int robot_may_press(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS],
    robot_real limit, const robot_region *region, const robot_params *p, int *may)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || may == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_pressing k;
    robot_real rates[ROBOT_N];
    int status = robot_check_positive(&limit, 1);
    if (status == ROBOT_OK) {
        status = robot_check_impact(region, p);
    }
    if (status == ROBOT_OK) {
        status = robot_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    if (status != ROBOT_OK) {
        return status;
    }
    bool kept = true;
    for (int point = 0; point < ROBOT_POINTS && region->clamped != 0 && kept; ++point) {
        const robot_real speed = robot_arrive_as_it_moves(point, rates, &k.impact.arrival);
        robot_impact_forget(&k.impact);
        prepare_pressing(p, AGAIN_UNTIL, &k);
        kept = !(speed > ROBOT_AT_REST) || keeps(&k, region, speed, limit);
    }
    *may = kept ? 0 : 1;
    return ROBOT_OK;
}
