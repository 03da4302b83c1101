/* SPDX-License-Identifier: 0BSD */
/*
 * Laws of contact of ur5e_: Hertz's, f = k_f d^1.5, or one through points.
 *
 * Between two points a law is the parabola over the triangle of both and the knee, where its tangents
 * meet: d = d0 + t (a0 + t a1) and f = f0 + t (b0 + t b1), t from 0 to 1. So any k d + s f is a quadratic of
 * t, and what presses skin and body together needs no iteration. Behind the last point it goes on straight.
 */
#include "ur5e_impact.h"

/*
 * Halvings of a force that is only a first guess; and trials under Hertz's law, where the speed grows like the
 * force to the power of 5/6 to 1, so that each leaves a sixth of how far the last was off, in powers.
 */
#define FORCE_HALVINGS 16
#define FORCE_TRIALS 6

/* What a sum of depth and force, each times a number, does from a point of a law to the next. */
typedef struct {
    ur5e_real start, rise, bend;
} law_course;

static law_course course_of(const ur5e_region *region, int i, ur5e_real hold, ur5e_real soft)
{
    const ur5e_law_point *const point = &region->law[i];
    const ur5e_real knee = hold*(point->knee_depth - point->depth) + soft*(point->knee_force - point->force);
    law_course c = {hold*point->depth + soft*point->force, knee, UR5E_R(0.0)};
    if (i + 1 < region->law_points) {
        const ur5e_law_point *const next = &region->law[i + 1];
        c.rise = UR5E_R(2.0)*knee;
        c.bend = hold*next->depth + soft*next->force - c.start - c.rise;
    }
    return c;
}

/* The piece in which such a sum, which rises, is `sum`, and where in it. */
static int piece_of(const ur5e_region *region, ur5e_real hold, ur5e_real soft, ur5e_real sum, ur5e_real *t)
{
    int low = 0;
    int high = region->law_points;
    while (high - low > 1) {
        const int middle = (low + high)/2;
        const ur5e_law_point *const point = &region->law[middle];
        if (hold*point->depth + soft*point->force <= sum) {
            low = middle;
        } else {
            high = middle;
        }
    }
    const law_course c = course_of(region, low, hold, soft);
    const ur5e_real rest = UR5E_FMAX(sum - c.start, UR5E_R(0.0));
    const ur5e_real square = UR5E_FMAX(c.rise*c.rise + UR5E_R(4.0)*c.bend*rest, UR5E_R(0.0));
    const ur5e_real both = c.rise + UR5E_SQRT(square);
    *t = both > UR5E_R(0.0) ? UR5E_R(2.0)*rest/both : UR5E_R(0.0);
    return low;
}

static ur5e_real value_at(law_course c, ur5e_real t)
{
    return c.start + t*(c.rise + t*c.bend);
}

ur5e_real ur5e_law_press(const ur5e_region *region, ur5e_real hold, ur5e_real soft, ur5e_real pressed,
    ur5e_real *depth)
{
    ur5e_real t;
    const ur5e_real yields = UR5E_FMAX(soft, UR5E_R(0.0));
    const int i = piece_of(region, hold, yields, pressed, &t);
    *depth = value_at(course_of(region, i, UR5E_R(1.0), UR5E_R(0.0)), t);
    return value_at(course_of(region, i, UR5E_R(0.0), UR5E_R(1.0)), t);
}

ur5e_real ur5e_law_depth(const ur5e_region *region, ur5e_real force)
{
    if (region->law == NULL) {
        const ur5e_real root = UR5E_CBRT(force/region->hertz_stiffness);
        return root*root;
    }
    ur5e_real depth;
    (void)ur5e_law_press(region, UR5E_R(0.0), UR5E_R(1.0), force, &depth);
    return depth;
}

/* Twice the work from t = 0 on: of 2 f d'. */
static ur5e_real twice_work(law_course depth, law_course force, ur5e_real t)
{
    const ur5e_real third = UR5E_R(1.0)/UR5E_R(3.0);
    const ur5e_real level = force.start*depth.rise;
    const ur5e_real slope = UR5E_R(0.5)*force.rise*depth.rise + force.start*depth.bend;
    const ur5e_real bend = third*(force.bend*depth.rise + UR5E_R(2.0)*force.rise*depth.bend);
    const ur5e_real rest = UR5E_R(0.5)*force.bend*depth.bend;
    return UR5E_R(2.0)*t*(level + t*(slope + t*(bend + t*rest)));
}

ur5e_real ur5e_law_twice_work(const ur5e_region *region, ur5e_real force)
{
    if (region->law == NULL) {
        return UR5E_R(0.8)*force*ur5e_law_depth(region, force);
    }
    ur5e_real t;
    ur5e_real sum = UR5E_R(0.0);
    const int last = piece_of(region, UR5E_R(0.0), UR5E_R(1.0), force, &t);
    for (int i = 0; i <= last; ++i) {
        sum += twice_work(course_of(region, i, UR5E_R(1.0), UR5E_R(0.0)),
            course_of(region, i, UR5E_R(0.0), UR5E_R(1.0)), i < last ? UR5E_R(1.0) : t);
    }
    return sum;
}

ur5e_real ur5e_law_stiffness(const ur5e_region *region, ur5e_real force)
{
    if (region->law == NULL) {
        const ur5e_real hertz = region->hertz_stiffness;
        return UR5E_R(1.5)*UR5E_CBRT(hertz*hertz*force);
    }
    ur5e_real most = UR5E_R(0.0);
    for (int i = 0; i < region->law_points && region->law[i].force <= force; ++i) {
        const ur5e_law_point *const point = &region->law[i];
        most = UR5E_FMAX(most, (point->knee_force - point->force)/(point->knee_depth - point->depth));
        if (i + 1 < region->law_points) {
            const ur5e_law_point *const next = &region->law[i + 1];
            most = UR5E_FMAX(most, (next->force - point->knee_force)/(next->depth - point->knee_depth));
        }
    }
    return most;
}

/* Whether three numbers rise, the last but one step maybe by nothing. */
static bool rises(ur5e_real before, ur5e_real between, ur5e_real after)
{
    return before <= between && between <= after && before < after;
}

bool ur5e_law_is_one(const ur5e_region *region)
{
    if (region->law == NULL) {
        return true;
    }
    if (region->law_points < 1 || region->law_points > UR5E_MOST_LAW_POINTS) {
        return false;
    }
    const ur5e_law_point *const law = region->law;
    bool good = !(UR5E_FABS(law[0].depth) > UR5E_R(0.0)) && !(UR5E_FABS(law[0].force) > UR5E_R(0.0));
    for (int i = 0; i < region->law_points && good; ++i) {
        const bool ends = i + 1 == region->law_points;
        good = law[i].depth < law[i].knee_depth && law[i].knee_depth <= UR5E_REAL_MAX
            && law[i].knee_force <= UR5E_REAL_MAX
            && (ends ? law[i].force < law[i].knee_force
                     : law[i].knee_depth < law[i + 1].depth
                           && rises(law[i].force, law[i].knee_force, law[i + 1].force));
    }
    return good;
}

ur5e_real ur5e_two_body_speed(const ur5e_region *region, ur5e_real mobility, ur5e_real force)
{
    return UR5E_SQRT(mobility*(force*force/region->stiffness + ur5e_law_twice_work(region, force)));
}

ur5e_real ur5e_two_body_force(const ur5e_region *region, ur5e_real mobility, ur5e_real speed)
{
    const ur5e_real spring = speed*UR5E_SQRT(region->stiffness/mobility);
    if (region->law == NULL) {
        ur5e_real force = spring;
        for (int k = 0; k < FORCE_TRIALS; ++k) {
            force *= speed/ur5e_two_body_speed(region, mobility, force);
        }
        return force;
    }
    ur5e_real low = UR5E_R(0.0);
    ur5e_real high = spring;
    for (int k = 0; k < FORCE_HALVINGS; ++k) {
        const ur5e_real middle = UR5E_R(0.5)*(low + high);
        if (ur5e_two_body_speed(region, mobility, middle) > speed) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}
