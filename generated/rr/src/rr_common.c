/* SPDX-License-Identifier: 0BSD */
/* Status texts, default parameters and body regions of rr. */
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
        return "an input is out of range";
    case RR_SINGULAR:
        return "the configuration is singular";
    case RR_LOOP_OPEN:
        return "a loop of the closed chain is open";
    case RR_NO_EQUILIBRIUM:
        return "no equilibrium of springs and gravity was found";
    case RR_UNRESOLVED:
        return "impacts cannot be followed to their end, and no bound is known";
    case RR_BOUNDED:
        return "impacts cannot be followed to their end; the result is on the safe side";
    case RR_FOREIGN_PARAMS:
        return "the parameters were not filled in for this library";
    default:
        return "unknown status";
    }
}

const char *rr_version(void)
{
    return RR_VERSION;
}

const char *rr_model_digest(void)
{
    return RR_MODEL_DIGEST;
}

int rr_fill_params(rr_params *p, unsigned int layout)
{
    if (p == NULL) {
        return RR_NULL_POINTER;
    }
    if (layout != RR_LAYOUT) {
        return RR_FOREIGN_PARAMS;
    }
    p->layout = layout;
    p->rotor_inertia[0] = RR_R(0.0);
    p->rotor_inertia[1] = RR_R(0.0);
    p->rotor_inertia[2] = RR_R(0.0);
    p->rotor_inertia[3] = RR_R(0.0);
    p->position_gain[0] = RR_R(0.0);
    p->position_gain[1] = RR_R(0.0);
    p->position_gain[2] = RR_R(0.0);
    p->position_gain[3] = RR_R(0.0);
    p->damping_gain[0] = RR_R(0.0);
    p->damping_gain[1] = RR_R(0.0);
    p->damping_gain[2] = RR_R(0.0);
    p->damping_gain[3] = RR_R(0.0);
    p->reaction_time = RR_R(0.02);
    p->horizon = RR_R(0.5);
    p->motors = RR_MOTORS_FREE_OR_DRIVEN;
    p->steps = 800;
    return RR_OK;
}

int rr_body_region(int part, int clamped, rr_region *region)
{
    static const rr_real numbers[12][4] = {
        /* stiffness, effective mass, quasi-static limit, limit */
        {RR_R(150000.0), RR_R(4.4), RR_R(130.0), RR_R(130.0)}, /* Skull and forehead */
        {RR_R(75000.0), RR_R(4.4), RR_R(65.0), RR_R(65.0)}, /* Face */
        {RR_R(50000.0), RR_R(1.2), RR_R(150.0), RR_R(300.0)}, /* Neck */
        {RR_R(35000.0), RR_R(40.0), RR_R(210.0), RR_R(420.0)}, /* Back and shoulders */
        {RR_R(25000.0), RR_R(40.0), RR_R(140.0), RR_R(280.0)}, /* Chest */
        {RR_R(10000.0), RR_R(40.0), RR_R(110.0), RR_R(220.0)}, /* Abdomen */
        {RR_R(25000.0), RR_R(40.0), RR_R(180.0), RR_R(360.0)}, /* Pelvis */
        {RR_R(30000.0), RR_R(3.0), RR_R(150.0), RR_R(300.0)}, /* Upper arms and elbow joints */
        {RR_R(40000.0), RR_R(2.0), RR_R(160.0), RR_R(320.0)}, /* Lower arms and wrist joints */
        {RR_R(75000.0), RR_R(0.6), RR_R(140.0), RR_R(280.0)}, /* Hands and fingers */
        {RR_R(50000.0), RR_R(75.0), RR_R(220.0), RR_R(440.0)}, /* Thighs and knees */
        {RR_R(60000.0), RR_R(75.0), RR_R(130.0), RR_R(260.0)}, /* Lower legs */
    };
    if (region == NULL) {
        return RR_NULL_POINTER;
    }
    if (part < 0 || part >= 12) {
        return RR_OUT_OF_RANGE;
    }
    region->stiffness = numbers[part][0];
    region->damping = RR_R(10.0);
    region->effective_mass = numbers[part][1];
    region->hertz_stiffness = RR_R(19000000.0);
    region->quasi_static_limit = numbers[part][2];
    region->force_limit = numbers[part][3];
    region->law = NULL;
    region->law_points = 0;
    region->clamped = clamped != 0;
    return RR_OK;
}
