/* SPDX-License-Identifier: 0BSD */
/* What presses on a clamped body once the quasi-static limit counts, and speeds that keep both limits. */
#include "ur5e_state.h"

/* Until when it is looked where slower speeds matter, s: contacts that began late may come a little earlier there. */
#define AGAIN_UNTIL UR5E_R(0.62)
/* Halvings of a speed that presses too hard. */
#define SLOWER 14
/*
 * Share of a limit that counts where the law of contact is a table: forces that swing about what presses fell by up to
 * 7 % as the speed rose, between the shares that are tried.
 */
#define KEPT_OF_TABLES UR5E_R(0.9)
/*
 * Share of a limit that no later force may reach if slower speeds need not be looked at: motions by Hertz's law grow
 * nearly with the speed, so what parts for good at one does at slower ones.
 */
#define CALM UR5E_R(0.5)
/* What steps err by, as a share of the peak, which they are fitted to: far smaller late forces were 1.8e-3 off. */
#define OF_PEAK UR5E_R(2e-3)
/* Else shares of the speed that are tried: arms may bounce past 0.5 s at slower speeds and not at that one. */
#define SHARES 10

/* An impact that is followed until 0.6 s. */
typedef struct {
    ur5e_params p;
    ur5e_impact impact;
    ur5e_budget budget;
    ur5e_watch watch;
    bool bounded; /* some force is a bound */
    bool calm; /* what was asked last cannot press harder at slower speeds */
    ur5e_real peak; /* force of what was asked last, N */
} ur5e_pressing;

/*
 * Largest force from 0.5 s on; less than `matters`, or nothing, if it is proven that none exceeds that. The
 * largest of numbers where that is not known.
 */
static ur5e_real pressed_by(ur5e_pressing *k, ur5e_real speed, ur5e_real matters)
{
    ur5e_peak peak;
    k->watch.matters = matters;
    k->watch.depth = ur5e_law_depth(k->impact.region, matters);
    k->watch.apart = UR5E_R(0.0);
    k->watch.settled = false;
    k->watch.late = UR5E_R(0.0);
    k->watch.before = UR5E_R(0.0);
    k->watch.last = UR5E_R(0.0);
    k->budget.watch = &k->watch;
    ur5e_impact_run(&k->impact, speed, &k->budget, &peak);
    k->peak = peak.force;
    if (peak.ended && !peak.torn) {
        return k->watch.late;
    }
    const ur5e_real bound = k->impact.status == UR5E_OK ? ur5e_bound(&k->impact) : UR5E_R(0.0);
    k->bounded = true;
    return bound > UR5E_R(0.0) ? bound*speed : UR5E_REAL_MAX;
}

/* Whether what presses keeps a limit at a speed, by any motors; false where that is not known. */
static bool keeps(ur5e_pressing *k, const ur5e_region *region, ur5e_real speed, ur5e_real limit)
{
    int first;
    int last;
    ur5e_kinds_of_motors(&k->p, &first, &last);
    bool kept = true;
    k->watch.slower = true;
    k->calm = region->law == NULL;
    for (int motors = first; motors <= last && kept; ++motors) {
        kept = ur5e_impact_prepare(region, &k->p, motors, limit, &k->impact) == UR5E_OK;
        const ur5e_real late = kept ? pressed_by(k, speed, CALM*limit) : UR5E_REAL_MAX;
        const ur5e_real counts = k->impact.smooth > UR5E_HARDLY ? UR5E_COUNTS_ELSEWHERE : UR5E_R(1.0);
        kept = late <= UR5E_KEPT*counts*limit - OF_PEAK*k->peak;
        k->calm = kept && k->calm && k->watch.settled && k->watch.late <= CALM*limit;
    }
    return kept;
}

static void prepare_pressing(const ur5e_params *p, ur5e_real until, ur5e_pressing *k)
{
    k->p = *p;
    k->p.horizon = UR5E_FMAX(UR5E_HORIZON(p), until);
    k->budget.steps = p->steps;
    k->budget.rough = false;
    k->budget.fine = false;
    k->budget.stop_above = UR5E_REAL_MAX;
    k->budget.watch = NULL;
    k->watch.slower = false;
    k->bounded = false;
    k->calm = false;
    k->peak = UR5E_R(0.0);
}

/* A speed at which a proven bound keeps a limit; 0 if there is none. */
static ur5e_real bounded_speed(ur5e_pressing *k, const ur5e_region *region, ur5e_real limit)
{
    int first;
    int last;
    ur5e_kinds_of_motors(&k->p, &first, &last);
    ur5e_real most = UR5E_R(0.0);
    bool is_known = true;
    for (int motors = first; motors <= last && is_known; ++motors) {
        is_known = ur5e_impact_prepare(region, &k->p, motors, limit, &k->impact) == UR5E_OK;
        const ur5e_real bound = is_known ? ur5e_bound(&k->impact) : UR5E_R(0.0);
        is_known = bound > UR5E_R(0.0);
        most = UR5E_FMAX(most, bound);
    }
    return is_known ? UR5E_KEPT*limit/most : UR5E_R(0.0);
}

/* The largest speed up to one at which and, as far as it is looked, below which what presses keeps a limit; or 0. */
static ur5e_real slow_down(ur5e_pressing *k, const ur5e_region *region, ur5e_real speed, ur5e_real limit)
{
    static const ur5e_real shares[SHARES] = {UR5E_R(0.03), UR5E_R(0.06), UR5E_R(0.1), UR5E_R(0.17), UR5E_R(0.25),
        UR5E_R(0.35), UR5E_R(0.48), UR5E_R(0.62), UR5E_R(0.76), UR5E_R(0.9)};
    ur5e_real low = UR5E_R(0.0);
    ur5e_real high = speed;
    bool calm = false;
    if (keeps(k, region, speed, limit)) {
        low = speed;
        calm = k->calm;
    }
    for (int i = 0; i < SLOWER && low < speed; ++i) {
        const ur5e_real middle = UR5E_R(0.5)*(low + high);
        k->budget.steps = k->p.steps;
        if (keeps(k, region, middle, limit)) {
            low = middle;
            calm = k->calm;
        } else {
            high = middle;
        }
    }
    const ur5e_real found = low;
    for (int i = 0; i < SHARES && !calm && found > UR5E_R(0.0); ++i) {
        k->budget.steps = k->p.steps;
        if (!keeps(k, region, shares[i]*found, limit)) {
            low = i > 0 ? shares[i - 1]*found : UR5E_R(0.0);
            break;
        }
    }
    return low > UR5E_R(0.0) ? low : UR5E_FMIN(speed, bounded_speed(k, region, limit));
}

int ur5e_pressing_force_at(const ur5e_real q[UR5E_JOINTS], int point, const ur5e_real n[3],
    ur5e_real speed, const ur5e_region *region, const ur5e_params *p, ur5e_real *force)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || force == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_pressing k;
    int status = ur5e_check_positive(&speed, 1);
    if (status == UR5E_OK) {
        status = ur5e_approach(q, point, n, region, p, &k.impact);
    }
    if (status != UR5E_OK) {
        return status;
    }
    prepare_pressing(p, UR5E_COUNTS_UNTIL, &k);
    ur5e_real found = UR5E_R(0.0);
    int first;
    int last;
    ur5e_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last && region->clamped != 0; ++motors) {
        status = ur5e_impact_prepare(region, &k.p, motors, -speed, &k.impact);
        if (status != UR5E_OK) {
            return status;
        }
        found = UR5E_FMAX(found, pressed_by(&k, speed, UR5E_R(0.0)));
        if (k.impact.status != UR5E_OK) {
            return k.impact.status;
        }
    }
    if (!(found < UR5E_REAL_MAX)) {
        return UR5E_UNRESOLVED;
    }
    *force = found;
    return k.bounded ? UR5E_BOUNDED : UR5E_OK;
}

/* Checks for limits of both kinds. */
static int check_limits(const ur5e_region *region)
{
    const ur5e_real limits[2] = {region->force_limit, region->quasi_static_limit};
    return ur5e_check_positive(limits, region->clamped != 0 ? 2 : 1);
}

/* Largest speed up to a cap, where that is positive, that keeps all limits of a region. */
static int find_allowed(const ur5e_region *region, const ur5e_params *p, ur5e_real cap, ur5e_pressing *k,
    ur5e_allowed_speed_t *found)
{
    ur5e_safe_speed_t safe;
    const int status = ur5e_find_speed(region, p, region->force_limit, cap, &k->impact, &safe);
    if (status == UR5E_OK || status == UR5E_BOUNDED) {
        found->speed = safe.speed;
        found->force = safe.force;
        if (region->clamped != 0) {
            prepare_pressing(p, AGAIN_UNTIL, k);
            const ur5e_real share = region->law == NULL ? UR5E_R(1.0) : KEPT_OF_TABLES;
            found->speed = slow_down(k, region, safe.speed, share*region->quasi_static_limit);
        }
        found->pressed = found->speed < safe.speed ? 1 : 0;
    }
    return status;
}

int ur5e_allowed_speed_at(const ur5e_real q[UR5E_JOINTS], int point, const ur5e_real n[3],
    const ur5e_region *region, const ur5e_params *p, ur5e_allowed_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_pressing k;
    ur5e_allowed_speed_t found;
    int status = check_limits(region);
    if (status == UR5E_OK) {
        status = ur5e_approach(q, point, n, region, p, &k.impact);
    }
    if (status == UR5E_OK) {
        status = find_allowed(region, p, UR5E_R(0.0), &k, &found);
    }
    if (status != UR5E_OK && status != UR5E_BOUNDED) {
        return status;
    }
    if (!(found.speed > UR5E_R(0.0))) {
        return UR5E_UNRESOLVED;
    }
    *out = found;
    return status;
}

int ur5e_allowed_factor(const ur5e_real q[UR5E_JOINTS], const ur5e_real dq[UR5E_JOINTS],
    const ur5e_region *region, const ur5e_params *p, ur5e_allowed_factor_t *out)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_pressing k;
    ur5e_real rates[UR5E_N];
    ur5e_allowed_factor_t found = {UR5E_R(1.0), -1, UR5E_R(0.0), UR5E_R(0.0), 0};
    bool bounded = false;
    int status = check_limits(region);
    if (status == UR5E_OK) {
        status = ur5e_check_impact(region, p);
    }
    if (status == UR5E_OK) {
        status = ur5e_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    for (int point = 0; point < UR5E_POINTS && status == UR5E_OK; ++point) {
        const ur5e_real speed = ur5e_arrive_as_it_moves(point, rates, &k.impact.arrival);
        ur5e_allowed_speed_t allowed = {speed, UR5E_R(0.0), 0};
        ur5e_impact_forget(&k.impact);
        if (speed > UR5E_AT_REST) {
            status = find_allowed(region, p, found.factor*speed, &k, &allowed);
            bounded = bounded || status == UR5E_BOUNDED;
            status = status == UR5E_BOUNDED ? UR5E_OK : status;
        }
        if (speed > UR5E_AT_REST && status == UR5E_OK
            && (allowed.speed < found.factor*speed || found.point < 0)) {
            found.factor = UR5E_FMIN(found.factor, allowed.speed/speed);
            found.point = point;
            found.speed = allowed.speed;
            found.force = allowed.force;
            found.pressed = allowed.pressed;
            status = allowed.speed > UR5E_R(0.0) ? UR5E_OK : UR5E_UNRESOLVED;
        }
    }
    const ur5e_real numbers[3] = {found.factor, found.speed, found.force};
    if (status == UR5E_OK && !ur5e_all_finite(numbers, 3)) {
        status = UR5E_SINGULAR;
    }
    if (status != UR5E_OK) {
        return status;
    }
    *out = found;
    return bounded ? UR5E_BOUNDED : UR5E_OK;
}

int ur5e_may_press(const ur5e_real q[UR5E_JOINTS], const ur5e_real dq[UR5E_JOINTS],
    ur5e_real limit, const ur5e_region *region, const ur5e_params *p, int *may)
{
    if (q == NULL || dq == NULL || region == NULL || p == NULL || may == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_pressing k;
    ur5e_real rates[UR5E_N];
    int status = ur5e_check_positive(&limit, 1);
    if (status == UR5E_OK) {
        status = ur5e_check_impact(region, p);
    }
    if (status == UR5E_OK) {
        status = ur5e_set_off(q, dq, p, rates, &k.impact.arrival);
    }
    if (status != UR5E_OK) {
        return status;
    }
    bool kept = true;
    for (int point = 0; point < UR5E_POINTS && region->clamped != 0 && kept; ++point) {
        const ur5e_real speed = ur5e_arrive_as_it_moves(point, rates, &k.impact.arrival);
        ur5e_impact_forget(&k.impact);
        prepare_pressing(p, AGAIN_UNTIL, &k);
        kept = !(speed > UR5E_AT_REST) || keeps(&k, region, speed, limit);
    }
    *may = kept ? 0 : 1;
    return UR5E_OK;
}
