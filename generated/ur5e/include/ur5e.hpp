/* SPDX-License-Identifier: 0BSD */
/*
 * ur5e in C++17, over ur5e.h: no exceptions, no allocation.
 *
 *     ur5e::params p; // the defaults
 *     const auto found = ur5e::safe_speed(
 *         q, n, limit, region, p);
 *     if (found) use(found.value);
 */
#ifndef UR5E_HPP
#define UR5E_HPP

#include <array>
#include <cstddef>

#include "ur5e.h"

namespace ur5e {

using real = ur5e_real;

template <std::size_t N>
using vector = std::array<real, N>;

/* Rows. */
template <std::size_t M, std::size_t N>
using matrix = std::array<std::array<real, N>, M>;

/* What a function says, and what it has written if that is good. */
template <typename T>
struct [[nodiscard]] result {
    int status{UR5E_NULL_POINTER};
    T value{};

    /* Whether there is a value: the status is UR5E_OK, or UR5E_BOUNDED. */
    explicit operator bool() const noexcept
    {
        return status == UR5E_OK || status == UR5E_BOUNDED;
    }

    const char *text() const noexcept { return ur5e_status_text(status); }
};

/* Parameters, filled in with what is known of the model. */
struct params : ur5e_params {
    params() noexcept : ur5e_params{}
    {
        ur5e_default_params(this);
    }
};

/* A body region of ISO/TS 15066; OUT_OF_RANGE for others. */
inline result<ur5e_region> body_region(ur5e_body_part part, bool clamped) noexcept
{
    result<ur5e_region> found;
    found.status = ur5e_body_region(static_cast<int>(part), clamped ? 1 : 0, &found.value);
    return found;
}

/* Mass matrix M(q) of the links, without rotors.
 * M: kg m^2; links only.
 * 197 operations, 10 sines and cosines. Error: 1e-12 in double, 2e-06 in float. */
inline result<matrix<6, 6>> mass_matrix(
    const vector<6> &q) noexcept
{
    result<matrix<6, 6>> found;
    real m[6][6];
    found.status = ur5e_mass_matrix(q.data(), m);
    if (found) {
        for (std::size_t i = 0; i < 6; ++i) {
            for (std::size_t j = 0; j < 6; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Translational Jacobian J(q) of the contact point: velocity = J dq/dt.
 * J: m/rad; base axes.
 * 126 operations, 10 sines and cosines. Error: 1e-12 in double, 2e-06 in float. */
inline result<matrix<3, 6>> jacobian(
    const vector<6> &q) noexcept
{
    result<matrix<3, 6>> found;
    real m[3][6];
    found.status = ur5e_jacobian(q.data(), m);
    if (found) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 6; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Mass matrix M0 over the generalised coordinates (MSM Eq. 42).
 * M0: kg m^2.
 * Of p it reads rotor_inertia.
 * 203 operations, 10 sines and cosines. Error: 1e-12 in double, 9e-07 in float. */
inline result<matrix<12, 12>> generalised_mass_matrix(
    const vector<6> &q,
    const ur5e_params &p) noexcept
{
    result<matrix<12, 12>> found;
    real m[12][12];
    found.status = ur5e_generalised_mass_matrix(q.data(), &p, m);
    if (found) {
        for (std::size_t i = 0; i < 12; ++i) {
            for (std::size_t j = 0; j < 12; ++j) {
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
inline result<matrix<12, 12>> stiffness_matrix(
    const vector<6> &q,
    const ur5e_params &p) noexcept
{
    result<matrix<12, 12>> found;
    real m[12][12];
    found.status = ur5e_stiffness_matrix(q.data(), &p, m);
    if (found) {
        for (std::size_t i = 0; i < 12; ++i) {
            for (std::size_t j = 0; j < 12; ++j) {
                found.value[i][j] = m[i][j];
            }
        }
    }
    return found;
}

/* Row J_c = n'J over the generalised coordinates (MSM Eq. 4).
 * J_c: m/rad.
 * 81 operations, 12 sines and cosines. Error: 1e-12 in double, 3e-06 in float. */
inline result<vector<12>> contact_jacobian(
    const vector<6> &q,
    const vector<3> &n) noexcept
{
    result<vector<12>> found;
    found.status = ur5e_contact_jacobian(q.data(), n.data(), found.value.data());
    return found;
}

/* Mass m_c that the contact point feels along n (MSM Eq. 36).
 * m_c: kg; mass felt at the contact point.
 * 414 operations, 12 sines and cosines. Error: 1e-12 in double, 4e-06 in float. */
inline result<real> reflected_mass(
    const vector<6> &q,
    const vector<3> &n) noexcept
{
    result<real> found;
    found.status = ur5e_reflected_mass(q.data(), n.data(), &found.value);
    return found;
}

/* Two masses and a spring that stand for the robot along n (MSM Eq. 36-38).
 * Of p it reads joint_stiffness and rotor_inertia and position_gain.
 * 728 operations, 12 sines and cosines. Error: 1e-12 in double, 2e-05 in float. */
inline result<ur5e_reduced_model_t> reduced_model(
    const vector<6> &q,
    const vector<3> &n,
    const ur5e_params &p) noexcept
{
    result<ur5e_reduced_model_t> found;
    found.status = ur5e_reduced_model(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Chain of 3 masses that stands for the robot along n.
 * Of p it reads joint_stiffness and rotor_inertia and position_gain.
 * 842 operations, 12 sines and cosines. Error: 3e-12 in double, 0.007 in float. */
inline result<ur5e_chain_t> chain(
    const vector<6> &q,
    const vector<3> &n,
    const ur5e_params &p) noexcept
{
    result<ur5e_chain_t> found;
    found.status = ur5e_chain(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Operational space inertias of the contact point, in the base's axes.
 * Of p it reads rotor_inertia.
 * 880 operations, 12 sines and cosines. Error: 1e-12 in double, 0.0002 in float. */
inline result<ur5e_osim_t> osim(
    const vector<6> &q,
    const ur5e_params &p) noexcept
{
    result<ur5e_osim_t> found;
    found.status = ur5e_osim(q.data(), &p, &found.value);
    return found;
}

/* Generalised impact factors.
 * Of p it reads rotor_inertia.
 * 795 operations, 10 sines and cosines. Error: 1e-12 in double, 2e-05 in float. */
inline result<ur5e_giaf_t> giaf(
    const vector<6> &q,
    const ur5e_params &p) noexcept
{
    result<ur5e_giaf_t> found;
    found.status = ur5e_giaf(q.data(), &p, &found.value);
    return found;
}

/* Share of the inertia along n that is not the rotors' (GIAF Eq. 29).
 * giaf: dimensionless; 1 if rotors do not count.
 * Of p it reads rotor_inertia.
 * 905 operations, 12 sines and cosines. Error: 1e-12 in double, 2e-05 in float. */
inline result<real> directional_giaf(
    const vector<6> &q,
    const vector<3> &n,
    const ur5e_params &p) noexcept
{
    result<real> found;
    found.status = ur5e_directional_giaf(q.data(), n.data(), &p, &found.value);
    return found;
}

/* Directions of least and greatest absorption, base axes (GIAF Eq. 29).
 * Of p it reads rotor_inertia.
 * 1516 operations, 12 sines and cosines. Error: 1e-12 in double, 7e-05 in float. */
inline result<ur5e_absorption_extremes_t> absorption_extremes(
    const vector<6> &q,
    const ur5e_params &p) noexcept
{
    result<ur5e_absorption_extremes_t> found;
    found.status = ur5e_absorption_extremes(q.data(), &p, &found.value);
    return found;
}

/* Manipulability and the matrix of its ellipsoid {(J J')^(1/2) u: |u| <= 1}.
 * 255 operations, 10 sines and cosines. Error: 1e-12 in double, 3e-06 in float. */
inline result<ur5e_manipulability_t> manipulability(
    const vector<6> &q) noexcept
{
    result<ur5e_manipulability_t> found;
    found.status = ur5e_manipulability(q.data(), &found.value);
    return found;
}

/* Force measure 1/omega_m (GIAF Eq. 3).
 * omega_f: rad^3/m^3.
 * 226 operations, 10 sines and cosines. Error: 1e-12 in double, 8e-06 in float. */
inline result<real> force_measure(
    const vector<6> &q) noexcept
{
    result<real> found;
    found.status = ur5e_force_measure(q.data(), &found.value);
    return found;
}

/* Dynamic impact measure and the matrix of its ellipsoid, with rotors (GIAF Eq. 15).
 * Of p it reads rotor_inertia.
 * 818 operations, 12 sines and cosines. Error: 1e-12 in double, 6e-05 in float. */
inline result<ur5e_impact_measure_t> impact_measure(
    const vector<6> &q,
    const ur5e_params &p) noexcept
{
    result<ur5e_impact_measure_t> found;
    found.status = ur5e_impact_measure(q.data(), &p, &found.value);
    return found;
}

/* What each rotor and gear does to the absorption factor (GIAF III).
 * Of p it reads rotor_inertia.
 * 1101 operations, 12 sines and cosines. Error: 1e-12 in double, 0.0002 in float. */
inline result<ur5e_rotor_influence_t> rotor_influence(
    const vector<6> &q,
    const ur5e_params &p) noexcept
{
    result<ur5e_rotor_influence_t> found;
    found.status = ur5e_rotor_influence(q.data(), &p, &found.value);
    return found;
}

/* Absorption factor of each joint alone (GIAF III.B).
 * giaf: dimensionless; with the rotor of each joint alone.
 * Of p it reads rotor_inertia.
 * 916 operations, 12 sines and cosines. Error: 1e-12 in double, 9e-05 in float. */
inline result<vector<6>> single_joint_giaf(
    const vector<6> &q,
    const ur5e_params &p) noexcept
{
    result<vector<6>> found;
    found.status = ur5e_single_joint_giaf(q.data(), &p, found.value.data());
    return found;
}

/* Impulses of an impact on the robot with rigid joints (GIAF Eq. 14, derived anew).
 * speed: m/s, > 0; of approach along n.
 * restitution: dimensionless, from 0 to 1; e: 0 no rebound, 1 elastic.
 * other_mobility: 1/kg, >= 0; 1/mass of what is hit; 0 if it is held.
 * Of p it reads rotor_inertia.
 * 480 operations, 12 sines and cosines. Error: 1e-12 in double, 5e-06 in float. */
inline result<ur5e_joint_impulse_t> joint_impulse(
    const vector<6> &q,
    const vector<3> &n,
    real speed,
    real restitution,
    real other_mobility,
    const ur5e_params &p) noexcept
{
    result<ur5e_joint_impulse_t> found;
    found.status = ur5e_joint_impulse(q.data(), n.data(), speed, restitution, other_mobility, &p, &found.value);
    return found;
}

/* Share of the force by which the linear robot may be off at an impact.
 * error: dimensionless; share of the force.
 * speed: m/s, > 0; of approach along n.
 * duration: s, >= 0; from first touch to the peak, or to the reaction.
 * 1624 operations, 24 sines and cosines. Error: 1e-12 in double, 0.0001 in float. */
inline result<real> linear_error(
    const vector<6> &q,
    const vector<3> &n,
    real speed,
    real duration) noexcept
{
    result<real> found;
    found.status = ur5e_linear_error(q.data(), n.data(), speed, duration, &found.value);
    return found;
}

/* Largest force over all contacts with a body region, from first touch to p->horizon.
 * speed: m/s, > 0; of the contact point along n. Joints arrive with the velocities of least norm
 * that move it along n alone; springs are at rest. Motors do as p->motors and p->reaction_time
 * say.
 * Error: 0.002 in double and in float. UR5E_BOUNDED: the force is a bound that none exceeds. */
inline result<ur5e_peak_force_t> peak_force(
    const vector<6> &q,
    const vector<3> &n,
    real speed,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_peak_force_t> found;
    found.status = ur5e_peak_force(q.data(), n.data(), speed, &region, &p, &found.value);
    return found;
}

/* The same of another contact point, a ur5e_point. */
inline result<ur5e_peak_force_t> peak_force_at(
    const vector<6> &q,
    int point,
    const vector<3> &n,
    real speed,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_peak_force_t> found;
    found.status = ur5e_peak_force_at(q.data(), point, n.data(), speed, &region, &p, &found.value);
    return found;
}

/* Speed along n up to which impacts keep a limit, found by integrating impacts: the force at the
 * speed
 * that is returned is 1 to 2.3 % below the limit (up to 3.8 % on bodies that damp hard), or jumps
 * over it
 * with little more speed. That slower speeds press less is searched for, not proven.
 * limit: N, > 0. UR5E_BOUNDED: the search did not end. The speed keeps the limit by its own
 * impact, or
 * by a proven bound; a greater one may, too. */
inline result<ur5e_safe_speed_t> safe_speed(
    const vector<6> &q,
    const vector<3> &n,
    real limit,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_safe_speed_t> found;
    found.status = ur5e_safe_speed(q.data(), n.data(), limit, &region, &p, &found.value);
    return found;
}

/* The same of another contact point, a ur5e_point. */
inline result<ur5e_safe_speed_t> safe_speed_at(
    const vector<6> &q,
    int point,
    const vector<3> &n,
    real limit,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_safe_speed_t> found;
    found.status = ur5e_safe_speed_at(q.data(), point, n.data(), limit, &region, &p, &found.value);
    return found;
}

/* By how much to slow down the present motion so that no contact point exceeds a limit, each
 * hitting in
 * the direction in which it moves. One call a control cycle.
 * dq: joint velocities. limit: N, > 0. UR5E_BOUNDED: as for ur5e_safe_speed. */
inline result<ur5e_speed_factor_t> speed_factor(
    const vector<6> &q,
    const vector<6> &dq,
    real limit,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_speed_factor_t> found;
    found.status = ur5e_speed_factor(q.data(), dq.data(), limit, &region, &p, &found.value);
    return found;
}

/* Largest force with which a point presses on a clamped body from 0.5 to 0.6 s after first touch,
 * when the
 * quasi-static limit counts; 0 on one that gives way. p->horizon does not matter.
 * UR5E_BOUNDED: the force is a bound that none exceeds. */
inline result<real> pressing_force_at(
    const vector<6> &q,
    int point,
    const vector<3> &n,
    real speed,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<real> found;
    found.status = ur5e_pressing_force_at(q.data(), point, n.data(), speed, &region, &p, &found.value);
    return found;
}

/* As ur5e_peak_force and ur5e_safe_speed, of a place (m) in a frame, a ur5e_frame. */
inline result<ur5e_peak_force_t> peak_force_on(
    const vector<6> &q,
    int frame,
    const vector<3> &place,
    const vector<3> &n,
    real speed,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_peak_force_t> found;
    found.status = ur5e_peak_force_on(q.data(), frame, place.data(), n.data(), speed, &region, &p, &found.value);
    return found;
}

inline result<ur5e_safe_speed_t> safe_speed_on(
    const vector<6> &q,
    int frame,
    const vector<3> &place,
    const vector<3> &n,
    real limit,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_safe_speed_t> found;
    found.status = ur5e_safe_speed_on(q.data(), frame, place.data(), n.data(), limit, &region, &p, &found.value);
    return found;
}

/* The direction in which a contact point (ur5e_point) hits hardest at a speed, among those in
 * which the
 * robot can go at this pose: some 300 impacts, each with a budget of p->steps; not for a control
 * loop. The
 * error is estimated by what looking closer brought, and held in tests against thousands of
 * directions. Where the
 * impacts of some direction cannot be followed to their end (UR5E_BOUNDED), the force is one that
 * no direction
 * exceeds, and n the hardest direction that was seen. */
inline result<ur5e_worst_direction_t> worst_direction_at(
    const vector<6> &q,
    int point,
    real speed,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_worst_direction_t> found;
    found.status = ur5e_worst_direction_at(q.data(), point, speed, &region, &p, &found.value);
    return found;
}

/* The same of a place (m) in a frame, a ur5e_frame. */
inline result<ur5e_worst_direction_t> worst_direction_on(
    const vector<6> &q,
    int frame,
    const vector<3> &place,
    real speed,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_worst_direction_t> found;
    found.status = ur5e_worst_direction_on(q.data(), frame, place.data(), speed, &region, &p, &found.value);
    return found;
}

/* As ur5e_safe_speed_at, for all limits of a region: region->force_limit up to the horizon and,
 * clamped,
 * region->quasi_static_limit from 0.5 to 0.6 s, and from 0.25 to 0.62 s once they parted and met
 * again: at slower
 * speeds they meet later. If something may press then, ten slower speeds are tried, too.
 * UR5E_UNRESOLVED if no
 * speed is known to keep both. */
inline result<ur5e_allowed_speed_t> allowed_speed_at(
    const vector<6> &q,
    int point,
    const vector<3> &n,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_allowed_speed_t> found;
    found.status = ur5e_allowed_speed_at(q.data(), point, n.data(), &region, &p, &found.value);
    return found;
}

/* As ur5e_speed_factor, for all limits of a region. */
inline result<ur5e_allowed_factor_t> allowed_factor(
    const vector<6> &q,
    const vector<6> &dq,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<ur5e_allowed_factor_t> found;
    found.status = ur5e_allowed_factor(q.data(), dq.data(), &region, &p, &found.value);
    return found;
}

/* Whether a contact point that moves as joints do might press on a clamped body harder than a
 * limit from
 * 0.5 to 0.6 s, or in contacts after the first from 0.25 to 0.62 s: 0 where it is proven or
 * integrated that none does. */
inline result<int> may_press(
    const vector<6> &q,
    const vector<6> &dq,
    real limit,
    const ur5e_region &region,
    const ur5e_params &p) noexcept
{
    result<int> found;
    found.status = ur5e_may_press(q.data(), dq.data(), limit, &region, &p, &found.value);
    return found;
}

} // namespace ur5e

#endif
