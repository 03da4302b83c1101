/* SPDX-License-Identifier: 0BSD */
/* The direction in which robot_ hits hardest: looked for among many, then around the best of them. */
#include "robot_impact.h"

/* Directions over half a ball, or half a circle where the point moves in a plane: forces are even. */
#define OVER_A_BALL 96
#define OVER_A_CIRCLE 32
#define TURN ROBOT_R(2.399963229728653) /* of one from the one before: pi (3 - sqrt(5)) */
#define HALF_A_TURN ROBOT_R(3.141592653589793)
/*
 * How far around the best is looked, as a share of a unit vector, first and last; and last where motors hardly move
 * the point one way, so that directions in which they can lie within a slice.
 */
#define WIDE ROBOT_R(0.2)
#define NARROW ROBOT_R(2e-3)
#define SLICE ROBOT_R(1e-5)
#define MOST_ROUNDS 20
/* Around how many it is looked, and the cosine above which two of them are the same: forces have several tops. */
#define STARTS 3
#define ALIKE (ROBOT_REACH > 2 ? ROBOT_R(0.94) : ROBOT_R(0.98))
/*
 * What forces may be too low, added to what the directions were apart: 1.04 % were found, of a later contact that the
 * horizon cut off.
 */
#define OF_FORCES ROBOT_R(0.015)

typedef struct {
    robot_impact impact;
    int point; /* whose rows of J count */
    robot_real speed;
    robot_real n[3]; /* the worst so far */
    robot_real force;
    robot_real tried; /* force of the last direction that was tried */
    robot_matrix axes; /* of the ellipsoid of what motors move, a row each */
    int least; /* of these, the shortest */
    bool bounded, unknown; /* some direction */
    bool lost; /* some direction is one in which motors cannot move the point here */
} hardest;

/* Tries a direction over those in which the robot moves; says whether it is worse than all before. */
static bool try_direction(const robot_region *region, const robot_params *p, const robot_real along[3], hardest *w)
{
    robot_real n[3];
    robot_peak_force_t found = {ROBOT_R(0.0), ROBOT_R(0.0)};
    for (int k = 0; k < 3; ++k) {
        n[k] = ROBOT_R(0.0);
        for (int l = 0; l < ROBOT_REACH; ++l) {
            n[k] += along[l]*robot_directions[l][k];
        }
    }
    int status = robot_arrive(n, w->point, &w->impact.arrival);
    robot_impact_forget(&w->impact);
    if (status == ROBOT_OK) {
        status = robot_find_peak(region, p, w->speed, &w->impact, &found);
    }
    w->bounded = w->bounded || status == ROBOT_BOUNDED;
    w->lost = w->lost || status == ROBOT_SINGULAR;
    w->unknown = w->unknown || (status != ROBOT_OK && status != ROBOT_BOUNDED && status != ROBOT_SINGULAR);
    w->tried = found.force;
    const bool worse = (status == ROBOT_OK || status == ROBOT_BOUNDED) && found.force > w->force;
    if (worse) {
        w->force = found.force;
        for (int k = 0; k < 3; ++k) {
            w->n[k] = along[k];
        }
    }
    return worse;
}

/* Direction number k of those over half a ball or circle. */
static void direction_of(int k, robot_real along[3])
{
    const robot_real turn = ROBOT_REACH > 2 ? TURN*(robot_real)k : HALF_A_TURN*(robot_real)k/(robot_real)OVER_A_CIRCLE;
    const robot_real up = ROBOT_REACH > 2 ? ((robot_real)k + ROBOT_R(0.5))/(robot_real)OVER_A_BALL : ROBOT_R(0.0);
    const robot_real flat = ROBOT_SQRT(ROBOT_R(1.0) - up*up);
    along[0] = ROBOT_REACH > 1 ? flat*ROBOT_COS(turn) : ROBOT_R(1.0);
    along[1] = flat*ROBOT_SIN(turn);
    along[2] = up;
}

#if ROBOT_REACH > 1
/* Finds the axes along which motors move the point most to least, whatever joints do at a given rate. */
static void find_axes(hardest *w)
{
    const robot_links_t *const links = &w->impact.arrival.links;
    const int x = 3*w->point;
    robot_matrix square;
    robot_real unit[ROBOT_REACH][ROBOT_SYSTEM]; /* vectors */
    robot_real values[ROBOT_SYSTEM];
    for (int k = 0; k < ROBOT_REACH; ++k) {
        for (int l = 0; l < ROBOT_REACH; ++l) {
            const robot_real *const a = robot_directions[k];
            const robot_real *const b = robot_directions[l];
            square[k][l] = ROBOT_R(0.0);
            unit[k][l] = k == l ? ROBOT_R(1.0) : ROBOT_R(0.0);
            for (int i = 0; i < ROBOT_N; ++i) {
                const robot_real by_a = a[0]*links->J[x][i] + a[1]*links->J[x + 1][i] + a[2]*links->J[x + 2][i];
                const robot_real by_b = b[0]*links->J[x][i] + b[1]*links->J[x + 1][i] + b[2]*links->J[x + 2][i];
                square[k][l] += robot_has_motor[i] ? by_a*by_b : ROBOT_R(0.0);
            }
        }
    }
    if (!robot_spectrum(ROBOT_REACH, ROBOT_EPSILON*ROBOT_EPSILON, square, values, ROBOT_REACH, unit, NULL)) {
        w->unknown = true;
        return;
    }
    w->least = 0;
    for (int k = 0; k < ROBOT_REACH; ++k) {
        for (int l = 0; l < ROBOT_REACH; ++l) {
            w->axes[k][l] = unit[l][k];
        }
        w->least = values[k] < values[w->least] ? k : w->least;
    }
}

/*
 * Tries directions at right angles to that in which motors move the point least: where they hardly do, a pose has
 * one dimension less, and hardly any of the directions over a ball is within the others.
 */
static void try_across(const robot_region *region, const robot_params *p, hardest *w)
{
    const robot_real *const a = w->axes[(w->least + 1) % ROBOT_REACH];
    const robot_real *const b = w->axes[(w->least + 2) % ROBOT_REACH];
    for (int k = 0; k < (ROBOT_REACH > 2 ? OVER_A_CIRCLE : 1); ++k) {
        const robot_real turn = HALF_A_TURN*(robot_real)k/(robot_real)OVER_A_CIRCLE;
        robot_real along[3] = {ROBOT_R(0.0), ROBOT_R(0.0), ROBOT_R(0.0)};
        for (int l = 0; l < ROBOT_REACH; ++l) {
            along[l] = ROBOT_REACH > 2 ? ROBOT_COS(turn)*a[l] + ROBOT_SIN(turn)*b[l] : a[l];
        }
        (void)try_direction(region, p, along, w);
    }
}

/*
 * Looks around the worst, along each of the axes as far as that helps: where motors move the point much more one
 * way than others, hard directions lie on a narrow ridge.
 */
static void look_around(const robot_region *region, const robot_params *p, hardest *w)
{
    const robot_real narrow = w->lost ? SLICE : NARROW;
    robot_real wide[3] = {WIDE, WIDE, WIDE};
    for (int round = 0; round < MOST_ROUNDS; ++round) {
        for (int k = 0; k < ROBOT_REACH; ++k) {
            bool better = false;
            for (int side = 0; side < 2 && !better && wide[k] > narrow; ++side) {
                const robot_real by = side == 0 ? wide[k] : -wide[k];
                robot_real along[3] = {ROBOT_R(0.0), ROBOT_R(0.0), ROBOT_R(0.0)};
                robot_real size = ROBOT_R(0.0);
                for (int l = 0; l < ROBOT_REACH; ++l) {
                    along[l] = w->n[l] + by*w->axes[k][l];
                    size += along[l]*along[l];
                }
                size = ROBOT_SQRT(size);
                for (int l = 0; l < ROBOT_REACH && size > ROBOT_R(0.0); ++l) {
                    along[l] /= size;
                }
                better = try_direction(region, p, along, w);
            }
            wide[k] *= better ? ROBOT_R(1.5) : ROBOT_R(0.5);
        }
    }
}

/* Looks around the directions that were hardest, beside the hardest, of those over the ball. */
static void look_elsewhere(const robot_region *region, const robot_params *p, int count, robot_real *forces, hardest *w)
{
    for (int start = 0; start < STARTS; ++start) {
        const robot_real n[3] = {w->n[0], w->n[1], w->n[2]};
        const robot_real force = w->force;
        int best = 0;
        for (int k = 1; k < count; ++k) {
            best = forces[k] > forces[best] ? k : best;
        }
        if (!(forces[best] > ROBOT_R(0.0))) {
            return;
        }
        direction_of(best, w->n);
        w->force = forces[best];
        for (int k = 0; k < count; ++k) {
            robot_real along[3];
            direction_of(k, along);
            const robot_real cosine = along[0]*w->n[0] + along[1]*w->n[1] + along[2]*w->n[2];
            forces[k] = ROBOT_FABS(cosine) > ALIKE ? ROBOT_R(0.0) : forces[k];
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
 * What robot_bound takes of a direction is its K = k + c^2 mobility and its energy, and the bound grows with both.
 * Over directions n of unit length the robot's mobility is a quadratic form, n'An, and so is r'(M + B)r for joint
 * velocities r that are linear in n: none exceeds the sum of its values along directions at right angles, which is
 * the form's trace. Links and rotors as one weigh no more than r'(M + B)r at a contact point, so with a body of
 * mass m, and nothing but joints' springs, the energy is at most that of two masses, 1/(1/trace + 1/m). What pulls
 * on none of the r of these directions pulls on no sum of them.
 */
static robot_real bound_all(const robot_region *region, const robot_params *p, int motors, hardest *w)
{
    robot_impact *const impact = &w->impact;
    const robot_real body = region->clamped == 0 ? ROBOT_R(1.0)/region->effective_mass : ROBOT_R(0.0);
    robot_real mobility = body;
    robot_real twice = ROBOT_R(0.0);
    for (int k = 0; k < ROBOT_REACH; ++k) {
        const int status = robot_arrive(robot_directions[k], w->point, &impact->arrival);
        robot_impact_forget(impact);
        if (status != ROBOT_OK || robot_impact_prepare(region, p, motors, -w->speed, impact) != ROBOT_OK
            || !(robot_bound(impact) > ROBOT_R(0.0))) {
            return ROBOT_R(0.0);
        }
        mobility += impact->mobility - body;
        twice += robot_twice_energy_of_arrival(&impact->arrival, p);
    }
    twice = ROBOT_STRUCTURED ? twice/(ROBOT_R(1.0) + twice*body) : twice;
    return w->speed*robot_bound_by(impact, region->stiffness + region->damping*region->damping*mobility, twice);
}

/* Where some impacts cannot be followed to their end: takes the bound of all directions; false if none is known. */
static bool raise_to_bound(const robot_region *region, const robot_params *p, hardest *w)
{
    int first;
    int last;
    robot_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const robot_real bound = bound_all(region, p, motors, w);
        if (!(bound > ROBOT_R(0.0) && bound <= ROBOT_REAL_MAX)) {
            return false;
        }
        w->force = ROBOT_FMAX(w->force, bound);
    }
    return true;
}

/* Looks everywhere. */
static int find_hardest(const robot_region *region, const robot_params *p, hardest *w, robot_worst_direction_t *out)
{
    const int count = ROBOT_REACH > 2 ? OVER_A_BALL : ROBOT_REACH > 1 ? OVER_A_CIRCLE : 1;
    w->force = ROBOT_R(0.0);
    w->bounded = false;
    w->unknown = false;
    w->lost = false;
    robot_real forces[OVER_A_BALL];
    for (int k = 0; k < count; ++k) {
        robot_real along[3];
        direction_of(k, along);
        (void)try_direction(region, p, along, w);
        forces[k] = w->tried;
    }
#if ROBOT_REACH > 1
    find_axes(w);
    if (w->lost) {
        try_across(region, p, w);
    }
#endif
    if (w->unknown) {
        return ROBOT_UNRESOLVED;
    }
    if (!(w->force > ROBOT_R(0.0))) {
        return ROBOT_SINGULAR;
    }
    const robot_real seen = w->force;
#if ROBOT_REACH > 1
    if (!w->bounded) {
        look_around(region, p, w);
        look_elsewhere(region, p, count, forces, w);
    }
#endif
    if (w->unknown) { /* so may be the hardest */
        return ROBOT_UNRESOLVED;
    }
    if (w->bounded && !raise_to_bound(region, p, w)) {
        return ROBOT_UNRESOLVED;
    }
    for (int k = 0; k < 3; ++k) {
        out->n[k] = ROBOT_R(0.0);
        for (int l = 0; l < ROBOT_REACH; ++l) {
            out->n[k] += w->n[l]*robot_directions[l][k];
        }
    }
    out->force = w->force;
    out->error = w->bounded ? ROBOT_R(0.0) : w->force/seen - ROBOT_R(1.0) + OF_FORCES;
    return w->bounded ? ROBOT_BOUNDED : ROBOT_OK;
}

int robot_worst_direction_at(const robot_real q[ROBOT_JOINTS], int point, robot_real speed,
    const robot_region *region, const robot_params *p, robot_worst_direction_t *out)
{
    if (q == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    hardest w;
    int status = robot_check_positive(&speed, 1);
    if (status == ROBOT_OK) {
        status = robot_check_impact(region, p);
    }
    if (status == ROBOT_OK && !(point >= 0 && point < ROBOT_POINTS)) {
        status = ROBOT_OUT_OF_RANGE;
    }
    if (status == ROBOT_OK) {
        status = robot_links(ROBOT_LINKS_OF(q, p), &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = point;
    return status == ROBOT_OK ? find_hardest(region, p, &w, out) : status;
}

#if ROBOT_FRAMES > 0
int robot_worst_direction_on(const robot_real q[ROBOT_JOINTS], int frame, const robot_real place[3],
    robot_real speed, const robot_region *region, const robot_params *p, robot_worst_direction_t *out)
{
    if (q == NULL || place == NULL || region == NULL || p == NULL || out == NULL) {
        return ROBOT_NULL_POINTER;
    }
    hardest w;
    int status = robot_check_positive(&speed, 1);
    if (status == ROBOT_OK) {
        status = robot_check_impact(region, p);
    }
    if (status == ROBOT_OK) {
        status = robot_links_on(q, frame, place, p, &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = 0;
    return status == ROBOT_OK ? find_hardest(region, p, &w, out) : status;
}
#endif
