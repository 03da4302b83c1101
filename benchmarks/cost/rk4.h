/* SPDX-License-Identifier: BSD-3-Clause */
#ifndef RK4_H
#define RK4_H

#include "sample.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Peak force [N]; step times the fastest rate stays below share. NAN if the chain is singular. */
double rk4_peak_force(const sample *s, double share);

/* Shares of a limit between which the force at a safe speed lies, as in codegen/runtime/robot_safe_speed.c. */
#define RK4_NEAR 0.977
#define RK4_KEPT 0.99

/* Speed [m/s] at which that force is between these shares of limit. */
double rk4_safe_speed(const sample *s, double limit, double share);

#ifdef __cplusplus
}
#endif

#endif
