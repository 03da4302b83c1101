// SPDX-License-Identifier: 0BSD
//! What `ur5e.h` declares. Its comments say what each function takes, gives and refuses.
//!
//! All functions check their arguments, but for pointers: each must be null or point to as many
//! numbers as its type says.
#![no_std]
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals)]

use core::ffi::{c_char, c_int, c_uchar, c_uint};

/// The number type of this build.
#[cfg(not(feature = "float"))]
pub type ur5e_real = f64;
/// The number type of this build.
#[cfg(feature = "float")]
pub type ur5e_real = f32;

pub const UR5E_JOINTS: usize = 6;
pub const UR5E_COORDINATES: usize = 12;
pub const UR5E_CHAIN_ORDER: usize = 3;
pub const UR5E_MOST_LAW_POINTS: usize = 128;
pub const UR5E_POINTS: usize = 1;
pub const UR5E_VERSION: &str = "0.2.0";
pub const UR5E_MODEL_DIGEST: &str = "40f477935b27b5347d857cf794de085d62bc0c098f5702fa8094214d1cb3bf35";
/// What structs and functions look like, in this number type.
pub const UR5E_LAYOUT: c_uint = 0x7a1f28f0 + core::mem::size_of::<ur5e_real>() as c_uint;

pub const UR5E_OK: c_int = 0;
pub const UR5E_NULL_POINTER: c_int = 1;
pub const UR5E_NOT_FINITE: c_int = 2;
pub const UR5E_ZERO_DIRECTION: c_int = 3;
pub const UR5E_OUT_OF_RANGE: c_int = 4;
pub const UR5E_SINGULAR: c_int = 5;
pub const UR5E_LOOP_OPEN: c_int = 6;
pub const UR5E_NO_EQUILIBRIUM: c_int = 7;
pub const UR5E_UNRESOLVED: c_int = 8;
pub const UR5E_BOUNDED: c_int = 9;
pub const UR5E_FOREIGN_PARAMS: c_int = 10;

pub const UR5E_MOTORS_FREE_OR_DRIVEN: c_int = 0;
pub const UR5E_MOTORS_FREE: c_int = 1;
pub const UR5E_MOTORS_DRIVEN: c_int = 2;
pub const UR5E_MOTORS_SERVO: c_int = 3;

pub const UR5E_HEAD: c_int = 0;
pub const UR5E_FACE: c_int = 1;
pub const UR5E_NECK: c_int = 2;
pub const UR5E_BACK: c_int = 3;
pub const UR5E_CHEST: c_int = 4;
pub const UR5E_ABDOMEN: c_int = 5;
pub const UR5E_PELVIS: c_int = 6;
pub const UR5E_UPPER_ARM: c_int = 7;
pub const UR5E_LOWER_ARM: c_int = 8;
pub const UR5E_HAND: c_int = 9;
pub const UR5E_THIGH: c_int = 10;
pub const UR5E_LOWER_LEG: c_int = 11;

pub const UR5E_POINT_TIP: c_int = 0;

pub const UR5E_FRAME_SHOULDER_LINK: c_int = 0;
pub const UR5E_FRAME_UPPER_ARM_LINK: c_int = 1;
pub const UR5E_FRAME_FOREARM_LINK: c_int = 2;
pub const UR5E_FRAME_WRIST_1_LINK: c_int = 3;
pub const UR5E_FRAME_WRIST_2_LINK: c_int = 4;
pub const UR5E_FRAME_WRIST_3_LINK: c_int = 5;
pub const UR5E_FRAME_FLANGE: c_int = 6;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_params {
    /// UR5E_LAYOUT; ur5e_default_params sets it
    pub layout: c_uint,
    /// N m/rad, > 0; stiffness of the joint's spring
    pub joint_stiffness: [ur5e_real; 6],
    /// kg m^2, > 0; rotor inertia, reflected to the joint
    pub rotor_inertia: [ur5e_real; 6],
    /// N m/rad, >= 0; proportional gain of the motor's controller
    pub position_gain: [ur5e_real; 6],
    /// N m s/rad, >= 0; gain of the same on the motor's rate
    pub damping_gain: [ur5e_real; 6],
    /// s, >= 0; from first touch until motors are released
    pub reaction_time: ur5e_real,
    /// s, > 0; forces count until then
    pub horizon: ur5e_real,
    /// ur5e_motors
    pub motors: c_int,
    /// > 0; budget of a call of peak_force, safe_speed or speed_factor
    pub steps: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_reduced_model_t {
    /// kg; mass felt at the contact point
    pub m_c: ur5e_real,
    /// N/m; reflected stiffness
    pub k_r: ur5e_real,
    /// kg; mass on the actuators' side
    pub m_a: ur5e_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_chain_t {
    /// kg; the contact force acts on the first
    pub mass: [ur5e_real; 3],
    /// N/m; [i] joins mass i and i+1; last to ground
    pub stiffness: [ur5e_real; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_osim_t {
    /// kg; with rotors (GIAF Eq. 13)
    pub Lambda: [[ur5e_real; 3]; 3],
    /// kg; without (GIAF Eq. 24)
    pub Lambda_F: [[ur5e_real; 3]; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_giaf_t {
    /// dimensionless; absorption factor (GIAF Eq. 28)
    pub giaf: ur5e_real,
    /// dimensionless; increment factor (GIAF Eq. 27)
    pub giif: ur5e_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_absorption_extremes_t {
    /// dimensionless; smallest value
    pub least: ur5e_real,
    /// dimensionless; largest value
    pub greatest: ur5e_real,
    /// dimensionless; unit vector; where two values meet, one of many
    pub least_direction: [ur5e_real; 3],
    /// dimensionless; the same for it
    pub greatest_direction: [ur5e_real; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_manipulability_t {
    /// m^3/rad^3; 0 where singular (GIAF Eq. 2)
    pub omega_m: ur5e_real,
    /// m^2/rad^2; J J', base axes
    pub JJ: [[ur5e_real; 3]; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_impact_measure_t {
    /// kg^3 m^3; sqrt(det E)
    pub omega_di: ur5e_real,
    /// kg^2 m^2; (H J+)' (H J+), base axes
    pub E: [[ur5e_real; 3]; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_rotor_influence_t {
    /// 1/(kg m^2); dGIAF/db of each rotor inertia b
    pub by_rotor: [ur5e_real; 6],
    /// dimensionless; for a change of the gear ratio by its own size: 2 b dGIAF/db
    pub by_gear: [ur5e_real; 6],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_joint_impulse_t {
    /// N s; between the bodies
    pub contact: ur5e_real,
    /// N m s; -J'n contact, on each joint's axis
    pub joints: [ur5e_real; 6],
    /// N m s; from each link to its rotor
    pub gears: [ur5e_real; 6],
    /// rad/s; of each joint
    pub velocity_change: [ur5e_real; 6],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_law_point {
    /// m
    pub depth: ur5e_real,
    /// N
    pub force: ur5e_real,
    /// m
    pub knee_depth: ur5e_real,
    /// N
    pub knee_force: ur5e_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_region {
    /// k_h of the body, N/m, > 0
    pub stiffness: ur5e_real,
    /// c_h of the body, N s/m, >= 0
    pub damping: ur5e_real,
    /// that gives way with it, kg, > 0; not read if clamped
    pub effective_mass: ur5e_real,
    /// k_f of the skin, N/m^1.5, > 0; not read if there is another law
    pub hertz_stiffness: ur5e_real,
    /// of the force while clamped, N; for the caller
    pub quasi_static_limit: ur5e_real,
    /// of the first milliseconds, N; for the caller
    pub force_limit: ur5e_real,
    /// NULL for Hertz's; else its points, which rise
    pub law: *const ur5e_law_point,
    /// how many there are, 1 to 128; not read without a law
    pub law_points: c_int,
    /// 0 if the body can give way
    pub clamped: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_peak_force_t {
    /// N; largest contact force up to the horizon
    pub force: ur5e_real,
    /// s; of it since first touch
    pub time: ur5e_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_safe_speed_t {
    /// m/s
    pub speed: ur5e_real,
    /// N; largest at this speed, below the limit
    pub force: ur5e_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_speed_factor_t {
    /// of all joint velocities, 0 to 1
    pub factor: ur5e_real,
    /// ur5e_point that needs it, -1 if none moves
    pub point: c_int,
    /// m/s; that this point may have
    pub speed: ur5e_real,
    /// N; largest at that speed
    pub force: ur5e_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_speed_factor_over_t {
    /// of all joint velocities, 0 to 1
    pub factor: ur5e_real,
    /// of the table that needs it, -1 if none moves
    pub entry: c_int,
    /// m/s; that its point may have
    pub speed: ur5e_real,
    /// N; largest at that speed
    pub force: ur5e_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_worst_direction_t {
    /// of the impact, a unit vector
    pub n: [ur5e_real; 3],
    /// N; along it
    pub force: ur5e_real,
    /// share of the force by which another direction may be harder
    pub error: ur5e_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_allowed_speed_t {
    /// m/s
    pub speed: ur5e_real,
    /// N; largest at this speed up to the horizon, or at a greater one
    pub force: ur5e_real,
    /// 1 if what presses later needs this speed, 0 if the force
    pub pressed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_allowed_factor_t {
    /// of all joint velocities, 0 to 1
    pub factor: ur5e_real,
    /// ur5e_point that needs it, -1 if none moves
    pub point: c_int,
    /// m/s; that this point may have
    pub speed: ur5e_real,
    /// N; largest at that speed up to the horizon, or at a greater one
    pub force: ur5e_real,
    /// 1 if what presses later needs it
    pub pressed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ur5e_selection_t {
    /// row of the pose with the least peak force; the first of equals
    pub best: c_int,
    /// row of the next, -1 if there is none
    pub second: c_int,
    /// how many poses could be compared
    pub usable: c_int,
    /// N; peak force of the best
    pub force: ur5e_real,
    /// N; by how much the second exceeds it, 0 if there is none
    pub margin: ur5e_real,
}

extern "C" {
    pub fn ur5e_status_text(status: c_int) -> *const c_char;
    pub fn ur5e_version() -> *const c_char;
    pub fn ur5e_model_digest() -> *const c_char;
    pub fn ur5e_fill_params(p: *mut ur5e_params, layout: c_uint) -> c_int;
    pub fn ur5e_mass_matrix(q: *const ur5e_real, M: *mut [ur5e_real; 6]) -> c_int;
    pub fn ur5e_jacobian(q: *const ur5e_real, J: *mut [ur5e_real; 6]) -> c_int;
    pub fn ur5e_generalised_mass_matrix(q: *const ur5e_real, p: *const ur5e_params, M0: *mut [ur5e_real; 12]) -> c_int;
    pub fn ur5e_stiffness_matrix(q: *const ur5e_real, p: *const ur5e_params, K0: *mut [ur5e_real; 12]) -> c_int;
    pub fn ur5e_contact_jacobian(q: *const ur5e_real, n: *const ur5e_real, J_c: *mut ur5e_real) -> c_int;
    pub fn ur5e_reflected_mass(q: *const ur5e_real, n: *const ur5e_real, m_c: *mut ur5e_real) -> c_int;
    pub fn ur5e_reduced_model(q: *const ur5e_real, n: *const ur5e_real, p: *const ur5e_params, out: *mut ur5e_reduced_model_t) -> c_int;
    pub fn ur5e_chain(q: *const ur5e_real, n: *const ur5e_real, p: *const ur5e_params, out: *mut ur5e_chain_t) -> c_int;
    pub fn ur5e_osim(q: *const ur5e_real, p: *const ur5e_params, out: *mut ur5e_osim_t) -> c_int;
    pub fn ur5e_giaf(q: *const ur5e_real, p: *const ur5e_params, out: *mut ur5e_giaf_t) -> c_int;
    pub fn ur5e_directional_giaf(q: *const ur5e_real, n: *const ur5e_real, p: *const ur5e_params, giaf: *mut ur5e_real) -> c_int;
    pub fn ur5e_absorption_extremes(q: *const ur5e_real, p: *const ur5e_params, out: *mut ur5e_absorption_extremes_t) -> c_int;
    pub fn ur5e_manipulability(q: *const ur5e_real, out: *mut ur5e_manipulability_t) -> c_int;
    pub fn ur5e_force_measure(q: *const ur5e_real, omega_f: *mut ur5e_real) -> c_int;
    pub fn ur5e_impact_measure(q: *const ur5e_real, p: *const ur5e_params, out: *mut ur5e_impact_measure_t) -> c_int;
    pub fn ur5e_rotor_influence(q: *const ur5e_real, p: *const ur5e_params, out: *mut ur5e_rotor_influence_t) -> c_int;
    pub fn ur5e_single_joint_giaf(q: *const ur5e_real, p: *const ur5e_params, giaf: *mut ur5e_real) -> c_int;
    pub fn ur5e_joint_impulse(q: *const ur5e_real, n: *const ur5e_real, speed: ur5e_real, restitution: ur5e_real, other_mobility: ur5e_real, p: *const ur5e_params, out: *mut ur5e_joint_impulse_t) -> c_int;
    pub fn ur5e_linear_error(q: *const ur5e_real, n: *const ur5e_real, speed: ur5e_real, duration: ur5e_real, error: *mut ur5e_real) -> c_int;
    pub fn ur5e_body_region(part: c_int, clamped: c_int, region: *mut ur5e_region) -> c_int;
    pub fn ur5e_peak_force(q: *const ur5e_real, n: *const ur5e_real, speed: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_peak_force_t) -> c_int;
    pub fn ur5e_peak_force_at(q: *const ur5e_real, point: c_int, n: *const ur5e_real, speed: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_peak_force_t) -> c_int;
    pub fn ur5e_safe_speed(q: *const ur5e_real, n: *const ur5e_real, limit: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_safe_speed_t) -> c_int;
    pub fn ur5e_safe_speed_at(q: *const ur5e_real, point: c_int, n: *const ur5e_real, limit: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_safe_speed_t) -> c_int;
    pub fn ur5e_speed_factor(q: *const ur5e_real, dq: *const ur5e_real, limit: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_speed_factor_t) -> c_int;
    pub fn ur5e_speed_factor_over(q: *const ur5e_real, dq: *const ur5e_real, points: *const c_int, regions: *const ur5e_region, limits: *const ur5e_real, count: c_int, p: *const ur5e_params, out: *mut ur5e_speed_factor_over_t) -> c_int;
    pub fn ur5e_pressing_force_at(q: *const ur5e_real, point: c_int, n: *const ur5e_real, speed: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, force: *mut ur5e_real) -> c_int;
    pub fn ur5e_peak_force_on(q: *const ur5e_real, frame: c_int, place: *const ur5e_real, n: *const ur5e_real, speed: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_peak_force_t) -> c_int;
    pub fn ur5e_safe_speed_on(q: *const ur5e_real, frame: c_int, place: *const ur5e_real, n: *const ur5e_real, limit: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_safe_speed_t) -> c_int;
    pub fn ur5e_worst_direction_at(q: *const ur5e_real, point: c_int, speed: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_worst_direction_t) -> c_int;
    pub fn ur5e_worst_direction_on(q: *const ur5e_real, frame: c_int, place: *const ur5e_real, speed: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_worst_direction_t) -> c_int;
    pub fn ur5e_allowed_speed_at(q: *const ur5e_real, point: c_int, n: *const ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_allowed_speed_t) -> c_int;
    pub fn ur5e_allowed_factor(q: *const ur5e_real, dq: *const ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_allowed_factor_t) -> c_int;
    pub fn ur5e_may_press(q: *const ur5e_real, dq: *const ur5e_real, limit: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, may: *mut c_int) -> c_int;
    pub fn ur5e_select_configuration(poses: *const [ur5e_real; 6], count: c_int, allowed: *const c_uchar, n: *const ur5e_real, speed: ur5e_real, region: *const ur5e_region, p: *const ur5e_params, out: *mut ur5e_selection_t) -> c_int;
}

/// The parameters as the library fills them in; an error is the status.
pub fn ur5e_default_params() -> Result<ur5e_params, c_int> {
    let mut p = core::mem::MaybeUninit::zeroed();
    // SAFETY: p has the layout that is named, and zeros are numbers
    let status = unsafe { ur5e_fill_params(p.as_mut_ptr(), UR5E_LAYOUT) };
    if status == UR5E_OK { Ok(unsafe { p.assume_init() }) } else { Err(status) }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn library_is_of_this_header() {
        let [version, digest] = [unsafe { ur5e_version() }, unsafe { ur5e_model_digest() }];
        assert_eq!(unsafe { CStr::from_ptr(version) }.to_str(), Ok(UR5E_VERSION));
        assert_eq!(unsafe { CStr::from_ptr(digest) }.to_str(), Ok(UR5E_MODEL_DIGEST));
    }

    #[test]
    fn parameters_lie_as_in_c() {
        let p = ur5e_default_params().expect("the layout is that of the library");
        assert_eq!(p.layout, UR5E_LAYOUT);
        let mut other = p;
        let status = unsafe { ur5e_fill_params(&mut other, UR5E_LAYOUT ^ 12) };
        assert_eq!(status, UR5E_FOREIGN_PARAMS);
    }
}
