/* SPDX-License-Identifier: 0BSD */
/* The direction in which panda_ hits hardest: looked for among many, then around the best of them. */
#include "panda_impact.h"

/* Directions over half a ball, or half a circle where the point moves in a plane: forces are even. */
#define OVER_A_BALL 96
#define OVER_A_CIRCLE 32
#define TURN PANDA_R(2.399963229728653) /* of one from the one before: pi (3 - sqrt(5)) */
#define HALF_A_TURN PANDA_R(3.141592653589793)
/*
 * How far around the best is looked, as a share of a unit vector, first and last; and last where motors hardly move
 * the point one way, so that directions in which they can lie within a slice.
 */
#define WIDE PANDA_R(0.2)
#define NARROW PANDA_R(2e-3)
#define SLICE PANDA_R(1e-5)
#define MOST_ROUNDS 20
/* Around how many it is looked, and the cosine above which two of them are the same: forces have several tops. */
#define STARTS 3
#define ALIKE (PANDA_REACH > 2 ? PANDA_R(0.94) : PANDA_R(0.98))
/*
 * What forces may be too low, added to what the directions were apart: 1.04 % were found, of a later contact that the
 * horizon cut off.
 */
#define OF_FORCES PANDA_R(0.015)

typedef struct {
    panda_impact impact;
    int point; /* whose rows of J count */
    panda_real speed;
    panda_real n[3]; /* the worst so far */
    panda_real force;
    panda_real tried; /* force of the last direction that was tried */
    panda_matrix axes; /* of the ellipsoid of what motors move, a row each */
    int least; /* of these, the shortest */
    bool bounded, unknown; /* some direction */
    bool lost; /* some direction is one in which motors cannot move the point here */
} hardest;

/* Tries a direction over those in which the robot moves; says whether it is worse than all before. */
static bool try_direction(const panda_region *region, const panda_params *p, const panda_real along[3], hardest *w)
{
    panda_real n[3];
    panda_peak_force_t found = {PANDA_R(0.0), PANDA_R(0.0)};
    for (int k = 0; k < 3; ++k) {
        n[k] = PANDA_R(0.0);
        for (int l = 0; l < PANDA_REACH; ++l) {
            n[k] += along[l]*panda_directions[l][k];
        }
    }
    int status = panda_arrive(n, w->point, &w->impact.arrival);
    panda_impact_forget(&w->impact);
    if (status == PANDA_OK) {
        status = panda_find_peak(region, p, w->speed, &w->impact, &found);
    }
    w->bounded = w->bounded || status == PANDA_BOUNDED;
    w->lost = w->lost || status == PANDA_SINGULAR;
    w->unknown = w->unknown || (status != PANDA_OK && status != PANDA_BOUNDED && status != PANDA_SINGULAR);
    w->tried = found.force;
    const bool worse = (status == PANDA_OK || status == PANDA_BOUNDED) && found.force > w->force;
    if (worse) {
        w->force = found.force;
        for (int k = 0; k < 3; ++k) {
            w->n[k] = along[k];
        }
    }
    return worse;
}

/* Direction number k of those over half a ball or circle. */
static void direction_of(int k, panda_real along[3])
{
    const panda_real turn = PANDA_REACH > 2 ? TURN*(panda_real)k : HALF_A_TURN*(panda_real)k/(panda_real)OVER_A_CIRCLE;
    const panda_real up = PANDA_REACH > 2 ? ((panda_real)k + PANDA_R(0.5))/(panda_real)OVER_A_BALL : PANDA_R(0.0);
    const panda_real flat = PANDA_SQRT(PANDA_R(1.0) - up*up);
    along[0] = PANDA_REACH > 1 ? flat*PANDA_COS(turn) : PANDA_R(1.0);
    along[1] = flat*PANDA_SIN(turn);
    along[2] = up;
}

#if PANDA_REACH > 1
/* Finds the axes along which motors move the point most to least, whatever joints do at a given rate. */
static void find_axes(hardest *w)
{
    const panda_links_t *const links = &w->impact.arrival.links;
    const int x = 3*w->point;
    panda_matrix square;
    panda_real unit[PANDA_REACH][PANDA_SYSTEM]; /* vectors */
    panda_real values[PANDA_SYSTEM];
    for (int k = 0; k < PANDA_REACH; ++k) {
        for (int l = 0; l < PANDA_REACH; ++l) {
            const panda_real *const a = panda_directions[k];
            const panda_real *const b = panda_directions[l];
            square[k][l] = PANDA_R(0.0);
            unit[k][l] = k == l ? PANDA_R(1.0) : PANDA_R(0.0);
            for (int i = 0; i < PANDA_N; ++i) {
                const panda_real by_a = a[0]*links->J[x][i] + a[1]*links->J[x + 1][i] + a[2]*links->J[x + 2][i];
                const panda_real by_b = b[0]*links->J[x][i] + b[1]*links->J[x + 1][i] + b[2]*links->J[x + 2][i];
                square[k][l] += panda_has_motor[i] ? by_a*by_b : PANDA_R(0.0);
            }
        }
    }
    if (!panda_spectrum(PANDA_REACH, PANDA_EPSILON*PANDA_EPSILON, square, values, PANDA_REACH, unit, NULL)) {
        w->unknown = true;
        return;
    }
    w->least = 0;
    for (int k = 0; k < PANDA_REACH; ++k) {
        for (int l = 0; l < PANDA_REACH; ++l) {
            w->axes[k][l] = unit[l][k];
        }
        w->least = values[k] < values[w->least] ? k : w->least;
    }
}

/*
 * Tries directions at right angles to that in which motors move the point least: where they hardly do, a pose has
 * one dimension less, and hardly any of the directions over a ball is within the others.
 */
static void try_across(const panda_region *region, const panda_params *p, hardest *w)
{
    const panda_real *const a = w->axes[(w->least + 1) % PANDA_REACH];
    const panda_real *const b = w->axes[(w->least + 2) % PANDA_REACH];
    for (int k = 0; k < (PANDA_REACH > 2 ? OVER_A_CIRCLE : 1); ++k) {
        const panda_real turn = HALF_A_TURN*(panda_real)k/(panda_real)OVER_A_CIRCLE;
        panda_real along[3] = {PANDA_R(0.0), PANDA_R(0.0), PANDA_R(0.0)};
        for (int l = 0; l < PANDA_REACH; ++l) {
            along[l] = PANDA_REACH > 2 ? PANDA_COS(turn)*a[l] + PANDA_SIN(turn)*b[l] : a[l];
        }
        (void)try_direction(region, p, along, w);
    }
}

/*
 * Looks around the worst, along each of the axes as far as that helps: where motors move the point much more one
 * way than others, hard directions lie on a narrow ridge.
 */
static void look_around(const panda_region *region, const panda_params *p, hardest *w)
{
    const panda_real narrow = w->lost ? SLICE : NARROW;
    panda_real wide[3] = {WIDE, WIDE, WIDE};
    for (int round = 0; round < MOST_ROUNDS; ++round) {
        for (int k = 0; k < PANDA_REACH; ++k) {
            bool better = false;
            for (int side = 0; side < 2 && !better && wide[k] > narrow; ++side) {
                const panda_real by = side == 0 ? wide[k] : -wide[k];
                panda_real along[3] = {PANDA_R(0.0), PANDA_R(0.0), PANDA_R(0.0)};
                panda_real size = PANDA_R(0.0);
                for (int l = 0; l < PANDA_REACH; ++l) {
                    along[l] = w->n[l] + by*w->axes[k][l];
                    size += along[l]*along[l];
                }
                size = PANDA_SQRT(size);
                for (int l = 0; l < PANDA_REACH && size > PANDA_R(0.0); ++l) {
                    along[l] /= size;
                }
                better = try_direction(region, p, along, w);
            }
            wide[k] *= better ? PANDA_R(1.5) : PANDA_R(0.5);
        }
    }
}

/* Looks around the directions that were hardest, beside the hardest, of those over the ball. */
static void look_elsewhere(const panda_region *region, const panda_params *p, int count, panda_real *forces, hardest *w)
{
    for (int start = 0; start < STARTS; ++start) {
        const panda_real n[3] = {w->n[0], w->n[1], w->n[2]};
        const panda_real force = w->force;
        int best = 0;
        for (int k = 1; k < count; ++k) {
            best = forces[k] > forces[best] ? k : best;
        }
        if (!(forces[best] > PANDA_R(0.0))) {
            return;
        }
        direction_of(best, w->n);
        w->force = forces[best];
        for (int k = 0; k < count; ++k) {
            panda_real along[3];
            direction_of(k, along);
            const panda_real cosine = along[0]*w->n[0] + along[1]*w->n[1] + along[2]*w->n[2];
            forces[k] = PANDA_FABS(cosine) > ALIKE ? PANDA_R(0.0) : forces[k];
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
 * What panda_bound takes of a direction is its K = k + c^2 mobility and its energy, and the bound grows with both.
 * Over directions n of unit length the robot's mobility is a quadratic form, n'An, and so is r'(M + B)r for joint
 * velocities r that are linear in n: none exceeds the sum of its values along directions at right angles, which is
 * the form's trace. Links and rotors as one weigh no more than r'(M + B)r at a contact point, so with a body of
 * mass m, and nothing but joints' springs, the energy is at most that of two masses, 1/(1/trace + 1/m). What pulls
 * on none of the r of these directions pulls on no sum of them.
 */
static panda_real bound_all(const panda_region *region, const panda_params *p, int motors, hardest *w)
{
    panda_impact *const impact = &w->impact;
    const panda_real body = region->clamped == 0 ? PANDA_R(1.0)/region->effective_mass : PANDA_R(0.0);
    panda_real mobility = body;
    panda_real twice = PANDA_R(0.0);
    for (int k = 0; k < PANDA_REACH; ++k) {
        const int status = panda_arrive(panda_directions[k], w->point, &impact->arrival);
        panda_impact_forget(impact);
        if (status != PANDA_OK || panda_impact_prepare(region, p, motors, -w->speed, impact) != PANDA_OK
            || !(panda_bound(impact) > PANDA_R(0.0))) {
            return PANDA_R(0.0);
        }
        mobility += impact->mobility - body;
        twice += panda_twice_energy_of_arrival(&impact->arrival, p);
    }
    twice = PANDA_STRUCTURED ? twice/(PANDA_R(1.0) + twice*body) : twice;
    return w->speed*panda_bound_by(impact, region->stiffness + region->damping*region->damping*mobility, twice);
}

/* Where some impacts cannot be followed to their end: takes the bound of all directions; false if none is known. */
static bool raise_to_bound(const panda_region *region, const panda_params *p, hardest *w)
{
    int first;
    int last;
    panda_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const panda_real bound = bound_all(region, p, motors, w);
        if (!(bound > PANDA_R(0.0) && bound <= PANDA_REAL_MAX)) {
            return false;
        }
        w->force = PANDA_FMAX(w->force, bound);
    }
    return true;
}

/* Looks everywhere. */
static int find_hardest(const panda_region *region, const panda_params *p, hardest *w, panda_worst_direction_t *out)
{
    const int count = PANDA_REACH > 2 ? OVER_A_BALL : PANDA_REACH > 1 ? OVER_A_CIRCLE : 1;
    w->force = PANDA_R(0.0);
    w->bounded = false;
    w->unknown = false;
    w->lost = false;
    panda_real forces[OVER_A_BALL];
    for (int k = 0; k < count; ++k) {
        panda_real along[3];
        direction_of(k, along);
        (void)try_direction(region, p, along, w);
        forces[k] = w->tried;
    }
#if PANDA_REACH > 1
    find_axes(w);
    if (w->lost) {
        try_across(region, p, w);
    }
#endif
    if (w->unknown) {
        return PANDA_UNRESOLVED;
    }
    if (!(w->force > PANDA_R(0.0))) {
        return PANDA_SINGULAR;
    }
    const panda_real seen = w->force;
#if PANDA_REACH > 1
    if (!w->bounded) {
        look_around(region, p, w);
        look_elsewhere(region, p, count, forces, w);
    }
#endif
    if (w->unknown) { /* so may be the hardest */
        return PANDA_UNRESOLVED;
    }
    if (w->bounded && !raise_to_bound(region, p, w)) {
        return PANDA_UNRESOLVED;
    }
    for (int k = 0; k < 3; ++k) {
        out->n[k] = PANDA_R(0.0);
        for (int l = 0; l < PANDA_REACH; ++l) {
            out->n[k] += w->n[l]*panda_directions[l][k];
        }
    }
    out->force = w->force;
    out->error = w->bounded ? PANDA_R(0.0) : w->force/seen - PANDA_R(1.0) + OF_FORCES;
    return w->bounded ? PANDA_BOUNDED : PANDA_OK;
}

int panda_worst_direction_at(const panda_real q[PANDA_JOINTS], int point, panda_real speed,
    const panda_region *region, const panda_params *p, panda_worst_direction_t *out)
{
    if (q == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    hardest w;
    int status = panda_check_positive(&speed, 1);
    if (status == PANDA_OK) {
        status = panda_check_impact(region, p);
    }
    if (status == PANDA_OK && !(point >= 0 && point < PANDA_POINTS)) {
        status = PANDA_OUT_OF_RANGE;
    }
    if (status == PANDA_OK) {
        status = panda_links(PANDA_LINKS_OF(q, p), &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = point;
    return status == PANDA_OK ? find_hardest(region, p, &w, out) : status;
}

#if PANDA_FRAMES > 0
int panda_worst_direction_on(const panda_real q[PANDA_JOINTS], int frame, const panda_real place[3],
    panda_real speed, const panda_region *region, const panda_params *p, panda_worst_direction_t *out)
{
    if (q == NULL || place == NULL || region == NULL || p == NULL || out == NULL) {
        return PANDA_NULL_POINTER;
    }
    hardest w;
    int status = panda_check_positive(&speed, 1);
    if (status == PANDA_OK) {
        status = panda_check_impact(region, p);
    }
    if (status == PANDA_OK) {
        status = panda_links_on(q, frame, place, p, &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = 0;
    return status == PANDA_OK ? find_hardest(region, p, &w, out) : status;
}
#endif
