/* SPDX-License-Identifier: 0BSD */
/* Largest speed of rmin_ up to which impacts stay below a force. */
#include "rmin_impact.h"

/* Share of the limit at which trials aim, below RMIN_KEPT, and from which on one is near enough. */
#define AIM RMIN_R(0.9825)
#define NEAR_ENOUGH RMIN_R(0.977)
/* Most trials, and how near two speeds must be between which the force jumps over the limit. */
#define TRIALS 32
#define APART RMIN_R(4e-3)
/*
 * Where a cover ends as if it were solid the force of a law by table jumps with speed, from which one on is known to
 * half a percent.
 */
#define SHORT_OF_JUMP RMIN_R(0.99)
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
#define LATER RMIN_R(0.85)
/* Most that a speed may be off its force's power law at once. */
#define LEAP RMIN_R(8.0)

typedef struct {
    rmin_real limit;
    rmin_real low, low_force; /* the largest speed known to be safe; 0 while unknown */
    rmin_real high; /* the least known not to be; 0 while unknown */
    rmin_real later; /* of the former, of contacts in doubt */
} search;

/* Next speed to try: as for two bodies that meet, unless that is known to be wrong. */
static rmin_real next_speed(const rmin_impact *impact, const search *s, rmin_real v, rmin_real force)
{
    const rmin_real ratio = rmin_two_body_speed(impact->region, impact->mobility, AIM*s->limit)
        /rmin_two_body_speed(impact->region, impact->mobility, force);
    const rmin_real next = v*RMIN_FMIN(LEAP, RMIN_FMAX(RMIN_R(1.0)/LEAP, ratio));
    const bool fits = next > s->low && (next < s->high || !(s->high > RMIN_R(0.0)));
    return fits ? next : RMIN_R(0.5)*(s->low + s->high);
}

/* Tries a speed; false once the steps are used up. */
static bool try_speed(rmin_impact *impact, rmin_real v, bool rough, search *s,
    rmin_budget *budget, rmin_real *force)
{
    rmin_peak peak;
    budget->rough = rough;
    budget->stop_above = rough ? RMIN_R(2.0)*s->limit : s->limit;
    rmin_impact_run(impact, v, budget, &peak);
    *force = peak.force;
    if (!peak.ended || rough) {
        return peak.ended && peak.force > RMIN_R(0.0);
    }
    if (peak.force <= RMIN_KEPT*s->limit && !peak.torn) {
        s->low = v;
        s->low_force = peak.force;
        s->later = peak.later;
    } else {
        s->high = v;
    }
    return peak.force > RMIN_R(0.0);
}

static bool is_found(const search *s, rmin_real cap)
{
    const bool near = s->low_force >= NEAR_ENOUGH*s->limit;
    const bool jumps = s->high > RMIN_R(0.0) && s->high - s->low <= APART*s->low;
    return s->low > RMIN_R(0.0) && (near || jumps || (cap > RMIN_R(0.0) && s->low >= cap));
}

/* Searches, in finer steps at last where contacts in doubt matter; false if the steps do not do. */
static bool find(rmin_impact *impact, rmin_real guess, rmin_real cap, search *s,
    rmin_budget *budget)
{
    rmin_real most = cap;
    bool rough = guess < cap || !(cap > RMIN_R(0.0));
    rmin_real v = rough ? guess : cap;
    for (int k = 0; k < TRIALS; ++k) {
        rmin_real force;
        if (!(v > RMIN_R(0.0) && v < RMIN_R(0.01)*RMIN_REAL_MAX)) {
            return false;
        }
        if (!try_speed(impact, v, rough, s, budget, &force)) {
            return false;
        }
        rough = false;
        if (!is_found(s, most)) {
            v = next_speed(impact, s, v, force);
            v = most > RMIN_R(0.0) ? RMIN_FMIN(v, most) : v;
        } else if (!budget->fine && s->later > LATER*s->limit) { /* once more */
            budget->fine = true;
            most = s->low;
            v = most;
            s->low = RMIN_R(0.0);
            s->high = RMIN_R(0.0);
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
static bool look_slower(rmin_impact *impact, int slowest, search *s, rmin_budget *budget)
{
    static const rmin_real slower[SHARES] = {RMIN_R(0.25), RMIN_R(0.45), RMIN_R(0.6), RMIN_R(0.72),
        RMIN_R(0.84), RMIN_R(0.94)};
    const rmin_real found = s->low;
    const rmin_real force = s->low_force;
    rmin_real from = found;
    s->low = RMIN_R(0.0);
    int k = slowest; /* those before are safe */
    while (k < SHARES) {
        rmin_real unused;
        s->high = RMIN_R(0.0);
        if (!try_speed(impact, slower[k]*from, false, s, budget, &unused) || (s->high > RMIN_R(0.0) && k > slowest)) {
            break;
        }
        if (s->high > RMIN_R(0.0)) {
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

/* Whether loose motors bring too little energy for a force: rmin_settled.c, w = 0 at first touch. */
static bool are_weak(const rmin_impact *impact, rmin_real speed, rmin_real force)
{
    const rmin_real needed = force*force/impact->hold + rmin_law_twice_work(impact->region, force);
    return RMIN_STRUCTURED && speed*speed*rmin_twice_energy(impact) <= needed;
}

int rmin_find_speed(const rmin_region *region, const rmin_params *p, rmin_real limit,
    rmin_real cap, rmin_impact *impact, rmin_safe_speed_t *found)
{
    rmin_budget budget = {p->steps, false, false, limit, NULL};
    bool bounded = false;
    int first;
    int last;
    rmin_kinds_of_motors(p, &first, &last);
    found->speed = cap;
    found->force = RMIN_R(0.0);
    for (int motors = last; motors >= first; --motors) {
        if (motors < last && are_weak(impact, found->speed, RMIN_KEPT*limit)) {
            continue;
        }
        const int status = rmin_impact_prepare(region, p, motors, limit, impact);
        if (status != RMIN_OK) {
            return status;
        }
        const bool is_held = !RMIN_STRUCTURED && !(impact->mobility > RMIN_LEAST_MOBILITY);
        const bool hardly_damps = impact->smooth > RMIN_HARDLY && !is_held;
        const rmin_real counts = impact->smooth < RMIN_HARD || hardly_damps ? RMIN_COUNTS_ELSEWHERE*limit : limit;
        const rmin_real guess = rmin_two_body_speed(region, impact->mobility, AIM*counts);
        search s = {counts, RMIN_R(0.0), RMIN_R(0.0), RMIN_R(0.0), RMIN_R(0.0)};
        budget.fine = false;
        const rmin_real share = region->law == NULL ? RMIN_R(1.0) : SHORT_OF_JUMP;
        const rmin_real most = found->speed/share; /* so that what is kept free counts once, not for each kind */
        bool is_known = find(impact, motors == last ? guess : most, most, &s, &budget);
        if (most > RMIN_R(0.0) && s.low >= most) {
            s.low = found->speed;
        } else {
            s.low *= share;
        }
        const bool all_slower = region->law != NULL || hardly_damps;
        if (all_slower || budget.fine) {
            s.low = is_known ? s.low : RMIN_R(0.0); /* slower speeds than what was tried are not known */
            is_known = is_known && look_slower(impact, all_slower ? 0 : NEAREST, &s, &budget);
        }
        if (!is_known) {
            if (impact->status != RMIN_OK) {
                return impact->status;
            }
            bounded = true;
            const rmin_real bound = rmin_bound(impact);
            if (bound > RMIN_R(0.0) && s.low < limit/bound) {
                s.low = RMIN_FMIN(limit/bound, found->speed > RMIN_R(0.0) ? found->speed : RMIN_REAL_MAX);
                s.low_force = RMIN_FMIN(s.low*bound, limit);
            }
            if (!(s.low > RMIN_R(0.0))) {
                return RMIN_UNRESOLVED;
            }
        }
        found->force = s.low < found->speed ? s.low_force : RMIN_FMAX(found->force, s.low_force);
        found->speed = s.low;
    }
    const rmin_real numbers[2] = {found->speed, found->force};
    if (rmin_check_positive(numbers, 2) != RMIN_OK) {
        return RMIN_SINGULAR;
    }
    return bounded ? RMIN_BOUNDED : RMIN_OK;
}

int rmin_safe_speed_at(const rmin_real q[RMIN_JOINTS], int point, const rmin_real n[3],
    rmin_real limit, const rmin_region *region, const rmin_params *p, rmin_safe_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    rmin_impact impact;
    int status = rmin_check_positive(&limit, 1);
    if (status == RMIN_OK) {
        status = rmin_approach(q, point, n, region, p, &impact);
    }
    if (status != RMIN_OK) {
        return status;
    }
    rmin_safe_speed_t found;
    status = rmin_find_speed(region, p, limit, RMIN_R(0.0), &impact, &found);
    if (status == RMIN_OK || status == RMIN_BOUNDED) {
        *out = found;
    }
    return status;
}

int rmin_safe_speed(const rmin_real q[RMIN_JOINTS], const rmin_real n[3], rmin_real limit,
    const rmin_region *region, const rmin_params *p, rmin_safe_speed_t *out)
{
    return rmin_safe_speed_at(q, RMIN_POINT_TIP, n, limit, region, p, out);
}
