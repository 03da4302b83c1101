/* SPDX-License-Identifier: 0BSD */
/* The direction in which ur5e_ hits hardest: looked for among many, then around the best of them. */
#include "ur5e_impact.h"

/* Directions over half a ball, or half a circle where the point moves in a plane: forces are even. */
#define OVER_A_BALL 96
#define OVER_A_CIRCLE 32
#define TURN UR5E_R(2.399963229728653) /* of one from the one before: pi (3 - sqrt(5)) */
#define HALF_A_TURN UR5E_R(3.141592653589793)
/*
 * How far around the best is looked, as a share of a unit vector, first and last; and last where motors hardly move
 * the point one way, so that directions in which they can lie within a slice.
 */
#define WIDE UR5E_R(0.2)
#define NARROW UR5E_R(2e-3)
#define SLICE UR5E_R(1e-5)
#define MOST_ROUNDS 20
/* Around how many it is looked, and the cosine above which two of them are the same: forces have several tops. */
#define STARTS 3
#define ALIKE (UR5E_REACH > 2 ? UR5E_R(0.94) : UR5E_R(0.98))
/*
 * What forces may be too low, added to what the directions were apart: 1.04 % were found, of a later contact that the
 * horizon cut off.
 */
#define OF_FORCES UR5E_R(0.015)

typedef struct {
    ur5e_impact impact;
    int point; /* whose rows of J count */
    ur5e_real speed;
    ur5e_real n[3]; /* the worst so far */
    ur5e_real force;
    ur5e_real tried; /* force of the last direction that was tried */
    ur5e_matrix axes; /* of the ellipsoid of what motors move, a row each */
    int least; /* of these, the shortest */
    bool bounded, unknown; /* some direction */
    bool lost; /* some direction is one in which motors cannot move the point here */
} hardest;

/* Tries a direction over those in which the robot moves; says whether it is worse than all before. */
static bool try_direction(const ur5e_region *region, const ur5e_params *p, const ur5e_real along[3], hardest *w)
{
    ur5e_real n[3];
    ur5e_peak_force_t found = {UR5E_R(0.0), UR5E_R(0.0)};
    for (int k = 0; k < 3; ++k) {
        n[k] = UR5E_R(0.0);
        for (int l = 0; l < UR5E_REACH; ++l) {
            n[k] += along[l]*ur5e_directions[l][k];
        }
    }
    int status = ur5e_arrive(n, w->point, &w->impact.arrival);
    ur5e_impact_forget(&w->impact);
    if (status == UR5E_OK) {
        status = ur5e_find_peak(region, p, w->speed, &w->impact, &found);
    }
    w->bounded = w->bounded || status == UR5E_BOUNDED;
    w->lost = w->lost || status == UR5E_SINGULAR;
    w->unknown = w->unknown || (status != UR5E_OK && status != UR5E_BOUNDED && status != UR5E_SINGULAR);
    w->tried = found.force;
    const bool worse = (status == UR5E_OK || status == UR5E_BOUNDED) && found.force > w->force;
    if (worse) {
        w->force = found.force;
        for (int k = 0; k < 3; ++k) {
            w->n[k] = along[k];
        }
    }
    return worse;
}

/* Direction number k of those over half a ball or circle. */
static void direction_of(int k, ur5e_real along[3])
{
    const ur5e_real turn = UR5E_REACH > 2 ? TURN*(ur5e_real)k : HALF_A_TURN*(ur5e_real)k/(ur5e_real)OVER_A_CIRCLE;
    const ur5e_real up = UR5E_REACH > 2 ? ((ur5e_real)k + UR5E_R(0.5))/(ur5e_real)OVER_A_BALL : UR5E_R(0.0);
    const ur5e_real flat = UR5E_SQRT(UR5E_R(1.0) - up*up);
    along[0] = UR5E_REACH > 1 ? flat*UR5E_COS(turn) : UR5E_R(1.0);
    along[1] = flat*UR5E_SIN(turn);
    along[2] = up;
}

#if UR5E_REACH > 1
/* Finds the axes along which motors move the point most to least, whatever joints do at a given rate. */
static void find_axes(hardest *w)
{
    const ur5e_links_t *const links = &w->impact.arrival.links;
    const int x = 3*w->point;
    ur5e_matrix square;
    ur5e_real unit[UR5E_REACH][UR5E_SYSTEM]; /* vectors */
    ur5e_real values[UR5E_SYSTEM];
    for (int k = 0; k < UR5E_REACH; ++k) {
        for (int l = 0; l < UR5E_REACH; ++l) {
            const ur5e_real *const a = ur5e_directions[k];
            const ur5e_real *const b = ur5e_directions[l];
            square[k][l] = UR5E_R(0.0);
            unit[k][l] = k == l ? UR5E_R(1.0) : UR5E_R(0.0);
            for (int i = 0; i < UR5E_N; ++i) {
                const ur5e_real by_a = a[0]*links->J[x][i] + a[1]*links->J[x + 1][i] + a[2]*links->J[x + 2][i];
                const ur5e_real by_b = b[0]*links->J[x][i] + b[1]*links->J[x + 1][i] + b[2]*links->J[x + 2][i];
                square[k][l] += ur5e_has_motor[i] ? by_a*by_b : UR5E_R(0.0);
            }
        }
    }
    if (!ur5e_spectrum(UR5E_REACH, UR5E_EPSILON*UR5E_EPSILON, square, values, UR5E_REACH, unit, NULL)) {
        w->unknown = true;
        return;
    }
    w->least = 0;
    for (int k = 0; k < UR5E_REACH; ++k) {
        for (int l = 0; l < UR5E_REACH; ++l) {
            w->axes[k][l] = unit[l][k];
        }
        w->least = values[k] < values[w->least] ? k : w->least;
    }
}

/*
 * Tries directions at right angles to that in which motors move the point least: where they hardly do, a pose has
 * one dimension less, and hardly any of the directions over a ball is within the others.
 */
static void try_across(const ur5e_region *region, const ur5e_params *p, hardest *w)
{
    const ur5e_real *const a = w->axes[(w->least + 1) % UR5E_REACH];
    const ur5e_real *const b = w->axes[(w->least + 2) % UR5E_REACH];
    for (int k = 0; k < (UR5E_REACH > 2 ? OVER_A_CIRCLE : 1); ++k) {
        const ur5e_real turn = HALF_A_TURN*(ur5e_real)k/(ur5e_real)OVER_A_CIRCLE;
        ur5e_real along[3] = {UR5E_R(0.0), UR5E_R(0.0), UR5E_R(0.0)};
        for (int l = 0; l < UR5E_REACH; ++l) {
            along[l] = UR5E_REACH > 2 ? UR5E_COS(turn)*a[l] + UR5E_SIN(turn)*b[l] : a[l];
        }
        (void)try_direction(region, p, along, w);
    }
}

/*
 * Looks around the worst, along each of the axes as far as that helps: where motors move the point much more one
 * way than others, hard directions lie on a narrow ridge.
 */
static void look_around(const ur5e_region *region, const ur5e_params *p, hardest *w)
{
    const ur5e_real narrow = w->lost ? SLICE : NARROW;
    ur5e_real wide[3] = {WIDE, WIDE, WIDE};
    for (int round = 0; round < MOST_ROUNDS; ++round) {
        for (int k = 0; k < UR5E_REACH; ++k) {
            bool better = false;
            for (int side = 0; side < 2 && !better && wide[k] > narrow; ++side) {
                const ur5e_real by = side == 0 ? wide[k] : -wide[k];
                ur5e_real along[3] = {UR5E_R(0.0), UR5E_R(0.0), UR5E_R(0.0)};
                ur5e_real size = UR5E_R(0.0);
                for (int l = 0; l < UR5E_REACH; ++l) {
                    along[l] = w->n[l] + by*w->axes[k][l];
                    size += along[l]*along[l];
                }
                size = UR5E_SQRT(size);
                for (int l = 0; l < UR5E_REACH && size > UR5E_R(0.0); ++l) {
                    along[l] /= size;
                }
                better = try_direction(region, p, along, w);
            }
            wide[k] *= better ? UR5E_R(1.5) : UR5E_R(0.5);
        }
    }
}

/* Looks around the directions that were hardest, beside the hardest, of those over the ball. */
static void look_elsewhere(const ur5e_region *region, const ur5e_params *p, int count, ur5e_real *forces, hardest *w)
{
    for (int start = 0; start < STARTS; ++start) {
        const ur5e_real n[3] = {w->n[0], w->n[1], w->n[2]};
        const ur5e_real force = w->force;
        int best = 0;
        for (int k = 1; k < count; ++k) {
            best = forces[k] > forces[best] ? k : best;
        }
        if (!(forces[best] > UR5E_R(0.0))) {
            return;
        }
        direction_of(best, w->n);
        w->force = forces[best];
        for (int k = 0; k < count; ++k) {
            ur5e_real along[3];
            direction_of(k, along);
            const ur5e_real cosine = along[0]*w->n[0] + along[1]*w->n[1] + along[2]*w->n[2];
            forces[k] = UR5E_FABS(cosine) > ALIKE ? UR5E_R(0.0) : forces[k];
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
 * What ur5e_bound takes of a direction is its K = k + c^2 mobility and its energy, and the bound grows with both.
 * Over directions n of unit length the robot's mobility is a quadratic form, n'An, and so is r'(M + B)r for joint
 * velocities r that are linear in n: none exceeds the sum of its values along directions at right angles, which is
 * the form's trace. Links and rotors as one weigh no more than r'(M + B)r at a contact point, so with a body of
 * mass m, and nothing but joints' springs, the energy is at most that of two masses, 1/(1/trace + 1/m). What pulls
 * on none of the r of these directions pulls on no sum of them.
 */
static ur5e_real bound_all(const ur5e_region *region, const ur5e_params *p, int motors, hardest *w)
{
    ur5e_impact *const impact = &w->impact;
    const ur5e_real body = region->clamped == 0 ? UR5E_R(1.0)/region->effective_mass : UR5E_R(0.0);
    ur5e_real mobility = body;
    ur5e_real twice = UR5E_R(0.0);
    for (int k = 0; k < UR5E_REACH; ++k) {
        const int status = ur5e_arrive(ur5e_directions[k], w->point, &impact->arrival);
        ur5e_impact_forget(impact);
        if (status != UR5E_OK || ur5e_impact_prepare(region, p, motors, -w->speed, impact) != UR5E_OK
            || !(ur5e_bound(impact) > UR5E_R(0.0))) {
            return UR5E_R(0.0);
        }
        mobility += impact->mobility - body;
        twice += ur5e_twice_energy_of_arrival(&impact->arrival, p);
    }
    twice = UR5E_STRUCTURED ? twice/(UR5E_R(1.0) + twice*body) : twice;
    return w->speed*ur5e_bound_by(impact, region->stiffness + region->damping*region->damping*mobility, twice);
}

/* Where some impacts cannot be followed to their end: takes the bound of all directions; false if none is known. */
static bool raise_to_bound(const ur5e_region *region, const ur5e_params *p, hardest *w)
{
    int first;
    int last;
    ur5e_kinds_of_motors(p, &first, &last);
    for (int motors = first; motors <= last; ++motors) {
        const ur5e_real bound = bound_all(region, p, motors, w);
        if (!(bound > UR5E_R(0.0) && bound <= UR5E_REAL_MAX)) {
            return false;
        }
        w->force = UR5E_FMAX(w->force, bound);
    }
    return true;
}

/* Looks everywhere. */
static int find_hardest(const ur5e_region *region, const ur5e_params *p, hardest *w, ur5e_worst_direction_t *out)
{
    const int count = UR5E_REACH > 2 ? OVER_A_BALL : UR5E_REACH > 1 ? OVER_A_CIRCLE : 1;
    w->force = UR5E_R(0.0);
    w->bounded = false;
    w->unknown = false;
    w->lost = false;
    ur5e_real forces[OVER_A_BALL];
    for (int k = 0; k < count; ++k) {
        ur5e_real along[3];
        direction_of(k, along);
        (void)try_direction(region, p, along, w);
        forces[k] = w->tried;
    }
#if UR5E_REACH > 1
    find_axes(w);
    if (w->lost) {
        try_across(region, p, w);
    }
#endif
    if (w->unknown) {
        return UR5E_UNRESOLVED;
    }
    if (!(w->force > UR5E_R(0.0))) {
        return UR5E_SINGULAR;
    }
    const ur5e_real seen = w->force;
#if UR5E_REACH > 1
    if (!w->bounded) {
        look_around(region, p, w);
        look_elsewhere(region, p, count, forces, w);
    }
#endif
    if (w->unknown) { /* so may be the hardest */
        return UR5E_UNRESOLVED;
    }
    if (w->bounded && !raise_to_bound(region, p, w)) {
        return UR5E_UNRESOLVED;
    }
    for (int k = 0; k < 3; ++k) {
        out->n[k] = UR5E_R(0.0);
        for (int l = 0; l < UR5E_REACH; ++l) {
            out->n[k] += w->n[l]*ur5e_directions[l][k];
        }
    }
    out->force = w->force;
    out->error = w->bounded ? UR5E_R(0.0) : w->force/seen - UR5E_R(1.0) + OF_FORCES;
    return w->bounded ? UR5E_BOUNDED : UR5E_OK;
}

int ur5e_worst_direction_at(const ur5e_real q[UR5E_JOINTS], int point, ur5e_real speed,
    const ur5e_region *region, const ur5e_params *p, ur5e_worst_direction_t *out)
{
    if (q == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    hardest w;
    int status = ur5e_check_positive(&speed, 1);
    if (status == UR5E_OK) {
        status = ur5e_check_impact(region, p);
    }
    if (status == UR5E_OK && !(point >= 0 && point < UR5E_POINTS)) {
        status = UR5E_OUT_OF_RANGE;
    }
    if (status == UR5E_OK) {
        status = ur5e_links(UR5E_LINKS_OF(q, p), &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = point;
    return status == UR5E_OK ? find_hardest(region, p, &w, out) : status;
}

#if UR5E_FRAMES > 0
int ur5e_worst_direction_on(const ur5e_real q[UR5E_JOINTS], int frame, const ur5e_real place[3],
    ur5e_real speed, const ur5e_region *region, const ur5e_params *p, ur5e_worst_direction_t *out)
{
    if (q == NULL || place == NULL || region == NULL || p == NULL || out == NULL) {
        return UR5E_NULL_POINTER;
    }
    hardest w;
    int status = ur5e_check_positive(&speed, 1);
    if (status == UR5E_OK) {
        status = ur5e_check_impact(region, p);
    }
    if (status == UR5E_OK) {
        status = ur5e_links_on(q, frame, place, p, &w.impact.arrival.links);
    }
    w.speed = speed;
    w.point = 0;
    return status == UR5E_OK ? find_hardest(region, p, &w, out) : status;
}
#endif
