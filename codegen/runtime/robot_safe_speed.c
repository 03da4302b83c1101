/* SPDX-License-Identifier: 0BSD */
/* Largest speed of robot_ up to which impacts stay below a force. */
#include "robot_impact.h"

/* Share of the limit at which trials aim, below ROBOT_KEPT, and from which on one is near enough. */
#define AIM ROBOT_R(0.9825)
#define NEAR_ENOUGH ROBOT_R(0.977)
/* Most trials, and how near two speeds must be between which the force jumps over the limit. */
#define TRIALS 32
#define APART ROBOT_R(4e-3)
/*
 * Where a cover ends as if it were solid the force of a law by table jumps with speed, from which one on is known to
 * half a percent.
 */
#define SHORT_OF_JUMP ROBOT_R(0.99)
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
#define LATER ROBOT_R(0.85)
/* Most that a speed may be off its force's power law at once. */
#define LEAP ROBOT_R(8.0)

typedef struct {
    robot_real limit;
    robot_real low, low_force; /* the largest speed known to be safe; 0 while unknown */
    robot_real high; /* the least known not to be; 0 while unknown */
    robot_real later; /* of the former, of contacts in doubt */
} search;

/* Next speed to try: as for two bodies that meet, unless that is known to be wrong. */
static robot_real next_speed(const robot_impact *impact, const search *s, robot_real v, robot_real force)
{
    const robot_real ratio = robot_two_body_speed(impact->region, impact->mobility, AIM*s->limit)
        /robot_two_body_speed(impact->region, impact->mobility, force);
    const robot_real next = v*ROBOT_FMIN(LEAP, ROBOT_FMAX(ROBOT_R(1.0)/LEAP, ratio));
    const bool fits = next > s->low && (next < s->high || !(s->high > ROBOT_R(0.0)));
    return fits ? next : ROBOT_R(0.5)*(s->low + s->high);
}

/* Tries a speed; false once the steps are used up. */
static bool try_speed(robot_impact *impact, robot_real v, bool rough, search *s,
    robot_budget *budget, robot_real *force)
{
    robot_peak peak;
    budget->rough = rough;
    budget->stop_above = rough ? ROBOT_R(2.0)*s->limit : s->limit;
    robot_impact_run(impact, v, budget, &peak);
    *force = peak.force;
    if (!peak.ended || rough) {
        return peak.ended && peak.force > ROBOT_R(0.0);
    }
    if (peak.force <= ROBOT_KEPT*s->limit && !peak.torn) {
        s->low = v;
        s->low_force = peak.force;
        s->later = peak.later;
    } else {
        s->high = v;
    }
    return peak.force > ROBOT_R(0.0);
}

static bool is_found(const search *s, robot_real cap)
{
    const bool near = s->low_force >= NEAR_ENOUGH*s->limit;
    const bool jumps = s->high > ROBOT_R(0.0) && s->high - s->low <= APART*s->low;
    return s->low > ROBOT_R(0.0) && (near || jumps || (cap > ROBOT_R(0.0) && s->low >= cap));
}

/* Searches, in finer steps at last where contacts in doubt matter; false if the steps do not do. */
static bool find(robot_impact *impact, robot_real guess, robot_real cap, search *s,
    robot_budget *budget)
{
    robot_real most = cap;
    bool rough = guess < cap || !(cap > ROBOT_R(0.0));
    robot_real v = rough ? guess : cap;
    for (int k = 0; k < TRIALS; ++k) {
        robot_real force;
        if (!(v > ROBOT_R(0.0) && v < ROBOT_R(0.01)*ROBOT_REAL_MAX)) {
            return false;
        }
        if (!try_speed(impact, v, rough, s, budget, &force)) {
            return false;
        }
        rough = false;
        if (!is_found(s, most)) {
            v = next_speed(impact, s, v, force);
            v = most > ROBOT_R(0.0) ? ROBOT_FMIN(v, most) : v;
        } else if (!budget->fine && s->later > LATER*s->limit) { /* once more */
            budget->fine = true;
            most = s->low;
            v = most;
            s->low = ROBOT_R(0.0);
            s->high = ROBOT_R(0.0);
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
static bool look_slower(robot_impact *impact, int slowest, search *s, robot_budget *budget)
{
    static const robot_real slower[SHARES] = {ROBOT_R(0.25), ROBOT_R(0.45), ROBOT_R(0.6), ROBOT_R(0.72),
        ROBOT_R(0.84), ROBOT_R(0.94)};
    const robot_real found = s->low;
    const robot_real force = s->low_force;
    robot_real from = found;
    s->low = ROBOT_R(0.0);
    int k = slowest; /* those before are safe */
    while (k < SHARES) {
        robot_real unused;
        s->high = ROBOT_R(0.0);
        if (!try_speed(impact, slower[k]*from, false, s, budget, &unused) || (s->high > ROBOT_R(0.0) && k > slowest)) {
            break;
        }
        if (s->high > ROBOT_R(0.0)) {
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

/* Whether loose motors bring too little energy for a force: robot_settled.c, w = 0 at first touch. */
static bool are_weak(const robot_impact *impact, robot_real speed, robot_real force)
{
    const robot_real needed = force*force/impact->hold + robot_law_twice_work(impact->region, force);
    return ROBOT_STRUCTURED && speed*speed*robot_twice_energy(impact) <= needed;
}

int robot_find_speed(const robot_region *region, const robot_params *p, robot_real limit,
    robot_real cap, robot_impact *impact, robot_safe_speed_t *found)
{
    robot_budget budget = {p->steps, false, false, limit, NULL};
    bool bounded = false;
    int first;
    int last;
    robot_kinds_of_motors(p, &first, &last);
    found->speed = cap;
    found->force = ROBOT_R(0.0);
    for (int motors = last; motors >= first; --motors) {
        if (motors < last && are_weak(impact, found->speed, ROBOT_KEPT*limit)) {
            continue;
        }
        const int status = robot_impact_prepare(region, p, motors, limit, impact);
        if (status != ROBOT_OK) {
            return status;
        }
        const bool is_held = !ROBOT_STRUCTURED && !(impact->mobility > ROBOT_LEAST_MOBILITY);
        const bool hardly_damps = impact->smooth > ROBOT_HARDLY && !is_held;
        const robot_real counts = impact->smooth < ROBOT_HARD || hardly_damps ? ROBOT_COUNTS_ELSEWHERE*limit : limit;
        const robot_real guess = robot_two_body_speed(region, impact->mobility, AIM*counts);
        search s = {counts, ROBOT_R(0.0), ROBOT_R(0.0), ROBOT_R(0.0), ROBOT_R(0.0)};
        budget.fine = false;
        const robot_real share = region->law == NULL ? ROBOT_R(1.0) : SHORT_OF_JUMP;
        const robot_real most = found->speed/share; /* so that what is kept free counts once, not for each kind */
        bool is_known = find(impact, motors == last ? guess : most, most, &s, &budget);
        if (most > ROBOT_R(0.0) && s.low >= most) {
            s.low = found->speed;
        } else {
            s.low *= share;
        }
        const bool all_slower = region->law != NULL || hardly_damps;
        if (all_slower || budget.fine) {
            s.low = is_known ? s.low : ROBOT_R(0.0); /* slower speeds than what was tried are not known */
            is_known = is_known && look_slower(impact, all_slower ? 0 : NEAREST, &s, &budget);
        }
        if (!is_known) {
            if (impact->status != ROBOT_OK) {
                return impact->status;
            }
            bounded = true;
            const robot_real bound = robot_bound(impact);
            if (bound > ROBOT_R(0.0) && s.low < limit/bound) {
                s.low = ROBOT_FMIN(limit/bound, found->speed > ROBOT_R(0.0) ? found->speed : ROBOT_REAL_MAX);
                s.low_force = ROBOT_FMIN(s.low*bound, limit);
            }
            if (!(s.low > ROBOT_R(0.0))) {
                return ROBOT_UNRESOLVED;
            }
        }
        found->force = s.low < found->speed ? s.low_force : ROBOT_FMAX(found->force, s.low_force);
        found->speed = s.low;
    }
    const robot_real numbers[2] = {found->speed, found->force};
    if (robot_check_positive(numbers, 2) != ROBOT_OK) {
        return ROBOT_SINGULAR;
    }
    return bounded ? ROBOT_BOUNDED : ROBOT_OK;
}

int robot_safe_speed_at(const robot_real q[ROBOT_JOINTS], int point, const robot_real n[3],
    robot_real limit, const robot_region *region, const robot_params *p, robot_safe_speed_t *out)
{
    if (q == NULL || n == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    robot_impact impact;
    int status = robot_check_positive(&limit, 1);
    if (status == ROBOT_OK) {
        status = robot_approach(q, point, n, region, p, &impact);
    }
    if (status != ROBOT_OK) {
        return status;
    }
    robot_safe_speed_t found;
    status = robot_find_speed(region, p, limit, ROBOT_R(0.0), &impact, &found);
    if (status == ROBOT_OK || status == ROBOT_BOUNDED) {
        *out = found;
    }
    return status;
}

int robot_safe_speed(const robot_real q[ROBOT_JOINTS], const robot_real n[3], robot_real limit,
    const robot_region *region, const robot_params *p, robot_safe_speed_t *out)
{
    return robot_safe_speed_at(q, ROBOT_POINT_TIP, n, limit, region, p, out);
}
