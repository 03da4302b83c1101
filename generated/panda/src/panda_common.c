/* SPDX-License-Identifier: 0BSD */
/* Status texts and default parameters of panda. */
#include "panda_internal.h"

const char *panda_status_text(int status)
{
    switch (status) {
    case PANDA_OK:
        return "ok";
    case PANDA_NULL_POINTER:
        return "an argument is NULL";
    case PANDA_NOT_FINITE:
        return "an input is infinite or not a number";
    case PANDA_ZERO_DIRECTION:
        return "the direction is zero";
    case PANDA_OUT_OF_RANGE:
        return "a parameter is out of range";
    case PANDA_SINGULAR:
        return "the configuration is singular";
    default:
        return "unknown status";
    }
}

int panda_default_params(panda_params *p)
{
    if (p == NULL) {
        return PANDA_NULL_POINTER;
    }
    p->joint_stiffness[0] = PANDA_R(0.0);
    p->joint_stiffness[1] = PANDA_R(0.0);
    p->joint_stiffness[2] = PANDA_R(0.0);
    p->joint_stiffness[3] = PANDA_R(0.0);
    p->joint_stiffness[4] = PANDA_R(0.0);
    p->joint_stiffness[5] = PANDA_R(0.0);
    p->joint_stiffness[6] = PANDA_R(0.0);
    p->rotor_inertia[0] = PANDA_R(0.605721456);
    p->rotor_inertia[1] = PANDA_R(0.605721456);
    p->rotor_inertia[2] = PANDA_R(0.462474144);
    p->rotor_inertia[3] = PANDA_R(0.462474144);
    p->rotor_inertia[4] = PANDA_R(0.205544064);
    p->rotor_inertia[5] = PANDA_R(0.205544064);
    p->rotor_inertia[6] = PANDA_R(0.205544064);
    p->position_gain[0] = PANDA_R(0.0);
    p->position_gain[1] = PANDA_R(0.0);
    p->position_gain[2] = PANDA_R(0.0);
    p->position_gain[3] = PANDA_R(0.0);
    p->position_gain[4] = PANDA_R(0.0);
    p->position_gain[5] = PANDA_R(0.0);
    p->position_gain[6] = PANDA_R(0.0);
    return PANDA_OK;
}
