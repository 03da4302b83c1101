/* SPDX-License-Identifier: 0BSD */
/* The direction in which ur5e_ hits hardest: looked for among many, then around the best of them. */
#include "ur5e_impact.h"

/* Directions over half a ball, or half a circle where the point moves in a plane: forces are even. */
#define OVER_A_BALL 96
#define OVER_A_CIRCLE 32
#define TURN UR5E_R(2.399963229728653) /* of one from the one before: pi (3 - sqrt(5)) */
#define HALF_A_TURN UR5E_R(3.141592653589793)
/* How far around the best is looked, as a share of a unit vector, first and last. */
#define WIDE UR5E_R(0.2)
#define NARROW UR5E_R(0.01)
#define AROUND 6
#define MOST_ROUNDS 16
/* Around how many it is looked, and the cosine above which two of them are the same: forces have several tops. */
#define STARTS 3
#define ALIKE UR5E_R(0.94)
/* What forces may be too low, added to what the directions were apart. */
#define OF_FORCES (UR5E_R(1.0) - UR5E_KEPT)

typedef struct {
    ur5e_impact impact;
    int point; /* whose rows of J count */
    ur5e_real speed;
    ur5e_real n[3]; /* the worst so far */
    ur5e_real force;
    ur5e_real tried; /* force of the last direction that was tried */
    bool bounded, unknown;
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
    w->lost = w->lost || status == UR5E_SINGULAR;
    w->unknown = w->unknown || (status != UR5E_OK && status != UR5E_BOUNDED && status != UR5E_SINGULAR);
    w->tried = found.force;
    const bool worse = (status == UR5E_OK || status == UR5E_BOUNDED) && found.force > w->force;
    if (worse) {
        w->force = found.force;
        w->bounded = status == UR5E_BOUNDED;
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
/*
 * Tries directions at right angles to that in which motors move the point least: where they hardly do, a pose has
 * one dimension less, and hardly any of the directions over a ball is within the others.
 */
static void try_across(const ur5e_region *region, const ur5e_params *p, hardest *w)
{
    const ur5e_links_t *const links = &w->impact.arrival.links;
    const int x = 3*w->point;
    ur5e_matrix square;
    ur5e_matrix vectors;
    ur5e_real values[UR5E_SYSTEM];
    for (int k = 0; k < UR5E_REACH; ++k) {
        for (int l = 0; l < UR5E_REACH; ++l) {
            const ur5e_real *const a = ur5e_directions[k];
            const ur5e_real *const b = ur5e_directions[l];
            square[k][l] = UR5E_R(0.0);
            for (int i = 0; i < UR5E_N; ++i) {
                const ur5e_real by_a = a[0]*links->J[x][i] + a[1]*links->J[x + 1][i] + a[2]*links->J[x + 2][i];
                const ur5e_real by_b = b[0]*links->J[x][i] + b[1]*links->J[x + 1][i] + b[2]*links->J[x + 2][i];
                square[k][l] += ur5e_has_motor[i] ? by_a*by_b : UR5E_R(0.0);
            }
        }
    }
    if (!ur5e_spectrum(UR5E_REACH, UR5E_EPSILON*UR5E_EPSILON, square, values, vectors)) {
        w->unknown = true;
        return;
    }
    int least = 0;
    for (int k = 1; k < UR5E_REACH; ++k) {
        least = values[k] < values[least] ? k : least;
    }
    const ur5e_real *const a = vectors[(least + 1) % UR5E_REACH];
    const ur5e_real *const b = vectors[(least + 2) % UR5E_REACH];
    for (int k = 0; k < (UR5E_REACH > 2 ? OVER_A_CIRCLE : 1); ++k) {
        const ur5e_real turn = HALF_A_TURN*(ur5e_real)k/(ur5e_real)OVER_A_CIRCLE;
        ur5e_real along[3] = {UR5E_R(0.0), UR5E_R(0.0), UR5E_R(0.0)};
        for (int l = 0; l < UR5E_REACH; ++l) {
            along[l] = UR5E_REACH > 2 ? UR5E_COS(turn)*a[l] + UR5E_SIN(turn)*b[l] : a[l];
        }
        (void)try_direction(region, p, along, w);
    }
}
#endif

/* Looks around the worst, wider where that helps. */
static void look_around(const ur5e_region *region, const ur5e_params *p, hardest *w)
{
    ur5e_real wide = WIDE;
    for (int round = 0; round < MOST_ROUNDS && wide > NARROW && UR5E_REACH > 1; ++round) {
        const ur5e_real *const n = w->n;
        const ur5e_real side = UR5E_FABS(n[2]) < UR5E_R(0.9) ? UR5E_SQRT(n[0]*n[0] + n[1]*n[1])
            : UR5E_SQRT(n[1]*n[1] + n[2]*n[2]);
        const ur5e_real a[3] = {UR5E_FABS(n[2]) < UR5E_R(0.9) ? n[1]/side : UR5E_R(0.0),
            UR5E_FABS(n[2]) < UR5E_R(0.9) ? -n[0]/side : n[2]/side,
            UR5E_FABS(n[2]) < UR5E_R(0.9) ? UR5E_R(0.0) : -n[1]/side};
        const ur5e_real b[3] = {n[1]*a[2] - n[2]*a[1], n[2]*a[0] - n[0]*a[2], n[0]*a[1] - n[1]*a[0]};
        const ur5e_real centre[3] = {n[0], n[1], n[2]};
        bool better = false;
        for (int k = 0; k < AROUND; ++k) {
            const ur5e_real turn = UR5E_R(2.0)*HALF_A_TURN*(ur5e_real)k/(ur5e_real)AROUND;
            const ur5e_real s = wide*UR5E_SIN(turn);
            const ur5e_real c = wide*UR5E_COS(turn);
            const ur5e_real aside[3] = {centre[0] + c*a[0] + s*b[0], centre[1] + c*a[1] + s*b[1],
                UR5E_REACH > 2 ? centre[2] + c*a[2] + s*b[2] : UR5E_R(0.0)};
            const ur5e_real size = UR5E_SQRT(aside[0]*aside[0] + aside[1]*aside[1] + aside[2]*aside[2]);
            const ur5e_real along[3] = {aside[0]/size, aside[1]/size, aside[2]/size};
            better = try_direction(region, p, along, w) || better;
        }
        wide = better ? wide : UR5E_R(0.5)*wide;
    }
}

/* Looks around the directions that were hardest, beside the hardest, of those over the ball. */
static void look_elsewhere(const ur5e_region *region, const ur5e_params *p, int count, ur5e_real *forces, hardest *w)
{
    for (int start = 0; start < STARTS; ++start) {
        const ur5e_real n[3] = {w->n[0], w->n[1], w->n[2]};
        const ur5e_real force = w->force;
        const bool bounded = w->bounded;
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
            w->bounded = bounded;
            for (int k = 0; k < 3; ++k) {
                w->n[k] = n[k];
            }
        }
    }
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
    look_around(region, p, w);
    look_elsewhere(region, p, count, forces, w);
    if (w->unknown) { /* so may be the hardest */
        return UR5E_UNRESOLVED;
    }
    for (int k = 0; k < 3; ++k) {
        out->n[k] = UR5E_R(0.0);
        for (int l = 0; l < UR5E_REACH; ++l) {
            out->n[k] += w->n[l]*ur5e_directions[l][k];
        }
    }
    out->force = w->force;
    out->error = w->force/seen - UR5E_R(1.0) + OF_FORCES;
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
