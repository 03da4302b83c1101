/* SPDX-License-Identifier: 0BSD */
/* The direction in which panda_ hits hardest: looked for among many, then around the best of them. */
#include "panda_impact.h"

/* Directions over half a ball, or half a circle where the point moves in a plane: forces are even. */
#define OVER_A_BALL 96
#define OVER_A_CIRCLE 32
#define TURN PANDA_R(2.399963229728653) /* of one from the one before: pi (3 - sqrt(5)) */
#define HALF_A_TURN PANDA_R(3.141592653589793)
/* How far around the best is looked, as a share of a unit vector, first and last. */
#define WIDE PANDA_R(0.2)
#define NARROW PANDA_R(0.01)
#define AROUND 6
#define MOST_ROUNDS 16
/* Around how many it is looked, and the cosine above which two of them are the same: forces have several tops. */
#define STARTS 3
#define ALIKE PANDA_R(0.94)
/* What forces may be too low, added to what the directions were apart. */
#define OF_FORCES (PANDA_R(1.0) - PANDA_KEPT)

typedef struct {
    panda_impact impact;
    int point; /* whose rows of J count */
    panda_real speed;
    panda_real n[3]; /* the worst so far */
    panda_real force;
    panda_real tried; /* force of the last direction that was tried */
    bool bounded, unknown;
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
    w->lost = w->lost || status == PANDA_SINGULAR;
    w->unknown = w->unknown || (status != PANDA_OK && status != PANDA_BOUNDED && status != PANDA_SINGULAR);
    w->tried = found.force;
    const bool worse = (status == PANDA_OK || status == PANDA_BOUNDED) && found.force > w->force;
    if (worse) {
        w->force = found.force;
        w->bounded = status == PANDA_BOUNDED;
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
/*
 * Tries directions at right angles to that in which motors move the point least: where they hardly do, a pose has
 * one dimension less, and hardly any of the directions over a ball is within the others.
 */
static void try_across(const panda_region *region, const panda_params *p, hardest *w)
{
    const panda_links_t *const links = &w->impact.arrival.links;
    const int x = 3*w->point;
    panda_matrix square;
    panda_matrix vectors;
    panda_real values[PANDA_SYSTEM];
    for (int k = 0; k < PANDA_REACH; ++k) {
        for (int l = 0; l < PANDA_REACH; ++l) {
            const panda_real *const a = panda_directions[k];
            const panda_real *const b = panda_directions[l];
            square[k][l] = PANDA_R(0.0);
            for (int i = 0; i < PANDA_N; ++i) {
                const panda_real by_a = a[0]*links->J[x][i] + a[1]*links->J[x + 1][i] + a[2]*links->J[x + 2][i];
                const panda_real by_b = b[0]*links->J[x][i] + b[1]*links->J[x + 1][i] + b[2]*links->J[x + 2][i];
                square[k][l] += panda_has_motor[i] ? by_a*by_b : PANDA_R(0.0);
            }
        }
    }
    if (!panda_spectrum(PANDA_REACH, PANDA_EPSILON*PANDA_EPSILON, square, values, vectors)) {
        w->unknown = true;
        return;
    }
    int least = 0;
    for (int k = 1; k < PANDA_REACH; ++k) {
        least = values[k] < values[least] ? k : least;
    }
    const panda_real *const a = vectors[(least + 1) % PANDA_REACH];
    const panda_real *const b = vectors[(least + 2) % PANDA_REACH];
    for (int k = 0; k < (PANDA_REACH > 2 ? OVER_A_CIRCLE : 1); ++k) {
        const panda_real turn = HALF_A_TURN*(panda_real)k/(panda_real)OVER_A_CIRCLE;
        panda_real along[3] = {PANDA_R(0.0), PANDA_R(0.0), PANDA_R(0.0)};
        for (int l = 0; l < PANDA_REACH; ++l) {
            along[l] = PANDA_REACH > 2 ? PANDA_COS(turn)*a[l] + PANDA_SIN(turn)*b[l] : a[l];
        }
        (void)try_direction(region, p, along, w);
    }
}
#endif

/* Looks around the worst, wider where that helps. */
static void look_around(const panda_region *region, const panda_params *p, hardest *w)
{
    panda_real wide = WIDE;
    for (int round = 0; round < MOST_ROUNDS && wide > NARROW && PANDA_REACH > 1; ++round) {
        const panda_real *const n = w->n;
        const panda_real side = PANDA_FABS(n[2]) < PANDA_R(0.9) ? PANDA_SQRT(n[0]*n[0] + n[1]*n[1])
            : PANDA_SQRT(n[1]*n[1] + n[2]*n[2]);
        const panda_real a[3] = {PANDA_FABS(n[2]) < PANDA_R(0.9) ? n[1]/side : PANDA_R(0.0),
            PANDA_FABS(n[2]) < PANDA_R(0.9) ? -n[0]/side : n[2]/side,
            PANDA_FABS(n[2]) < PANDA_R(0.9) ? PANDA_R(0.0) : -n[1]/side};
        const panda_real b[3] = {n[1]*a[2] - n[2]*a[1], n[2]*a[0] - n[0]*a[2], n[0]*a[1] - n[1]*a[0]};
        const panda_real centre[3] = {n[0], n[1], n[2]};
        bool better = false;
        for (int k = 0; k < AROUND; ++k) {
            const panda_real turn = PANDA_R(2.0)*HALF_A_TURN*(panda_real)k/(panda_real)AROUND;
            const panda_real s = wide*PANDA_SIN(turn);
            const panda_real c = wide*PANDA_COS(turn);
            const panda_real aside[3] = {centre[0] + c*a[0] + s*b[0], centre[1] + c*a[1] + s*b[1],
                PANDA_REACH > 2 ? centre[2] + c*a[2] + s*b[2] : PANDA_R(0.0)};
            const panda_real size = PANDA_SQRT(aside[0]*aside[0] + aside[1]*aside[1] + aside[2]*aside[2]);
            const panda_real along[3] = {aside[0]/size, aside[1]/size, aside[2]/size};
            better = try_direction(region, p, along, w) || better;
        }
        wide = better ? wide : PANDA_R(0.5)*wide;
    }
}

/* Looks around the directions that were hardest, beside the hardest, of those over the ball. */
static void look_elsewhere(const panda_region *region, const panda_params *p, int count, panda_real *forces, hardest *w)
{
    for (int start = 0; start < STARTS; ++start) {
        const panda_real n[3] = {w->n[0], w->n[1], w->n[2]};
        const panda_real force = w->force;
        const bool bounded = w->bounded;
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
            w->bounded = bounded;
            for (int k = 0; k < 3; ++k) {
                w->n[k] = n[k];
            }
        }
    }
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
    look_around(region, p, w);
    look_elsewhere(region, p, count, forces, w);
    if (w->unknown) { /* so may be the hardest */
        return PANDA_UNRESOLVED;
    }
    for (int k = 0; k < 3; ++k) {
        out->n[k] = PANDA_R(0.0);
        for (int l = 0; l < PANDA_REACH; ++l) {
            out->n[k] += w->n[l]*panda_directions[l][k];
        }
    }
    out->force = w->force;
    out->error = w->force/seen - PANDA_R(1.0) + OF_FORCES;
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
