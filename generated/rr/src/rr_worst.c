/* SPDX-License-Identifier: 0BSD */
/* The direction in which rr_ hits hardest: looked for among many, then around the best of them. */
#include "rr_impact.h"

/* Directions over half a ball, or half a circle where the point moves in a plane: forces are even. */
#define OVER_A_BALL 96
#define OVER_A_CIRCLE 32
#define TURN RR_R(2.399963229728653) /* of one from the one before: pi (3 - sqrt(5)) */
#define HALF_A_TURN RR_R(3.141592653589793)
/*
 * How far around the best is looked, as a share of a unit vector, first and last; and last where motors hardly move
 * the point one way, so that directions in which they can lie within a slice.
 */
#define WIDE RR_R(0.2)
#define NARROW RR_R(2e-3)
#define SLICE RR_R(1e-5)
#define MOST_ROUNDS 20
/* Around how many it is looked, and the cosine above which two of them are the same: forces have several tops. */
#define STARTS 3
#define ALIKE (RR_REACH > 2 ? RR_R(0.94) : RR_R(0.98))
/*
 * What forces may be too low, added to what the directions were apart: 1.04 % were found, of a later contact that the
 * horizon cut off.
 */
#define OF_FORCES RR_R(0.015)

typedef struct {
    rr_impact impact;
    int point; /* whose rows of J count */
    rr_real speed;
    rr_real n[3]; /* the worst so far */
    rr_real force;
    rr_real tried; /* force of the last direction that was tried */
    rr_matrix axes; /* of the ellipsoid of what motors move, a row each */
    int least; /* of these, the shortest */
    bool bounded, unknown; /* some direction */
    bool lost; /* some direction is one in which motors cannot move the point here */
} hardest;

/* Tries a direction over those in which the robot moves; says whether it is worse than all before. */
static bool try_direction(const rr_region *region, const rr_params *p, const rr_real along[3], hardest *w)
{
    rr_real n[3];
    rr_peak_force_t found = {RR_R(0.0), RR_R(0.0)};
    for (int k = 0; k < 3; ++k) {
        n[k] = RR_R(0.0);
        for (int l = 0; l < RR_REACH; ++l) {
            n[k] += along[l]*rr_directions[l][k];
        }
    }
    int status = rr_arrive(n, w->point, &w->impact.arrival);
    rr_impact_forget(&w->impact);
    if (status == RR_OK) {
        status = rr_find_peak(region, p, w->speed, &w->impact, &found);
    }
    w->bounded = w->bounded || status == RR_BOUNDED;
    w->lost = w->lost || status == RR_SINGULAR;
    w->unknown = w->unknown || (status != RR_OK && status != RR_BOUNDED && status != RR_SINGULAR);
    w->tried = found.force;
    const bool worse = (status == RR_OK || status == RR_BOUNDED) && found.force > w->force;
    if (worse) {
        w->force = found.force;
        for (int k = 0; k < 3; ++k) {
            w->n[k] = along[k];
        }
    }
    return worse;
}

/* Direction number k of those over half a ball or circle. */
static void direction_of(int k, rr_real along[3])
{
    const rr_real turn = RR_REACH > 2 ? TURN*(rr_real)k : HALF_A_TURN*(rr_real)k/(rr_real)OVER_A_CIRCLE;
    const rr_real up = RR_REACH > 2 ? ((rr_real)k + RR_R(0.5))/(rr_real)OVER_A_BALL : RR_R(0.0);
    const rr_real flat = RR_SQRT(RR_R(1.0) - up*up);
    along[0] = RR_REACH > 1 ? flat*RR_COS(turn) : RR_R(1.0);
    along[1] = flat*RR_SIN(turn);
    along[2] = up;
}

#if RR_REACH > 1
/* Finds the axes along which motors move the point most to least, whatever joints do at a given rate. */
static void find_axes(hardest *w)
{
    const rr_links_t *const links = &w->impact.arrival.links;
    const int x = 3*w->point;
    rr_matrix square;
    rr_real unit[RR_REACH][RR_SYSTEM]; /* vectors */
    rr_real values[RR_SYSTEM];
    for (int k = 0; k < RR_REACH; ++k) {
        for (int l = 0; l < RR_REACH; ++l) {
            const rr_real *const a = rr_directions[k];
            const rr_real *const b = rr_directions[l];
            square[k][l] = RR_R(0.0);
            unit[k][l] = k == l ? RR_R(1.0) : RR_R(0.0);
            for (int i = 0; i < RR_N; ++i) {
                const rr_real by_a = a[0]*links->J[x][i] + a[1]*links->J[x + 1][i] + a[2]*links->J[x + 2][i];
                const rr_real by_b = b[0]*links->J[x][i] + b[1]*links->J[x + 1][i] + b[2]*links->J[x + 2][i];
                square[k][l] += rr_has_motor[i] ? by_a*by_b : RR_R(0.0);
            }
        }
    }
    if (!rr_spectrum(RR_REACH, RR_EPSILON*RR_EPSILON, square, values, RR_REACH, unit, NULL)) {
        w->unknown = true;
        return;
    }
    w->least = 0;
    for (int k = 0; k < RR_REACH; ++k) {
        for (int l = 0; l < RR_REACH; ++l) {
            w->axes[k][l] = unit[l][k];
        }
        w->least = values[k] < values[w->least] ? k : w->least;
    }
}

/*
 * Tries directions at right angles to that in which motors move the point least: where they hardly do, a pose has
 * one dimension less, and hardly any of the directions over a ball is within the others.
 */
static void try_across(const rr_region *region, const rr_params *p, hardest *w)
{
    const rr_real *const a = w->axes[(w->least + 1) % RR_REACH];
    const rr_real *const b = w->axes[(w->least + 2) % RR_REACH];
    for (int k = 0; k < (RR_REACH > 2 ? OVER_A_CIRCLE : 1); ++k) {
        const rr_real turn = HALF_A_TURN*(rr_real)k/(rr_real)OVER_A_CIRCLE;
        rr_real along[3] = {RR_R(0.0), RR_R(0.0), RR_R(0.0)};
        for (int l = 0; l < RR_REACH; ++l) {
            along[l] = RR_REACH > 2 ? RR_COS(turn)*a[l] + RR_SIN(turn)*b[l] : a[l];
        }
        (void)try_direction(region, p, along, w);
    }
}

/*
 * Looks around the worst, along each of the axes as far as that helps: where motors move the point much more one
 * way than others, hard directions lie on a narrow ridge.
 */
static void look_around(const rr_region *region, const rr_params *p, hardest *w)
{
    const rr_real narrow = w->lost ? SLICE : NARROW;
    rr_real wide[3] = {WIDE, WIDE, WIDE};
    for (int round = 0; round < MOST_ROUNDS; ++round) {
        for (int k = 0; k < RR_REACH; ++k) {
            bool better = false;
            for (int side = 0; side < 2 && !better && wide[k] > narrow; ++side) {
                const rr_real by = side == 0 ? wide[k] : -wide[k];
                rr_real along[3] = {RR_R(0.0), RR_R(0.0), RR_R(0.0)};
                rr_real size = RR_R(0.0);
                for (int l = 0; l < RR_REACH; ++l) {
                    along[l] = w->n[l] + by*w->axes[k][l];
                    size += along[l]*along[l];
                }
                size = RR_SQRT(size);
                for (int l = 0; l < RR_REACH && size > RR_R(0.0); ++l) {
                    along[l] /= size;
                }
                better = try_direction(region, p, along, w);
            }
            wide[k] *= better ? RR_R(1.5) : RR_R(0.5);
        }
    }
}

/* Looks around the directions that were hardest, beside the hardest, of those over the ball. */
static void look_elsewhere(const rr_region *region, const rr_params *p, int count, rr_real *forces, hardest *w)
{
    for (int start = 0; start < STARTS; ++start) {
        const rr_real n[3] = {w->n[0], w->n[1], w->n[2]};
        const rr_real force = w->force;
        int best = 0;
        for (int k = 1; k < count; ++k) {
            best = forces[k] > forces[best] ? k : best;
        }
        if (!(forces[best] > RR_R(0.0))) {
            return;
        }
        direction_of(best, w->n);
        w->force = forces[best];
        for (int k = 0; k < count; ++k) {
            rr_real along[3];
            direction_of(k, along);
            const rr_real cosine = along[0]*w->n[0] + along[1]*w->n[1] + along[2]*w->n[2];
            forces[k] = RR_FABS(cosine) > ALIKE ? RR_R(0.0) : forces[k];
        }
        look_around(region, p, w);
        if (!(w->force > force)) {
            w->force = force;
            for (int k = 0; k < 3; ++k) {
                w->n[k] = n[k];
            }
        }
    }
}
#endif

/*
 * A force that no impact in any direction exceeds, by motors of one kind; 0 where none is known.
 *
 * What rr_bound takes of a direction is its K = k + c^2 mobility and its energy, and the bound grows with both.
 * Over directions n of unit length the robot's mobility is a quadratic form, n'An, and so is r'(M + B)r for joint
 * velocities r that are linear in n: none exceeds the sum of its values along directions at right angles, which is
 * the form's trace. Links and rotors as one weigh no more than r'(M + B)r at a contact point, so with a body of
 * mass m, and nothing but joints' springs, the energy is at most that of two masses, 1/(1/trace + 1/m). What pulls
 * on none of the r of these directions pulls on no sum of them.
 */
static rr_real bound_all(const rr_region *region, const rr_params *p, int motors, hardest *w)
{
    rr_impact *const impact = &w->impact;
    const rr_real body = region->clamped == 0 ? RR_R(1.0)/region->effective_mass : RR_R(0.0);
    rr_real mobility = body;
    rr_real twice = RR_R(0.0);
    for (int k = 0; k < RR_REACH; ++k) {
        const int status = rr_arrive(rr_directions[k], w->point, &impact->arrival);
        rr_impact_forget(impact);
        if (status != RR_OK || rr_impact_prepare(region, p, motors, -w->speed, impact) != RR_OK
            || !(rr_bound(impact) > RR_R(0.0))) {
            return RR_R(0.0);
        }
        mobility += impact->mobility - body;
        twice += rr_twice_energy_of_arrival(&impact->arrival, p);
    }
    twice = RR_STRUCTURED ? twice/(RR_R(1.0) + twice*body) : twice;
    return w->speed*rr_bound_by(impact, region->stiffness + region->damping*region->damping*mobility, twice);
}

/* Where some impacts cannot be followed to their end: takes the bound of all directions; false if none is known. */
static bool raise_to_bound(const rr_region *region, const rr_params *p, hardest *w)
{
    int first;
    int last;
    rr_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const rr_real bound = bound_all(region, p, motors, w);
        if (!(bound > RR_R(0.0) && bound <= RR_REAL_MAX)) {
            return false;
        }
        w->force = RR_FMAX(w->force, bound);
    }
    return true;
}

/* Looks everywhere. */
static int find_hardest(const rr_region *region, const rr_params *p, hardest *w, rr_worst_direction_t *out)
{
    const int count = RR_REACH > 2 ? OVER_A_BALL : RR_REACH > 1 ? OVER_A_CIRCLE : 1;
    w->force = RR_R(0.0);
    w->bounded = false;
    w->unknown = false;
    w->lost = false;
    rr_real forces[OVER_A_BALL];
    for (int k = 0; k < count; ++k) {
        rr_real along[3];
        direction_of(k, along);
        (void)try_direction(region, p, along, w);
        forces[k] = w->tried;
    }
#if RR_REACH > 1
    find_axes(w);
    if (w->lost) {
        try_across(region, p, w);
    }
#endif
    if (w->unknown) {
        return RR_UNRESOLVED;
    }
    if (!(w->force > RR_R(0.0))) {
        return RR_SINGULAR;
    }
    const rr_real seen = w->force;
#if RR_REACH > 1
    if (!w->bounded) {
        look_around(region, p, w);
        look_elsewhere(region, p, count, forces, w);
    }
#endif
    if (w->unknown) { /* so may be the hardest */
        return RR_UNRESOLVED;
    }
    if (w->bounded && !raise_to_bound(region, p, w)) {
        return RR_UNRESOLVED;
    }
    for (int k = 0; k < 3; ++k) {
        out->n[k] = RR_R(0.0);
        for (int l = 0; l < RR_REACH; ++l) {
            out->n[k] += w->n[l]*rr_directions[l][k];
        }
    }
    out->force = w->force;
    out->error = w->bounded ? RR_R(0.0) : w->force/seen - RR_R(1.0) + OF_FORCES;
    return w->bounded ? RR_BOUNDED : RR_OK;
}

int rr_worst_direction_at(const rr_real q[RR_JOINTS], int point, rr_real speed,
    const rr_region *region, const rr_params *p, rr_worst_direction_t *out)
{
    if (q == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    hardest w;
    int status = rr_check_positive(&speed, 1);
    if (status == RR_OK) {
        status = rr_check_impact(region, p);
    }
    if (status == RR_OK && !(point >= 0 && point < RR_POINTS)) {
        status = RR_OUT_OF_RANGE;
    }
    if (status == RR_OK) {
        status = rr_links(RR_LINKS_OF(q, p), &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = point;
    return status == RR_OK ? find_hardest(region, p, &w, out) : status;
}

#if RR_FRAMES > 0
int rr_worst_direction_on(const rr_real q[RR_JOINTS], int frame, const rr_real place[3],
    rr_real speed, const rr_region *region, const rr_params *p, rr_worst_direction_t *out)
{
    if (q == NULL || place == NULL || region == NULL || p == NULL || out == NULL) {
        return RR_NULL_POINTER;
    }
    hardest w;
    int status = rr_check_positive(&speed, 1);
    if (status == RR_OK) {
        status = rr_check_impact(region, p);
    }
    if (status == RR_OK) {
        status = rr_links_on(q, frame, place, p, &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = 0;
    return status == RR_OK ? find_hardest(region, p, &w, out) : status;
}
#endif
