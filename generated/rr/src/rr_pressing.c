/* SPDX-License-Identifier: 0BSD */
/* What presses on a clamped body once the quasi-static limit counts, and speeds that keep both limits. */
#include "rr_state.h"

/* Until when it is looked where slower speeds matter, s: contacts that began late may come a little earlier there. */
#define AGAIN_UNTIL RR_R(0.62)
/* Halvings of a speed that presses too hard. */
#define SLOWER 14
/*
 * Share of a limit that counts where the law of contact is a table: forces that swing about what presses fell by up to
 * 7 % as the speed rose, between the shares that are tried.
 */
#define KEPT_OF_TABLES RR_R(0.9)
/*
 * Share of a limit that no later force may reach if slower speeds need not be looked at: motions by Hertz's law grow
 * nearly with the speed, so what parts for good at one does at slower ones.
 */
#define CALM RR_R(0.5)
/* What steps err by, as a share of the peak, which they are fitted to: far smaller late forces were 1.8e-3 off. */
#define OF_PEAK RR_R(2e-3)
/* Else shares of the speed that are tried: arms may bounce past 0.5 s at slower speeds and not at that one. */
#define SHARES 10

/* An impact that is followed until 0.6 s. */
typedef struct {
    rr_params p;
    rr_impact impact;
    rr_budget budget;
    rr_watch watch;
    bool bounded; /* some force is a bound */
    bool calm; /* what was asked last cannot press harder at slower speeds */
    rr_real peak; /* force of what was asked last, N */
} rr_pressing;

/*
 * Largest force from 0.5 s on; less than `matters`, or nothing, if it is proven that none exceeds that. The
 * largest of numbers where that is not known.
 */
static rr_real pressed_by(rr_pressing *k, rr_real speed, rr_real matters)
{
    rr_peak peak;
    k->watch.matters = matters;
    k->watch.depth = rr_law_depth(k->impact.region, matters);
    k->watch.apart = RR_R(0.0);
    k->watch.settled = false;
    k->watch.late = RR_R(0.0);
    k->watch.before = RR_R(0.0);
    k->watch.last = RR_R(0.0);
    k->budget.watch = &k->watch;
    rr_impact_run(&k->impact, speed, &k->budget, &peak);
    k->peak = peak.force;
    if (peak.ended && !peak.torn) {
        return k->watch.late;
    }
    const rr_real bound = k->impact.status == RR_OK ? rr_bound(&k->impact) : RR_R(0.0);
    k->bounded = true;
    return bound > RR_R(0.0) ? bound*speed : RR_REAL_MAX;
}

/* Whether what presses keeps a limit at a speed, by any motors; false where that is not known. */
static bool keeps(rr_pressing *k, const rr_region *region, rr_real speed, rr_real limit)
{
    int first;
    int last;
    rr_kinds_of_motors(&k->p, &first, &last);
    bool kept = true;
    k->watch.slower = true;
    k->calm = region->law == NULL;
    for (int motors = first; motors <= last && kept; ++motors) {
        kept = rr_impact_prepare(region, &k->p, motors, limit, &k->impact) == RR_OK;
        const rr_real late = kept ? pressed_by(k, speed, CALM*limit) : RR_REAL_MAX;
        const rr_real counts = k->impact.smooth > RR_HARDLY ? RR_COUNTS_ELSEWHERE : RR_R(1.0);
        kept = late <= RR_KEPT*counts*limit - OF_PEAK*k->peak;
        k->calm = kept && k->calm && k->watch.settled && k->watch.late <= CALM*limit;
    }
    return kept;
}

static void prepare_pressing(const rr_params *p, rr_real until, rr_pressing *k)
{
    k->p = *p;
    k->p.horizon = RR_FMAX(RR_HORIZON(p), until);
    k->budget.steps = p->steps;
    k->budget.rough = false;
    k->budget.fine = false;
    k->budget.stop_above = RR_REAL_MAX;
    k->budget.watch = NULL;
    k->watch.slower = false;
    k->bounded = false;
    k->calm = false;
    k->peak = RR_R(0.0);
}

/* A speed at which a proven bound keeps a limit; 0 if there is none. */
static rr_real bounded_speed(rr_pressing *k, const rr_region *region, rr_real limit)
{
    int first;
    int last;
    rr_kinds_of_motors(&k->p, &first, &last);
    rr_real most = RR_R(0.0);
    bool is_known = true;
    for (int motors = first; motors <= last && is_known; ++motors) {
        is_known = rr_impact_prepare(region, &k->p, motors, limit, &k->impact) == RR_OK;
        const rr_real bound = is_known ? rr_bound(&k->impact) : RR_R(0.0);
        is_known = bound > RR_R(0.0);
        most = RR_FMAX(most, bound);
    }
    return is_known ? RR_KEPT*limit/most : RR_R(0.0);
}

/* The largest speed up to one at which and, as far as it is looked, below which what presses keeps a limit; or 0. */
static rr_real slow_down(rr_pressing *k, const rr_region *region, rr_real speed, rr_real limit)
{
    static const rr_real shares[SHARES] = {RR_R(0.03), RR_R(0.06), RR_R(0.1), RR_R(0.17), RR_R(0.25),
        RR_R(0.35), RR_R(0.48), RR_R(0.62), RR_R(0.76), RR_R(0.9)};
    rr_real low = RR_R(0.0);
    rr_real high = speed;
    bool calm = false;
    if (keeps(k, region, speed, limit)) {
        low = speed;
        calm = k->calm;
    }
    for (int i = 0; i < SLOWER && low < speed; ++i) {
        const rr_real middle = RR_R(0.5)*(low + high);
        k->budget.steps = k->p.steps;
        if (keeps(k, region, middle, limit)) {
            low = middle;
            calm = k->calm;
        } else {
            high = middle;
        }
    }
    const rr_real found = low;
    for (int i = 0; i < SHARES && !calm && found > RR_R(0.0); ++i) {
        k->budget.steps = k->p.steps;
        if (!keeps(k, region, shares[i]*found, limit)) {
            low = i > 0 ? shares[i - 1]*found : RR_R(0.0);
            break;
        }
    }
    return low > RR_R(0.0) ? low : RR_FMIN(speed, bounded_speed(k, region, limit));
}

int rr_pressing_force_at(const rr_real q[RR_JOINTS], int point, const rr_real n[3],
    rr_real speed, const rr_region *region, const rr_params *p, rr_real *force)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || force == NULL) {
        return RR_NULL_POINTER;
    }
    rr_pressing k;
    int status = rr_check_positive(&speed, 1);
    if (status == RR_OK) {
        status = rr_approach(q, point, n, region, p, &k.impact);
    }
    if (status != RR_OK) {
        return status;
    }
    prepare_pressing(p, RR_COUNTS_UNTIL, &k);
    rr_real found = RR_R(0.0);
    int first;
    int last;
    rr_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last && region->clamped != 0; ++motors) {
        status = rr_impact_prepare(region, &k.p, motors, -speed, &k.impact);
        if (status != RR_OK) {
            return status;
        }
        found = RR_FMAX(found, pressed_by(&k, speed, RR_R(0.0)));
        if (k.impact.status != RR_OK) {
            return k.impact.status;
        }
    }
    if (!(found < RR_REAL_MAX)) {
        return RR_UNRESOLVED;
    }
    *force = found;
    return k.bounded ? RR_BOUNDED : RR_OK;
}

/* Checks for limits of both kinds. */
static int check_limits(const rr_region *region)
{
    const rr_real limits[2] = {region->force_limit, region->quasi_static_limit};
    return rr_check_positive(limits, region->clamped != 0 ? 2 : 1);
}

/* Largest speed up to a cap, where that is positive, that keeps all limits of a region. */
static int find_allowed(const rr_region *region, const rr_params *p, rr_real cap, rr_pressing *k,
    rr_allowed_speed_t *found)
{
    rr_safe_speed_t safe;
    const int status = rr_find_speed(region, p, region->force_limit, cap, &k->impact, &safe);
    if (status == RR_OK || status == RR_BOUNDED) {
        found->speed = safe.speed;
        found->force = safe.force;
        if (region->clamped != 0) {
            prepare_pressing(p, AGAIN_UNTIL, k);
            const rr_real share = region->law == NULL ? RR_R(1.0) : KEPT_OF_TABLES;
            found->speed = slow_down(k, region, safe.speed, share*region->quasi_static_limit);
        }
        found->pressed = found->speed < safe.speed ? 1 : 0;
    }
    return status;
}

int rr_allowed_speed_at(const rr_real q[RR_JOINTS], int point, const rr_real n[3],
    const rr_region *region, const rr_params *p, rr_allowed_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    rr_pressing k;
    rr_allowed_speed_t found;
    int status = check_limits(region);
    if (status == RR_OK) {
        status = rr_approach(q, point, n, region, p, &k.impact);
    }
    if (status == RR_OK) {
        status = find_allowed(region, p, RR_R(0.0), &k, &found);
    }
    if (status != RR_OK && status != RR_BOUNDED) {
        return status;
    }
    if (!(found.speed > RR_R(0.0))) {
        return RR_UNRESOLVED;
    }
    *out = found;
    return status;
}

int rr_allowed_factor(const rr_real q[RR_JOINTS], const rr_real dq[RR_JOINTS],
    const rr_region *region, const rr_params *p, rr_allowed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    rr_pressing k;
    rr_real rates[RR_N];
    rr_allowed_factor_t found = {RR_R(1.0), -1, RR_R(0.0), RR_R(0.0), 0};
    bool bounded = false;
    int status = check_limits(region);
    if (status == RR_OK) {
        status = rr_check_impact(region, p);
    }
    if (status == RR_OK) {
        status = rr_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    for (int point = 0; point < RR_POINTS && status == RR_OK; ++point) {
        const rr_real speed = rr_arrive_as_it_moves(point, rates, &k.impact.arrival);
        rr_allowed_speed_t allowed = {speed, RR_R(0.0), 0};
        rr_impact_forget(&k.impact);
        if (speed > RR_AT_REST) {
            status = find_allowed(region, p, found.factor*speed, &k, &allowed);
            bounded = bounded || status == RR_BOUNDED;
            status = status == RR_BOUNDED ? RR_OK : status;
        }
        if (speed > RR_AT_REST && status == RR_OK
            && (allowed.speed < found.factor*speed || found.point < 0)) {
            found.factor = RR_FMIN(found.factor, allowed.speed/speed);
            found.point = point;
            found.speed = allowed.speed;
            found.force = allowed.force;
            found.pressed = allowed.pressed;
            status = allowed.speed > RR_R(0.0) ? RR_OK : RR_UNRESOLVED;
        }
    }
    const rr_real numbers[3] = {found.factor, found.speed, found.force};
    if (status == RR_OK && !rr_all_finite(numbers, 3)) {
        status = RR_SINGULAR;
    }
    if (status != RR_OK) {
        return status;
    }
    *out = found;
    return bounded ? RR_BOUNDED : RR_OK;
}

int rr_may_press(const rr_real q[RR_JOINTS], const rr_real dq[RR_JOINTS],
    rr_real limit, const rr_region *region, const rr_params *p, int *may)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || may == NULL) {
        return RR_NULL_POINTER;
    }
    rr_pressing k;
    rr_real rates[RR_N];
    int status = rr_check_positive(&limit, 1);
    if (status == RR_OK) {
        status = rr_check_impact(region, p);
    }
    if (status == RR_OK) {
        status = rr_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    if (status != RR_OK) {
        return status;
    }
    bool kept = true;
    for (int point = 0; point < RR_POINTS && region->clamped != 0 && kept; ++point) {
        const rr_real speed = rr_arrive_as_it_moves(point, rates, &k.impact.arrival);
        rr_impact_forget(&k.impact);
        prepare_pressing(p, AGAIN_UNTIL, &k);
        kept = !(speed > RR_AT_REST) || keeps(&k, region, speed, limit);
    }
    *may = kept ? 0 : 1;
    return RR_OK;
}
