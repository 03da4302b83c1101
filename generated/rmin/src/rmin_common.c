/* SPDX-License-Identifier: 0BSD */
/* Status texts, default parameters and body regions of rmin. */
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
        return "an input is out of range";
    case RMIN_SINGULAR:
        return "the configuration is singular";
    case RMIN_LOOP_OPEN:
        return "a loop of the closed chain is open";
    case RMIN_NO_EQUILIBRIUM:
        return "no equilibrium of springs and gravity was found";
    case RMIN_UNRESOLVED:
        return "impacts cannot be followed to their end, and no bound is known";
    case RMIN_BOUNDED:
        return "impacts cannot be followed to their end; the result is on the safe side";
    case RMIN_FOREIGN_PARAMS:
        return "the parameters were not filled in for this library";
    default:
        return "unknown status";
    }
}

const char *rmin_version(void)
{
    return RMIN_VERSION;
}

const char *rmin_model_digest(void)
{
    return RMIN_MODEL_DIGEST;
}

int rmin_fill_params(rmin_params *p, unsigned int layout)
{
    if (p == NULL) {
        return RMIN_NULL_POINTER;
    }
    if (layout != RMIN_LAYOUT) {
        return RMIN_FOREIGN_PARAMS;
    }
    p->layout = layout;
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
    p->damping_gain[0] = RMIN_R(0.0);
    p->damping_gain[1] = RMIN_R(0.0);
    p->damping_gain[2] = RMIN_R(0.0);
    p->damping_gain[3] = RMIN_R(0.0);
    p->damping_gain[4] = RMIN_R(0.0);
    p->damping_gain[5] = RMIN_R(0.0);
    p->reaction_time = RMIN_R(0.02);
    p->horizon = RMIN_R(0.5);
    p->motors = RMIN_MOTORS_FREE_OR_DRIVEN;
    p->steps = 800;
    return RMIN_OK;
}

int rmin_body_region(int part, int clamped, rmin_region *region)
{
    static const rmin_real numbers[12][4] = {
        /* stiffness, effective mass, quasi-static limit, limit */
        {RMIN_R(150000.0), RMIN_R(4.4), RMIN_R(130.0), RMIN_R(130.0)}, /* Skull and forehead */
        {RMIN_R(75000.0), RMIN_R(4.4), RMIN_R(65.0), RMIN_R(65.0)}, /* Face */
        {RMIN_R(50000.0), RMIN_R(1.2), RMIN_R(150.0), RMIN_R(300.0)}, /* Neck */
        {RMIN_R(35000.0), RMIN_R(40.0), RMIN_R(210.0), RMIN_R(420.0)}, /* Back and shoulders */
        {RMIN_R(25000.0), RMIN_R(40.0), RMIN_R(140.0), RMIN_R(280.0)}, /* Chest */
        {RMIN_R(10000.0), RMIN_R(40.0), RMIN_R(110.0), RMIN_R(220.0)}, /* Abdomen */
        {RMIN_R(25000.0), RMIN_R(40.0), RMIN_R(180.0), RMIN_R(360.0)}, /* Pelvis */
        {RMIN_R(30000.0), RMIN_R(3.0), RMIN_R(150.0), RMIN_R(300.0)}, /* Upper arms and elbow joints */
        {RMIN_R(40000.0), RMIN_R(2.0), RMIN_R(160.0), RMIN_R(320.0)}, /* Lower arms and wrist joints */
        {RMIN_R(75000.0), RMIN_R(0.6), RMIN_R(140.0), RMIN_R(280.0)}, /* Hands and fingers */
        {RMIN_R(50000.0), RMIN_R(75.0), RMIN_R(220.0), RMIN_R(440.0)}, /* Thighs and knees */
        {RMIN_R(60000.0), RMIN_R(75.0), RMIN_R(130.0), RMIN_R(260.0)}, /* Lower legs */
    };
    if (region == NULL) {
        return RMIN_NULL_POINTER;
    }
    if (part < 0 || part >= 12) {
        return RMIN_OUT_OF_RANGE;
    }
    region->stiffness = numbers[part][0];
    region->damping = RMIN_R(10.0);
    region->effective_mass = numbers[part][1];
    region->hertz_stiffness = RMIN_R(19000000.0);
    region->quasi_static_limit = numbers[part][2];
    region->force_limit = numbers[part][3];
    region->law = NULL;
    region->law_points = 0;
    region->clamped = clamped != 0;
    return RMIN_OK;
}
