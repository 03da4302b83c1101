/* SPDX-License-Identifier: 0BSD */
/*
 * Laws of contact of panda_: Hertz's, f = k_f d^1.5, or one through points.
 *
 * Between two points a law is the parabola over the triangle of both and the knee, where its tangents
 * meet: d = d0 + t (a0 + t a1) and f = f0 + t (b0 + t b1), t from 0 to 1. So any k d + s f is a quadratic of
 * t, and what presses skin and body together needs no iteration. Behind the last point it goes on straight.
 */
#include "panda_impact.h"

/*
 * Halvings of a force that is only a first guess; and trials under Hertz's law, where the speed grows like the
 * force to the power of 5/6 to 1, so that each leaves a sixth of how far the last was off, in powers.
 */
#define FORCE_HALVINGS 16
#define FORCE_TRIALS 6

/* What a sum of depth and force, each times a number, does from a point of a law to the next. */
typedef struct {
    panda_real start, rise, bend;
} law_course;

static law_course course_of(const panda_region *region, int i, panda_real hold, panda_real soft)
{
    const panda_law_point *const point = &region->law[i];
    const panda_real knee = hold*(point->knee_depth - point->depth) + soft*(point->knee_force - point->force);
    law_course c = {hold*point->depth + soft*point->force, knee, PANDA_R(0.0)};
    if (i + 1 < region->law_points) {
        const panda_law_point *const next = &region->law[i + 1];
        c.rise = PANDA_R(2.0)*knee;
        c.bend = hold*next->depth + soft*next->force - c.start - c.rise;
    }
    return c;
}

/* The piece in which such a sum, which rises, is `sum`, and where in it. */
static int piece_of(const panda_region *region, panda_real hold, panda_real soft, panda_real sum, panda_real *t)
{
    int low = 0;
    int high = region->law_points;
    while (high - low > 1) {
        const int middle = (low + high)/2;
        const panda_law_point *const point = &region->law[middle];
        if (hold*point->depth + soft*point->force <= sum) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const law_course c = course_of(region, low, hold, soft);
    const panda_real rest = PANDA_FMAX(sum - c.start, PANDA_R(0.0));
    const panda_real square = PANDA_FMAX(c.rise*c.rise + PANDA_R(4.0)*c.bend*rest, PANDA_R(0.0));
    const panda_real both = c.rise + PANDA_SQRT(square);
    *t = both > PANDA_R(0.0) ? PANDA_R(2.0)*rest/both : PANDA_R(0.0);
    return low;
}

static panda_real value_at(law_course c, panda_real t)
{
    return c.start + t*(c.rise + t*c.bend);
}

panda_real panda_law_press(const panda_region *region, panda_real hold, panda_real soft, panda_real pressed,
    panda_real *depth)
{
    panda_real t;
    const panda_real yields = PANDA_FMAX(soft, PANDA_R(0.0));
    const int i = piece_of(region, hold, yields, pressed, &t);
    *depth = value_at(course_of(region, i, PANDA_R(1.0), PANDA_R(0.0)), t);
    return value_at(course_of(region, i, PANDA_R(0.0), PANDA_R(1.0)), t);
}

panda_real panda_law_depth(const panda_region *region, panda_real force)
{
    if (region->law == NULL) {
        const panda_real root = PANDA_CBRT(force/region->hertz_stiffness);
        return root*root;
    }
    panda_real depth;
    (void)panda_law_press(region, PANDA_R(0.0), PANDA_R(1.0), force, &depth);
    return depth;
}

/* Twice the work from t = 0 on: of 2 f d'. */
static panda_real twice_work(law_course depth, law_course force, panda_real t)
{
    const panda_real third = PANDA_R(1.0)/PANDA_R(3.0);
    const panda_real level = force.start*depth.rise;
    const panda_real slope = PANDA_R(0.5)*force.rise*depth.rise + force.start*depth.bend;
    const panda_real bend = third*(force.bend*depth.rise + PANDA_R(2.0)*force.rise*depth.bend);
    const panda_real rest = PANDA_R(0.5)*force.bend*depth.bend;
    return PANDA_R(2.0)*t*(level + t*(slope + t*(bend + t*rest)));
}

panda_real panda_law_twice_work(const panda_region *region, panda_real force)
{
    if (region->law == NULL) {
        return PANDA_R(0.8)*force*panda_law_depth(region, force);
    }
    panda_real t;
    panda_real sum = PANDA_R(0.0);
    const int last = piece_of(region, PANDA_R(0.0), PANDA_R(1.0), force, &t);
    for (int i = 0; i <= last; ++i) {
        sum += twice_work(course_of(region, i, PANDA_R(1.0), PANDA_R(0.0)),
            course_of(region, i, PANDA_R(0.0), PANDA_R(1.0)), i < last ? PANDA_R(1.0) : t);
    }
    return sum;
}

panda_real panda_law_stiffness(const panda_region *region, panda_real force)
{
    if (region->law == NULL) {
        const panda_real hertz = region->hertz_stiffness;
        return PANDA_R(1.5)*PANDA_CBRT(hertz*hertz*force);
    }
    panda_real most = PANDA_R(0.0);
    for (int i = 0; i < region->law_points && region->law[i].force <= force; ++i) {
        const panda_law_point *const point = &region->law[i];
        most = PANDA_FMAX(most, (point->knee_force - point->force)/(point->knee_depth - point->depth));
        if (i + 1 < region->law_points) {
            const panda_law_point *const next = &region->law[i + 1];
            most = PANDA_FMAX(most, (next->force - point->knee_force)/(next->depth - point->knee_depth));
        }
    }
    return most;
}

/* Whether three numbers rise, the last but one step maybe by nothing. */
static bool rises(panda_real before, panda_real between, panda_real after)
{
    return before <= between && between <= after && before < after;
}

bool panda_law_is_one(const panda_region *region)
{
    if (region->law == NULL) {
        return true;
    }
    if (region->law_points < 1 || region->law_points > PANDA_MOST_LAW_POINTS) {
        return false;
    }
    const panda_law_point *const law = region->law;
    bool good = !(PANDA_FABS(law[0].depth) > PANDA_R(0.0)) && !(PANDA_FABS(law[0].force) > PANDA_R(0.0));
    for (int i = 0; i < region->law_points && good; ++i) {
        const bool ends = i + 1 == region->law_points;
        good = law[i].depth < law[i].knee_depth && law[i].knee_depth <= PANDA_REAL_MAX
            && law[i].knee_force <= PANDA_REAL_MAX
            && (ends ? law[i].force < law[i].knee_force
                     : law[i].knee_depth < law[i + 1].depth
                           && rises(law[i].force, law[i].knee_force, law[i + 1].force));
    }
    return good;
}

panda_real panda_two_body_speed(const panda_region *region, panda_real mobility, panda_real force)
{
    return PANDA_SQRT(mobility*(force*force/region->stiffness + panda_law_twice_work(region, force)));
}

panda_real panda_two_body_force(const panda_region *region, panda_real mobility, panda_real speed)
{
    const panda_real spring = speed*PANDA_SQRT(region->stiffness/mobility);
    if (region->law == NULL) {
        panda_real force = spring;
        for (int k = 0; k < FORCE_TRIALS; ++k) {
            force *= speed/panda_two_body_speed(region, mobility, force);
        }
        return force;
    }
    panda_real low = PANDA_R(0.0);
    panda_real high = spring;
    for (int k = 0; k < FORCE_HALVINGS; ++k) {
        const panda_real middle = PANDA_R(0.5)*(low + high);
        if (panda_two_body_speed(region, mobility, middle) > speed) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}
