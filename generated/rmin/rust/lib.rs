// SPDX-License-Identifier: 0BSD
//! What `rmin.h` declares. Its comments say what each function takes, gives and refuses.
//!
//! All functions check their arguments, but for pointers: each must be null or point to as many
//! numbers as its type says.
#![no_std]
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals)]

use core::ffi::{c_char, c_int, c_uchar, c_uint};

/// The number type of this build.
#[cfg(not(feature = "float"))]
pub type rmin_real = f64;
/// The number type of this build.
#[cfg(feature = "float")]
pub type rmin_real = f32;

pub const RMIN_JOINTS: usize = 6;
pub const RMIN_COORDINATES: usize = 4;
pub const RMIN_CHAIN_ORDER: usize = 3;
pub const RMIN_MOST_LAW_POINTS: usize = 128;
pub const RMIN_POINTS: usize = 1;
pub const RMIN_CANDIDATES: usize = 4;
pub const RMIN_VERSION: &str = "0.2.0";
pub const RMIN_MODEL_DIGEST: &str = "9aef78915461144e8c584f0d2e2b92eeefff44bc17b988d6df56b13ba4a63606";
/// What structs and functions look like, in this number type.
pub const RMIN_LAYOUT: c_uint = 0x530c2c90 + core::mem::size_of::<rmin_real>() as c_uint;

pub const RMIN_OK: c_int = 0;
pub const RMIN_NULL_POINTER: c_int = 1;
pub const RMIN_NOT_FINITE: c_int = 2;
pub const RMIN_ZERO_DIRECTION: c_int = 3;
pub const RMIN_OUT_OF_RANGE: c_int = 4;
pub const RMIN_SINGULAR: c_int = 5;
pub const RMIN_LOOP_OPEN: c_int = 6;
pub const RMIN_NO_EQUILIBRIUM: c_int = 7;
pub const RMIN_UNRESOLVED: c_int = 8;
pub const RMIN_BOUNDED: c_int = 9;
pub const RMIN_FOREIGN_PARAMS: c_int = 10;

pub const RMIN_MOTORS_FREE_OR_DRIVEN: c_int = 0;
pub const RMIN_MOTORS_FREE: c_int = 1;
pub const RMIN_MOTORS_DRIVEN: c_int = 2;
pub const RMIN_MOTORS_SERVO: c_int = 3;

pub const RMIN_HEAD: c_int = 0;
pub const RMIN_FACE: c_int = 1;
pub const RMIN_NECK: c_int = 2;
pub const RMIN_BACK: c_int = 3;
pub const RMIN_CHEST: c_int = 4;
pub const RMIN_ABDOMEN: c_int = 5;
pub const RMIN_PELVIS: c_int = 6;
pub const RMIN_UPPER_ARM: c_int = 7;
pub const RMIN_LOWER_ARM: c_int = 8;
pub const RMIN_HAND: c_int = 9;
pub const RMIN_THIGH: c_int = 10;
pub const RMIN_LOWER_LEG: c_int = 11;

pub const RMIN_POINT_TIP: c_int = 0;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_params {
    /// RMIN_LAYOUT; rmin_default_params sets it
    pub layout: c_uint,
    /// kg m^2, >= 0; rotor inertia, reflected to the joint; may be 0
    pub rotor_inertia: [rmin_real; 6],
    /// N m/rad, >= 0; proportional gain of the motor's controller
    pub position_gain: [rmin_real; 6],
    /// N m s/rad, >= 0; gain of the same on the motor's rate
    pub damping_gain: [rmin_real; 6],
    /// s, >= 0; from first touch until motors are released
    pub reaction_time: rmin_real,
    /// s, > 0; forces count until then
    pub horizon: rmin_real,
    /// rmin_motors
    pub motors: c_int,
    /// > 0; budget of a call of peak_force, safe_speed or speed_factor
    pub steps: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_reduced_model_t {
    /// kg; mass felt at the contact point
    pub m_c: rmin_real,
    /// N/m; reflected stiffness
    pub k_r: rmin_real,
    /// kg; mass on the actuators' side
    pub m_a: rmin_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_chain_t {
    /// kg; the contact force acts on the first
    pub mass: [rmin_real; 3],
    /// N/m; [i] joins mass i and i+1; last to ground
    pub stiffness: [rmin_real; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_law_point {
    /// m
    pub depth: rmin_real,
    /// N
    pub force: rmin_real,
    /// m
    pub knee_depth: rmin_real,
    /// N
    pub knee_force: rmin_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_region {
    /// k_h of the body, N/m, > 0
    pub stiffness: rmin_real,
    /// c_h of the body, N s/m, >= 0
    pub damping: rmin_real,
    /// that gives way with it, kg, > 0; not read if clamped
    pub effective_mass: rmin_real,
    /// k_f of the skin, N/m^1.5, > 0; not read if there is another law
    pub hertz_stiffness: rmin_real,
    /// of the force while clamped, N; for the caller
    pub quasi_static_limit: rmin_real,
    /// of the first milliseconds, N; for the caller
    pub force_limit: rmin_real,
    /// NULL for Hertz's; else its points, which rise
    pub law: *const rmin_law_point,
    /// how many there are, 1 to 128; not read without a law
    pub law_points: c_int,
    /// 0 if the body can give way
    pub clamped: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_peak_force_t {
    /// N; largest contact force up to the horizon
    pub force: rmin_real,
    /// s; of it since first touch
    pub time: rmin_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_safe_speed_t {
    /// m/s
    pub speed: rmin_real,
    /// N; largest at this speed, below the limit
    pub force: rmin_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_speed_factor_t {
    /// of all joint velocities, 0 to 1
    pub factor: rmin_real,
    /// rmin_point that needs it, -1 if none moves
    pub point: c_int,
    /// m/s; that this point may have
    pub speed: rmin_real,
    /// N; largest at that speed
    pub force: rmin_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_speed_factor_over_t {
    /// of all joint velocities, 0 to 1
    pub factor: rmin_real,
    /// of the table that needs it, -1 if none moves
    pub entry: c_int,
    /// m/s; that its point may have
    pub speed: rmin_real,
    /// N; largest at that speed
    pub force: rmin_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_worst_direction_t {
    /// of the impact, a unit vector
    pub n: [rmin_real; 3],
    /// N; along it
    pub force: rmin_real,
    /// share of the force by which another direction may be harder
    pub error: rmin_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_allowed_speed_t {
    /// m/s
    pub speed: rmin_real,
    /// N; largest at this speed up to the horizon, or at a greater one
    pub force: rmin_real,
    /// 1 if what presses later needs this speed, 0 if the force
    pub pressed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_allowed_factor_t {
    /// of all joint velocities, 0 to 1
    pub factor: rmin_real,
    /// rmin_point that needs it, -1 if none moves
    pub point: c_int,
    /// m/s; that this point may have
    pub speed: rmin_real,
    /// N; largest at that speed up to the horizon, or at a greater one
    pub force: rmin_real,
    /// 1 if what presses later needs it
    pub pressed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rmin_selection_t {
    /// row of the pose with the least peak force; the first of equals
    pub best: c_int,
    /// row of the next, -1 if there is none
    pub second: c_int,
    /// how many poses could be compared
    pub usable: c_int,
    /// N; peak force of the best
    pub force: rmin_real,
    /// N; by how much the second exceeds it, 0 if there is none
    pub margin: rmin_real,
}

extern "C" {
    pub static rmin_candidates: [[rmin_real; 6]; 4];
    pub fn rmin_status_text(status: c_int) -> *const c_char;
    pub fn rmin_version() -> *const c_char;
    pub fn rmin_model_digest() -> *const c_char;
    pub fn rmin_fill_params(p: *mut rmin_params, layout: c_uint) -> c_int;
    pub fn rmin_configuration(motors: *const rmin_real, start: *const rmin_real, q: *mut rmin_real) -> c_int;
    pub fn rmin_mass_matrix(q: *const rmin_real, M: *mut [rmin_real; 4]) -> c_int;
    pub fn rmin_jacobian(q: *const rmin_real, J: *mut [rmin_real; 4]) -> c_int;
    pub fn rmin_generalised_mass_matrix(q: *const rmin_real, p: *const rmin_params, M0: *mut [rmin_real; 4]) -> c_int;
    pub fn rmin_stiffness_matrix(q: *const rmin_real, p: *const rmin_params, K0: *mut [rmin_real; 4]) -> c_int;
    pub fn rmin_contact_jacobian(q: *const rmin_real, n: *const rmin_real, J_c: *mut rmin_real) -> c_int;
    pub fn rmin_reflected_mass(q: *const rmin_real, n: *const rmin_real, p: *const rmin_params, m_c: *mut rmin_real) -> c_int;
    pub fn rmin_reduced_model(q: *const rmin_real, n: *const rmin_real, p: *const rmin_params, out: *mut rmin_reduced_model_t) -> c_int;
    pub fn rmin_chain(q: *const rmin_real, n: *const rmin_real, p: *const rmin_params, out: *mut rmin_chain_t) -> c_int;
    pub fn rmin_body_region(part: c_int, clamped: c_int, region: *mut rmin_region) -> c_int;
    pub fn rmin_peak_force(q: *const rmin_real, n: *const rmin_real, speed: rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_peak_force_t) -> c_int;
    pub fn rmin_peak_force_at(q: *const rmin_real, point: c_int, n: *const rmin_real, speed: rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_peak_force_t) -> c_int;
    pub fn rmin_safe_speed(q: *const rmin_real, n: *const rmin_real, limit: rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_safe_speed_t) -> c_int;
    pub fn rmin_safe_speed_at(q: *const rmin_real, point: c_int, n: *const rmin_real, limit: rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_safe_speed_t) -> c_int;
    pub fn rmin_speed_factor(q: *const rmin_real, dq: *const rmin_real, limit: rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_speed_factor_t) -> c_int;
    pub fn rmin_speed_factor_over(q: *const rmin_real, dq: *const rmin_real, points: *const c_int, regions: *const rmin_region, limits: *const rmin_real, count: c_int, p: *const rmin_params, out: *mut rmin_speed_factor_over_t) -> c_int;
    pub fn rmin_pressing_force_at(q: *const rmin_real, point: c_int, n: *const rmin_real, speed: rmin_real, region: *const rmin_region, p: *const rmin_params, force: *mut rmin_real) -> c_int;
    pub fn rmin_worst_direction_at(q: *const rmin_real, point: c_int, speed: rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_worst_direction_t) -> c_int;
    pub fn rmin_allowed_speed_at(q: *const rmin_real, point: c_int, n: *const rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_allowed_speed_t) -> c_int;
    pub fn rmin_allowed_factor(q: *const rmin_real, dq: *const rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_allowed_factor_t) -> c_int;
    pub fn rmin_may_press(q: *const rmin_real, dq: *const rmin_real, limit: rmin_real, region: *const rmin_region, p: *const rmin_params, may: *mut c_int) -> c_int;
    pub fn rmin_select_configuration(poses: *const [rmin_real; 6], count: c_int, allowed: *const c_uchar, n: *const rmin_real, speed: rmin_real, region: *const rmin_region, p: *const rmin_params, out: *mut rmin_selection_t) -> c_int;
}

/// The parameters as the library fills them in; an error is the status.
pub fn rmin_default_params() -> Result<rmin_params, c_int> {
    let mut p = core::mem::MaybeUninit::zeroed();
    // SAFETY: p has the layout that is named, and zeros are numbers
    let status = unsafe { rmin_fill_params(p.as_mut_ptr(), RMIN_LAYOUT) };
    if status == RMIN_OK { Ok(unsafe { p.assume_init() }) } else { Err(status) }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn library_is_of_this_header() {
        let [version, digest] = [unsafe { rmin_version() }, unsafe { rmin_model_digest() }];
        assert_eq!(unsafe { CStr::from_ptr(version) }.to_str(), Ok(RMIN_VERSION));
        assert_eq!(unsafe { CStr::from_ptr(digest) }.to_str(), Ok(RMIN_MODEL_DIGEST));
    }

    #[test]
    fn parameters_lie_as_in_c() {
        let p = rmin_default_params().expect("the layout is that of the library");
        assert_eq!(p.layout, RMIN_LAYOUT);
        let mut other = p;
        let status = unsafe { rmin_fill_params(&mut other, RMIN_LAYOUT ^ 12) };
        assert_eq!(status, RMIN_FOREIGN_PARAMS);
    }
}
