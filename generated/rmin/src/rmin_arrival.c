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
static int modes_of(rmin_impact *impact, int which)
{
    rmin_phase *const phase = &impact->phase[which];
    phase->drift = RMIN_R(0.0);
    phase->modes.noise = RMIN_R(0.0);
    phase->damped = false;
    for (int i = 0; i < RMIN_N; ++i) {
        phase->damping[i] = RMIN_R(0.0);
    }
    if (which == RMIN_LOOSE) {
        return rmin_free_modes(&impact->arrival, impact->p, &phase->modes, impact->carried);
    }
    if (impact->motors == RMIN_MOTORS_DRIVEN) {
        return rmin_driven_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < RMIN_N; ++i) {
        phase->damping[i] = RMIN_DAMPING_GAIN(impact->p, i);
        phase->damped = phase->damped || phase->damping[i] > RMIN_R(0.0);
    }
    return rmin_servo_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
}

#if !RMIN_STRUCTURED
static rmin_real mobility_of(const rmin_modes *modes)
{
    rmin_real sum = RMIN_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        sum += modes->row[i]*modes->row[i];
    }
    return sum;
}
#endif

/* Times at which a phase begins and ends. */
static rmin_real time_of(const rmin_impact *impact, int which)
{
    const rmin_real horizon = RMIN_HORIZON(impact->p);
    const rmin_real until = which < impact->last ? RMIN_REACTION_TIME(impact->p) : horizon;
    return which > impact->first ? horizon - RMIN_REACTION_TIME(impact->p) : until;
}

static void steps_of(rmin_impact *impact, int which)
{
    rmin_phase *const phase = &impact->phase[which];
    const rmin_real time = time_of(impact, which);
    phase->blurred = phase->modes.noise*time*time > BLURS;
    rmin_phase_steps(impact, time, phase);
    const rmin_real numbers[2] = {phase->level[0].h, phase->level[RMIN_LEVELS - 1].h};
    if (rmin_check_positive(numbers, 2) != RMIN_OK) {
        impact->status = RMIN_SINGULAR;
    }
}

void rmin_impact_let_go(rmin_impact *impact)
{
    if (!impact->phase[RMIN_LOOSE].ready) {
        impact->status = modes_of(impact, RMIN_LOOSE);
        if (impact->status == RMIN_OK) {
            steps_of(impact, RMIN_LOOSE);
        }
    }
}

/* Mobilities of the contact, and modes where those need them. */
static void weigh(rmin_impact *impact)
{
    const rmin_real body = impact->gives_way ? RMIN_R(1.0)/impact->region->effective_mass : RMIN_R(0.0);
    rmin_real mobility = RMIN_R(0.0);
#if RMIN_STRUCTURED
    impact->status = rmin_mobilities(&impact->arrival, impact->p, &mobility, &impact->rotors);
#else
    for (int k = impact->first; k <= impact->last && impact->status == RMIN_OK; ++k) {
        impact->status = modes_of(impact, k);
        mobility = RMIN_FMAX(mobility, mobility_of(&impact->phase[k].modes));
    }
    impact->rotors = RMIN_R(0.0);
    const bool held = !RMIN_ELASTIC && impact->last == RMIN_LED && impact->motors == RMIN_MOTORS_DRIVEN;
    if (!(mobility > RMIN_LEAST_MOBILITY) && !held) {
        impact->status = RMIN_SINGULAR;
    }
#endif
    impact->mobility = RMIN_FMAX(mobility, RMIN_LEAST_MOBILITY) + body;
}

int rmin_impact_prepare(const rmin_region *region, const rmin_params *p, int motors,
    rmin_real force, rmin_impact *impact)
{
    const rmin_real reaction = RMIN_REACTION_TIME(p);
    const bool loose = motors == RMIN_MOTORS_FREE || !(reaction > RMIN_R(0.0));
    impact->region = region;
    impact->p = p;
    impact->motors = motors;
    impact->gives_way = region->clamped == 0;
    impact->first = loose ? RMIN_LOOSE : RMIN_LED;
    impact->last = loose || reaction < RMIN_HORIZON(p) ? RMIN_LOOSE : RMIN_LED;
    impact->status = RMIN_OK;
    impact->phase[RMIN_LED].ready = false;
    impact->phase[RMIN_LOOSE].ready = false;
    weigh(impact);
    if (impact->status != RMIN_OK) {
        return impact->status;
    }
    const rmin_real size =
        force > RMIN_R(0.0) ? force : rmin_two_body_force(region, impact->mobility, -force);
    impact->scale = RMIN_R(0.4)*size;
    impact->hold = region->stiffness + region->damping*region->damping*impact->mobility;
    const rmin_real damped = region->damping*RMIN_SQRT(impact->mobility/region->stiffness);
    impact->smooth = RMIN_R(1.0)/(RMIN_R(1.0) + RMIN_R(4.0)*damped);
    impact->skin_rate = skin_stiffness(region, size)*impact->mobility;
    const rmin_real numbers[3] = {impact->mobility, impact->scale, impact->skin_rate};
    if (!rmin_all_finite(numbers, 3) || rmin_check_positive(numbers, 3) != RMIN_OK) {
        return RMIN_SINGULAR;
    }
#if RMIN_STRUCTURED
    impact->status = modes_of(impact, impact->first);
    if (impact->status == RMIN_OK) {
        steps_of(impact, impact->first);
    }
#else
    for (int k = impact->first; k <= impact->last; ++k) {
        steps_of(impact, k);
    }
#endif
    return impact->status;
}
