// SPDX-License-Identifier: 0BSD
//! What `rr.h` declares. Its comments say what each function takes, gives and refuses.
//!
//! All functions check their arguments, but for pointers: each must be null or point to as many
//! numbers as its type says.
#![no_std]
#![allow(non_camel_case_types, non_snake_case, non_upper_case_globals)]

use core::ffi::{c_char, c_int, c_uchar, c_uint};

/// The number type of this build.
#[cfg(not(feature = "float"))]
pub type rr_real = f64;
/// The number type of this build.
#[cfg(feature = "float")]
pub type rr_real = f32;

pub const RR_JOINTS: usize = 4;
pub const RR_COORDINATES: usize = 4;
pub const RR_CHAIN_ORDER: usize = 3;
pub const RR_MOST_LAW_POINTS: usize = 128;
pub const RR_POINTS: usize = 1;
pub const RR_VERSION: &str = "0.2.0";
pub const RR_MODEL_DIGEST: &str = "daba4e0e37a07503c013166f12b00244bb892e0fa7403efb8b19103c492fe0d6";
/// What structs and functions look like, in this number type.
pub const RR_LAYOUT: c_uint = 0x21fc1d50 + core::mem::size_of::<rr_real>() as c_uint;

pub const RR_OK: c_int = 0;
pub const RR_NULL_POINTER: c_int = 1;
pub const RR_NOT_FINITE: c_int = 2;
pub const RR_ZERO_DIRECTION: c_int = 3;
pub const RR_OUT_OF_RANGE: c_int = 4;
pub const RR_SINGULAR: c_int = 5;
pub const RR_LOOP_OPEN: c_int = 6;
pub const RR_NO_EQUILIBRIUM: c_int = 7;
pub const RR_UNRESOLVED: c_int = 8;
pub const RR_BOUNDED: c_int = 9;
pub const RR_FOREIGN_PARAMS: c_int = 10;

pub const RR_MOTORS_FREE_OR_DRIVEN: c_int = 0;
pub const RR_MOTORS_FREE: c_int = 1;
pub const RR_MOTORS_DRIVEN: c_int = 2;
pub const RR_MOTORS_SERVO: c_int = 3;

pub const RR_HEAD: c_int = 0;
pub const RR_FACE: c_int = 1;
pub const RR_NECK: c_int = 2;
pub const RR_BACK: c_int = 3;
pub const RR_CHEST: c_int = 4;
pub const RR_ABDOMEN: c_int = 5;
pub const RR_PELVIS: c_int = 6;
pub const RR_UPPER_ARM: c_int = 7;
pub const RR_LOWER_ARM: c_int = 8;
pub const RR_HAND: c_int = 9;
pub const RR_THIGH: c_int = 10;
pub const RR_LOWER_LEG: c_int = 11;

pub const RR_POINT_TIP: c_int = 0;

pub const RR_FRAME_MOTOR1: c_int = 0;
pub const RR_FRAME_LINK1: c_int = 1;
pub const RR_FRAME_MOTOR2: c_int = 2;
pub const RR_FRAME_LINK2: c_int = 3;
pub const RR_FRAME_O3: c_int = 4;
pub const RR_FRAME_P: c_int = 5;

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_params {
    /// RR_LAYOUT; rr_default_params sets it
    pub layout: c_uint,
    /// kg m^2, >= 0; rotor inertia, reflected to the joint; may be 0
    pub rotor_inertia: [rr_real; 4],
    /// N m/rad, >= 0; proportional gain of the motor's controller
    pub position_gain: [rr_real; 4],
    /// N m s/rad, >= 0; gain of the same on the motor's rate
    pub damping_gain: [rr_real; 4],
    /// s, >= 0; from first touch until motors are released
    pub reaction_time: rr_real,
    /// s, > 0; forces count until then
    pub horizon: rr_real,
    /// rr_motors
    pub motors: c_int,
    /// > 0; budget of a call of peak_force, safe_speed or speed_factor
    pub steps: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_reduced_model_t {
    /// kg; mass felt at the contact point
    pub m_c: rr_real,
    /// N/m; reflected stiffness
    pub k_r: rr_real,
    /// kg; mass on the actuators' side
    pub m_a: rr_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_chain_t {
    /// kg; the contact force acts on the first
    pub mass: [rr_real; 3],
    /// N/m; [i] joins mass i and i+1; last to ground
    pub stiffness: [rr_real; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_joint_impulse_t {
    /// N s; between the bodies
    pub contact: rr_real,
    /// N m s; -J'n contact, on each joint's axis
    pub joints: [rr_real; 4],
    /// N m s; from each link to its rotor
    pub gears: [rr_real; 4],
    /// rad/s; of each joint
    pub velocity_change: [rr_real; 4],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_law_point {
    /// m
    pub depth: rr_real,
    /// N
    pub force: rr_real,
    /// m
    pub knee_depth: rr_real,
    /// N
    pub knee_force: rr_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_region {
    /// k_h of the body, N/m, > 0
    pub stiffness: rr_real,
    /// c_h of the body, N s/m, >= 0
    pub damping: rr_real,
    /// that gives way with it, kg, > 0; not read if clamped
    pub effective_mass: rr_real,
    /// k_f of the skin, N/m^1.5, > 0; not read if there is another law
    pub hertz_stiffness: rr_real,
    /// of the force while clamped, N; for the caller
    pub quasi_static_limit: rr_real,
    /// of the first milliseconds, N; for the caller
    pub force_limit: rr_real,
    /// NULL for Hertz's; else its points, which rise
    pub law: *const rr_law_point,
    /// how many there are, 1 to 128; not read without a law
    pub law_points: c_int,
    /// 0 if the body can give way
    pub clamped: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_peak_force_t {
    /// N; largest contact force up to the horizon
    pub force: rr_real,
    /// s; of it since first touch
    pub time: rr_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_safe_speed_t {
    /// m/s
    pub speed: rr_real,
    /// N; largest at this speed, below the limit
    pub force: rr_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_speed_factor_t {
    /// of all joint velocities, 0 to 1
    pub factor: rr_real,
    /// rr_point that needs it, -1 if none moves
    pub point: c_int,
    /// m/s; that this point may have
    pub speed: rr_real,
    /// N; largest at that speed
    pub force: rr_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_speed_factor_over_t {
    /// of all joint velocities, 0 to 1
    pub factor: rr_real,
    /// of the table that needs it, -1 if none moves
    pub entry: c_int,
    /// m/s; that its point may have
    pub speed: rr_real,
    /// N; largest at that speed
    pub force: rr_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_worst_direction_t {
    /// of the impact, a unit vector
    pub n: [rr_real; 3],
    /// N; along it
    pub force: rr_real,
    /// share of the force by which another direction may be harder
    pub error: rr_real,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_allowed_speed_t {
    /// m/s
    pub speed: rr_real,
    /// N; largest at this speed up to the horizon, or at a greater one
    pub force: rr_real,
    /// 1 if what presses later needs this speed, 0 if the force
    pub pressed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_allowed_factor_t {
    /// of all joint velocities, 0 to 1
    pub factor: rr_real,
    /// rr_point that needs it, -1 if none moves
    pub point: c_int,
    /// m/s; that this point may have
    pub speed: rr_real,
    /// N; largest at that speed up to the horizon, or at a greater one
    pub force: rr_real,
    /// 1 if what presses later needs it
    pub pressed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct rr_selection_t {
    /// row of the pose with the least peak force; the first of equals
    pub best: c_int,
    /// row of the next, -1 if there is none
    pub second: c_int,
    /// how many poses could be compared
    pub usable: c_int,
    /// N; peak force of the best
    pub force: rr_real,
    /// N; by how much the second exceeds it, 0 if there is none
    pub margin: rr_real,
}

extern "C" {
    pub fn rr_status_text(status: c_int) -> *const c_char;
    pub fn rr_version() -> *const c_char;
    pub fn rr_model_digest() -> *const c_char;
    pub fn rr_fill_params(p: *mut rr_params, layout: c_uint) -> c_int;
    pub fn rr_mass_matrix(q: *const rr_real, M: *mut [rr_real; 4]) -> c_int;
    pub fn rr_jacobian(q: *const rr_real, J: *mut [rr_real; 4]) -> c_int;
    pub fn rr_generalised_mass_matrix(q: *const rr_real, p: *const rr_params, M0: *mut [rr_real; 4]) -> c_int;
    pub fn rr_stiffness_matrix(q: *const rr_real, p: *const rr_params, K0: *mut [rr_real; 4]) -> c_int;
    pub fn rr_contact_jacobian(q: *const rr_real, n: *const rr_real, J_c: *mut rr_real) -> c_int;
    pub fn rr_reflected_mass(q: *const rr_real, n: *const rr_real, p: *const rr_params, m_c: *mut rr_real) -> c_int;
    pub fn rr_reduced_model(q: *const rr_real, n: *const rr_real, p: *const rr_params, out: *mut rr_reduced_model_t) -> c_int;
    pub fn rr_chain(q: *const rr_real, n: *const rr_real, p: *const rr_params, out: *mut rr_chain_t) -> c_int;
    pub fn rr_joint_impulse(q: *const rr_real, n: *const rr_real, speed: rr_real, restitution: rr_real, other_mobility: rr_real, p: *const rr_params, out: *mut rr_joint_impulse_t) -> c_int;
    pub fn rr_body_region(part: c_int, clamped: c_int, region: *mut rr_region) -> c_int;
    pub fn rr_peak_force(q: *const rr_real, n: *const rr_real, speed: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_peak_force_t) -> c_int;
    pub fn rr_peak_force_at(q: *const rr_real, point: c_int, n: *const rr_real, speed: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_peak_force_t) -> c_int;
    pub fn rr_safe_speed(q: *const rr_real, n: *const rr_real, limit: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_safe_speed_t) -> c_int;
    pub fn rr_safe_speed_at(q: *const rr_real, point: c_int, n: *const rr_real, limit: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_safe_speed_t) -> c_int;
    pub fn rr_speed_factor(q: *const rr_real, dq: *const rr_real, limit: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_speed_factor_t) -> c_int;
    pub fn rr_speed_factor_over(q: *const rr_real, dq: *const rr_real, points: *const c_int, regions: *const rr_region, limits: *const rr_real, count: c_int, p: *const rr_params, out: *mut rr_speed_factor_over_t) -> c_int;
    pub fn rr_pressing_force_at(q: *const rr_real, point: c_int, n: *const rr_real, speed: rr_real, region: *const rr_region, p: *const rr_params, force: *mut rr_real) -> c_int;
    pub fn rr_peak_force_on(q: *const rr_real, frame: c_int, place: *const rr_real, n: *const rr_real, speed: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_peak_force_t) -> c_int;
    pub fn rr_safe_speed_on(q: *const rr_real, frame: c_int, place: *const rr_real, n: *const rr_real, limit: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_safe_speed_t) -> c_int;
    pub fn rr_worst_direction_at(q: *const rr_real, point: c_int, speed: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_worst_direction_t) -> c_int;
    pub fn rr_worst_direction_on(q: *const rr_real, frame: c_int, place: *const rr_real, speed: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_worst_direction_t) -> c_int;
    pub fn rr_allowed_speed_at(q: *const rr_real, point: c_int, n: *const rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_allowed_speed_t) -> c_int;
    pub fn rr_allowed_factor(q: *const rr_real, dq: *const rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_allowed_factor_t) -> c_int;
    pub fn rr_may_press(q: *const rr_real, dq: *const rr_real, limit: rr_real, region: *const rr_region, p: *const rr_params, may: *mut c_int) -> c_int;
    pub fn rr_select_configuration(poses: *const [rr_real; 4], count: c_int, allowed: *const c_uchar, n: *const rr_real, speed: rr_real, region: *const rr_region, p: *const rr_params, out: *mut rr_selection_t) -> c_int;
}

/// The parameters as the library fills them in; an error is the status.
pub fn rr_default_params() -> Result<rr_params, c_int> {
    let mut p = core::mem::MaybeUninit::zeroed();
    // SAFETY: p has the layout that is named, and zeros are numbers
    let status = unsafe { rr_fill_params(p.as_mut_ptr(), RR_LAYOUT) };
    if status == RR_OK { Ok(unsafe { p.assume_init() }) } else { Err(status) }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn library_is_of_this_header() {
        let [version, digest] = [unsafe { rr_version() }, unsafe { rr_model_digest() }];
        assert_eq!(unsafe { CStr::from_ptr(version) }.to_str(), Ok(RR_VERSION));
        assert_eq!(unsafe { CStr::from_ptr(digest) }.to_str(), Ok(RR_MODEL_DIGEST));
    }

    #[test]
    fn parameters_lie_as_in_c() {
        let p = rr_default_params().expect("the layout is that of the library");
        assert_eq!(p.layout, RR_LAYOUT);
        let mut other = p;
        let status = unsafe { rr_fill_params(&mut other, RR_LAYOUT ^ 12) };
        assert_eq!(status, RR_FOREIGN_PARAMS);
    }
}
