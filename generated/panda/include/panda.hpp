/* SPDX-License-Identifier: 0BSD */
/*
 * panda in C++17, over panda.h: no exceptions, no allocation.
 *
 *     panda::params p; // the defaults
 *     const auto found = panda::safe_speed(
 *         q, n, limit, region, p);
 *     if (found) use(found.value);
 */
#ifndef PANDA_HPP
#define PANDA_HPP

#include <array>
#include <cstddef>

#include "panda.h"

namespace panda {

using real = panda_real;

template <std::size_t N>
using vector = std::array<real, N>;

/* Rows. */
template <std::size_t M, std::size_t N>
using matrix = std::array<std::array<real, N>, M>;

/* What a function says, and what it has written if that is good. */
template <typename T>
struct [[nodiscard]] result {
    int status{PANDA_NULL_POINTER};
    T value{};

    /* Whether there is a value: the status is PANDA_OK, or PANDA_BOUNDED. */
    explicit operator bool() const noexcept
    {
        return status == PANDA_OK || status == PANDA_BOUNDED;
    }

    const char *text() const noexcept { return panda_status_text(status); }
};

/* Parameters, filled in with what is known of the model. */
struct params : panda_params {
    params() noexcept : panda_params{}
    {
        panda_default_params(this);
    }
};

/* A body region of ISO/TS 15066; OUT_OF_RANGE for others. */
inline result<panda_region> body_region(panda_body_part part, bool clamped) noexcept
{
    result<panda_region> found;
    found.status = panda_body_region(static_cast<int>(part), clamped ? 1 : 0, &found.value);
    return found;
}

/* Mass matrix M(q) of the links, without rotors.
 * M: kg m^2; links only.
 * 320 operations, 12 sines and cosines. Error: 1e-12 in double, 2e-06 in float. */
inline result<matrix<7, 7>> mass_matrix(
    const vector<7> &q) noexcept
{
    result<matrix<7, 7>> found;
    real m[7][7];
    found.status = panda_mass_matrix(q.data(), m);
    if (found) {
        for (std::size_t i = 0; i < 7; ++i) {
            for (std::size_t j = 0; j < 7; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Translational Jacobian J(q) of the contact point: velocity = J dq/dt.
 * J: m/rad; base axes.
 * 173 operations, 12 sines and cosines. Error: 1e-12 in double, 2e-06 in float. */
inline result<matrix<3, 7>> jacobian(
    const vector<7> &q) noexcept
{
    result<matrix<3, 7>> found;
    real m[3][7];
    found.status = panda_jacobian(q.data(), m);
    if (found) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 7; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Mass matrix M0 over the generalised coordinates (MSM Eq. 42).
 * M0: kg m^2.
 * Of p it reads rotor_inertia.
 * 327 operations, 12 sines and cosines. Error: 1e-12 in double, 2e-06 in float. */
inline result<matrix<14, 14>> generalised_mass_matrix(
    const vector<7> &q,
    const panda_params &p) noexcept
{
    result<matrix<14, 14>> found;
    real m[14][14];
    found.status = panda_generalised_mass_matrix(q.data(), &p, m);
    if (found) {
        for (std::size_t i = 0; i < 14; ++i) {
            for (std::size_t j = 0; j < 14; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Stiffness matrix K0 over the generalised coordinates (MSM Eq. 45).
 * K0: N m/rad.
 * Of p it reads joint_stiffness and position_gain.
 * 0 operations, 0 sines and cosines. Error: 1e-12 in double, 5e-07 in float. */
inline result<matrix<14, 14>> stiffness_matrix(
    const vector<7> &q,
    const panda_params &p) noexcept
{
    result<matrix<14, 14>> found;
    real m[14][14];
    found.status = panda_stiffness_matrix(q.data(), &p, m);
    if (found) {
        for (std::size_t i = 0; i < 14; ++i) {
            for (std::size_t j = 0; j < 14; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Row J_c = n'J over the generalised coordinates (MSM Eq. 4).
 * J_c: m/rad.
 * 96 operations, 14 sines and cosines. Error: 1e-12 in double, 3e-06 in float. */
inline result<vector<14>> contact_jacobian(
    const vector<7> &q,
    const vector<3> &n) noexcept
{
    result<vector<14>> found;
    found.status = panda_contact_jacobian(q.data(), n.data(), found.value.data());
    return found;
}

/* Mass m_c that the contact point feels along n (MSM Eq. 36).
 * m_c: kg; mass felt at the contact point.
 * 612 operations, 14 sines and cosines. Error: 1e-12 in double, 4e-06 in float. */
inline result<real> reflected_mass(
    const vector<7> &q,
    const vector<3> &n) noexcept
{
    result<real> found;
    found.status = panda_reflected_mass(q.data(), n.data(), &found.value);
    return found;
}

/* Two masses and a spring that stand for the robot along n (MSM Eq. 36-38).
 * Of p it reads joint_stiffness and rotor_inertia and position_gain.
 * 1001 operations, 14 sines and cosines. Error: 1e-12 in double, 2e-05 in float. */
inline result<panda_reduced_model_t> reduced_model(
    const vector<7> &q,
    const vector<3> &n,
    const panda_params &p) noexcept
{
    result<panda_reduced_model_t> found;
    found.status = panda_reduced_model(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Chain of 3 masses that stands for the robot along n.
 * Of p it reads joint_stiffness and rotor_inertia and position_gain.
 * 1147 operations, 14 sines and cosines. Error: 1e-12 in double, 0.0006 in float. */
inline result<panda_chain_t> chain(
    const vector<7> &q,
    const vector<3> &n,
    const panda_params &p) noexcept
{
    result<panda_chain_t> found;
    found.status = panda_chain(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Operational space inertias of the contact point, in the base's axes.
 * Of p it reads rotor_inertia.
 * 1244 operations, 14 sines and cosines. Error: 1e-12 in double, 0.0002 in float. */
inline result<panda_osim_t> osim(
    const vector<7> &q,
    const panda_params &p) noexcept
{
    result<panda_osim_t> found;
    found.status = panda_osim(q.data(), &p, &found.value);
    return found;
}

/* Generalised impact factors.
 * Of p it reads rotor_inertia.
 * 1174 operations, 12 sines and cosines. Error: 1e-12 in double, 3e-06 in float. */
inline result<panda_giaf_t> giaf(
    const vector<7> &q,
    const panda_params &p) noexcept
{
    result<panda_giaf_t> found;
    found.status = panda_giaf(q.data(), &p, &found.value);
    return found;
}

/* Share of the inertia along n that is not the rotors' (GIAF Eq. 29).
 * giaf: dimensionless; 1 if rotors do not count.
 * Of p it reads rotor_inertia.
 * 1273 operations, 14 sines and cosines. Error: 1e-12 in double, 3e-05 in float. */
inline result<real> directional_giaf(
    const vector<7> &q,
    const vector<3> &n,
    const panda_params &p) noexcept
{
    result<real> found;
    found.status = panda_directional_giaf(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Directions of least and greatest absorption, base axes (GIAF Eq. 29).
 * Of p it reads rotor_inertia.
 * 1882 operations, 14 sines and cosines. Error: 1e-12 in double, 6e-05 in float. */
inline result<panda_absorption_extremes_t> absorption_extremes(
    const vector<7> &q,
    const panda_params &p) noexcept
{
    result<panda_absorption_extremes_t> found;
    found.status = panda_absorption_extremes(q.data(), &p, &found.value);
    return found;
}

/* Manipulability and the matrix of its ellipsoid {(J J')^(1/2) u: |u| <= 1}.
 * 330 operations, 12 sines and cosines. Error: 1e-12 in double, 3e-06 in float. */
inline result<panda_manipulability_t> manipulability(
    const vector<7> &q) noexcept
{
    result<panda_manipulability_t> found;
    found.status = panda_manipulability(q.data(), &found.value);
    return found;
}

/* Force measure 1/omega_m (GIAF Eq. 3).
 * omega_f: rad^3/m^3.
 * 296 operations, 12 sines and cosines. Error: 1e-12 in double, 7e-06 in float. */
inline result<real> force_measure(
    const vector<7> &q) noexcept
{
    result<real> found;
    found.status = panda_force_measure(q.data(), &found.value);
    return found;
}

/* Dynamic impact measure and the matrix of its ellipsoid, with rotors (GIAF Eq. 15).
 * Of p it reads rotor_inertia.
 * 1122 operations, 14 sines and cosines. Error: 1e-12 in double, 0.0001 in float. */
inline result<panda_impact_measure_t> impact_measure(
    const vector<7> &q,
    const panda_params &p) noexcept
{
    result<panda_impact_measure_t> found;
    found.status = panda_impact_measure(q.data(), &p, &found.value);
    return found;
}

/* What each rotor and gear does to the absorption factor (GIAF III).
 * Of p it reads rotor_inertia.
 * 1530 operations, 14 sines and cosines. Error: 1e-12 in double, 9e-05 in float. */
inline result<panda_rotor_influence_t> rotor_influence(
    const vector<7> &q,
    const panda_params &p) noexcept
{
    result<panda_rotor_influence_t> found;
    found.status = panda_rotor_influence(q.data(), &p, &found.value);
    return found;
}

/* Absorption factor of each joint alone (GIAF III.B).
 * giaf: dimensionless; with the rotor of each joint alone.
 * Of p it reads rotor_inertia.
 * 1294 operations, 14 sines and cosines. Error: 1e-12 in double, 3e-05 in float. */
inline result<vector<7>> single_joint_giaf(
    const vector<7> &q,
    const panda_params &p) noexcept
{
    result<vector<7>> found;
    found.status = panda_single_joint_giaf(q.data(), &p, found.value.data());
    return found;
}

/* Impulses of an impact on the robot with rigid joints (GIAF Eq. 14, derived anew).
 * speed: m/s, > 0; of approach along n.
 * restitution: dimensionless, from 0 to 1; e: 0 no rebound, 1 elastic.
 * other_mobility: 1/kg, >= 0; 1/mass of what is hit; 0 if it is held.
 * Of p it reads rotor_inertia.
 * 696 operations, 14 sines and cosines. Error: 1e-12 in double, 5e-06 in float. */
inline result<panda_joint_impulse_t> joint_impulse(
    const vector<7> &q,
    const vector<3> &n,
    real speed,
    real restitution,
    real other_mobility,
    const panda_params &p) noexcept
{
    result<panda_joint_impulse_t> found;
    found.status = panda_joint_impulse(q.data(), n.data(), speed, restitution, other_mobility, &p, &found.value);
    return found;
}

/* Share of the force by which the linear robot may be off at an impact.
 * error: dimensionless; share of the force.
 * speed: m/s, > 0; of approach along n.
 * duration: s, >= 0; from first touch to the peak, or to the reaction.
 * 2290 operations, 28 sines and cosines. Error: 1e-12 in double, 0.0003 in float. */
inline result<real> linear_error(
    const vector<7> &q,
    const vector<3> &n,
    real speed,
    real duration) noexcept
{
    result<real> found;
    found.status = panda_linear_error(q.data(), n.data(), speed, duration, &found.value);
    return found;
}

/* Largest force over all contacts with a body region, from first touch to p->horizon.
 * speed: m/s, > 0; of the contact point along n. Joints arrive with the velocities of least norm
 * that move it along n alone; springs are at rest. Motors do as p->motors and p->reaction_time
 * say.
 * Error: 0.002 in double and in float. PANDA_BOUNDED: the force is a bound that none exceeds. */
inline result<panda_peak_force_t> peak_force(
    const vector<7> &q,
    const vector<3> &n,
    real speed,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_peak_force_t> found;
    found.status = panda_peak_force(q.data(), n.data(), speed, &region, &p, &found.value);
    return found;
}

/* The same of another contact point, a panda_point. */
inline result<panda_peak_force_t> peak_force_at(
    const vector<7> &q,
    int point,
    const vector<3> &n,
    real speed,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_peak_force_t> found;
    found.status = panda_peak_force_at(q.data(), point, n.data(), speed, &region, &p, &found.value);
    return found;
}

/* Speed along n up to which impacts keep a limit, found by integrating impacts: the force at the
 * speed
 * that is returned is 1 to 2.3 % below the limit (up to 3.8 % on bodies that damp hard), or jumps
 * over it
 * with little more speed. That slower speeds press less is searched for, not proven.
 * limit: N, > 0. PANDA_BOUNDED: the search did not end. The speed keeps the limit by its own
 * impact, or
 * by a proven bound; a greater one may, too. */
inline result<panda_safe_speed_t> safe_speed(
    const vector<7> &q,
    const vector<3> &n,
    real limit,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_safe_speed_t> found;
    found.status = panda_safe_speed(q.data(), n.data(), limit, &region, &p, &found.value);
    return found;
}

/* The same of another contact point, a panda_point. */
inline result<panda_safe_speed_t> safe_speed_at(
    const vector<7> &q,
    int point,
    const vector<3> &n,
    real limit,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_safe_speed_t> found;
    found.status = panda_safe_speed_at(q.data(), point, n.data(), limit, &region, &p, &found.value);
    return found;
}

/* By how much to slow down the present motion so that no contact point exceeds a limit, each
 * hitting in
 * the direction in which it moves. One call a control cycle.
 * dq: joint velocities. limit: N, > 0. PANDA_BOUNDED: as for panda_safe_speed. */
inline result<panda_speed_factor_t> speed_factor(
    const vector<7> &q,
    const vector<7> &dq,
    real limit,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_speed_factor_t> found;
    found.status = panda_speed_factor(q.data(), dq.data(), limit, &region, &p, &found.value);
    return found;
}

/* Largest force with which a point presses on a clamped body from 0.5 to 0.6 s after first touch,
 * when the
 * quasi-static limit counts; 0 on one that gives way. p->horizon does not matter.
 * PANDA_BOUNDED: the force is a bound that none exceeds. */
inline result<real> pressing_force_at(
    const vector<7> &q,
    int point,
    const vector<3> &n,
    real speed,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<real> found;
    found.status = panda_pressing_force_at(q.data(), point, n.data(), speed, &region, &p, &found.value);
    return found;
}

/* As panda_peak_force and panda_safe_speed, of a place (m) in a frame, a panda_frame. */
inline result<panda_peak_force_t> peak_force_on(
    const vector<7> &q,
    int frame,
    const vector<3> &place,
    const vector<3> &n,
    real speed,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_peak_force_t> found;
    found.status = panda_peak_force_on(q.data(), frame, place.data(), n.data(), speed, &region, &p, &found.value);
    return found;
}

inline result<panda_safe_speed_t> safe_speed_on(
    const vector<7> &q,
    int frame,
    const vector<3> &place,
    const vector<3> &n,
    real limit,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_safe_speed_t> found;
    found.status = panda_safe_speed_on(q.data(), frame, place.data(), n.data(), limit, &region, &p, &found.value);
    return found;
}

/* The direction in which a contact point (panda_point) hits hardest at a speed, among those in
 * which the
 * robot can go at this pose: some 300 impacts, each with a budget of p->steps; not for a control
 * loop. The
 * error is estimated by what looking closer brought, and held in tests against thousands of
 * directions. Where the
 * impacts of some direction cannot be followed to their end (PANDA_BOUNDED), the force is one that
 * no direction
 * exceeds, and n the hardest direction that was seen. */
inline result<panda_worst_direction_t> worst_direction_at(
    const vector<7> &q,
    int point,
    real speed,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_worst_direction_t> found;
    found.status = panda_worst_direction_at(q.data(), point, speed, &region, &p, &found.value);
    return found;
}

/* The same of a place (m) in a frame, a panda_frame. */
inline result<panda_worst_direction_t> worst_direction_on(
    const vector<7> &q,
    int frame,
    const vector<3> &place,
    real speed,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_worst_direction_t> found;
    found.status = panda_worst_direction_on(q.data(), frame, place.data(), speed, &region, &p, &found.value);
    return found;
}

/* As panda_safe_speed_at, for all limits of a region: region->force_limit up to the horizon and,
 * clamped,
 * region->quasi_static_limit from 0.5 to 0.6 s, and from 0.25 to 0.62 s once they parted and met
 * again: at slower
 * speeds they meet later. If something may press then, ten slower speeds are tried, too.
 * PANDA_UNRESOLVED if no
 * speed is known to keep both. */
inline result<panda_allowed_speed_t> allowed_speed_at(
    const vector<7> &q,
    int point,
    const vector<3> &n,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_allowed_speed_t> found;
    found.status = panda_allowed_speed_at(q.data(), point, n.data(), &region, &p, &found.value);
    return found;
}

/* As panda_speed_factor, for all limits of a region. */
inline result<panda_allowed_factor_t> allowed_factor(
    const vector<7> &q,
    const vector<7> &dq,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<panda_allowed_factor_t> found;
    found.status = panda_allowed_factor(q.data(), dq.data(), &region, &p, &found.value);
    return found;
}

/* Whether a contact point that moves as joints do might press on a clamped body harder than a
 * limit from
 * 0.5 to 0.6 s, or in contacts after the first from 0.25 to 0.62 s: 0 where it is proven or
 * integrated that none does. */
inline result<int> may_press(
    const vector<7> &q,
    const vector<7> &dq,
    real limit,
    const panda_region &region,
    const panda_params &p) noexcept
{
    result<int> found;
    found.status = panda_may_press(q.data(), dq.data(), limit, &region, &p, &found.value);
    return found;
}

} // namespace panda

#endif
