/* SPDX-License-Identifier: 0BSD */
/* Status texts, default parameters and body regions of ur5e. */
#include "ur5e_internal.h"

const char *ur5e_status_text(int status)
{
    switch (status) {
    case UR5E_OK:
        return "ok";
    case UR5E_NULL_POINTER:
        return "an argument is NULL";
    case UR5E_NOT_FINITE:
        return "an input is infinite or not a number";
    case UR5E_ZERO_DIRECTION:
        return "the direction is zero";
    case UR5E_OUT_OF_RANGE:
        return "an input is out of range";
    case UR5E_SINGULAR:
        return "the configuration is singular";
    case UR5E_LOOP_OPEN:
        return "a loop of the closed chain is open";
    case UR5E_NO_EQUILIBRIUM:
        return "no equilibrium of springs and gravity was found";
    case UR5E_UNRESOLVED:
        return "impacts cannot be followed to their end, and no bound is known";
    case UR5E_BOUNDED:
        return "impacts cannot be followed to their end; the result is on the safe side";
    case UR5E_FOREIGN_PARAMS:
        return "the parameters were not filled in for this library";
    default:
        return "unknown status";
    }
}

const char *ur5e_version(void)
{
    return UR5E_VERSION;
}

const char *ur5e_model_digest(void)
{
    return UR5E_MODEL_DIGEST;
}

int ur5e_fill_params(ur5e_params *p, unsigned int layout)
{
    if (p == NULL) {
        return UR5E_NULL_POINTER;
    }
    if (layout != UR5E_LAYOUT) {
        return UR5E_FOREIGN_PARAMS;
    }
    p->layout = layout;
    p->joint_stiffness[0] = UR5E_R(0.0);
    p->joint_stiffness[1] = UR5E_R(0.0);
    p->joint_stiffness[2] = UR5E_R(0.0);
    p->joint_stiffness[3] = UR5E_R(0.0);
    p->joint_stiffness[4] = UR5E_R(0.0);
    p->joint_stiffness[5] = UR5E_R(0.0);
    p->rotor_inertia[0] = UR5E_R(0.1);
    p->rotor_inertia[1] = UR5E_R(0.1);
    p->rotor_inertia[2] = UR5E_R(0.1);
    p->rotor_inertia[3] = UR5E_R(0.1);
    p->rotor_inertia[4] = UR5E_R(0.1);
    p->rotor_inertia[5] = UR5E_R(0.1);
    p->position_gain[0] = UR5E_R(0.0);
    p->position_gain[1] = UR5E_R(0.0);
    p->position_gain[2] = UR5E_R(0.0);
    p->position_gain[3] = UR5E_R(0.0);
    p->position_gain[4] = UR5E_R(0.0);
    p->position_gain[5] = UR5E_R(0.0);
    p->damping_gain[0] = UR5E_R(0.0);
    p->damping_gain[1] = UR5E_R(0.0);
    p->damping_gain[2] = UR5E_R(0.0);
    p->damping_gain[3] = UR5E_R(0.0);
    p->damping_gain[4] = UR5E_R(0.0);
    p->damping_gain[5] = UR5E_R(0.0);
    p->reaction_time = UR5E_R(0.02);
    p->horizon = UR5E_R(0.5);
    p->motors = UR5E_MOTORS_FREE_OR_DRIVEN;
    p->steps = 800;
    return UR5E_OK;
}

int ur5e_body_region(int part, int clamped, ur5e_region *region)
{
    static const ur5e_real numbers[12][4] = {
        /* stiffness, effective mass, quasi-static limit, limit */
        {UR5E_R(150000.0), UR5E_R(4.4), UR5E_R(130.0), UR5E_R(130.0)}, /* Skull and forehead */
        {UR5E_R(75000.0), UR5E_R(4.4), UR5E_R(65.0), UR5E_R(65.0)}, /* Face */
        {UR5E_R(50000.0), UR5E_R(1.2), UR5E_R(150.0), UR5E_R(300.0)}, /* Neck */
        {UR5E_R(35000.0), UR5E_R(40.0), UR5E_R(210.0), UR5E_R(420.0)}, /* Back and shoulders */
        {UR5E_R(25000.0), UR5E_R(40.0), UR5E_R(140.0), UR5E_R(280.0)}, /* Chest */
        {UR5E_R(10000.0), UR5E_R(40.0), UR5E_R(110.0), UR5E_R(220.0)}, /* Abdomen */
        {UR5E_R(25000.0), UR5E_R(40.0), UR5E_R(180.0), UR5E_R(360.0)}, /* Pelvis */
        {UR5E_R(30000.0), UR5E_R(3.0), UR5E_R(150.0), UR5E_R(300.0)}, /* Upper arms and elbow joints */
        {UR5E_R(40000.0), UR5E_R(2.0), UR5E_R(160.0), UR5E_R(320.0)}, /* Lower arms and wrist joints */
        {UR5E_R(75000.0), UR5E_R(0.6), UR5E_R(140.0), UR5E_R(280.0)}, /* Hands and fingers */
        {UR5E_R(50000.0), UR5E_R(75.0), UR5E_R(220.0), UR5E_R(440.0)}, /* Thighs and knees */
        {UR5E_R(60000.0), UR5E_R(75.0), UR5E_R(130.0), UR5E_R(260.0)}, /* Lower legs */
    };
    if (region == NULL) {
        return UR5E_NULL_POINTER;
    }
    if (part < 0 || part >= 12) {
        return UR5E_OUT_OF_RANGE;
    }
    region->stiffness = numbers[part][0];
    region->damping = UR5E_R(10.0);
    region->effective_mass = numbers[part][1];
    region->hertz_stiffness = UR5E_R(19000000.0);
    region->quasi_static_limit = numbers[part][2];
    region->force_limit = numbers[part][3];
    region->law = NULL;
    region->law_points = 0;
    region->clamped = clamped != 0;
    return UR5E_OK;
}
