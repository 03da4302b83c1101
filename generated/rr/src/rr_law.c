/* SPDX-License-Identifier: 0BSD */
/*
 * Laws of contact of rr_: Hertz's, f = k_f d^1.5, or one through points.
 *
 * Between two points a law is the parabola over the triangle of both and the knee, where its tangents
 * meet: d = d0 + t (a0 + t a1) and f = f0 + t (b0 + t b1), t from 0 to 1. So any k d + s f is a quadratic of
 * t, and what presses skin and body together needs no iteration. Behind the last point it goes on straight.
 */
#include "rr_impact.h"

/*
 * Halvings of a force that is only a first guess; and trials under Hertz's law, where the speed grows like the
 * force to the power of 5/6 to 1, so that each leaves a sixth of how far the last was off, in powers.
 */
#define FORCE_HALVINGS 16
#define FORCE_TRIALS 6

/* What a sum of depth and force, each times a number, does from a point of a law to the next. */
typedef struct {
    rr_real start, rise, bend;
} law_course;

static law_course course_of(const rr_region *region, int i, rr_real hold, rr_real soft)
{
    const rr_law_point *const point = &region->law[i];
    const rr_real knee = hold*(point->knee_depth - point->depth) + soft*(point->knee_force - point->force);
    law_course c = {hold*point->depth + soft*point->force, knee, RR_R(0.0)};
    if (i + 1 < region->law_points) {
        const rr_law_point *const next = &region->law[i + 1];
        c.rise = RR_R(2.0)*knee;
        c.bend = hold*next->depth + soft*next->force - c.start - c.rise;
    }
    return c;
}

/* The piece in which such a sum, which rises, is `sum`, and where in it. */
static int piece_of(const rr_region *region, rr_real hold, rr_real soft, rr_real sum, rr_real *t)
{
    int low = 0;
    int high = region->law_points;
    while (high - low > 1) {
        const int middle = (low + high)/2;
        const rr_law_point *const point = &region->law[middle];
        if (hold*point->depth + soft*point->force <= sum) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const law_course c = course_of(region, low, hold, soft);
    const rr_real rest = RR_FMAX(sum - c.start, RR_R(0.0));
    const rr_real square = RR_FMAX(c.rise*c.rise + RR_R(4.0)*c.bend*rest, RR_R(0.0));
    const rr_real both = c.rise + RR_SQRT(square);
    *t = both > RR_R(0.0) ? RR_R(2.0)*rest/both : RR_R(0.0);
    return low;
}

static rr_real value_at(law_course c, rr_real t)
{
    return c.start + t*(c.rise + t*c.bend);
}

rr_real rr_law_press(const rr_region *region, rr_real hold, rr_real soft, rr_real pressed,
    rr_real *depth)
{
    rr_real t;
    const rr_real yields = RR_FMAX(soft, RR_R(0.0));
    const int i = piece_of(region, hold, yields, pressed, &t);
    *depth = value_at(course_of(region, i, RR_R(1.0), RR_R(0.0)), t);
    return value_at(course_of(region, i, RR_R(0.0), RR_R(1.0)), t);
}

rr_real rr_law_depth(const rr_region *region, rr_real force)
{
    if (region->law == NULL) {
        const rr_real root = RR_CBRT(force/region->hertz_stiffness);
        return root*root;
    }
    rr_real depth;
    (void)rr_law_press(region, RR_R(0.0), RR_R(1.0), force, &depth);
    return depth;
}

/* Twice the work from t = 0 on: of 2 f d'. */
static rr_real twice_work(law_course depth, law_course force, rr_real t)
{
    const rr_real third = RR_R(1.0)/RR_R(3.0);
    const rr_real level = force.start*depth.rise;
    const rr_real slope = RR_R(0.5)*force.rise*depth.rise + force.start*depth.bend;
    const rr_real bend = third*(force.bend*depth.rise + RR_R(2.0)*force.rise*depth.bend);
    const rr_real rest = RR_R(0.5)*force.bend*depth.bend;
    return RR_R(2.0)*t*(level + t*(slope + t*(bend + t*rest)));
}

rr_real rr_law_twice_work(const rr_region *region, rr_real force)
{
    if (region->law == NULL) {
        return RR_R(0.8)*force*rr_law_depth(region, force);
    }
    rr_real t;
    rr_real sum = RR_R(0.0);
    const int last = piece_of(region, RR_R(0.0), RR_R(1.0), force, &t);
    for (int i = 0; i <= last; ++i) {
        sum += twice_work(course_of(region, i, RR_R(1.0), RR_R(0.0)),
            course_of(region, i, RR_R(0.0), RR_R(1.0)), i < last ? RR_R(1.0) : t);
    }
    return sum;
}

rr_real rr_law_stiffness(const rr_region *region, rr_real force)
{
    if (region->law == NULL) {
        const rr_real hertz = region->hertz_stiffness;
        return RR_R(1.5)*RR_CBRT(hertz*hertz*force);
    }
    rr_real most = RR_R(0.0);
    for (int i = 0; i < region->law_points && region->law[i].force <= force; ++i) {
        const rr_law_point *const point = &region->law[i];
        most = RR_FMAX(most, (point->knee_force - point->force)/(point->knee_depth - point->depth));
        if (i + 1 < region->law_points) {
            const rr_law_point *const next = &region->law[i + 1];
            most = RR_FMAX(most, (next->force - point->knee_force)/(next->depth - point->knee_depth));
        }
    }
    return most;
}

/* Whether three numbers rise, the last but one step maybe by nothing. */
static bool rises(rr_real before, rr_real between, rr_real after)
{
    return before <= between && between <= after && before < after;
}

bool rr_law_is_one(const rr_region *region)
{
    if (region->law == NULL) {
        return true;
    }
    if (region->law_points < 1 || region->law_points > RR_MOST_LAW_POINTS) {
        return false;
    }
    const rr_law_point *const law = region->law;
    bool good = !(RR_FABS(law[0].depth) > RR_R(0.0)) && !(RR_FABS(law[0].force) > RR_R(0.0));
    for (int i = 0; i < region->law_points && good; ++i) {
        const bool ends = i + 1 == region->law_points;
        good = law[i].depth < law[i].knee_depth && law[i].knee_depth <= RR_REAL_MAX
            && law[i].knee_force <= RR_REAL_MAX
            && (ends ? law[i].force < law[i].knee_force
                     : law[i].knee_depth < law[i + 1].depth
                           && rises(law[i].force, law[i].knee_force, law[i + 1].force));
    }
    return good;
}

rr_real rr_two_body_speed(const rr_region *region, rr_real mobility, rr_real force)
{
    return RR_SQRT(mobility*(force*force/region->stiffness + rr_law_twice_work(region, force)));
}

rr_real rr_two_body_force(const rr_region *region, rr_real mobility, rr_real speed)
{
    const rr_real spring = speed*RR_SQRT(region->stiffness/mobility);
    if (region->law == NULL) {
        rr_real force = spring;
        for (int k = 0; k < FORCE_TRIALS; ++k) {
            force *= speed/rr_two_body_speed(region, mobility, force);
        }
        return force;
    }
    rr_real low = RR_R(0.0);
    rr_real high = spring;
    for (int k = 0; k < FORCE_HALVINGS; ++k) {
        const rr_real middle = RR_R(0.5)*(low + high);
        if (rr_two_body_speed(region, mobility, middle) > speed) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}
