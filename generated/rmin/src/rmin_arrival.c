/* SPDX-License-Identifier: 0BSD */
/* Robot_ about to touch, and what its impacts are prepared with. */
#include "rmin_impact.h"

/* Squared share of n that may point where motors never move the contact point. */
#define OUTSIDE RMIN_R(1e-6)
#define MOST_STEPS 1000000
/* Noise of a squared frequency, times the squared time of a servo, that moves the robot too much. */
#define BLURS RMIN_R(1.6e-2)

int rmin_check_impact(const rmin_region *region, const rmin_params *p)
{
    if (p->layout != RMIN_LAYOUT) {
        return RMIN_FOREIGN_PARAMS;
    }
    const rmin_real numbers[4] = {region->stiffness, region->damping, region->hertz_stiffness,
        region->clamped != 0 ? RMIN_R(1.0) : region->effective_mass};
    if (!rmin_all_finite(numbers, 4)) {
        return RMIN_NOT_FINITE;
    }
    const bool body = region->stiffness > RMIN_R(0.0) && region->damping >= RMIN_R(0.0)
        && region->hertz_stiffness > RMIN_R(0.0) && numbers[3] > RMIN_R(0.0);
    const rmin_real horizon = RMIN_HORIZON(p);
    const rmin_real reaction = RMIN_REACTION_TIME(p);
    int status = rmin_check_positive(&horizon, 1);
    if (status == RMIN_OK) {
        status = rmin_check_not_negative(&reaction, 1);
    }
    for (int i = 0; i < RMIN_N && status == RMIN_OK; ++i) {
        const rmin_real gains[2] = {RMIN_GAIN(p, i), RMIN_DAMPING_GAIN(p, i)};
        status = rmin_check_not_negative(gains, 2);
#if RMIN_ELASTIC
        const rmin_real drive[2] = {RMIN_SPRING(p, i), RMIN_ROTOR(p, i)};
        status = status == RMIN_OK ? rmin_check_positive(drive, 2) : status;
#endif
    }
    if (status != RMIN_OK) {
        return status;
    }
    const bool motion = p->motors >= RMIN_MOTORS_FREE_OR_DRIVEN && p->motors <= RMIN_MOTORS_SERVO
        && p->steps > 0 && p->steps <= MOST_STEPS;
    return body && motion ? RMIN_OK : RMIN_OUT_OF_RANGE;
}

int rmin_arrive(const rmin_real n[3], int point, rmin_arrival *arrival)
{
    rmin_real u[3];
    const int status = rmin_unit_vector(n, u);
    if (status != RMIN_OK) {
        return status;
    }
    const rmin_real (*const J)[RMIN_N] = (const rmin_real (*)[RMIN_N])&arrival->links.J[3*point];
    rmin_matrix square;
    rmin_real moved[RMIN_REACH][RMIN_N];
    rmin_real share[RMIN_SYSTEM];
    rmin_real within = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        arrival->row[i] = u[0]*J[0][i] + u[1]*J[1][i] + u[2]*J[2][i];
    }
    for (int k = 0; k < RMIN_REACH; ++k) {
        const rmin_real *const d = rmin_directions[k];
        share[k] = d[0]*u[0] + d[1]*u[1] + d[2]*u[2];
        within += share[k]*share[k];
        for (int i = 0; i < RMIN_N; ++i) {
            moved[k][i] = rmin_has_motor[i] ? d[0]*J[0][i] + d[1]*J[1][i] + d[2]*J[2][i] : RMIN_R(0.0);
        }
        for (int l = 0; l <= k; ++l) {
            rmin_real sum = RMIN_R(0.0);
            for (int i = 0; i < RMIN_N; ++i) {
                sum += moved[k][i]*moved[l][i];
            }
            square[k][l] = sum;
            square[l][k] = sum;
        }
    }
    if (!(within > RMIN_R(1.0) - OUTSIDE) || !rmin_cholesky(RMIN_REACH, square)) {
        return RMIN_SINGULAR;
    }
    rmin_forward(RMIN_REACH, square, share);
    rmin_backward(RMIN_REACH, square, share);
    rmin_real fast = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        rmin_real rate = RMIN_R(0.0);
        for (int k = 0; k < RMIN_REACH; ++k) {
            rate += moved[k][i]*share[k];
        }
        arrival->rates[i] = rate;
        fast += rate*rate;
    }
    return fast < RMIN_FASTEST ? RMIN_OK : RMIN_SINGULAR;
}

void rmin_kinds_of_motors(const rmin_params *p, int *first, int *last)
{
    const bool both = p->motors == RMIN_MOTORS_FREE_OR_DRIVEN;
    *first = both ? RMIN_MOTORS_FREE : p->motors;
    *last = both ? RMIN_MOTORS_DRIVEN : p->motors;
}

/* Largest stiffness of the skin up to a force. */
static rmin_real skin_stiffness(const rmin_region *region, rmin_real force)
{
    const rmin_real third = RMIN_R(1.0)/RMIN_R(3.0);
    return RMIN_R(1.5)*RMIN_POW(region->hertz_stiffness*region->hertz_stiffness*force, third);
}

rmin_real rmin_two_body_force(const rmin_region *region, rmin_real mobility, rmin_real speed)
{
    const rmin_real spring = speed*RMIN_SQRT(region->stiffness/mobility);
    const rmin_real energy = RMIN_R(1.25)*speed*speed/mobility;
    const rmin_real skin = RMIN_POW(energy, RMIN_R(0.6))*RMIN_POW(region->hertz_stiffness, RMIN_R(0.4));
    return RMIN_R(1.0)/(RMIN_R(1.0)/spring + RMIN_R(1.0)/skin);
}

rmin_real rmin_two_body_speed(const rmin_region *region, rmin_real mobility, rmin_real force)
{
    const rmin_real depth = RMIN_POW(force/region->hertz_stiffness, RMIN_R(2.0)/RMIN_R(3.0));
    return RMIN_SQRT(mobility*force*(force/region->stiffness + RMIN_R(0.8)*depth));
}

/* Modes of a phase. */
static int modes_of(int motors, const rmin_params *p, rmin_impact *impact, rmin_phase *phase)
{
    phase->drift = RMIN_R(0.0);
    phase->modes.noise = RMIN_R(0.0);
    phase->damped = false;
    for (int i = 0; i < RMIN_N; ++i) {
        phase->damping[i] = RMIN_R(0.0);
    }
    if (motors == RMIN_MOTORS_FREE) {
        return rmin_free_modes(&impact->arrival, p, &phase->modes, impact->carried);
    }
    if (motors == RMIN_MOTORS_DRIVEN) {
        return rmin_driven_modes(&impact->arrival, p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < RMIN_N; ++i) {
        phase->damping[i] = RMIN_DAMPING_GAIN(p, i);
        phase->damped = phase->damped || phase->damping[i] > RMIN_R(0.0);
    }
    return rmin_servo_modes(&impact->arrival, p, &phase->modes, &phase->drift);
}

static rmin_real mobility_of(const rmin_modes *modes)
{
    rmin_real sum = RMIN_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        sum += modes->row[i]*modes->row[i];
    }
    return sum;
}

int rmin_impact_prepare(const rmin_region *region, const rmin_params *p, int motors,
    rmin_real force, rmin_impact *impact)
{
    const rmin_real horizon = RMIN_HORIZON(p);
    const rmin_real reaction = RMIN_REACTION_TIME(p);
    const bool released = motors != RMIN_MOTORS_FREE && reaction < horizon;
    const bool at_once = released && !(reaction > RMIN_R(0.0));
    impact->phases = released && !at_once ? 2 : 1;
    int status = modes_of(at_once ? RMIN_MOTORS_FREE : motors, p, impact, &impact->phase[0]);
    if (status == RMIN_OK && impact->phases == 2) {
        status = modes_of(RMIN_MOTORS_FREE, p, impact, &impact->phase[1]);
    }
    if (status != RMIN_OK) {
        return status;
    }
    const rmin_real served = RMIN_FMIN(reaction, horizon);
    impact->blurred = impact->phase[0].modes.noise*served*served > BLURS;
    impact->stiffness = region->stiffness;
    impact->damping = region->damping;
    impact->skin = region->hertz_stiffness;
    impact->gives_way = region->clamped == 0;
    const rmin_real body = impact->gives_way ? RMIN_R(1.0)/region->effective_mass : RMIN_R(0.0);
    rmin_real mobility = RMIN_R(0.0);
    for (int k = 0; k < impact->phases; ++k) {
        mobility = RMIN_FMAX(mobility, mobility_of(&impact->phase[k].modes));
    }
    const bool moves = mobility > RMIN_LEAST_MOBILITY;
    if (!moves && (RMIN_ELASTIC || motors == RMIN_MOTORS_FREE || impact->phases == 2)) {
        return RMIN_SINGULAR;
    }
    impact->mobility = RMIN_FMAX(mobility, RMIN_LEAST_MOBILITY) + body;
    const rmin_real size =
        force > RMIN_R(0.0) ? force : rmin_two_body_force(region, impact->mobility, -force);
    impact->scale = RMIN_R(0.4)*size;
    const rmin_real damped = region->damping*RMIN_SQRT(impact->mobility/region->stiffness);
    impact->smooth = RMIN_R(1.0)/(RMIN_R(1.0) + RMIN_R(4.0)*damped);
    const rmin_real skin_rate = skin_stiffness(region, size)*impact->mobility;
    for (int k = 0; k < impact->phases; ++k) {
        const rmin_real from = k > 0 ? reaction : RMIN_R(0.0);
        const rmin_real until = k == 0 && impact->phases == 2 ? reaction : horizon;
        rmin_phase_steps(region, impact->mobility, skin_rate, until - from, k > 0, &impact->phase[k]);
    }
#if RMIN_ELASTIC
    for (int i = 0; i < RMIN_N; ++i) {
        impact->springs[i] = RMIN_SPRING(p, i);
        impact->rotors[i] = RMIN_ROTOR(p, i);
    }
#endif
    impact->bound = rmin_bound(p, motors, impact);
    const rmin_real numbers[4] = {impact->mobility, impact->scale, impact->phase[0].level[0].h,
        impact->phase[impact->phases - 1].level[0].h};
    return rmin_all_finite(numbers, 4) && rmin_check_positive(numbers, 4) == RMIN_OK
        ? RMIN_OK : RMIN_SINGULAR;
}
