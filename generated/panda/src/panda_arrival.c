/* SPDX-License-Identifier: 0BSD */
/* Robot_ about to touch, and what its impacts are prepared with. */
#include "panda_impact.h"

/* Squared share of n that may point where motors never move the contact point. */
#define OUTSIDE PANDA_R(1e-6)
#define MOST_STEPS 1000000
/* Noise of a squared frequency, times the squared time of a servo, that moves the robot too much. */
#define BLURS PANDA_R(1.6e-2)

int panda_check_impact(const panda_region *region, const panda_params *p)
{
    if (p->layout != PANDA_LAYOUT) {
        return PANDA_FOREIGN_PARAMS;
    }
    const panda_real numbers[4] = {region->stiffness, region->damping, region->hertz_stiffness,
        region->clamped != 0 ? PANDA_R(1.0) : region->effective_mass};
    if (!panda_all_finite(numbers, 4)) {
        return PANDA_NOT_FINITE;
    }
    const bool body = region->stiffness > PANDA_R(0.0) && region->damping >= PANDA_R(0.0)
        && region->hertz_stiffness > PANDA_R(0.0) && numbers[3] > PANDA_R(0.0);
    const panda_real horizon = PANDA_HORIZON(p);
    const panda_real reaction = PANDA_REACTION_TIME(p);
    int status = panda_check_positive(&horizon, 1);
    if (status == PANDA_OK) {
        status = panda_check_not_negative(&reaction, 1);
    }
    for (int i = 0; i < PANDA_N && status == PANDA_OK; ++i) {
        const panda_real gains[2] = {PANDA_GAIN(p, i), PANDA_DAMPING_GAIN(p, i)};
        status = panda_check_not_negative(gains, 2);
#if PANDA_ELASTIC
        const panda_real drive[2] = {PANDA_SPRING(p, i), PANDA_ROTOR(p, i)};
        status = status == PANDA_OK ? panda_check_positive(drive, 2) : status;
#endif
    }
    if (status != PANDA_OK) {
        return status;
    }
    const bool motion = p->motors >= PANDA_MOTORS_FREE_OR_DRIVEN && p->motors <= PANDA_MOTORS_SERVO
        && p->steps > 0 && p->steps <= MOST_STEPS;
    return body && motion ? PANDA_OK : PANDA_OUT_OF_RANGE;
}

int panda_arrive(const panda_real n[3], int point, panda_arrival *arrival)
{
    panda_real u[3];
    const int status = panda_unit_vector(n, u);
    if (status != PANDA_OK) {
        return status;
    }
    const panda_real (*const J)[PANDA_N] = (const panda_real (*)[PANDA_N])&arrival->links.J[3*point];
    panda_matrix square;
    panda_real moved[PANDA_REACH][PANDA_N];
    panda_real share[PANDA_SYSTEM];
    panda_real within = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        arrival->row[i] = u[0]*J[0][i] + u[1]*J[1][i] + u[2]*J[2][i];
    }
    for (int k = 0; k < PANDA_REACH; ++k) {
        const panda_real *const d = panda_directions[k];
        share[k] = d[0]*u[0] + d[1]*u[1] + d[2]*u[2];
        within += share[k]*share[k];
        for (int i = 0; i < PANDA_N; ++i) {
            moved[k][i] = panda_has_motor[i] ? d[0]*J[0][i] + d[1]*J[1][i] + d[2]*J[2][i] : PANDA_R(0.0);
        }
        for (int l = 0; l <= k; ++l) {
            panda_real sum = PANDA_R(0.0);
            for (int i = 0; i < PANDA_N; ++i) {
                sum += moved[k][i]*moved[l][i];
            }
            square[k][l] = sum;
            square[l][k] = sum;
        }
    }
    if (!(within > PANDA_R(1.0) - OUTSIDE) || !panda_cholesky(PANDA_REACH, square)) {
        return PANDA_SINGULAR;
    }
    panda_forward(PANDA_REACH, square, share);
    panda_backward(PANDA_REACH, square, share);
    panda_real fast = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        panda_real rate = PANDA_R(0.0);
        for (int k = 0; k < PANDA_REACH; ++k) {
            rate += moved[k][i]*share[k];
        }
        arrival->rates[i] = rate;
        fast += rate*rate;
    }
    return fast < PANDA_FASTEST ? PANDA_OK : PANDA_SINGULAR;
}

void panda_kinds_of_motors(const panda_params *p, int *first, int *last)
{
    const bool both = p->motors == PANDA_MOTORS_FREE_OR_DRIVEN;
    *first = both ? PANDA_MOTORS_FREE : p->motors;
    *last = both ? PANDA_MOTORS_DRIVEN : p->motors;
}

/* Largest stiffness of the skin up to a force. */
static panda_real skin_stiffness(const panda_region *region, panda_real force)
{
    const panda_real third = PANDA_R(1.0)/PANDA_R(3.0);
    return PANDA_R(1.5)*PANDA_POW(region->hertz_stiffness*region->hertz_stiffness*force, third);
}

panda_real panda_two_body_force(const panda_region *region, panda_real mobility, panda_real speed)
{
    const panda_real spring = speed*PANDA_SQRT(region->stiffness/mobility);
    const panda_real energy = PANDA_R(1.25)*speed*speed/mobility;
    const panda_real skin = PANDA_POW(energy, PANDA_R(0.6))*PANDA_POW(region->hertz_stiffness, PANDA_R(0.4));
    return PANDA_R(1.0)/(PANDA_R(1.0)/spring + PANDA_R(1.0)/skin);
}

panda_real panda_two_body_speed(const panda_region *region, panda_real mobility, panda_real force)
{
    const panda_real depth = PANDA_POW(force/region->hertz_stiffness, PANDA_R(2.0)/PANDA_R(3.0));
    return PANDA_SQRT(mobility*force*(force/region->stiffness + PANDA_R(0.8)*depth));
}

/* Modes of a phase. */
static int modes_of(panda_impact *impact, int which)
{
    panda_phase *const phase = &impact->phase[which];
    phase->drift = PANDA_R(0.0);
    phase->modes.noise = PANDA_R(0.0);
    phase->damped = false;
    for (int i = 0; i < PANDA_N; ++i) {
        phase->damping[i] = PANDA_R(0.0);
    }
    if (which == PANDA_LOOSE) {
        return panda_free_modes(&impact->arrival, impact->p, &phase->modes, impact->carried);
    }
    if (impact->motors == PANDA_MOTORS_DRIVEN) {
        return panda_driven_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < PANDA_N; ++i) {
        phase->damping[i] = PANDA_DAMPING_GAIN(impact->p, i);
        phase->damped = phase->damped || phase->damping[i] > PANDA_R(0.0);
    }
    return panda_servo_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
}

#if !PANDA_STRUCTURED
static panda_real mobility_of(const panda_modes *modes)
{
    panda_real sum = PANDA_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        sum += modes->row[i]*modes->row[i];
    }
    return sum;
}
#endif

/* Times at which a phase begins and ends. */
static panda_real time_of(const panda_impact *impact, int which)
{
    const panda_real horizon = PANDA_HORIZON(impact->p);
    const panda_real until = which < impact->last ? PANDA_REACTION_TIME(impact->p) : horizon;
    return which > impact->first ? horizon - PANDA_REACTION_TIME(impact->p) : until;
}

static void steps_of(panda_impact *impact, int which)
{
    panda_phase *const phase = &impact->phase[which];
    const panda_real time = time_of(impact, which);
    phase->blurred = phase->modes.noise*time*time > BLURS;
    panda_phase_steps(impact, time, phase);
    const panda_real numbers[2] = {phase->level[0].h, phase->level[PANDA_LEVELS - 1].h};
    if (panda_check_positive(numbers, 2) != PANDA_OK) {
        impact->status = PANDA_SINGULAR;
    }
}

void panda_impact_let_go(panda_impact *impact)
{
    if (!impact->phase[PANDA_LOOSE].ready) {
        impact->status = modes_of(impact, PANDA_LOOSE);
        if (impact->status == PANDA_OK) {
            steps_of(impact, PANDA_LOOSE);
        }
    }
}

/* Mobilities of the contact, and modes where those need them. */
static void weigh(panda_impact *impact)
{
    const panda_real body = impact->gives_way ? PANDA_R(1.0)/impact->region->effective_mass : PANDA_R(0.0);
    panda_real mobility = PANDA_R(0.0);
#if PANDA_STRUCTURED
    impact->status = panda_mobilities(&impact->arrival, impact->p, &mobility, &impact->rotors);
#else
    for (int k = impact->first; k <= impact->last && impact->status == PANDA_OK; ++k) {
        impact->status = modes_of(impact, k);
        mobility = PANDA_FMAX(mobility, mobility_of(&impact->phase[k].modes));
    }
    impact->rotors = PANDA_R(0.0);
    const bool held = !PANDA_ELASTIC && impact->last == PANDA_LED && impact->motors == PANDA_MOTORS_DRIVEN;
    if (!(mobility > PANDA_LEAST_MOBILITY) && !held) {
        impact->status = PANDA_SINGULAR;
    }
#endif
    impact->mobility = PANDA_FMAX(mobility, PANDA_LEAST_MOBILITY) + body;
}

int panda_impact_prepare(const panda_region *region, const panda_params *p, int motors,
    panda_real force, panda_impact *impact)
{
    const panda_real reaction = PANDA_REACTION_TIME(p);
    const bool loose = motors == PANDA_MOTORS_FREE || !(reaction > PANDA_R(0.0));
    impact->region = region;
    impact->p = p;
    impact->motors = motors;
    impact->gives_way = region->clamped == 0;
    impact->first = loose ? PANDA_LOOSE : PANDA_LED;
    impact->last = loose || reaction < PANDA_HORIZON(p) ? PANDA_LOOSE : PANDA_LED;
    impact->status = PANDA_OK;
    impact->phase[PANDA_LED].ready = false;
    impact->phase[PANDA_LOOSE].ready = false;
    weigh(impact);
    if (impact->status != PANDA_OK) {
        return impact->status;
    }
    const panda_real size =
        force > PANDA_R(0.0) ? force : panda_two_body_force(region, impact->mobility, -force);
    impact->scale = PANDA_R(0.4)*size;
    impact->hold = region->stiffness + region->damping*region->damping*impact->mobility;
    const panda_real damped = region->damping*PANDA_SQRT(impact->mobility/region->stiffness);
    impact->smooth = PANDA_R(1.0)/(PANDA_R(1.0) + PANDA_R(4.0)*damped);
    impact->skin_rate = skin_stiffness(region, size)*impact->mobility;
    const panda_real numbers[3] = {impact->mobility, impact->scale, impact->skin_rate};
    if (!panda_all_finite(numbers, 3) || panda_check_positive(numbers, 3) != PANDA_OK) {
        return PANDA_SINGULAR;
    }
#if PANDA_STRUCTURED
    impact->status = modes_of(impact, impact->first);
    if (impact->status == PANDA_OK) {
        steps_of(impact, impact->first);
    }
#else
    for (int k = impact->first; k <= impact->last; ++k) {
        steps_of(impact, k);
    }
#endif
    return impact->status;
}
