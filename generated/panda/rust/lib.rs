// SPDX-License-Identifier: 0BSD
//! What `panda.h` declares. Its comments say what each function takes, gives and refuses.
//!
//! All functions check their arguments, but for pointers: each must be null or point to as many
//! numbers as its type says.
#![no_std]
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals)]

use core::ffi::{c_char, c_int, c_uchar, c_uint};

/// The number type of this build.
#[cfg(not(feature = "float"))]
pub type panda_real = f64;
/// The number type of this build.
#[cfg(feature = "float")]
pub type panda_real = f32;

pub const PANDA_JOINTS: usize = 7;
pub const PANDA_COORDINATES: usize = 14;
pub const PANDA_CHAIN_ORDER: usize = 3;
pub const PANDA_MOST_LAW_POINTS: usize = 128;
pub const PANDA_POINTS: usize = 1;
pub const PANDA_CANDIDATES: usize = 24;
pub const PANDA_VERSION: &str = "0.2.0";
pub const PANDA_MODEL_DIGEST: &str = "4d55b88b1dbb963dbf3ba6052077da0bf8d34700e10b93eac36c486e0b89b1d5";
/// What structs and functions look like, in this number type.
pub const PANDA_LAYOUT: c_uint = 0x9d73a0a0 + core::mem::size_of::<panda_real>() as c_uint;

pub const PANDA_OK: c_int = 0;
pub const PANDA_NULL_POINTER: c_int = 1;
pub const PANDA_NOT_FINITE: c_int = 2;
pub const PANDA_ZERO_DIRECTION: c_int = 3;
pub const PANDA_OUT_OF_RANGE: c_int = 4;
pub const PANDA_SINGULAR: c_int = 5;
pub const PANDA_LOOP_OPEN: c_int = 6;
pub const PANDA_NO_EQUILIBRIUM: c_int = 7;
pub const PANDA_UNRESOLVED: c_int = 8;
pub const PANDA_BOUNDED: c_int = 9;
pub const PANDA_FOREIGN_PARAMS: c_int = 10;

pub const PANDA_MOTORS_FREE_OR_DRIVEN: c_int = 0;
pub const PANDA_MOTORS_FREE: c_int = 1;
pub const PANDA_MOTORS_DRIVEN: c_int = 2;
pub const PANDA_MOTORS_SERVO: c_int = 3;

pub const PANDA_HEAD: c_int = 0;
pub const PANDA_FACE: c_int = 1;
pub const PANDA_NECK: c_int = 2;
pub const PANDA_BACK: c_int = 3;
pub const PANDA_CHEST: c_int = 4;
pub const PANDA_ABDOMEN: c_int = 5;
pub const PANDA_PELVIS: c_int = 6;
pub const PANDA_UPPER_ARM: c_int = 7;
pub const PANDA_LOWER_ARM: c_int = 8;
pub const PANDA_HAND: c_int = 9;
pub const PANDA_THIGH: c_int = 10;
pub const PANDA_LOWER_LEG: c_int = 11;

pub const PANDA_POINT_TIP: c_int = 0;

pub const PANDA_FRAME_LINK1: c_int = 0;
pub const PANDA_FRAME_LINK2: c_int = 1;
pub const PANDA_FRAME_LINK3: c_int = 2;
pub const PANDA_FRAME_LINK4: c_int = 3;
pub const PANDA_FRAME_LINK5: c_int = 4;
pub const PANDA_FRAME_LINK6: c_int = 5;
pub const PANDA_FRAME_LINK7: c_int = 6;
pub const PANDA_FRAME_HAND: c_int = 7;
pub const PANDA_FRAME_LEFT_FINGER: c_int = 8;
pub const PANDA_FRAME_RIGHT_FINGER: c_int = 9;
pub const PANDA_FRAME_FLANGE: c_int = 10;
pub const PANDA_FRAME_HAND_TCP: c_int = 11;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_params {
    /// PANDA_LAYOUT; panda_default_params sets it
    pub layout: c_uint,
    /// N m/rad, > 0; stiffness of the joint's spring
    pub joint_stiffness: [panda_real; 7],
    /// kg m^2, > 0; rotor inertia, reflected to the joint
    pub rotor_inertia: [panda_real; 7],
    /// N m/rad, >= 0; proportional gain of the motor's controller
    pub position_gain: [panda_real; 7],
    /// N m s/rad, >= 0; gain of the same on the motor's rate
    pub damping_gain: [panda_real; 7],
    /// s, >= 0; from first touch until motors are released
    pub reaction_time: panda_real,
    /// s, > 0; forces count until then
    pub horizon: panda_real,
    /// panda_motors
    pub motors: c_int,
    /// > 0; budget of a call of peak_force, safe_speed or speed_factor
    pub steps: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_reduced_model_t {
    /// kg; mass felt at the contact point
    pub m_c: panda_real,
    /// N/m; reflected stiffness
    pub k_r: panda_real,
    /// kg; mass on the actuators' side
    pub m_a: panda_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_chain_t {
    /// kg; the contact force acts on the first
    pub mass: [panda_real; 3],
    /// N/m; [i] joins mass i and i+1; last to ground
    pub stiffness: [panda_real; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_osim_t {
    /// kg; with rotors (GIAF Eq. 13)
    pub Lambda: [[panda_real; 3]; 3],
    /// kg; without (GIAF Eq. 24)
    pub Lambda_F: [[panda_real; 3]; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_giaf_t {
    /// dimensionless; absorption factor (GIAF Eq. 28)
    pub giaf: panda_real,
    /// dimensionless; increment factor (GIAF Eq. 27)
    pub giif: panda_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_absorption_extremes_t {
    /// dimensionless; smallest value
    pub least: panda_real,
    /// dimensionless; largest value
    pub greatest: panda_real,
    /// dimensionless; unit vector; where two values meet, one of many
    pub least_direction: [panda_real; 3],
    /// dimensionless; the same for it
    pub greatest_direction: [panda_real; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_manipulability_t {
    /// m^3/rad^3; 0 where singular (GIAF Eq. 2)
    pub omega_m: panda_real,
    /// m^2/rad^2; J J', base axes
    pub JJ: [[panda_real; 3]; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_impact_measure_t {
    /// kg^3 m^3; sqrt(det E)
    pub omega_di: panda_real,
    /// kg^2 m^2; (H J+)' (H J+), base axes
    pub E: [[panda_real; 3]; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_rotor_influence_t {
    /// 1/(kg m^2); dGIAF/db of each rotor inertia b
    pub by_rotor: [panda_real; 7],
    /// dimensionless; for a change of the gear ratio by its own size: 2 b dGIAF/db
    pub by_gear: [panda_real; 7],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_joint_impulse_t {
    /// N s; between the bodies
    pub contact: panda_real,
    /// N m s; -J'n contact, on each joint's axis
    pub joints: [panda_real; 7],
    /// N m s; from each link to its rotor
    pub gears: [panda_real; 7],
    /// rad/s; of each joint
    pub velocity_change: [panda_real; 7],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_law_point {
    /// m
    pub depth: panda_real,
    /// N
    pub force: panda_real,
    /// m
    pub knee_depth: panda_real,
    /// N
    pub knee_force: panda_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_region {
    /// k_h of the body, N/m, > 0
    pub stiffness: panda_real,
    /// c_h of the body, N s/m, >= 0
    pub damping: panda_real,
    /// that gives way with it, kg, > 0; not read if clamped
    pub effective_mass: panda_real,
    /// k_f of the skin, N/m^1.5, > 0; not read if there is another law
    pub hertz_stiffness: panda_real,
    /// of the force while clamped, N; for the caller
    pub quasi_static_limit: panda_real,
    /// of the first milliseconds, N; for the caller
    pub force_limit: panda_real,
    /// NULL for Hertz's; else its points, which rise
    pub law: *const panda_law_point,
    /// how many there are, 1 to 128; not read without a law
    pub law_points: c_int,
    /// 0 if the body can give way
    pub clamped: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_peak_force_t {
    /// N; largest contact force up to the horizon
    pub force: panda_real,
    /// s; of it since first touch
    pub time: panda_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_safe_speed_t {
    /// m/s
    pub speed: panda_real,
    /// N; largest at this speed, below the limit
    pub force: panda_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_speed_factor_t {
    /// of all joint velocities, 0 to 1
    pub factor: panda_real,
    /// panda_point that needs it, -1 if none moves
    pub point: c_int,
    /// m/s; that this point may have
    pub speed: panda_real,
    /// N; largest at that speed
    pub force: panda_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_speed_factor_over_t {
    /// of all joint velocities, 0 to 1
    pub factor: panda_real,
    /// of the table that needs it, -1 if none moves
    pub entry: c_int,
    /// m/s; that its point may have
    pub speed: panda_real,
    /// N; largest at that speed
    pub force: panda_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_worst_direction_t {
    /// of the impact, a unit vector
    pub n: [panda_real; 3],
    /// N; along it
    pub force: panda_real,
    /// share of the force by which another direction may be harder
    pub error: panda_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_allowed_speed_t {
    /// m/s
    pub speed: panda_real,
    /// N; largest at this speed up to the horizon, or at a greater one
    pub force: panda_real,
    /// 1 if what presses later needs this speed, 0 if the force
    pub pressed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_allowed_factor_t {
    /// of all joint velocities, 0 to 1
    pub factor: panda_real,
    /// panda_point that needs it, -1 if none moves
    pub point: c_int,
    /// m/s; that this point may have
    pub speed: panda_real,
    /// N; largest at that speed up to the horizon, or at a greater one
    pub force: panda_real,
    /// 1 if what presses later needs it
    pub pressed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct panda_selection_t {
    /// row of the pose with the least peak force; the first of equals
    pub best: c_int,
    /// row of the next, -1 if there is none
    pub second: c_int,
    /// how many poses could be compared
    pub usable: c_int,
    /// N; peak force of the best
    pub force: panda_real,
    /// N; by how much the second exceeds it, 0 if there is none
    pub margin: panda_real,
}

extern "C" {
    pub static panda_candidates: [[panda_real; 7]; 24];
    pub fn panda_status_text(status: c_int) -> *const c_char;
    pub fn panda_version() -> *const c_char;
    pub fn panda_model_digest() -> *const c_char;
    pub fn panda_fill_params(p: *mut panda_params, layout: c_uint) -> c_int;
    pub fn panda_mass_matrix(q: *const panda_real, M: *mut [panda_real; 7]) -> c_int;
    pub fn panda_jacobian(q: *const panda_real, J: *mut [panda_real; 7]) -> c_int;
    pub fn panda_generalised_mass_matrix(q: *const panda_real, p: *const panda_params, M0: *mut [panda_real; 14]) -> c_int;
    pub fn panda_stiffness_matrix(q: *const panda_real, p: *const panda_params, K0: *mut [panda_real; 14]) -> c_int;
    pub fn panda_contact_jacobian(q: *const panda_real, n: *const panda_real, J_c: *mut panda_real) -> c_int;
    pub fn panda_reflected_mass(q: *const panda_real, n: *const panda_real, m_c: *mut panda_real) -> c_int;
    pub fn panda_reduced_model(q: *const panda_real, n: *const panda_real, p: *const panda_params, out: *mut panda_reduced_model_t) -> c_int;
    pub fn panda_chain(q: *const panda_real, n: *const panda_real, p: *const panda_params, out: *mut panda_chain_t) -> c_int;
    pub fn panda_osim(q: *const panda_real, p: *const panda_params, out: *mut panda_osim_t) -> c_int;
    pub fn panda_giaf(q: *const panda_real, p: *const panda_params, out: *mut panda_giaf_t) -> c_int;
    pub fn panda_directional_giaf(q: *const panda_real, n: *const panda_real, p: *const panda_params, giaf: *mut panda_real) -> c_int;
    pub fn panda_absorption_extremes(q: *const panda_real, p: *const panda_params, out: *mut panda_absorption_extremes_t) -> c_int;
    pub fn panda_manipulability(q: *const panda_real, out: *mut panda_manipulability_t) -> c_int;
    pub fn panda_force_measure(q: *const panda_real, omega_f: *mut panda_real) -> c_int;
    pub fn panda_impact_measure(q: *const panda_real, p: *const panda_params, out: *mut panda_impact_measure_t) -> c_int;
    pub fn panda_rotor_influence(q: *const panda_real, p: *const panda_params, out: *mut panda_rotor_influence_t) -> c_int;
    pub fn panda_single_joint_giaf(q: *const panda_real, p: *const panda_params, giaf: *mut panda_real) -> c_int;
    pub fn panda_joint_impulse(q: *const panda_real, n: *const panda_real, speed: panda_real, restitution: panda_real, other_mobility: panda_real, p: *const panda_params, out: *mut panda_joint_impulse_t) -> c_int;
    pub fn panda_linear_error(q: *const panda_real, n: *const panda_real, speed: panda_real, duration: panda_real, error: *mut panda_real) -> c_int;
    pub fn panda_body_region(part: c_int, clamped: c_int, region: *mut panda_region) -> c_int;
    pub fn panda_peak_force(q: *const panda_real, n: *const panda_real, speed: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_peak_force_t) -> c_int;
    pub fn panda_peak_force_at(q: *const panda_real, point: c_int, n: *const panda_real, speed: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_peak_force_t) -> c_int;
    pub fn panda_safe_speed(q: *const panda_real, n: *const panda_real, limit: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_safe_speed_t) -> c_int;
    pub fn panda_safe_speed_at(q: *const panda_real, point: c_int, n: *const panda_real, limit: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_safe_speed_t) -> c_int;
    pub fn panda_speed_factor(q: *const panda_real, dq: *const panda_real, limit: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_speed_factor_t) -> c_int;
    pub fn panda_speed_factor_over(q: *const panda_real, dq: *const panda_real, points: *const c_int, regions: *const panda_region, limits: *const panda_real, count: c_int, p: *const panda_params, out: *mut panda_speed_factor_over_t) -> c_int;
    pub fn panda_pressing_force_at(q: *const panda_real, point: c_int, n: *const panda_real, speed: panda_real, region: *const panda_region, p: *const panda_params, force: *mut panda_real) -> c_int;
    pub fn panda_peak_force_on(q: *const panda_real, frame: c_int, place: *const panda_real, n: *const panda_real, speed: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_peak_force_t) -> c_int;
    pub fn panda_safe_speed_on(q: *const panda_real, frame: c_int, place: *const panda_real, n: *const panda_real, limit: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_safe_speed_t) -> c_int;
    pub fn panda_worst_direction_at(q: *const panda_real, point: c_int, speed: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_worst_direction_t) -> c_int;
    pub fn panda_worst_direction_on(q: *const panda_real, frame: c_int, place: *const panda_real, speed: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_worst_direction_t) -> c_int;
    pub fn panda_allowed_speed_at(q: *const panda_real, point: c_int, n: *const panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_allowed_speed_t) -> c_int;
    pub fn panda_allowed_factor(q: *const panda_real, dq: *const panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_allowed_factor_t) -> c_int;
    pub fn panda_may_press(q: *const panda_real, dq: *const panda_real, limit: panda_real, region: *const panda_region, p: *const panda_params, may: *mut c_int) -> c_int;
    pub fn panda_select_configuration(poses: *const [panda_real; 7], count: c_int, allowed: *const c_uchar, n: *const panda_real, speed: panda_real, region: *const panda_region, p: *const panda_params, out: *mut panda_selection_t) -> c_int;
}

/// The parameters as the library fills them in; an error is the status.
pub fn panda_default_params() -> Result<panda_params, c_int> {
    let mut p = core::mem::MaybeUninit::zeroed();
    // SAFETY: p has the layout that is named, and zeros are numbers
    let status = unsafe { panda_fill_params(p.as_mut_ptr(), PANDA_LAYOUT) };
    if status == PANDA_OK { Ok(unsafe { p.assume_init() }) } else { Err(status) }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn library_is_of_this_header() {
        let [version, digest] = [unsafe { panda_version() }, unsafe { panda_model_digest() }];
        assert_eq!(unsafe { CStr::from_ptr(version) }.to_str(), Ok(PANDA_VERSION));
        assert_eq!(unsafe { CStr::from_ptr(digest) }.to_str(), Ok(PANDA_MODEL_DIGEST));
    }

    #[test]
    fn parameters_lie_as_in_c() {
        let p = panda_default_params().expect("the layout is that of the library");
        assert_eq!(p.layout, PANDA_LAYOUT);
        let mut other = p;
        let status = unsafe { panda_fill_params(&mut other, PANDA_LAYOUT ^ 12) };
        assert_eq!(status, PANDA_FOREIGN_PARAMS);
    }
}
