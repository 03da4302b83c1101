/* SPDX-License-Identifier: 0BSD */
/*
 * rr in C++17, over rr.h: no exceptions, no allocation.
 *
 *     rr::params p; // the defaults
 *     const auto found = rr::safe_speed(
 *         q, n, limit, region, p);
 *     if (found) use(found.value);
 */
#ifndef RR_HPP
#define RR_HPP

#include <array>
#include <cstddef>

#include "rr.h"

namespace rr {

using real = rr_real;

template <std::size_t N>
using vector = std::array<real, N>;

/* Rows. */
template <std::size_t M, std::size_t N>
using matrix = std::array<std::array<real, N>, M>;

/* What a function says, and what it has written if that is good. */
template <typename T>
struct [[nodiscard]] result {
    int status{RR_NULL_POINTER};
    T value{};

    /* Whether there is a value: the status is RR_OK, or RR_BOUNDED. */
    explicit operator bool() const noexcept
    {
        return status == RR_OK || status == RR_BOUNDED;
    }

    const char *text() const noexcept { return rr_status_text(status); }
};

/* Parameters, filled in with what is known of the model. */
struct params : rr_params {
    params() noexcept : rr_params{}
    {
        rr_default_params(this);
    }
};

/* A body region of ISO/TS 15066; OUT_OF_RANGE for others. */
inline result<rr_region> body_region(rr_body_part part, bool clamped) noexcept
{
    result<rr_region> found;
    found.status = rr_body_region(static_cast<int>(part), clamped ? 1 : 0, &found.value);
    return found;
}

/* Mass matrix M(q) of the links, without rotors.
 * M: kg m^2; links only.
 * 11 operations, 4 sines and cosines. Error: 1e-12 in double, 5e-07 in float. */
inline result<matrix<4, 4>> mass_matrix(
    const vector<4> &q) noexcept
{
    result<matrix<4, 4>> found;
    real m[4][4];
    found.status = rr_mass_matrix(q.data(), m);
    if (found) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Translational Jacobian J(q) of the contact point: velocity = J dq/dt.
 * J: m/rad; base axes.
 * 26 operations, 8 sines and cosines. Error: 1e-12 in double, 9e-07 in float. */
inline result<matrix<3, 4>> jacobian(
    const vector<4> &q) noexcept
{
    result<matrix<3, 4>> found;
    real m[3][4];
    found.status = rr_jacobian(q.data(), m);
    if (found) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Mass matrix M0 over the generalised coordinates (MSM Eq. 42).
 * M0: kg m^2.
 * Of p it reads rotor_inertia.
 * 15 operations, 4 sines and cosines. Error: 1e-12 in double, 5e-07 in float. */
inline result<matrix<4, 4>> generalised_mass_matrix(
    const vector<4> &q,
    const rr_params &p) noexcept
{
    result<matrix<4, 4>> found;
    real m[4][4];
    found.status = rr_generalised_mass_matrix(q.data(), &p, m);
    if (found) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Stiffness matrix K0 over the generalised coordinates (MSM Eq. 45).
 * K0: N m/rad.
 * Of p it reads position_gain.
 * 0 operations, 0 sines and cosines. Error: 1e-12 in double, 5e-07 in float. */
inline result<matrix<4, 4>> stiffness_matrix(
    const vector<4> &q,
    const rr_params &p) noexcept
{
    result<matrix<4, 4>> found;
    real m[4][4];
    found.status = rr_stiffness_matrix(q.data(), &p, m);
    if (found) {
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Row J_c = n'J over the generalised coordinates (MSM Eq. 4).
 * J_c: m/rad.
 * 24 operations, 8 sines and cosines. Error: 1e-12 in double, 7e-06 in float. */
inline result<vector<4>> contact_jacobian(
    const vector<4> &q,
    const vector<3> &n) noexcept
{
    result<vector<4>> found;
    found.status = rr_contact_jacobian(q.data(), n.data(), found.value.data());
    return found;
}

/* Mass m_c that the contact point feels along n (MSM Eq. 36).
 * m_c: kg; mass felt at the contact point.
 * Of p it reads rotor_inertia.
 * 92 operations, 8 sines and cosines. Error: 1e-12 in double, 9e-06 in float. */
inline result<real> reflected_mass(
    const vector<4> &q,
    const vector<3> &n,
    const rr_params &p) noexcept
{
    result<real> found;
    found.status = rr_reflected_mass(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Two masses and a spring that stand for the robot along n (MSM Eq. 36-38).
 * Of p it reads rotor_inertia and position_gain.
 * 235 operations, 8 sines and cosines. Error: 1e-12 in double, 2e-05 in float. */
inline result<rr_reduced_model_t> reduced_model(
    const vector<4> &q,
    const vector<3> &n,
    const rr_params &p) noexcept
{
    result<rr_reduced_model_t> found;
    found.status = rr_reduced_model(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Chain of 3 masses that stands for the robot along n.
 * Of p it reads rotor_inertia and position_gain.
 * 255 operations, 8 sines and cosines. Error: 1e-12 in double, 0.0003 in float. */
inline result<rr_chain_t> chain(
    const vector<4> &q,
    const vector<3> &n,
    const rr_params &p) noexcept
{
    result<rr_chain_t> found;
    found.status = rr_chain(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Impulses of an impact on the robot with rigid joints (GIAF Eq. 14, derived anew).
 * speed: m/s, > 0; of approach along n.
 * restitution: dimensionless, from 0 to 1; e: 0 no rebound, 1 elastic.
 * other_mobility: 1/kg, >= 0; 1/mass of what is hit; 0 if it is held.
 * Of p it reads rotor_inertia.
 * 127 operations, 8 sines and cosines. Error: 1e-12 in double, 2e-05 in float. */
inline result<rr_joint_impulse_t> joint_impulse(
    const vector<4> &q,
    const vector<3> &n,
    real speed,
    real restitution,
    real other_mobility,
    const rr_params &p) noexcept
{
    result<rr_joint_impulse_t> found;
    found.status = rr_joint_impulse(q.data(), n.data(), speed, restitution, other_mobility, &p, &found.value);
    return found;
}

/* Largest force over all contacts with a body region, from first touch to p->horizon.
 * speed: m/s, > 0; of the contact point along n. Joints arrive with the velocities of least norm
 * that move it along n alone; springs are at rest. Motors do as p->motors and p->reaction_time
 * say.
 * Error: 0.002 in double and in float. RR_BOUNDED: the force is a bound that none exceeds. */
inline result<rr_peak_force_t> peak_force(
    const vector<4> &q,
    const vector<3> &n,
    real speed,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_peak_force_t> found;
    found.status = rr_peak_force(q.data(), n.data(), speed, &region, &p, &found.value);
    return found;
}

/* The same of another contact point, a rr_point. */
inline result<rr_peak_force_t> peak_force_at(
    const vector<4> &q,
    int point,
    const vector<3> &n,
    real speed,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_peak_force_t> found;
    found.status = rr_peak_force_at(q.data(), point, n.data(), speed, &region, &p, &found.value);
    return found;
}

/* Speed along n up to which impacts keep a limit, found by integrating impacts: the force at the
 * speed
 * that is returned is 1 to 2.3 % below the limit (up to 3.8 % on bodies that damp hard), or jumps
 * over it
 * with little more speed. That slower speeds press less is searched for, not proven.
 * limit: N, > 0. RR_BOUNDED: the search did not end. The speed keeps the limit by its own impact,
 * or
 * by a proven bound; a greater one may, too. */
inline result<rr_safe_speed_t> safe_speed(
    const vector<4> &q,
    const vector<3> &n,
    real limit,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_safe_speed_t> found;
    found.status = rr_safe_speed(q.data(), n.data(), limit, &region, &p, &found.value);
    return found;
}

/* The same of another contact point, a rr_point. */
inline result<rr_safe_speed_t> safe_speed_at(
    const vector<4> &q,
    int point,
    const vector<3> &n,
    real limit,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_safe_speed_t> found;
    found.status = rr_safe_speed_at(q.data(), point, n.data(), limit, &region, &p, &found.value);
    return found;
}

/* By how much to slow down the present motion so that no contact point exceeds a limit, each
 * hitting in
 * the direction in which it moves. One call a control cycle.
 * dq: joint velocities. limit: N, > 0. RR_BOUNDED: as for rr_safe_speed. */
inline result<rr_speed_factor_t> speed_factor(
    const vector<4> &q,
    const vector<4> &dq,
    real limit,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_speed_factor_t> found;
    found.status = rr_speed_factor(q.data(), dq.data(), limit, &region, &p, &found.value);
    return found;
}

/* Largest force with which a point presses on a clamped body from 0.5 to 0.6 s after first touch,
 * when the
 * quasi-static limit counts; 0 on one that gives way. p->horizon does not matter.
 * RR_BOUNDED: the force is a bound that none exceeds. */
inline result<real> pressing_force_at(
    const vector<4> &q,
    int point,
    const vector<3> &n,
    real speed,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<real> found;
    found.status = rr_pressing_force_at(q.data(), point, n.data(), speed, &region, &p, &found.value);
    return found;
}

/* As rr_peak_force and rr_safe_speed, of a place (m) in a frame, a rr_frame. */
inline result<rr_peak_force_t> peak_force_on(
    const vector<4> &q,
    int frame,
    const vector<3> &place,
    const vector<3> &n,
    real speed,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_peak_force_t> found;
    found.status = rr_peak_force_on(q.data(), frame, place.data(), n.data(), speed, &region, &p, &found.value);
    return found;
}

inline result<rr_safe_speed_t> safe_speed_on(
    const vector<4> &q,
    int frame,
    const vector<3> &place,
    const vector<3> &n,
    real limit,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_safe_speed_t> found;
    found.status = rr_safe_speed_on(q.data(), frame, place.data(), n.data(), limit, &region, &p, &found.value);
    return found;
}

/* The direction in which a contact point (rr_point) hits hardest at a speed, among those in which
 * the
 * robot can go at this pose: some 300 impacts, each with a budget of p->steps; not for a control
 * loop. The
 * error is estimated by what looking closer brought, and held in tests against thousands of
 * directions. Where the
 * impacts of some direction cannot be followed to their end (RR_BOUNDED), the force is one that no
 * direction
 * exceeds, and n the hardest direction that was seen. */
inline result<rr_worst_direction_t> worst_direction_at(
    const vector<4> &q,
    int point,
    real speed,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_worst_direction_t> found;
    found.status = rr_worst_direction_at(q.data(), point, speed, &region, &p, &found.value);
    return found;
}

/* The same of a place (m) in a frame, a rr_frame. */
inline result<rr_worst_direction_t> worst_direction_on(
    const vector<4> &q,
    int frame,
    const vector<3> &place,
    real speed,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_worst_direction_t> found;
    found.status = rr_worst_direction_on(q.data(), frame, place.data(), speed, &region, &p, &found.value);
    return found;
}

/* As rr_safe_speed_at, for all limits of a region: region->force_limit up to the horizon and,
 * clamped,
 * region->quasi_static_limit from 0.5 to 0.6 s, and from 0.25 to 0.62 s once they parted and met
 * again: at slower
 * speeds they meet later. If something may press then, ten slower speeds are tried, too.
 * RR_UNRESOLVED if no
 * speed is known to keep both. */
inline result<rr_allowed_speed_t> allowed_speed_at(
    const vector<4> &q,
    int point,
    const vector<3> &n,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_allowed_speed_t> found;
    found.status = rr_allowed_speed_at(q.data(), point, n.data(), &region, &p, &found.value);
    return found;
}

/* As rr_speed_factor, for all limits of a region. */
inline result<rr_allowed_factor_t> allowed_factor(
    const vector<4> &q,
    const vector<4> &dq,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<rr_allowed_factor_t> found;
    found.status = rr_allowed_factor(q.data(), dq.data(), &region, &p, &found.value);
    return found;
}

/* Whether a contact point that moves as joints do might press on a clamped body harder than a
 * limit from
 * 0.5 to 0.6 s, or in contacts after the first from 0.25 to 0.62 s: 0 where it is proven or
 * integrated that none does. */
inline result<int> may_press(
    const vector<4> &q,
    const vector<4> &dq,
    real limit,
    const rr_region &region,
    const rr_params &p) noexcept
{
    result<int> found;
    found.status = rr_may_press(q.data(), dq.data(), limit, &region, &p, &found.value);
    return found;
}

} // namespace rr

#endif
