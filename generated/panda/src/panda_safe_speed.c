/* SPDX-License-Identifier: 0BSD */
/* Largest speed of panda_ up to which impacts stay below a force. */
#include "panda_impact.h"

/* Share of the limit at which trials aim, below PANDA_KEPT, and from which on one is near enough. */
#define AIM PANDA_R(0.9825)
#define NEAR_ENOUGH PANDA_R(0.977)
/* Most trials, and how near two speeds must be between which the force jumps over the limit. */
#define TRIALS 32
#define APART PANDA_R(4e-3)
/*
 * Where a cover ends as if it were solid the force of a law by table jumps with speed, from which one on is known to
 * half a percent.
 */
#define SHORT_OF_JUMP PANDA_R(0.99)
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
#define LATER PANDA_R(0.85)
/* Most that a speed may be off its force's power law at once. */
#define LEAP PANDA_R(8.0)

typedef struct {
    panda_real limit;
    panda_real low, low_force; /* the largest speed known to be safe; 0 while unknown */
    panda_real high; /* the least known not to be; 0 while unknown */
    panda_real later; /* of the former, of contacts in doubt */
} search;

/* Next speed to try: as for two bodies that meet, unless that is known to be wrong. */
static panda_real next_speed(const panda_impact *impact, const search *s, panda_real v, panda_real force)
{
    const panda_real ratio = panda_two_body_speed(impact->region, impact->mobility, AIM*s->limit)
        /panda_two_body_speed(impact->region, impact->mobility, force);
    const panda_real next = v*PANDA_FMIN(LEAP, PANDA_FMAX(PANDA_R(1.0)/LEAP, ratio));
    const bool fits = next > s->low && (next < s->high || !(s->high > PANDA_R(0.0)));
    return fits ? next : PANDA_R(0.5)*(s->low + s->high);
}

/* Tries a speed; false once the steps are used up. */
static bool try_speed(panda_impact *impact, panda_real v, bool rough, search *s,
    panda_budget *budget, panda_real *force)
{
    panda_peak peak;
    budget->rough = rough;
    budget->stop_above = rough ? PANDA_R(2.0)*s->limit : s->limit;
    panda_impact_run(impact, v, budget, &peak);
    *force = peak.force;
    if (!peak.ended || rough) {
        return peak.ended && peak.force > PANDA_R(0.0);
    }
    if (peak.force <= PANDA_KEPT*s->limit && !peak.torn) {
        s->low = v;
        s->low_force = peak.force;
        s->later = peak.later;
    } else {
        s->high = v;
    }
    return peak.force > PANDA_R(0.0);
}

static bool is_found(const search *s, panda_real cap)
{
    const bool near = s->low_force >= NEAR_ENOUGH*s->limit;
    const bool jumps = s->high > PANDA_R(0.0) && s->high - s->low <= APART*s->low;
    return s->low > PANDA_R(0.0) && (near || jumps || (cap > PANDA_R(0.0) && s->low >= cap));
}

/* Searches, in finer steps at last where contacts in doubt matter; false if the steps do not do. */
static bool find(panda_impact *impact, panda_real guess, panda_real cap, search *s,
    panda_budget *budget)
{
    panda_real most = cap;
    bool rough = guess < cap || !(cap > PANDA_R(0.0));
    panda_real v = rough ? guess : cap;
    for (int k = 0; k < TRIALS; ++k) {
        panda_real force;
        if (!(v > PANDA_R(0.0) && v < PANDA_R(0.01)*PANDA_REAL_MAX)) {
            return false;
        }
        if (!try_speed(impact, v, rough, s, budget, &force)) {
            return false;
        }
        rough = false;
        if (!is_found(s, most)) {
            v = next_speed(impact, s, v, force);
            v = most > PANDA_R(0.0) ? PANDA_FMIN(v, most) : v;
        } else if (!budget->fine && s->later > LATER*s->limit) { /* once more */
            budget->fine = true;
            most = s->low;
            v = most;
            s->low = PANDA_R(0.0);
            s->high = PANDA_R(0.0);
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
static bool look_slower(panda_impact *impact, int slowest, search *s, panda_budget *budget)
{
    static const panda_real slower[SHARES] = {PANDA_R(0.25), PANDA_R(0.45), PANDA_R(0.6), PANDA_R(0.72),
        PANDA_R(0.84), PANDA_R(0.94)};
    const panda_real found = s->low;
    const panda_real force = s->low_force;
    panda_real from = found;
    s->low = PANDA_R(0.0);
    int k = slowest; /* those before are safe */
    while (k < SHARES) {
        panda_real unused;
        s->high = PANDA_R(0.0);
        if (!try_speed(impact, slower[k]*from, false, s, budget, &unused) || (s->high > PANDA_R(0.0) && k > slowest)) {
            break;
        }
        if (s->high > PANDA_R(0.0)) {
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

/* Whether loose motors bring too little energy for a force: panda_settled.c, w = 0 at first touch. */
static bool are_weak(const panda_impact *impact, panda_real speed, panda_real force)
{
    const panda_real needed = force*force/impact->hold + panda_law_twice_work(impact->region, force);
    return PANDA_STRUCTURED && speed*speed*panda_twice_energy(impact) <= needed;
}

int panda_find_speed(const panda_region *region, const panda_params *p, panda_real limit,
    panda_real cap, panda_impact *impact, panda_safe_speed_t *found)
{
    panda_budget budget = {p->steps, false, false, limit, NULL};
    bool bounded = false;
    int first;
    int last;
    panda_kinds_of_motors(p, &first, &last);
    found->speed = cap;
    found->force = PANDA_R(0.0);
    for (int motors = last; motors >= first; --motors) {
        if (motors < last && are_weak(impact, found->speed, PANDA_KEPT*limit)) {
            continue;
        }
        const int status = panda_impact_prepare(region, p, motors, limit, impact);
        if (status != PANDA_OK) {
            return status;
        }
        const bool is_held = !PANDA_STRUCTURED && !(impact->mobility > PANDA_LEAST_MOBILITY);
        const bool hardly_damps = impact->smooth > PANDA_HARDLY && !is_held;
        const panda_real counts = impact->smooth < PANDA_HARD || hardly_damps ? PANDA_COUNTS_ELSEWHERE*limit : limit;
        const panda_real guess = panda_two_body_speed(region, impact->mobility, AIM*counts);
        search s = {counts, PANDA_R(0.0), PANDA_R(0.0), PANDA_R(0.0), PANDA_R(0.0)};
        budget.fine = false;
        const panda_real share = region->law == NULL ? PANDA_R(1.0) : SHORT_OF_JUMP;
        const panda_real most = found->speed/share; /* so that what is kept free counts once, not for each kind */
        bool is_known = find(impact, motors == last ? guess : most, most, &s, &budget);
        if (most > PANDA_R(0.0) && s.low >= most) {
            s.low = found->speed;
        } else {
            s.low *= share;
        }
        const bool all_slower = region->law != NULL || hardly_damps;
        if (all_slower || budget.fine) {
            s.low = is_known ? s.low : PANDA_R(0.0); /* slower speeds than what was tried are not known */
            is_known = is_known && look_slower(impact, all_slower ? 0 : NEAREST, &s, &budget);
        }
        if (!is_known) {
            if (impact->status != PANDA_OK) {
                return impact->status;
            }
            bounded = true;
            const panda_real bound = panda_bound(impact);
            if (bound > PANDA_R(0.0) && s.low < limit/bound) {
                s.low = PANDA_FMIN(limit/bound, found->speed > PANDA_R(0.0) ? found->speed : PANDA_REAL_MAX);
                s.low_force = PANDA_FMIN(s.low*bound, limit);
            }
            if (!(s.low > PANDA_R(0.0))) {
                return PANDA_UNRESOLVED;
            }
        }
        found->force = s.low < found->speed ? s.low_force : PANDA_FMAX(found->force, s.low_force);
        found->speed = s.low;
    }
    const panda_real numbers[2] = {found->speed, found->force};
    if (panda_check_positive(numbers, 2) != PANDA_OK) {
        return PANDA_SINGULAR;
    }
    return bounded ? PANDA_BOUNDED : PANDA_OK;
}

int panda_safe_speed_at(const panda_real q[PANDA_JOINTS], int point, const panda_real n[3],
    panda_real limit, const panda_region *region, const panda_params *p, panda_safe_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    panda_impact impact;
    int status = panda_check_positive(&limit, 1);
    if (status == PANDA_OK) {
        status = panda_approach(q, point, n, region, p, &impact);
    }
    if (status != PANDA_OK) {
        return status;
    }
    panda_safe_speed_t found;
    status = panda_find_speed(region, p, limit, PANDA_R(0.0), &impact, &found);
    if (status == PANDA_OK || status == PANDA_BOUNDED) {
        *out = found;
    }
    return status;
}

int panda_safe_speed(const panda_real q[PANDA_JOINTS], const panda_real n[3], panda_real limit,
    const panda_region *region, const panda_params *p, panda_safe_speed_t *out)
{
    return panda_safe_speed_at(q, PANDA_POINT_TIP, n, limit, region, p, out);
}
