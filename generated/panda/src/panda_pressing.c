/* SPDX-License-Identifier: 0BSD */
/* What presses on a clamped body once the quasi-static limit counts, and speeds that keep both limits. */
#include "panda_state.h"

/* Until when it is looked where slower speeds matter, s: contacts that began late may come a little earlier there. */
#define AGAIN_UNTIL PANDA_R(0.62)
/* Halvings of a speed that presses too hard. */
#define SLOWER 14
/*
 * Share of a limit that counts where the law of contact is a table: forces that swing about what presses fell by up to
 * 7 % as the speed rose, between the shares that are tried.
 */
#define KEPT_OF_TABLES PANDA_R(0.9)
/*
 * Share of a limit that no later force may reach if slower speeds need not be looked at: motions by Hertz's law grow
 * nearly with the speed, so what parts for good at one does at slower ones.
 */
#define CALM PANDA_R(0.5)
/* What steps err by, as a share of the peak, which they are fitted to: far smaller late forces were 1.8e-3 off. */
#define OF_PEAK PANDA_R(2e-3)
/* Else shares of the speed that are tried: arms may bounce past 0.5 s at slower speeds and not at that one. */
#define SHARES 10

/* An impact that is followed until 0.6 s. */
typedef struct {
    panda_params p;
    panda_impact impact;
    panda_budget budget;
    panda_watch watch;
    bool bounded; /* some force is a bound */
    bool calm; /* what was asked last cannot press harder at slower speeds */
    panda_real peak; /* force of what was asked last, N */
} panda_pressing;

/*
 * Largest force from 0.5 s on; less than `matters`, or nothing, if it is proven that none exceeds that. The
 * largest of numbers where that is not known.
 */
static panda_real pressed_by(panda_pressing *k, panda_real speed, panda_real matters)
{
    panda_peak peak;
    k->watch.matters = matters;
    k->watch.depth = panda_law_depth(k->impact.region, matters);
    k->watch.apart = PANDA_R(0.0);
    k->watch.settled = false;
    k->watch.late = PANDA_R(0.0);
    k->watch.before = PANDA_R(0.0);
    k->watch.last = PANDA_R(0.0);
    k->budget.watch = &k->watch;
    panda_impact_run(&k->impact, speed, &k->budget, &peak);
    k->peak = peak.force;
    if (peak.ended && !peak.torn) {
        return k->watch.late;
    }
    const panda_real bound = k->impact.status == PANDA_OK ? panda_bound(&k->impact) : PANDA_R(0.0);
    k->bounded = true;
    return bound > PANDA_R(0.0) ? bound*speed : PANDA_REAL_MAX;
}

/* Whether what presses keeps a limit at a speed, by any motors; false where that is not known. */
static bool keeps(panda_pressing *k, const panda_region *region, panda_real speed, panda_real limit)
{
    int first;
    int last;
    panda_kinds_of_motors(&k->p, &first, &last);
    bool kept = true;
    k->watch.slower = true;
    k->calm = region->law == NULL;
    for (int motors = first; motors <= last && kept; ++motors) {
        kept = panda_impact_prepare(region, &k->p, motors, limit, &k->impact) == PANDA_OK;
        const panda_real late = kept ? pressed_by(k, speed, CALM*limit) : PANDA_REAL_MAX;
        const panda_real counts = k->impact.smooth > PANDA_HARDLY ? PANDA_COUNTS_ELSEWHERE : PANDA_R(1.0);
        kept = late <= PANDA_KEPT*counts*limit - OF_PEAK*k->peak;
        k->calm = kept && k->calm && k->watch.settled && k->watch.late <= CALM*limit;
    }
    return kept;
}

static void prepare_pressing(const panda_params *p, panda_real until, panda_pressing *k)
{
    k->p = *p;
    k->p.horizon = PANDA_FMAX(PANDA_HORIZON(p), until);
    k->budget.steps = p->steps;
    k->budget.rough = false;
    k->budget.fine = false;
    k->budget.stop_above = PANDA_REAL_MAX;
    k->budget.watch = NULL;
    k->watch.slower = false;
    k->bounded = false;
    k->calm = false;
    k->peak = PANDA_R(0.0);
}

/* A speed at which a proven bound keeps a limit; 0 if there is none. */
static panda_real bounded_speed(panda_pressing *k, const panda_region *region, panda_real limit)
{
    int first;
    int last;
    panda_kinds_of_motors(&k->p, &first, &last);
    panda_real most = PANDA_R(0.0);
    bool is_known = true;
    for (int motors = first; motors <= last && is_known; ++motors) {
        is_known = panda_impact_prepare(region, &k->p, motors, limit, &k->impact) == PANDA_OK;
        const panda_real bound = is_known ? panda_bound(&k->impact) : PANDA_R(0.0);
        is_known = bound > PANDA_R(0.0);
        most = PANDA_FMAX(most, bound);
    }
    return is_known ? PANDA_KEPT*limit/most : PANDA_R(0.0);
}

/* The largest speed up to one at which and, as far as it is looked, below which what presses keeps a limit; or 0. */
static panda_real slow_down(panda_pressing *k, const panda_region *region, panda_real speed, panda_real limit)
{
    static const panda_real shares[SHARES] = {PANDA_R(0.03), PANDA_R(0.06), PANDA_R(0.1), PANDA_R(0.17), PANDA_R(0.25),
        PANDA_R(0.35), PANDA_R(0.48), PANDA_R(0.62), PANDA_R(0.76), PANDA_R(0.9)};
    panda_real low = PANDA_R(0.0);
    panda_real high = speed;
    bool calm = false;
    if (keeps(k, region, speed, limit)) {
        low = speed;
        calm = k->calm;
    }
    for (int i = 0; i < SLOWER && low < speed; ++i) {
        const panda_real middle = PANDA_R(0.5)*(low + high);
        k->budget.steps = k->p.steps;
        if (keeps(k, region, middle, limit)) {
            low = middle;
            calm = k->calm;
        } else {
            high = middle;
        }
    }
    const panda_real found = low;
    for (int i = 0; i < SHARES && !calm && found > PANDA_R(0.0); ++i) {
        k->budget.steps = k->p.steps;
        if (!keeps(k, region, shares[i]*found, limit)) {
            low = i > 0 ? shares[i - 1]*found : PANDA_R(0.0);
            break;
        }
    }
    return low > PANDA_R(0.0) ? low : PANDA_FMIN(speed, bounded_speed(k, region, limit));
}

int panda_pressing_force_at(const panda_real q[PANDA_JOINTS], int point, const panda_real n[3],
    panda_real speed, const panda_region *region, const panda_params *p, panda_real *force)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || force == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_pressing k;
    int status = panda_check_positive(&speed, 1);
    if (status == PANDA_OK) {
        status = panda_approach(q, point, n, region, p, &k.impact);
    }
    if (status != PANDA_OK) {
        return status;
    }
    prepare_pressing(p, PANDA_COUNTS_UNTIL, &k);
    panda_real found = PANDA_R(0.0);
    int first;
    int last;
    panda_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last && region->clamped != 0; ++motors) {
        status = panda_impact_prepare(region, &k.p, motors, -speed, &k.impact);
        if (status != PANDA_OK) {
            return status;
        }
        found = PANDA_FMAX(found, pressed_by(&k, speed, PANDA_R(0.0)));
        if (k.impact.status != PANDA_OK) {
            return k.impact.status;
        }
    }
    if (!(found < PANDA_REAL_MAX)) {
        return PANDA_UNRESOLVED;
    }
    *force = found;
    return k.bounded ? PANDA_BOUNDED : PANDA_OK;
}

/* Checks for limits of both kinds. */
static int check_limits(const panda_region *region)
{
    const panda_real limits[2] = {region->force_limit, region->quasi_static_limit};
    return panda_check_positive(limits, region->clamped != 0 ? 2 : 1);
}

/* Largest speed up to a cap, where that is positive, that keeps all limits of a region. */
static int find_allowed(const panda_region *region, const panda_params *p, panda_real cap, panda_pressing *k,
    panda_allowed_speed_t *found)
{
    panda_safe_speed_t safe;
    const int status = panda_find_speed(region, p, region->force_limit, cap, &k->impact, &safe);
    if (status == PANDA_OK || status == PANDA_BOUNDED) {
        found->speed = safe.speed;
        found->force = safe.force;
        if (region->clamped != 0) {
            prepare_pressing(p, AGAIN_UNTIL, k);
            const panda_real share = region->law == NULL ? PANDA_R(1.0) : KEPT_OF_TABLES;
            found->speed = slow_down(k, region, safe.speed, share*region->quasi_static_limit);
        }
        found->pressed = found->speed < safe.speed ? 1 : 0;
    }
    return status;
}

int panda_allowed_speed_at(const panda_real q[PANDA_JOINTS], int point, const panda_real n[3],
    const panda_region *region, const panda_params *p, panda_allowed_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_pressing k;
    panda_allowed_speed_t found;
    int status = check_limits(region);
    if (status == PANDA_OK) {
        status = panda_approach(q, point, n, region, p, &k.impact);
    }
    if (status == PANDA_OK) {
        status = find_allowed(region, p, PANDA_R(0.0), &k, &found);
    }
    if (status != PANDA_OK && status != PANDA_BOUNDED) {
        return status;
    }
    if (!(found.speed > PANDA_R(0.0))) {
        return PANDA_UNRESOLVED;
    }
    *out = found;
    return status;
}

int panda_allowed_factor(const panda_real q[PANDA_JOINTS], const panda_real dq[PANDA_JOINTS],
    const panda_region *region, const panda_params *p, panda_allowed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_pressing k;
    panda_real rates[PANDA_N];
    panda_allowed_factor_t found = {PANDA_R(1.0), -1, PANDA_R(0.0), PANDA_R(0.0), 0};
    bool bounded = false;
    int status = check_limits(region);
    if (status == PANDA_OK) {
        status = panda_check_impact(region, p);
    }
    if (status == PANDA_OK) {
        status = panda_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    for (int point = 0; point < PANDA_POINTS && status == PANDA_OK; ++point) {
        const panda_real speed = panda_arrive_as_it_moves(point, rates, &k.impact.arrival);
        panda_allowed_speed_t allowed = {speed, PANDA_R(0.0), 0};
        panda_impact_forget(&k.impact);
        if (speed > PANDA_AT_REST) {
            status = find_allowed(region, p, found.factor*speed, &k, &allowed);
            bounded = bounded || status == PANDA_BOUNDED;
            status = status == PANDA_BOUNDED ? PANDA_OK : status;
        }
        if (speed > PANDA_AT_REST && status == PANDA_OK
            && (allowed.speed < found.factor*speed || found.point < 0)) {
            found.factor = PANDA_FMIN(found.factor, allowed.speed/speed);
            found.point = point;
            found.speed = allowed.speed;
            found.force = allowed.force;
            found.pressed = allowed.pressed;
            status = allowed.speed > PANDA_R(0.0) ? PANDA_OK : PANDA_UNRESOLVED;
        }
    }
    const panda_real numbers[3] = {found.factor, found.speed, found.force};
    if (status == PANDA_OK && !panda_all_finite(numbers, 3)) {
        status = PANDA_SINGULAR;
    }
    if (status != PANDA_OK) {
        return status;
    }
    *out = found;
    return bounded ? PANDA_BOUNDED : PANDA_OK;
}

int panda_may_press(const panda_real q[PANDA_JOINTS], const panda_real dq[PANDA_JOINTS],
    panda_real limit, const panda_region *region, const panda_params *p, int *may)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || may == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_pressing k;
    panda_real rates[PANDA_N];
    int status = panda_check_positive(&limit, 1);
    if (status == PANDA_OK) {
        status = panda_check_impact(region, p);
    }
    if (status == PANDA_OK) {
        status = panda_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    if (status != PANDA_OK) {
        return status;
    }
    bool kept = true;
    for (int point = 0; point < PANDA_POINTS && region->clamped != 0 && kept; ++point) {
        const panda_real speed = panda_arrive_as_it_moves(point, rates, &k.impact.arrival);
        panda_impact_forget(&k.impact);
        prepare_pressing(p, AGAIN_UNTIL, &k);
        kept = !(speed > PANDA_AT_REST) || keeps(&k, region, speed, limit);
    }
    *may = kept ? 0 : 1;
    return PANDA_OK;
}
