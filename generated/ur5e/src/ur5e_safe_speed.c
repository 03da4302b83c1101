/* SPDX-License-Identifier: 0BSD */
/* Largest speed of ur5e_ up to which impacts stay below a force. */
#include "ur5e_impact.h"

/* Share of the limit at which trials aim, below UR5E_KEPT, and from which on one is near enough. */
#define AIM UR5E_R(0.9825)
#define NEAR_ENOUGH UR5E_R(0.977)
/* Most trials, and how near two speeds must be between which the force jumps over the limit. */
#define TRIALS 32
#define APART UR5E_R(4e-3)
/*
 * Where a cover ends as if it were solid the force of a law by table jumps with speed, from which one on is known to
 * half a percent.
 */
#define SHORT_OF_JUMP UR5E_R(0.99)
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
#define LATER UR5E_R(0.85)
/* Most that a speed may be off its force's power law at once. */
#define LEAP UR5E_R(8.0)

typedef struct {
    ur5e_real limit;
    ur5e_real low, low_force; /* the largest speed known to be safe; 0 while unknown */
    ur5e_real high; /* the least known not to be; 0 while unknown */
    ur5e_real later; /* of the former, of contacts in doubt */
} search;

/* Next speed to try: as for two bodies that meet, unless that is known to be wrong. */
static ur5e_real next_speed(const ur5e_impact *impact, const search *s, ur5e_real v, ur5e_real force)
{
    const ur5e_real ratio = ur5e_two_body_speed(impact->region, impact->mobility, AIM*s->limit)
        /ur5e_two_body_speed(impact->region, impact->mobility, force);
    const ur5e_real next = v*UR5E_FMIN(LEAP, UR5E_FMAX(UR5E_R(1.0)/LEAP, ratio));
    const bool fits = next > s->low && (next < s->high || !(s->high > UR5E_R(0.0)));
    return fits ? next : UR5E_R(0.5)*(s->low + s->high);
}

/* Tries a speed; false once the steps are used up. */
static bool try_speed(ur5e_impact *impact, ur5e_real v, bool rough, search *s,
    ur5e_budget *budget, ur5e_real *force)
{
    ur5e_peak peak;
    budget->rough = rough;
    budget->stop_above = rough ? UR5E_R(2.0)*s->limit : s->limit;
    ur5e_impact_run(impact, v, budget, &peak);
    *force = peak.force;
    if (!peak.ended || rough) {
        return peak.ended && peak.force > UR5E_R(0.0);
    }
    if (peak.force <= UR5E_KEPT*s->limit && !peak.torn) {
        s->low = v;
        s->low_force = peak.force;
        s->later = peak.later;
    } else {
        s->high = v;
    }
    return peak.force > UR5E_R(0.0);
}

static bool is_found(const search *s, ur5e_real cap)
{
    const bool near = s->low_force >= NEAR_ENOUGH*s->limit;
    const bool jumps = s->high > UR5E_R(0.0) && s->high - s->low <= APART*s->low;
    return s->low > UR5E_R(0.0) && (near || jumps || (cap > UR5E_R(0.0) && s->low >= cap));
}

/* Searches, in finer steps at last where contacts in doubt matter; false if the steps do not do. */
static bool find(ur5e_impact *impact, ur5e_real guess, ur5e_real cap, search *s,
    ur5e_budget *budget)
{
    ur5e_real most = cap;
    bool rough = guess < cap || !(cap > UR5E_R(0.0));
    ur5e_real v = rough ? guess : cap;
    for (int k = 0; k < TRIALS; ++k) {
        ur5e_real force;
        if (!(v > UR5E_R(0.0) && v < UR5E_R(0.01)*UR5E_REAL_MAX)) {
            return false;
        }
        if (!try_speed(impact, v, rough, s, budget, &force)) {
            return false;
        }
        rough = false;
        if (!is_found(s, most)) {
            v = next_speed(impact, s, v, force);
            v = most > UR5E_R(0.0) ? UR5E_FMIN(v, most) : v;
        } else if (!budget->fine && s->later > LATER*s->limit) { /* once more */
            budget->fine = true;
            most = s->low;
            v = most;
            s->low = UR5E_R(0.0);
            s->high = UR5E_R(0.0);
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
static bool look_slower(ur5e_impact *impact, int slowest, search *s, ur5e_budget *budget)
{
    static const ur5e_real slower[SHARES] = {UR5E_R(0.25), UR5E_R(0.45), UR5E_R(0.6), UR5E_R(0.72),
        UR5E_R(0.84), UR5E_R(0.94)};
    const ur5e_real found = s->low;
    const ur5e_real force = s->low_force;
    ur5e_real from = found;
    s->low = UR5E_R(0.0);
    int k = slowest; /* those before are safe */
    while (k < SHARES) {
        ur5e_real unused;
        s->high = UR5E_R(0.0);
        if (!try_speed(impact, slower[k]*from, false, s, budget, &unused) || (s->high > UR5E_R(0.0) && k > slowest)) {
            break;
        }
        if (s->high > UR5E_R(0.0)) {
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

/* Whether loose motors bring too little energy for a force: ur5e_settled.c, w = 0 at first touch. */
static bool are_weak(const ur5e_impact *impact, ur5e_real speed, ur5e_real force)
{
    const ur5e_real needed = force*force/impact->hold + ur5e_law_twice_work(impact->region, force);
    return UR5E_STRUCTURED && speed*speed*ur5e_twice_energy(impact) <= needed;
}

int ur5e_find_speed(const ur5e_region *region, const ur5e_params *p, ur5e_real limit,
    ur5e_real cap, ur5e_impact *impact, ur5e_safe_speed_t *found)
{
    ur5e_budget budget = {p->steps, false, false, limit, NULL};
    bool bounded = false;
    int first;
    int last;
    ur5e_kinds_of_motors(p, &first, &last);
    found->speed = cap;
    found->force = UR5E_R(0.0);
    for (int motors = last; motors >= first; --motors) {
        if (motors < last && are_weak(impact, found->speed, UR5E_KEPT*limit)) {
            continue;
        }
        const int status = ur5e_impact_prepare(region, p, motors, limit, impact);
        if (status != UR5E_OK) {
            return status;
        }
        const bool is_held = !UR5E_STRUCTURED && !(impact->mobility > UR5E_LEAST_MOBILITY);
        const bool hardly_damps = impact->smooth > UR5E_HARDLY && !is_held;
        const ur5e_real counts = impact->smooth < UR5E_HARD || hardly_damps ? UR5E_COUNTS_ELSEWHERE*limit : limit;
        const ur5e_real guess = ur5e_two_body_speed(region, impact->mobility, AIM*counts);
        search s = {counts, UR5E_R(0.0), UR5E_R(0.0), UR5E_R(0.0), UR5E_R(0.0)};
        budget.fine = false;
        const ur5e_real share = region->law == NULL ? UR5E_R(1.0) : SHORT_OF_JUMP;
        const ur5e_real most = found->speed/share; /* so that what is kept free counts once, not for each kind */
        bool is_known = find(impact, motors == last ? guess : most, most, &s, &budget);
        if (most > UR5E_R(0.0) && s.low >= most) {
            s.low = found->speed;
        } else {
            s.low *= share;
        }
        const bool all_slower = region->law != NULL || hardly_damps;
        if (all_slower || budget.fine) {
            s.low = is_known ? s.low : UR5E_R(0.0); /* slower speeds than what was tried are not known */
            is_known = is_known && look_slower(impact, all_slower ? 0 : NEAREST, &s, &budget);
        }
        if (!is_known) {
            if (impact->status != UR5E_OK) {
                return impact->status;
            }
            bounded = true;
            const ur5e_real bound = ur5e_bound(impact);
            if (bound > UR5E_R(0.0) && s.low < limit/bound) {
                s.low = UR5E_FMIN(limit/bound, found->speed > UR5E_R(0.0) ? found->speed : UR5E_REAL_MAX);
                s.low_force = UR5E_FMIN(s.low*bound, limit);
            }
            if (!(s.low > UR5E_R(0.0))) {
                return UR5E_UNRESOLVED;
            }
        }
        found->force = s.low < found->speed ? s.low_force : UR5E_FMAX(found->force, s.low_force);
        found->speed = s.low;
    }
    const ur5e_real numbers[2] = {found->speed, found->force};
    if (ur5e_check_positive(numbers, 2) != UR5E_OK) {
        return UR5E_SINGULAR;
    }
    return bounded ? UR5E_BOUNDED : UR5E_OK;
}

int ur5e_safe_speed_at(const ur5e_real q[UR5E_JOINTS], int point, const ur5e_real n[3],
    ur5e_real limit, const ur5e_region *region, const ur5e_params *p, ur5e_safe_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    ur5e_impact impact;
    int status = ur5e_check_positive(&limit, 1);
    if (status == UR5E_OK) {
        status = ur5e_approach(q, point, n, region, p, &impact);
    }
    if (status != UR5E_OK) {
        return status;
    }
    ur5e_safe_speed_t found;
    status = ur5e_find_speed(region, p, limit, UR5E_R(0.0), &impact, &found);
    if (status == UR5E_OK || status == UR5E_BOUNDED) {
        *out = found;
    }
    return status;
}

int ur5e_safe_speed(const ur5e_real q[UR5E_JOINTS], const ur5e_real n[3], ur5e_real limit,
    const ur5e_region *region, const ur5e_params *p, ur5e_safe_speed_t *out)
{
    return ur5e_safe_speed_at(q, UR5E_POINT_TIP, n, limit, region, p, out);
}
