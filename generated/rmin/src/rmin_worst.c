/* SPDX-License-Identifier: 0BSD */
/* The direction in which rmin_ hits hardest: looked for among many, then around the best of them. */
#include "rmin_impact.h"

/* Directions over half a ball, or half a circle where the point moves in a plane: forces are even. */
#define OVER_A_BALL 96
#define OVER_A_CIRCLE 32
#define TURN RMIN_R(2.399963229728653) /* of one from the one before: pi (3 - sqrt(5)) */
#define HALF_A_TURN RMIN_R(3.141592653589793)
/*
 * How far around the best is looked, as a share of a unit vector, first and last; and last where motors hardly move
 * the point one way, so that directions in which they can lie within a slice.
 */
#define WIDE RMIN_R(0.2)
#define NARROW RMIN_R(2e-3)
#define SLICE RMIN_R(1e-5)
#define MOST_ROUNDS 20
/* Around how many it is looked, and the cosine above which two of them are the same: forces have several tops. */
#define STARTS 3
#define ALIKE (RMIN_REACH > 2 ? RMIN_R(0.94) : RMIN_R(0.98))
/*
 * What forces may be too low, added to what the directions were apart: 1.04 % were found, of a later contact that the
 * horizon cut off.
 */
#define OF_FORCES RMIN_R(0.015)

typedef struct {
    rmin_impact impact;
    int point; /* whose rows of J count */
    rmin_real speed;
    rmin_real n[3]; /* the worst so far */
    rmin_real force;
    rmin_real tried; /* force of the last direction that was tried */
    rmin_matrix axes; /* of the ellipsoid of what motors move, a row each */
    int least; /* of these, the shortest */
    bool bounded, unknown; /* some direction */
    bool lost; /* some direction is one in which motors cannot move the point here */
} hardest;

/* Tries a direction over those in which the robot moves; says whether it is worse than all before. */
static bool try_direction(const rmin_region *region, const rmin_params *p, const rmin_real along[3], hardest *w)
{
    rmin_real n[3];
    rmin_peak_force_t found = {RMIN_R(0.0), RMIN_R(0.0)};
    for (int k = 0; k < 3; ++k) {
        n[k] = RMIN_R(0.0);
        for (int l = 0; l < RMIN_REACH; ++l) {
            n[k] += along[l]*rmin_directions[l][k];
        }
    }
    int status = rmin_arrive(n, w->point, &w->impact.arrival);
    rmin_impact_forget(&w->impact);
    if (status == RMIN_OK) {
        status = rmin_find_peak(region, p, w->speed, &w->impact, &found);
    }
    w->bounded = w->bounded || status == RMIN_BOUNDED;
    w->lost = w->lost || status == RMIN_SINGULAR;
    w->unknown = w->unknown || (status != RMIN_OK && status != RMIN_BOUNDED && status != RMIN_SINGULAR);
    w->tried = found.force;
    const bool worse = (status == RMIN_OK || status == RMIN_BOUNDED) && found.force > w->force;
    if (worse) {
        w->force = found.force;
        for (int k = 0; k < 3; ++k) {
            w->n[k] = along[k];
        }
    }
    return worse;
}

/* Direction number k of those over half a ball or circle. */
static void direction_of(int k, rmin_real along[3])
{
    const rmin_real turn = RMIN_REACH > 2 ? TURN*(rmin_real)k : HALF_A_TURN*(rmin_real)k/(rmin_real)OVER_A_CIRCLE;
    const rmin_real up = RMIN_REACH > 2 ? ((rmin_real)k + RMIN_R(0.5))/(rmin_real)OVER_A_BALL : RMIN_R(0.0);
    const rmin_real flat = RMIN_SQRT(RMIN_R(1.0) - up*up);
    along[0] = RMIN_REACH > 1 ? flat*RMIN_COS(turn) : RMIN_R(1.0);
    along[1] = flat*RMIN_SIN(turn);
    along[2] = up;
}

#if RMIN_REACH > 1
/* Finds the axes along which motors move the point most to least, whatever joints do at a given rate. */
static void find_axes(hardest *w)
{
    const rmin_links_t *const links = &w->impact.arrival.links;
    const int x = 3*w->point;
    rmin_matrix square;
    rmin_real unit[RMIN_REACH][RMIN_SYSTEM]; /* vectors */
    rmin_real values[RMIN_SYSTEM];
    for (int k = 0; k < RMIN_REACH; ++k) {
        for (int l = 0; l < RMIN_REACH; ++l) {
            const rmin_real *const a = rmin_directions[k];
            const rmin_real *const b = rmin_directions[l];
            square[k][l] = RMIN_R(0.0);
            unit[k][l] = k == l ? RMIN_R(1.0) : RMIN_R(0.0);
            for (int i = 0; i < RMIN_N; ++i) {
                const rmin_real by_a = a[0]*links->J[x][i] + a[1]*links->J[x + 1][i] + a[2]*links->J[x + 2][i];
                const rmin_real by_b = b[0]*links->J[x][i] + b[1]*links->J[x + 1][i] + b[2]*links->J[x + 2][i];
                square[k][l] += rmin_has_motor[i] ? by_a*by_b : RMIN_R(0.0);
            }
        }
    }
    if (!rmin_spectrum(RMIN_REACH, RMIN_EPSILON*RMIN_EPSILON, square, values, RMIN_REACH, unit, NULL)) {
        w->unknown = true;
        return;
    }
    w->least = 0;
    for (int k = 0; k < RMIN_REACH; ++k) {
        for (int l = 0; l < RMIN_REACH; ++l) {
            w->axes[k][l] = unit[l][k];
        }
        w->least = values[k] < values[w->least] ? k : w->least;
    }
}

/*
 * Tries directions at right angles to that in which motors move the point least: where they hardly do, a pose has
 * one dimension less, and hardly any of the directions over a ball is within the others.
 */
static void try_across(const rmin_region *region, const rmin_params *p, hardest *w)
{
    const rmin_real *const a = w->axes[(w->least + 1) % RMIN_REACH];
    const rmin_real *const b = w->axes[(w->least + 2) % RMIN_REACH];
    for (int k = 0; k < (RMIN_REACH > 2 ? OVER_A_CIRCLE : 1); ++k) {
        const rmin_real turn = HALF_A_TURN*(rmin_real)k/(rmin_real)OVER_A_CIRCLE;
        rmin_real along[3] = {RMIN_R(0.0), RMIN_R(0.0), RMIN_R(0.0)};
        for (int l = 0; l < RMIN_REACH; ++l) {
            along[l] = RMIN_REACH > 2 ? RMIN_COS(turn)*a[l] + RMIN_SIN(turn)*b[l] : a[l];
        }
        (void)try_direction(region, p, along, w);
    }
}

/*
 * Looks around the worst, along each of the axes as far as that helps: where motors move the point much more one
 * way than others, hard directions lie on a narrow ridge.
 */
static void look_around(const rmin_region *region, const rmin_params *p, hardest *w)
{
    const rmin_real narrow = w->lost ? SLICE : NARROW;
    rmin_real wide[3] = {WIDE, WIDE, WIDE};
    for (int round = 0; round < MOST_ROUNDS; ++round) {
        for (int k = 0; k < RMIN_REACH; ++k) {
            bool better = false;
            for (int side = 0; side < 2 && !better && wide[k] > narrow; ++side) {
                const rmin_real by = side == 0 ? wide[k] : -wide[k];
                rmin_real along[3] = {RMIN_R(0.0), RMIN_R(0.0), RMIN_R(0.0)};
                rmin_real size = RMIN_R(0.0);
                for (int l = 0; l < RMIN_REACH; ++l) {
                    along[l] = w->n[l] + by*w->axes[k][l];
                    size += along[l]*along[l];
                }
                size = RMIN_SQRT(size);
                for (int l = 0; l < RMIN_REACH && size > RMIN_R(0.0); ++l) {
                    along[l] /= size;
                }
                better = try_direction(region, p, along, w);
            }
            wide[k] *= better ? RMIN_R(1.5) : RMIN_R(0.5);
        }
    }
}

/* Looks around the directions that were hardest, beside the hardest, of those over the ball. */
static void look_elsewhere(const rmin_region *region, const rmin_params *p, int count, rmin_real *forces, hardest *w)
{
    for (int start = 0; start < STARTS; ++start) {
        const rmin_real n[3] = {w->n[0], w->n[1], w->n[2]};
        const rmin_real force = w->force;
        int best = 0;
        for (int k = 1; k < count; ++k) {
            best = forces[k] > forces[best] ? k : best;
        }
        if (!(forces[best] > RMIN_R(0.0))) {
            return;
        }
        direction_of(best, w->n);
        w->force = forces[best];
        for (int k = 0; k < count; ++k) {
            rmin_real along[3];
            direction_of(k, along);
            const rmin_real cosine = along[0]*w->n[0] + along[1]*w->n[1] + along[2]*w->n[2];
            forces[k] = RMIN_FABS(cosine) > ALIKE ? RMIN_R(0.0) : forces[k];
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
 * What rmin_bound takes of a direction is its K = k + c^2 mobility and its energy, and the bound grows with both.
 * Over directions n of unit length the robot's mobility is a quadratic form, n'An, and so is r'(M + B)r for joint
 * velocities r that are linear in n: none exceeds the sum of its values along directions at right angles, which is
 * the form's trace. Links and rotors as one weigh no more than r'(M + B)r at a contact point, so with a body of
 * mass m, and nothing but joints' springs, the energy is at most that of two masses, 1/(1/trace + 1/m). What pulls
 * on none of the r of these directions pulls on no sum of them.
 */
static rmin_real bound_all(const rmin_region *region, const rmin_params *p, int motors, hardest *w)
{
    rmin_impact *const impact = &w->impact;
    const rmin_real body = region->clamped == 0 ? RMIN_R(1.0)/region->effective_mass : RMIN_R(0.0);
    rmin_real mobility = body;
    rmin_real twice = RMIN_R(0.0);
    for (int k = 0; k < RMIN_REACH; ++k) {
        const int status = rmin_arrive(rmin_directions[k], w->point, &impact->arrival);
        rmin_impact_forget(impact);
        if (status != RMIN_OK || rmin_impact_prepare(region, p, motors, -w->speed, impact) != RMIN_OK
            || !(rmin_bound(impact) > RMIN_R(0.0))) {
            return RMIN_R(0.0);
        }
        mobility += impact->mobility - body;
        twice += rmin_twice_energy_of_arrival(&impact->arrival, p);
    }
    twice = RMIN_STRUCTURED ? twice/(RMIN_R(1.0) + twice*body) : twice;
    return w->speed*rmin_bound_by(impact, region->stiffness + region->damping*region->damping*mobility, twice);
}

/* Where some impacts cannot be followed to their end: takes the bound of all directions; false if none is known. */
static bool raise_to_bound(const rmin_region *region, const rmin_params *p, hardest *w)
{
    int first;
    int last;
    rmin_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const rmin_real bound = bound_all(region, p, motors, w);
        if (!(bound > RMIN_R(0.0) && bound <= RMIN_REAL_MAX)) {
            return false;
        }
        w->force = RMIN_FMAX(w->force, bound);
    }
    return true;
}

/* Looks everywhere. */
static int find_hardest(const rmin_region *region, const rmin_params *p, hardest *w, rmin_worst_direction_t *out)
{
    const int count = RMIN_REACH > 2 ? OVER_A_BALL : RMIN_REACH > 1 ? OVER_A_CIRCLE : 1;
    w->force = RMIN_R(0.0);
    w->bounded = false;
    w->unknown = false;
    w->lost = false;
    rmin_real forces[OVER_A_BALL];
    for (int k = 0; k < count; ++k) {
        rmin_real along[3];
        direction_of(k, along);
        (void)try_direction(region, p, along, w);
        forces[k] = w->tried;
    }
#if RMIN_REACH > 1
    find_axes(w);
    if (w->lost) {
        try_across(region, p, w);
    }
#endif
    if (w->unknown) {
        return RMIN_UNRESOLVED;
    }
    if (!(w->force > RMIN_R(0.0))) {
        return RMIN_SINGULAR;
    }
    const rmin_real seen = w->force;
#if RMIN_REACH > 1
    if (!w->bounded) {
        look_around(region, p, w);
        look_elsewhere(region, p, count, forces, w);
    }
#endif
    if (w->unknown) { /* so may be the hardest */
        return RMIN_UNRESOLVED;
    }
    if (w->bounded && !raise_to_bound(region, p, w)) {
        return RMIN_UNRESOLVED;
    }
    for (int k = 0; k < 3; ++k) {
        out->n[k] = RMIN_R(0.0);
        for (int l = 0; l < RMIN_REACH; ++l) {
            out->n[k] += w->n[l]*rmin_directions[l][k];
        }
    }
    out->force = w->force;
    out->error = w->bounded ? RMIN_R(0.0) : w->force/seen - RMIN_R(1.0) + OF_FORCES;
    return w->bounded ? RMIN_BOUNDED : RMIN_OK;
}

int rmin_worst_direction_at(const rmin_real q[RMIN_JOINTS], int point, rmin_real speed,
    const rmin_region *region, const rmin_params *p, rmin_worst_direction_t *out)
{
    if (q == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    hardest w;
    int status = rmin_check_positive(&speed, 1);
    if (status == RMIN_OK) {
        status = rmin_check_impact(region, p);
    }
    if (status == RMIN_OK && !(point >= 0 && point < RMIN_POINTS)) {
        status = RMIN_OUT_OF_RANGE;
    }
    if (status == RMIN_OK) {
        status = rmin_links(RMIN_LINKS_OF(q, p), &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = point;
    return status == RMIN_OK ? find_hardest(region, p, &w, out) : status;
}

#if RMIN_FRAMES > 0
int rmin_worst_direction_on(const rmin_real q[RMIN_JOINTS], int frame, const rmin_real place[3],
    rmin_real speed, const rmin_region *region, const rmin_params *p, rmin_worst_direction_t *out)
{
    if (q == NULL || place == NULL || region == NULL || p == NULL || out == NULL) {
        return RMIN_NULL_POINTER;
    }
    hardest w;
    int status = rmin_check_positive(&speed, 1);
    if (status == RMIN_OK) {
        status = rmin_check_impact(region, p);
    }
    if (status == RMIN_OK) {
        status = rmin_links_on(q, frame, place, p, &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = 0;
    return status == RMIN_OK ? find_hardest(region, p, &w, out) : status;
}
#endif
