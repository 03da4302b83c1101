/* SPDX-License-Identifier: 0BSD */
/* Status texts and default parameters of rr. */
#include "rr_internal.h"

const char *rr_status_text(int status)
{
    switch (status) {
    case RR_OK:
        return "ok";
    case RR_NULL_POINTER:
        return "an argument is NULL";
    case RR_NOT_FINITE:
        return "an input is infinite or not a number";
    case RR_ZERO_DIRECTION:
        return "the direction is zero";
    case RR_OUT_OF_RANGE:
        return "a parameter is out of range";
    case RR_SINGULAR:
        return "the configuration is singular";
    default:
        return "unknown status";
    }
}

int rr_default_params(rr_params *p)
{
    if (p == NULL) {
        return RR_NULL_POINTER;
    }
    p->rotor_inertia[0] = RR_R(0.0);
    p->rotor_inertia[1] = RR_R(0.0);
    p->rotor_inertia[2] = RR_R(0.0);
    p->rotor_inertia[3] = RR_R(0.0);
    p->position_gain[0] = RR_R(0.0);
    p->position_gain[1] = RR_R(0.0);
    p->position_gain[2] = RR_R(0.0);
    p->position_gain[3] = RR_R(0.0);
    return RR_OK;
}
