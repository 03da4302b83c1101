/* SPDX-License-Identifier: 0BSD */
/* Status texts and default parameters of rmin. */
#include "rmin_internal.h"

const char *rmin_status_text(int status)
{
    switch (status) {
    case RMIN_OK:
        return "ok";
    case RMIN_NULL_POINTER:
        return "an argument is NULL";
    case RMIN_NOT_FINITE:
        return "an input is infinite or not a number";
    case RMIN_ZERO_DIRECTION:
        return "the direction is zero";
    case RMIN_OUT_OF_RANGE:
        return "a parameter is out of range";
    case RMIN_SINGULAR:
        return "the configuration is singular";
    case RMIN_LOOP_OPEN:
        return "a loop of the closed chain is open";
    case RMIN_NO_EQUILIBRIUM:
        return "no equilibrium of springs and gravity was found";
    default:
        return "unknown status";
    }
}

int rmin_default_params(rmin_params *p)
{
    if (p == NULL) {
        return RMIN_NULL_POINTER;
    }
    p->rotor_inertia[0] = RMIN_R(0.0);
    p->rotor_inertia[1] = RMIN_R(0.0);
    p->rotor_inertia[2] = RMIN_R(0.0);
    p->rotor_inertia[3] = RMIN_R(0.0);
    p->rotor_inertia[4] = RMIN_R(0.0);
    p->rotor_inertia[5] = RMIN_R(0.0);
    p->position_gain[0] = RMIN_R(0.0);
    p->position_gain[1] = RMIN_R(0.0);
    p->position_gain[2] = RMIN_R(0.0);
    p->position_gain[3] = RMIN_R(0.0);
    p->position_gain[4] = RMIN_R(0.0);
    p->position_gain[5] = RMIN_R(0.0);
    return RMIN_OK;
}
