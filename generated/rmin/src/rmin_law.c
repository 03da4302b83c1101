/* SPDX-License-Identifier: 0BSD */
/*
 * Laws of contact of rmin_: Hertz's, f = k_f d^1.5, or one through points.
 *
 * Between two points a law is the parabola over the triangle of both and the knee, where its tangents
 * meet: d = d0 + t (a0 + t a1) and f = f0 + t (b0 + t b1), t from 0 to 1. So any k d + s f is a quadratic of
 * t, and what presses skin and body together needs no iteration. Behind the last point it goes on straight.
 */
#include "rmin_impact.h"

/*
 * Halvings of a force that is only a first guess; and trials under Hertz's law, where the speed grows like the
 * force to the power of 5/6 to 1, so that each leaves a sixth of how far the last was off, in powers.
 */
#define FORCE_HALVINGS 16
#define FORCE_TRIALS 6

/* What a sum of depth and force, each times a number, does from a point of a law to the next. */
typedef struct {
    rmin_real start, rise, bend;
} law_course;

static law_course course_of(const rmin_region *region, int i, rmin_real hold, rmin_real soft)
{
    const rmin_law_point *const point = &region->law[i];
    const rmin_real knee = hold*(point->knee_depth - point->depth) + soft*(point->knee_force - point->force);
    law_course c = {hold*point->depth + soft*point->force, knee, RMIN_R(0.0)};
    if (i + 1 < region->law_points) {
        const rmin_law_point *const next = &region->law[i + 1];
        c.rise = RMIN_R(2.0)*knee;
        c.bend = hold*next->depth + soft*next->force - c.start - c.rise;
    }
    return c;
}

/* The piece in which such a sum, which rises, is `sum`, and where in it. */
static int piece_of(const rmin_region *region, rmin_real hold, rmin_real soft, rmin_real sum, rmin_real *t)
{
    int low = 0;
    int high = region->law_points;
    while (high - low > 1) {
        const int middle = (low + high)/2;
        const rmin_law_point *const point = &region->law[middle];
        if (hold*point->depth + soft*point->force <= sum) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const law_course c = course_of(region, low, hold, soft);
    const rmin_real rest = RMIN_FMAX(sum - c.start, RMIN_R(0.0));
    const rmin_real square = RMIN_FMAX(c.rise*c.rise + RMIN_R(4.0)*c.bend*rest, RMIN_R(0.0));
    const rmin_real both = c.rise + RMIN_SQRT(square);
    *t = both > RMIN_R(0.0) ? RMIN_R(2.0)*rest/both : RMIN_R(0.0);
    return low;
}

static rmin_real value_at(law_course c, rmin_real t)
{
    return c.start + t*(c.rise + t*c.bend);
}

rmin_real rmin_law_press(const rmin_region *region, rmin_real hold, rmin_real soft, rmin_real pressed,
    rmin_real *depth)
{
    rmin_real t;
    const rmin_real yields = RMIN_FMAX(soft, RMIN_R(0.0));
    const int i = piece_of(region, hold, yields, pressed, &t);
    *depth = value_at(course_of(region, i, RMIN_R(1.0), RMIN_R(0.0)), t);
    return value_at(course_of(region, i, RMIN_R(0.0), RMIN_R(1.0)), t);
}

rmin_real rmin_law_depth(const rmin_region *region, rmin_real force)
{
    if (region->law == NULL) {
        const rmin_real root = RMIN_CBRT(force/region->hertz_stiffness);
        return root*root;
    }
    rmin_real depth;
    (void)rmin_law_press(region, RMIN_R(0.0), RMIN_R(1.0), force, &depth);
    return depth;
}

/* Twice the work from t = 0 on: of 2 f d'. */
static rmin_real twice_work(law_course depth, law_course force, rmin_real t)
{
    const rmin_real third = RMIN_R(1.0)/RMIN_R(3.0);
    const rmin_real level = force.start*depth.rise;
    const rmin_real slope = RMIN_R(0.5)*force.rise*depth.rise + force.start*depth.bend;
    const rmin_real bend = third*(force.bend*depth.rise + RMIN_R(2.0)*force.rise*depth.bend);
    const rmin_real rest = RMIN_R(0.5)*force.bend*depth.bend;
    return RMIN_R(2.0)*t*(level + t*(slope + t*(bend + t*rest)));
}

rmin_real rmin_law_twice_work(const rmin_region *region, rmin_real force)
{
    if (region->law == NULL) {
        return RMIN_R(0.8)*force*rmin_law_depth(region, force);
    }
    rmin_real t;
    rmin_real sum = RMIN_R(0.0);
    const int last = piece_of(region, RMIN_R(0.0), RMIN_R(1.0), force, &t);
    for (int i = 0; i <= last; ++i) {
        sum += twice_work(course_of(region, i, RMIN_R(1.0), RMIN_R(0.0)),
            course_of(region, i, RMIN_R(0.0), RMIN_R(1.0)), i < last ? RMIN_R(1.0) : t);
    }
    return sum;
}

rmin_real rmin_law_stiffness(const rmin_region *region, rmin_real force)
{
    if (region->law == NULL) {
        const rmin_real hertz = region->hertz_stiffness;
        return RMIN_R(1.5)*RMIN_CBRT(hertz*hertz*force);
    }
    rmin_real most = RMIN_R(0.0);
    for (int i = 0; i < region->law_points && region->law[i].force <= force; ++i) {
        const rmin_law_point *const point = &region->law[i];
        most = RMIN_FMAX(most, (point->knee_force - point->force)/(point->knee_depth - point->depth));
        if (i + 1 < region->law_points) {
            const rmin_law_point *const next = &region->law[i + 1];
            most = RMIN_FMAX(most, (next->force - point->knee_force)/(next->depth - point->knee_depth));
        }
    }
    return most;
}

/* Whether three numbers rise, the last but one step maybe by nothing. */
static bool rises(rmin_real before, rmin_real between, rmin_real after)
{
    return before <= between && between <= after && before < after;
}

bool rmin_law_is_one(const rmin_region *region)
{
    if (region->law == NULL) {
        return true;
    }
    if (region->law_points < 1 || region->law_points > RMIN_MOST_LAW_POINTS) {
        return false;
    }
    const rmin_law_point *const law = region->law;
    bool good = !(RMIN_FABS(law[0].depth) > RMIN_R(0.0)) && !(RMIN_FABS(law[0].force) > RMIN_R(0.0));
    for (int i = 0; i < region->law_points && good; ++i) {
        const bool ends = i + 1 == region->law_points;
        good = law[i].depth < law[i].knee_depth && law[i].knee_depth <= RMIN_REAL_MAX
            && law[i].knee_force <= RMIN_REAL_MAX
            && (ends ? law[i].force < law[i].knee_force
                     : law[i].knee_depth < law[i + 1].depth
                           && rises(law[i].force, law[i].knee_force, law[i + 1].force));
    }
    return good;
}

rmin_real rmin_two_body_speed(const rmin_region *region, rmin_real mobility, rmin_real force)
{
    return RMIN_SQRT(mobility*(force*force/region->stiffness + rmin_law_twice_work(region, force)));
}

rmin_real rmin_two_body_force(const rmin_region *region, rmin_real mobility, rmin_real speed)
{
    const rmin_real spring = speed*RMIN_SQRT(region->stiffness/mobility);
    if (region->law == NULL) {
        rmin_real force = spring;
        for (int k = 0; k < FORCE_TRIALS; ++k) {
            force *= speed/rmin_two_body_speed(region, mobility, force);
        }
        return force;
    }
    rmin_real low = RMIN_R(0.0);
    rmin_real high = spring;
    for (int k = 0; k < FORCE_HALVINGS; ++k) {
        const rmin_real middle = RMIN_R(0.5)*(low + high);
        if (rmin_two_body_speed(region, mobility, middle) > speed) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}
