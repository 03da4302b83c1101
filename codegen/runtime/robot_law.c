/* SPDX-License-Identifier: 0BSD */
/*
 * Laws of contact of robot_: Hertz's, f = k_f d^1.5, or one through points.
 *
 * Between two points a law is the parabola over the triangle of both and the knee, where its tangents
 * meet: d = d0 + t (a0 + t a1) and f = f0 + t (b0 + t b1), t from 0 to 1. So any k d + s f is a quadratic of
 * t, and what presses skin and body together needs no iteration. Behind the last point it goes on straight.
 */
#include "robot_impact.h"

/*
 * Halvings of a force that is only a first guess; and trials under Hertz's law, where the speed grows like the
 * force to the power of 5/6 to 1, so that each leaves a sixth of how far the last was off, in powers.
 */
#define FORCE_HALVINGS 16
#define FORCE_TRIALS 6

/* What a sum of depth and force, each times a number, does from a point of a law to the next. */
typedef struct {
    robot_real start, rise, bend;
} law_course;

static law_course course_of(const robot_region *region, int i, robot_real hold, robot_real soft)
{
    const robot_law_point *const point = &region->law[i];
    const robot_real knee = hold*(point->knee_depth - point->depth) + soft*(point->knee_force - point->force);
    law_course c = {hold*point->depth + soft*point->force, knee, ROBOT_R(0.0)};
    if (i + 1 < region->law_points) {
        const robot_law_point *const next = &region->law[i + 1];
        c.rise = ROBOT_R(2.0)*knee;
        c.bend = hold*next->depth + soft*next->force - c.start - c.rise;
    }
    return c;
}

/* The piece in which such a sum, which rises, is `sum`, and where in it. */
static int piece_of(const robot_region *region, robot_real hold, robot_real soft, robot_real sum, robot_real *t)
{
    int low = 0;
    int high = region->law_points;
    while (high - low > 1) {
        const int middle = (low + high)/2;
        const robot_law_point *const point = &region->law[middle];
        if (hold*point->depth + soft*point->force <= sum) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const law_course c = course_of(region, low, hold, soft);
    const robot_real rest = ROBOT_FMAX(sum - c.start, ROBOT_R(0.0));
    const robot_real square = ROBOT_FMAX(c.rise*c.rise + ROBOT_R(4.0)*c.bend*rest, ROBOT_R(0.0));
    const robot_real both = c.rise + ROBOT_SQRT(square);
    *t = both > ROBOT_R(0.0) ? ROBOT_R(2.0)*rest/both : ROBOT_R(0.0);
    return low;
}

static robot_real value_at(law_course c, robot_real t)
{
    return c.start + t*(c.rise + t*c.bend);
}

robot_real robot_law_press(const robot_region *region, robot_real hold, robot_real soft, robot_real pressed,
    robot_real *depth)
{
    robot_real t;
    const robot_real yields = ROBOT_FMAX(soft, ROBOT_R(0.0));
    const int i = piece_of(region, hold, yields, pressed, &t);
    *depth = value_at(course_of(region, i, ROBOT_R(1.0), ROBOT_R(0.0)), t);
    return value_at(course_of(region, i, ROBOT_R(0.0), ROBOT_R(1.0)), t);
}

robot_real robot_law_depth(const robot_region *region, robot_real force)
{
    if (region->law == NULL) {
        const robot_real root = ROBOT_CBRT(force/region->hertz_stiffness);
        return root*root;
    }
    robot_real depth;
    (void)robot_law_press(region, ROBOT_R(0.0), ROBOT_R(1.0), force, &depth);
    return depth;
}

/* Twice the work from t = 0 on: of 2 f d'. */
static robot_real twice_work(law_course depth, law_course force, robot_real t)
{
    const robot_real third = ROBOT_R(1.0)/ROBOT_R(3.0);
    const robot_real level = force.start*depth.rise;
    const robot_real slope = ROBOT_R(0.5)*force.rise*depth.rise + force.start*depth.bend;
    const robot_real bend = third*(force.bend*depth.rise + ROBOT_R(2.0)*force.rise*depth.bend);
    const robot_real rest = ROBOT_R(0.5)*force.bend*depth.bend;
    return ROBOT_R(2.0)*t*(level + t*(slope + t*(bend + t*rest)));
}

robot_real robot_law_twice_work(const robot_region *region, robot_real force)
{
    if (region->law == NULL) {
        return ROBOT_R(0.8)*force*robot_law_depth(region, force);
    }
    robot_real t;
    robot_real sum = ROBOT_R(0.0);
    const int last = piece_of(region, ROBOT_R(0.0), ROBOT_R(1.0), force, &t);
    for (int i = 0; i <= last; ++i) {
        sum += twice_work(course_of(region, i, ROBOT_R(1.0), ROBOT_R(0.0)),
            course_of(region, i, ROBOT_R(0.0), ROBOT_R(1.0)), i < last ? ROBOT_R(1.0) : t);
    }
    return sum;
}

robot_real robot_law_stiffness(const robot_region *region, robot_real force)
{
    if (region->law == NULL) {
        const robot_real hertz = region->hertz_stiffness;
        return ROBOT_R(1.5)*ROBOT_CBRT(hertz*hertz*force);
    }
    robot_real most = ROBOT_R(0.0);
    for (int i = 0; i < region->law_points && region->law[i].force <= force; ++i) {
        const robot_law_point *const point = &region->law[i];
        most = ROBOT_FMAX(most, (point->knee_force - point->force)/(point->knee_depth - point->depth));
        if (i + 1 < region->law_points) {
            const robot_law_point *const next = &region->law[i + 1];
            most = ROBOT_FMAX(most, (next->force - point->knee_force)/(next->depth - point->knee_depth));
        }
    }
    return most;
}

/* Whether three numbers rise, the last but one step maybe by nothing. */
static bool rises(robot_real before, robot_real between, robot_real after)
{
    return before <= between && between <= after && before < after;
}

bool robot_law_is_one(const robot_region *region)
{
    if (region->law == NULL) {
        return true;
    }
    if (region->law_points < 1 || region->law_points > ROBOT_MOST_LAW_POINTS) {
        return false;
    }
    const robot_law_point *const law = region->law;
    bool good = !(ROBOT_FABS(law[0].depth) > ROBOT_R(0.0)) && !(ROBOT_FABS(law[0].force) > ROBOT_R(0.0));
    for (int i = 0; i < region->law_points && good; ++i) {
        const bool ends = i + 1 == region->law_points;
        good = law[i].depth < law[i].knee_depth && law[i].knee_depth <= ROBOT_REAL_MAX
            && law[i].knee_force <= ROBOT_REAL_MAX
            && (ends ? law[i].force < law[i].knee_force
                     : law[i].knee_depth < law[i + 1].depth
                           && rises(law[i].force, law[i].knee_force, law[i + 1].force));
    }
    return good;
}

robot_real robot_two_body_speed(const robot_region *region, robot_real mobility, robot_real force)
{
    return ROBOT_SQRT(mobility*(force*force/region->stiffness + robot_law_twice_work(region, force)));
}

robot_real robot_two_body_force(const robot_region *region, robot_real mobility, robot_real speed)
{
    const robot_real spring = speed*ROBOT_SQRT(region->stiffness/mobility);
    if (region->law == NULL) {
        robot_real force = spring;
        for (int k = 0; k < FORCE_TRIALS; ++k) {
            force *= speed/robot_two_body_speed(region, mobility, force);
        }
        return force;
    }
    robot_real low = ROBOT_R(0.0);
    robot_real high = spring;
    for (int k = 0; k < FORCE_HALVINGS; ++k) {
        const robot_real middle = ROBOT_R(0.5)*(low + high);
        if (robot_two_body_speed(region, mobility, middle) > speed) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}
