/* SPDX-License-Identifier: 0BSD */
/* Status texts, default parameters and sines of rr. */
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
        return "the budget of steps is used up, and no bound is known";
    case RR_BOUNDED:
        return "the budget of steps is used up; the result is a bound on the safe side";
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
    p->damping_gain[0] = RR_R(0.0);
    p->damping_gain[1] = RR_R(0.0);
    p->damping_gain[2] = RR_R(0.0);
    p->damping_gain[3] = RR_R(0.0);
    p->reaction_time = RR_R(0.02);
    p->horizon = RR_R(0.5);
    p->motors = RR_MOTORS_FREE_OR_DRIVEN;
    p->steps = 8000;
    return RR_OK;
}

#if defined(RR_USE_FLOAT)
static void ask_library(const float *x, int count, float *s, float *c)
{
    for (int i = 0; i < count; ++i) {
        s[i] = sinf(x[i]);
        c[i] = cosf(x[i]);
    }
}

/*
 * Takes the nearest quarter turns off each angle; then a polynomial each. Error < 1.2e-07.
 * Whole turns are added before, so that truncation finds the nearest.
 */
void rr_sines_cosines(const float *x, int count, float *s, float *c)
{
    for (int i = 0; i < count; ++i) {
        if (!(fabsf(x[i]) < 200.0f)) {
            ask_library(x, count, s, c);
            return;
        }
        const float quarters = x[i]*0.636619772f + 128.5f;
        const int nearest = (int)quarters;
        const unsigned int quarter = (unsigned int)nearest;
        const float k = (float)nearest - 128.0f;
        const float about = (x[i] - k*1.5703125f) - k*0.00048375129699707f;
        const float r = about - k*7.54978995489188e-08f;
        const float z = r*r;
        const float odd = -0.166666552f + z*(0.00833217334f + z*-0.000195166562f);
        const float even = 0.0416666456f + z*(-0.00138873619f + z*2.44377297e-05f);
        const float sine = r + r*z*odd;
        const float cosine = 1.0f - 0.5f*z + z*z*even;
        const float first = (quarter & 1u) != 0u ? cosine : sine;
        const float second = (quarter & 1u) != 0u ? sine : cosine;
        s[i] = (quarter & 2u) != 0u ? -first : first;
        c[i] = ((quarter + 1u) & 2u) != 0u ? -second : second;
    }
}
#endif

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
    region->clamped = clamped != 0;
    return RR_OK;
}
