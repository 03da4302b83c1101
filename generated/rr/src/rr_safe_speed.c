/* SPDX-License-Identifier: 0BSD */
/* Largest speed of rr_ up to which impacts stay below a force. */
#include "rr_impact.h"

/* Share of the limit at which trials aim, below RR_KEPT, and from which on one is near enough. */
#define AIM RR_R(0.9825)
#define NEAR_ENOUGH RR_R(0.977)
/* Most trials, and how near two speeds must be between which the force jumps over the limit. */
#define TRIALS 32
#define APART RR_R(4e-3)
/*
 * Where a cover ends as if it were solid the force of a law by table jumps with speed, from which one on is known to
 * half a percent.
 */
#define SHORT_OF_JUMP RR_R(0.99)
/*
 * Shares of a speed at which laws by table and bodies that hardly damp are tried, too: a later contact may press
 * harder at a slower speed, by up to 1.24 and 2.4 times the limit in inputs that a search climbed to, over a third
 * of the speeds and more.
 */
#define SHARES 6
/*
 * The last of these, and the share of a limit from which on a third or later contact (before a hard damper a second
 * one) makes them count for other bodies, too, and shorter steps: errors grow about fivefold from contact to contact
 * (0.5 % in a second one, 2.4 % in the third), and such forces were up to 1.05 (1.17) times the limit at nine tenths of
 * the speed.
 */
#define NEAREST 3
#define LATER RR_R(0.85)
/* Most that a speed may be off its force's power law at once. */
#define LEAP RR_R(8.0)

typedef struct {
    rr_real limit;
    rr_real low, low_force; /* the largest speed known to be safe; 0 while unknown */
    rr_real high; /* the least known not to be; 0 while unknown */
    rr_real later; /* of the former, of contacts in doubt */
} search;

/* Next speed to try: as for two bodies that meet, unless that is known to be wrong. */
static rr_real next_speed(const rr_impact *impact, const search *s, rr_real v, rr_real force)
{
    const rr_real ratio = rr_two_body_speed(impact->region, impact->mobility, AIM*s->limit)
        /rr_two_body_speed(impact->region, impact->mobility, force);
    const rr_real next = v*RR_FMIN(LEAP, RR_FMAX(RR_R(1.0)/LEAP, ratio));
    const bool fits = next > s->low && (next < s->high || !(s->high > RR_R(0.0)));
    return fits ? next : RR_R(0.5)*(s->low + s->high);
}

/* Tries a speed; false once the steps are used up. */
static bool try_speed(rr_impact *impact, rr_real v, bool rough, search *s,
    rr_budget *budget, rr_real *force)
{
    rr_peak peak;
    budget->rough = rough;
    budget->stop_above = rough ? RR_R(2.0)*s->limit : s->limit;
    rr_impact_run(impact, v, budget, &peak);
    *force = peak.force;
    if (!peak.ended || rough) {
        return peak.ended && peak.force > RR_R(0.0);
    }
    if (peak.force <= RR_KEPT*s->limit && !peak.torn) {
        s->low = v;
        s->low_force = peak.force;
        s->later = peak.later;
    } else {
        s->high = v;
    }
    return peak.force > RR_R(0.0);
}

static bool is_found(const search *s, rr_real cap)
{
    const bool near = s->low_force >= NEAR_ENOUGH*s->limit;
    const bool jumps = s->high > RR_R(0.0) && s->high - s->low <= APART*s->low;
    return s->low > RR_R(0.0) && (near || jumps || (cap > RR_R(0.0) && s->low >= cap));
}

/* Searches, in finer steps at last where contacts in doubt matter; false if the steps do not do. */
static bool find(rr_impact *impact, rr_real guess, rr_real cap, search *s,
    rr_budget *budget)
{
    rr_real most = cap;
    bool rough = guess < cap || !(cap > RR_R(0.0));
    rr_real v = rough ? guess : cap;
    for (int k = 0; k < TRIALS; ++k) {
        rr_real force;
        if (!(v > RR_R(0.0) && v < RR_R(0.01)*RR_REAL_MAX)) {
            return false;
        }
        if (!try_speed(impact, v, rough, s, budget, &force)) {
            return false;
        }
        rough = false;
        if (!is_found(s, most)) {
            v = next_speed(impact, s, v, force);
            v = most > RR_R(0.0) ? RR_FMIN(v, most) : v;
        } else if (!budget->fine && s->later > LATER*s->limit) { /* once more */
            budget->fine = true;
            most = s->low;
            v = most;
            s->low = RR_R(0.0);
            s->high = RR_R(0.0);
        } else {
            return true;
        }
    }
    return false;
}

/*
 * Lowers a speed that was found below the slowest share of it that is not safe; where the slowest of all is none, the
 * same is done with that one, until one is or the steps do not do. False if the speed may be far too low. Of the
 * shares, those from one on.
 */
static bool look_slower(rr_impact *impact, int slowest, search *s, rr_budget *budget)
{
    static const rr_real slower[SHARES] = {RR_R(0.25), RR_R(0.45), RR_R(0.6), RR_R(0.72),
        RR_R(0.84), RR_R(0.94)};
    const rr_real found = s->low;
    const rr_real force = s->low_force;
    rr_real from = found;
    s->low = RR_R(0.0);
    int k = slowest; /* those before are safe */
    while (k < SHARES) {
        rr_real unused;
        s->high = RR_R(0.0);
        if (!try_speed(impact, slower[k]*from, false, s, budget, &unused) || (s->high > RR_R(0.0) && k > slowest)) {
            break;
        }
        if (s->high > RR_R(0.0)) {
            from = s->high;
        } else {
            ++k;
        }
    }
    if (from < found) {
        return false;
    }
    if (k == SHARES) {
        s->low = found;
        s->low_force = force;
    }
    return k > slowest;
}

/* Whether loose motors bring too little energy for a force: rr_settled.c, w = 0 at first touch. */
static bool are_weak(const rr_impact *impact, rr_real speed, rr_real force)
{
    const rr_real needed = force*force/impact->hold + rr_law_twice_work(impact->region, force);
    return RR_STRUCTURED && speed*speed*rr_twice_energy(impact) <= needed;
}

int rr_find_speed(const rr_region *region, const rr_params *p, rr_real limit,
    rr_real cap, rr_impact *impact, rr_safe_speed_t *found)
{
    rr_budget budget = {p->steps, false, false, limit, NULL};
    bool bounded = false;
    int first;
    int last;
    rr_kinds_of_motors(p, &first, &last);
    found->speed = cap;
    found->force = RR_R(0.0);
    for (int motors = last; motors >= first; --motors) {
        if (motors < last && are_weak(impact, found->speed, RR_KEPT*limit)) {
            continue;
        }
        const int status = rr_impact_prepare(region, p, motors, limit, impact);
        if (status != RR_OK) {
            return status;
        }
        const bool is_held = !RR_STRUCTURED && !(impact->mobility > RR_LEAST_MOBILITY);
        const bool hardly_damps = impact->smooth > RR_HARDLY && !is_held;
        const rr_real counts = impact->smooth < RR_HARD || hardly_damps ? RR_COUNTS_ELSEWHERE*limit : limit;
        const rr_real guess = rr_two_body_speed(region, impact->mobility, AIM*counts);
        search s = {counts, RR_R(0.0), RR_R(0.0), RR_R(0.0), RR_R(0.0)};
        budget.fine = false;
        const rr_real share = region->law == NULL ? RR_R(1.0) : SHORT_OF_JUMP;
        const rr_real most = found->speed/share; /* so that what is kept free counts once, not for each kind */
        bool is_known = find(impact, motors == last ? guess : most, most, &s, &budget);
        if (most > RR_R(0.0) && s.low >= most) {
            s.low = found->speed;
        } else {
            s.low *= share;
        }
        const bool all_slower = region->law != NULL || hardly_damps;
        if (all_slower || budget.fine) {
            s.low = is_known ? s.low : RR_R(0.0); /* slower speeds than what was tried are not known */
            is_known = is_known && look_slower(impact, all_slower ? 0 : NEAREST, &s, &budget);
        }
        if (!is_known) {
            if (impact->status != RR_OK) {
                return impact->status;
            }
            bounded = true;
            const rr_real bound = rr_bound(impact);
            if (bound > RR_R(0.0) && s.low < limit/bound) {
                s.low = RR_FMIN(limit/bound, found->speed > RR_R(0.0) ? found->speed : RR_REAL_MAX);
                s.low_force = RR_FMIN(s.low*bound, limit);
            }
            if (!(s.low > RR_R(0.0))) {
                return RR_UNRESOLVED;
            }
        }
        found->force = s.low < found->speed ? s.low_force : RR_FMAX(found->force, s.low_force);
        found->speed = s.low;
    }
    const rr_real numbers[2] = {found->speed, found->force};
    if (rr_check_positive(numbers, 2) != RR_OK) {
        return RR_SINGULAR;
    }
    return bounded ? RR_BOUNDED : RR_OK;
}

int rr_safe_speed_at(const rr_real q[RR_JOINTS], int point, const rr_real n[3],
    rr_real limit, const rr_region *region, const rr_params *p, rr_safe_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    rr_impact impact;
    int status = rr_check_positive(&limit, 1);
    if (status == RR_OK) {
        status = rr_approach(q, point, n, region, p, &impact);
    }
    if (status != RR_OK) {
        return status;
    }
    rr_safe_speed_t found;
    status = rr_find_speed(region, p, limit, RR_R(0.0), &impact, &found);
    if (status == RR_OK || status == RR_BOUNDED) {
        *out = found;
    }
    return status;
}

int rr_safe_speed(const rr_real q[RR_JOINTS], const rr_real n[3], rr_real limit,
    const rr_region *region, const rr_params *p, rr_safe_speed_t *out)
{
    return rr_safe_speed_at(q, RR_POINT_TIP, n, limit, region, p, out);
}
