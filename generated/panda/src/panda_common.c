/* SPDX-License-Identifier: 0BSD */
/* Status texts, default parameters and body regions of panda. */
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
        return "an input is out of range";
    case PANDA_SINGULAR:
        return "the configuration is singular";
    case PANDA_LOOP_OPEN:
        return "a loop of the closed chain is open";
    case PANDA_NO_EQUILIBRIUM:
        return "no equilibrium of springs and gravity was found";
    case PANDA_UNRESOLVED:
        return "impacts cannot be followed to their end, and no bound is known";
    case PANDA_BOUNDED:
        return "impacts cannot be followed to their end; the result is on the safe side";
    case PANDA_FOREIGN_PARAMS:
        return "the parameters were not filled in for this library";
    default:
        return "unknown status";
    }
}

const char *panda_version(void)
{
    return PANDA_VERSION;
}

const char *panda_model_digest(void)
{
    return PANDA_MODEL_DIGEST;
}

int panda_fill_params(panda_params *p, unsigned int layout)
{
    if (p == NULL) {
        return PANDA_NULL_POINTER;
    }
    if (layout != PANDA_LAYOUT) {
        return PANDA_FOREIGN_PARAMS;
    }
    p->layout = layout;
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
    p->damping_gain[0] = PANDA_R(0.0);
    p->damping_gain[1] = PANDA_R(0.0);
    p->damping_gain[2] = PANDA_R(0.0);
    p->damping_gain[3] = PANDA_R(0.0);
    p->damping_gain[4] = PANDA_R(0.0);
    p->damping_gain[5] = PANDA_R(0.0);
    p->damping_gain[6] = PANDA_R(0.0);
    p->reaction_time = PANDA_R(0.02);
    p->horizon = PANDA_R(0.5);
    p->motors = PANDA_MOTORS_FREE_OR_DRIVEN;
    p->steps = 800;
    return PANDA_OK;
}

int panda_body_region(int part, int clamped, panda_region *region)
{
    static const panda_real numbers[12][4] = {
        /* stiffness, effective mass, quasi-static limit, limit */
        {PANDA_R(150000.0), PANDA_R(4.4), PANDA_R(130.0), PANDA_R(130.0)}, /* Skull and forehead */
        {PANDA_R(75000.0), PANDA_R(4.4), PANDA_R(65.0), PANDA_R(65.0)}, /* Face */
        {PANDA_R(50000.0), PANDA_R(1.2), PANDA_R(150.0), PANDA_R(300.0)}, /* Neck */
        {PANDA_R(35000.0), PANDA_R(40.0), PANDA_R(210.0), PANDA_R(420.0)}, /* Back and shoulders */
        {PANDA_R(25000.0), PANDA_R(40.0), PANDA_R(140.0), PANDA_R(280.0)}, /* Chest */
        {PANDA_R(10000.0), PANDA_R(40.0), PANDA_R(110.0), PANDA_R(220.0)}, /* Abdomen */
        {PANDA_R(25000.0), PANDA_R(40.0), PANDA_R(180.0), PANDA_R(360.0)}, /* Pelvis */
        {PANDA_R(30000.0), PANDA_R(3.0), PANDA_R(150.0), PANDA_R(300.0)}, /* Upper arms and elbow joints */
        {PANDA_R(40000.0), PANDA_R(2.0), PANDA_R(160.0), PANDA_R(320.0)}, /* Lower arms and wrist joints */
        {PANDA_R(75000.0), PANDA_R(0.6), PANDA_R(140.0), PANDA_R(280.0)}, /* Hands and fingers */
        {PANDA_R(50000.0), PANDA_R(75.0), PANDA_R(220.0), PANDA_R(440.0)}, /* Thighs and knees */
        {PANDA_R(60000.0), PANDA_R(75.0), PANDA_R(130.0), PANDA_R(260.0)}, /* Lower legs */
    };
    if (region == NULL) {
        return PANDA_NULL_POINTER;
    }
    if (part < 0 || part >= 12) {
        return PANDA_OUT_OF_RANGE;
    }
    region->stiffness = numbers[part][0];
    region->damping = PANDA_R(10.0);
    region->effective_mass = numbers[part][1];
    region->hertz_stiffness = PANDA_R(19000000.0);
    region->quasi_static_limit = numbers[part][2];
    region->force_limit = numbers[part][3];
    region->law = NULL;
    region->law_points = 0;
    region->clamped = clamped != 0;
    return PANDA_OK;
}
