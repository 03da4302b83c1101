/* SPDX-License-Identifier: 0BSD */
/* What presses on a clamped body once the quasi-static limit counts, and speeds that keep both limits. */
#include "rmin_state.h"

/* Until when it is looked where slower speeds matter, s: contacts that began late may come a little earlier there. */
#define AGAIN_UNTIL RMIN_R(0.62)
/* Halvings of a speed that presses too hard. */
#define SLOWER 14
/*
 * Share of a limit that counts where the law of contact is a table: forces that swing about what presses fell by up to
 * 7 % as the speed rose, between the shares that are tried.
 */
#define KEPT_OF_TABLES RMIN_R(0.9)
/*
 * Share of a limit that no later force may reach if slower speeds need not be looked at: motions by Hertz's law grow
 * nearly with the speed, so what parts for good at one does at slower ones.
 */
#define CALM RMIN_R(0.5)
/* What steps err by, as a share of the peak, which they are fitted to: far smaller late forces were 1.8e-3 off. */
#define OF_PEAK RMIN_R(2e-3)
/* Else shares of the speed that are tried: arms may bounce past 0.5 s at slower speeds and not at that one. */
#define SHARES 10

/* An impact that is followed until 0.6 s. */
typedef struct {
    rmin_params p;
    rmin_impact impact;
    rmin_budget budget;
    rmin_watch watch;
    bool bounded; /* some force is a bound */
    bool calm; /* what was asked last cannot press harder at slower speeds */
    rmin_real peak; /* force of what was asked last, N */
} rmin_pressing;

/*
 * Largest force from 0.5 s on; less than `matters`, or nothing, if it is proven that none exceeds that. The
 * largest of numbers where that is not known.
 */
static rmin_real pressed_by(rmin_pressing *k, rmin_real speed, rmin_real matters)
{
    rmin_peak peak;
    k->watch.matters = matters;
    k->watch.depth = rmin_law_depth(k->impact.region, matters);
    k->watch.apart = RMIN_R(0.0);
    k->watch.settled = false;
    k->watch.late = RMIN_R(0.0);
    k->watch.before = RMIN_R(0.0);
    k->watch.last = RMIN_R(0.0);
    k->budget.watch = &k->watch;
    rmin_impact_run(&k->impact, speed, &k->budget, &peak);
    k->peak = peak.force;
    if (peak.ended && !peak.torn) {
        return k->watch.late;
    }
    const rmin_real bound = k->impact.status == RMIN_OK ? rmin_bound(&k->impact) : RMIN_R(0.0);
    k->bounded = true;
    return bound > RMIN_R(0.0) ? bound*speed : RMIN_REAL_MAX;
}

/* Whether what presses keeps a limit at a speed, by any motors; false where that is not known. */
static bool keeps(rmin_pressing *k, const rmin_region *region, rmin_real speed, rmin_real limit)
{
    int first;
    int last;
    rmin_kinds_of_motors(&k->p, &first, &last);
    bool kept = true;
    k->watch.slower = true;
    k->calm = region->law == NULL;
    for (int motors = first; motors <= last && kept; ++motors) {
        kept = rmin_impact_prepare(region, &k->p, motors, limit, &k->impact) == RMIN_OK;
        const rmin_real late = kept ? pressed_by(k, speed, CALM*limit) : RMIN_REAL_MAX;
        const rmin_real counts = k->impact.smooth > RMIN_HARDLY ? RMIN_COUNTS_ELSEWHERE : RMIN_R(1.0);
        kept = late <= RMIN_KEPT*counts*limit - OF_PEAK*k->peak;
        k->calm = kept && k->calm && k->watch.settled && k->watch.late <= CALM*limit;
    }
    return kept;
}

static void prepare_pressing(const rmin_params *p, rmin_real until, rmin_pressing *k)
{
    k->p = *p;
    k->p.horizon = RMIN_FMAX(RMIN_HORIZON(p), until);
    k->budget.steps = p->steps;
    k->budget.rough = false;
    k->budget.fine = false;
    k->budget.stop_above = RMIN_REAL_MAX;
    k->budget.watch = NULL;
    k->watch.slower = false;
    k->bounded = false;
    k->calm = false;
    k->peak = RMIN_R(0.0);
}

/* A speed at which a proven bound keeps a limit; 0 if there is none. */
static rmin_real bounded_speed(rmin_pressing *k, const rmin_region *region, rmin_real limit)
{
    int first;
    int last;
    rmin_kinds_of_motors(&k->p, &first, &last);
    rmin_real most = RMIN_R(0.0);
    bool is_known = true;
    for (int motors = first; motors <= last && is_known; ++motors) {
        is_known = rmin_impact_prepare(region, &k->p, motors, limit, &k->impact) == RMIN_OK;
        const rmin_real bound = is_known ? rmin_bound(&k->impact) : RMIN_R(0.0);
        is_known = bound > RMIN_R(0.0);
        most = RMIN_FMAX(most, bound);
    }
    return is_known ? RMIN_KEPT*limit/most : RMIN_R(0.0);
}

/* The largest speed up to one at which and, as far as it is looked, below which what presses keeps a limit; or 0. */
static rmin_real slow_down(rmin_pressing *k, const rmin_region *region, rmin_real speed, rmin_real limit)
{
    static const rmin_real shares[SHARES] = {RMIN_R(0.03), RMIN_R(0.06), RMIN_R(0.1), RMIN_R(0.17), RMIN_R(0.25),
        RMIN_R(0.35), RMIN_R(0.48), RMIN_R(0.62), RMIN_R(0.76), RMIN_R(0.9)};
    rmin_real low = RMIN_R(0.0);
    rmin_real high = speed;
    bool calm = false;
    if (keeps(k, region, speed, limit)) {
        low = speed;
        calm = k->calm;
    }
    for (int i = 0; i < SLOWER && low < speed; ++i) {
        const rmin_real middle = RMIN_R(0.5)*(low + high);
        k->budget.steps = k->p.steps;
        if (keeps(k, region, middle, limit)) {
            low = middle;
            calm = k->calm;
        } else {
            high = middle;
        }
    }
    const rmin_real found = low;
    for (int i = 0; i < SHARES && !calm && found > RMIN_R(0.0); ++i) {
        k->budget.steps = k->p.steps;
        if (!keeps(k, region, shares[i]*found, limit)) {
            low = i > 0 ? shares[i - 1]*found : RMIN_R(0.0);
            break;
        }
    }
    return low > RMIN_R(0.0) ? low : RMIN_FMIN(speed, bounded_speed(k, region, limit));
}

int rmin_pressing_force_at(const rmin_real q[RMIN_JOINTS], int point, const rmin_real n[3],
    rmin_real speed, const rmin_region *region, const rmin_params *p, rmin_real *force)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || force == NULL) {
        return RMIN_NULL_POINTER;
    }
    rmin_pressing k;
    int status = rmin_check_positive(&speed, 1);
    if (status == RMIN_OK) {
        status = rmin_approach(q, point, n, region, p, &k.impact);
    }
    if (status != RMIN_OK) {
        return status;
    }
    prepare_pressing(p, RMIN_COUNTS_UNTIL, &k);
    rmin_real found = RMIN_R(0.0);
    int first;
    int last;
    rmin_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last && region->clamped != 0; ++motors) {
        status = rmin_impact_prepare(region, &k.p, motors, -speed, &k.impact);
        if (status != RMIN_OK) {
            return status;
        }
        found = RMIN_FMAX(found, pressed_by(&k, speed, RMIN_R(0.0)));
        if (k.impact.status != RMIN_OK) {
            return k.impact.status;
        }
    }
    if (!(found < RMIN_REAL_MAX)) {
        return RMIN_UNRESOLVED;
    }
    *force = found;
    return k.bounded ? RMIN_BOUNDED : RMIN_OK;
}

/* Checks for limits of both kinds. */
static int check_limits(const rmin_region *region)
{
    const rmin_real limits[2] = {region->force_limit, region->quasi_static_limit};
    return rmin_check_positive(limits, region->clamped != 0 ? 2 : 1);
}

/* Largest speed up to a cap, where that is positive, that keeps all limits of a region. */
static int find_allowed(const rmin_region *region, const rmin_params *p, rmin_real cap, rmin_pressing *k,
    rmin_allowed_speed_t *found)
{
    rmin_safe_speed_t safe;
    const int status = rmin_find_speed(region, p, region->force_limit, cap, &k->impact, &safe);
    if (status == RMIN_OK || status == RMIN_BOUNDED) {
        found->speed = safe.speed;
        found->force = safe.force;
        if (region->clamped != 0) {
            prepare_pressing(p, AGAIN_UNTIL, k);
            const rmin_real share = region->law == NULL ? RMIN_R(1.0) : KEPT_OF_TABLES;
            found->speed = slow_down(k, region, safe.speed, share*region->quasi_static_limit);
        }
        found->pressed = found->speed < safe.speed ? 1 : 0;
    }
    return status;
}

int rmin_allowed_speed_at(const rmin_real q[RMIN_JOINTS], int point, const rmin_real n[3],
    const rmin_region *region, const rmin_params *p, rmin_allowed_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    rmin_pressing k;
    rmin_allowed_speed_t found;
    int status = check_limits(region);
    if (status == RMIN_OK) {
        status = rmin_approach(q, point, n, region, p, &k.impact);
    }
    if (status == RMIN_OK) {
        status = find_allowed(region, p, RMIN_R(0.0), &k, &found);
    }
    if (status != RMIN_OK && status != RMIN_BOUNDED) {
        return status;
    }
    if (!(found.speed > RMIN_R(0.0))) {
        return RMIN_UNRESOLVED;
    }
    *out = found;
    return status;
}

int rmin_allowed_factor(const rmin_real q[RMIN_JOINTS], const rmin_real dq[RMIN_JOINTS],
    const rmin_region *region, const rmin_params *p, rmin_allowed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    rmin_pressing k;
    rmin_real rates[RMIN_N];
    rmin_allowed_factor_t found = {RMIN_R(1.0), -1, RMIN_R(0.0), RMIN_R(0.0), 0};
    bool bounded = false;
    int status = check_limits(region);
    if (status == RMIN_OK) {
        status = rmin_check_impact(region, p);
    }
    if (status == RMIN_OK) {
        status = rmin_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    for (int point = 0; point < RMIN_POINTS && status == RMIN_OK; ++point) {
        const rmin_real speed = rmin_arrive_as_it_moves(point, rates, &k.impact.arrival);
        rmin_allowed_speed_t allowed = {speed, RMIN_R(0.0), 0};
        rmin_impact_forget(&k.impact);
        if (speed > RMIN_AT_REST) {
            status = find_allowed(region, p, found.factor*speed, &k, &allowed);
            bounded = bounded || status == RMIN_BOUNDED;
            status = status == RMIN_BOUNDED ? RMIN_OK : status;
        }
        if (speed > RMIN_AT_REST && status == RMIN_OK
            && (allowed.speed < found.factor*speed || found.point < 0)) {
            found.factor = RMIN_FMIN(found.factor, allowed.speed/speed);
            found.point = point;
            found.speed = allowed.speed;
            found.force = allowed.force;
            found.pressed = allowed.pressed;
            status = allowed.speed > RMIN_R(0.0) ? RMIN_OK : RMIN_UNRESOLVED;
        }
    }
    const rmin_real numbers[3] = {found.factor, found.speed, found.force};
    if (status == RMIN_OK && !rmin_all_finite(numbers, 3)) {
        status = RMIN_SINGULAR;
    }
    if (status != RMIN_OK) {
        return status;
    }
    *out = found;
    return bounded ? RMIN_BOUNDED : RMIN_OK;
}

int rmin_may_press(const rmin_real q[RMIN_JOINTS], const rmin_real dq[RMIN_JOINTS],
    rmin_real limit, const rmin_region *region, const rmin_params *p, int *may)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || may == NULL) {
        return RMIN_NULL_POINTER;
    }
    rmin_pressing k;
    rmin_real rates[RMIN_N];
    int status = rmin_check_positive(&limit, 1);
    if (status == RMIN_OK) {
        status = rmin_check_impact(region, p);
    }
    if (status == RMIN_OK) {
        status = rmin_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    if (status != RMIN_OK) {
        return status;
    }
    bool kept = true;
    for (int point = 0; point < RMIN_POINTS && region->clamped != 0 && kept; ++point) {
        const rmin_real speed = rmin_arrive_as_it_moves(point, rates, &k.impact.arrival);
        rmin_impact_forget(&k.impact);
        prepare_pressing(p, AGAIN_UNTIL, &k);
        kept = !(speed > RMIN_AT_REST) || keeps(&k, region, speed, limit);
    }
    *may = kept ? 0 : 1;
    return RMIN_OK;
}
