// SPDX-License-Identifier: BSD-3-Clause
//! By how much to slow down each state of a motion so that a collision with a chest keeps its limit.
//! Lines of q1 ... q7, dq1 ... dq7 (rad, rad/s) in, factors out; 0 where nothing is known to be safe.
use std::ffi::CStr;
use std::io::{self, BufRead};
use std::mem::MaybeUninit;
use std::process::exit;

use panda_sys::*;

const JOINTS: usize = PANDA_JOINTS;

/// A body and what the arm's drives are.
struct Guard {
    drives: panda_params,
    body: panda_region,
}

impl Guard {
    fn new() -> Result<Self, i32> {
        let mut drives = panda_default_params()?;
        drives.joint_stiffness = [3000.0; JOINTS]; // N m/rad; yours
        drives.horizon = 0.1; // s; what comes later is for the quasi-static limit
        let mut body = MaybeUninit::zeroed();
        // SAFETY: zeros are numbers, and OK means that all fields are written
        let status = unsafe { panda_body_region(PANDA_CHEST, 0, body.as_mut_ptr()) };
        if status == PANDA_OK { Ok(Self { drives, body: unsafe { body.assume_init() } }) } else { Err(status) }
    }

    /// The status, and the factor where it says that there is one.
    fn factor(&self, q: &[panda_real; JOINTS], dq: &[panda_real; JOINTS]) -> (i32, Option<panda_real>) {
        let mut out = MaybeUninit::<panda_speed_factor_t>::zeroed();
        // SAFETY: all arrays are as long as their types say
        let status = unsafe {
            let limit = self.body.force_limit;
            panda_speed_factor(q.as_ptr(), dq.as_ptr(), limit, &self.body, &self.drives, out.as_mut_ptr())
        };
        let written = status == PANDA_OK || status == PANDA_BOUNDED;
        (status, written.then(|| unsafe { out.assume_init() }.factor))
    }
}

fn numbers(line: &str) -> Option<[panda_real; 2 * JOINTS]> {
    let found: Option<Vec<_>> = line.split(',').map(|x| x.trim().parse().ok()).collect();
    found?.try_into().ok()
}

fn text(status: i32) -> String {
    // SAFETY: the text is never null, and constant
    unsafe { CStr::from_ptr(panda_status_text(status)) }.to_string_lossy().into_owned()
}

fn main() {
    let guard = Guard::new().unwrap_or_else(|status| {
        eprintln!("{}", text(status));
        exit(3)
    });
    for (i, line) in io::stdin().lock().lines().enumerate() {
        let Some(state) = line.ok().as_deref().and_then(numbers) else {
            eprintln!("line {} is not a state", i + 1);
            exit(2)
        };
        let (q, dq) = state.split_at(JOINTS);
        let (status, factor) = guard.factor(q.try_into().unwrap(), dq.try_into().unwrap());
        println!("{:.6} {}", factor.unwrap_or(0.0), text(status));
    }
}
