/* SPDX-License-Identifier: 0BSD */
/* Robot_ about to touch, and what its impacts are prepared with. */
#include "ur5e_impact.h"

/* Squared share of n that may point where motors never move the contact point. */
#define OUTSIDE UR5E_R(1e-6)
#define MOST_STEPS 1000000
/* Noise of a squared frequency, times the squared time of a servo, that moves the robot too much. */
#define BLURS UR5E_R(1.6e-2)

int ur5e_check_impact(const ur5e_region *region, const ur5e_params *p)
{
    if (p->layout != UR5E_LAYOUT) {
        return UR5E_FOREIGN_PARAMS;
    }
    const ur5e_real numbers[4] = {region->stiffness, region->damping, region->hertz_stiffness,
        region->clamped != 0 ? UR5E_R(1.0) : region->effective_mass};
    if (!ur5e_all_finite(numbers, 4)) {
        return UR5E_NOT_FINITE;
    }
    const bool body = region->stiffness > UR5E_R(0.0) && region->damping >= UR5E_R(0.0)
        && region->hertz_stiffness > UR5E_R(0.0) && numbers[3] > UR5E_R(0.0);
    const ur5e_real horizon = UR5E_HORIZON(p);
    const ur5e_real reaction = UR5E_REACTION_TIME(p);
    int status = ur5e_check_positive(&horizon, 1);
    if (status == UR5E_OK) {
        status = ur5e_check_not_negative(&reaction, 1);
    }
    for (int i = 0; i < UR5E_N && status == UR5E_OK; ++i) {
        const ur5e_real gains[2] = {UR5E_GAIN(p, i), UR5E_DAMPING_GAIN(p, i)};
        status = ur5e_check_not_negative(gains, 2);
#if UR5E_ELASTIC
        const ur5e_real drive[2] = {UR5E_SPRING(p, i), UR5E_ROTOR(p, i)};
        status = status == UR5E_OK ? ur5e_check_positive(drive, 2) : status;
#endif
    }
    if (status != UR5E_OK) {
        return status;
    }
    const bool motion = p->motors >= UR5E_MOTORS_FREE_OR_DRIVEN && p->motors <= UR5E_MOTORS_SERVO
        && p->steps > 0 && p->steps <= MOST_STEPS;
    return body && motion ? UR5E_OK : UR5E_OUT_OF_RANGE;
}

int ur5e_arrive(const ur5e_real n[3], int point, ur5e_arrival *arrival)
{
    ur5e_real u[3];
    const int status = ur5e_unit_vector(n, u);
    if (status != UR5E_OK) {
        return status;
    }
    const ur5e_real (*const J)[UR5E_N] = (const ur5e_real (*)[UR5E_N])&arrival->links.J[3*point];
    ur5e_matrix square;
    ur5e_real moved[UR5E_REACH][UR5E_N];
    ur5e_real share[UR5E_SYSTEM];
    ur5e_real within = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        arrival->row[i] = u[0]*J[0][i] + u[1]*J[1][i] + u[2]*J[2][i];
    }
    for (int k = 0; k < UR5E_REACH; ++k) {
        const ur5e_real *const d = ur5e_directions[k];
        share[k] = d[0]*u[0] + d[1]*u[1] + d[2]*u[2];
        within += share[k]*share[k];
        for (int i = 0; i < UR5E_N; ++i) {
            moved[k][i] = ur5e_has_motor[i] ? d[0]*J[0][i] + d[1]*J[1][i] + d[2]*J[2][i] : UR5E_R(0.0);
        }
        for (int l = 0; l <= k; ++l) {
            ur5e_real sum = UR5E_R(0.0);
            for (int i = 0; i < UR5E_N; ++i) {
                sum += moved[k][i]*moved[l][i];
            }
            square[k][l] = sum;
            square[l][k] = sum;
        }
    }
    if (!(within > UR5E_R(1.0) - OUTSIDE) || !ur5e_cholesky(UR5E_REACH, square)) {
        return UR5E_SINGULAR;
    }
    ur5e_forward(UR5E_REACH, square, share);
    ur5e_backward(UR5E_REACH, square, share);
    ur5e_real fast = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        ur5e_real rate = UR5E_R(0.0);
        for (int k = 0; k < UR5E_REACH; ++k) {
            rate += moved[k][i]*share[k];
        }
        arrival->rates[i] = rate;
        fast += rate*rate;
    }
    return fast < UR5E_FASTEST ? UR5E_OK : UR5E_SINGULAR;
}

void ur5e_kinds_of_motors(const ur5e_params *p, int *first, int *last)
{
    const bool both = p->motors == UR5E_MOTORS_FREE_OR_DRIVEN;
    *first = both ? UR5E_MOTORS_FREE : p->motors;
    *last = both ? UR5E_MOTORS_DRIVEN : p->motors;
}

/* Largest stiffness of the skin up to a force. */
static ur5e_real skin_stiffness(const ur5e_region *region, ur5e_real force)
{
    const ur5e_real third = UR5E_R(1.0)/UR5E_R(3.0);
    return UR5E_R(1.5)*UR5E_POW(region->hertz_stiffness*region->hertz_stiffness*force, third);
}

ur5e_real ur5e_two_body_force(const ur5e_region *region, ur5e_real mobility, ur5e_real speed)
{
    const ur5e_real spring = speed*UR5E_SQRT(region->stiffness/mobility);
    const ur5e_real energy = UR5E_R(1.25)*speed*speed/mobility;
    const ur5e_real skin = UR5E_POW(energy, UR5E_R(0.6))*UR5E_POW(region->hertz_stiffness, UR5E_R(0.4));
    return UR5E_R(1.0)/(UR5E_R(1.0)/spring + UR5E_R(1.0)/skin);
}

ur5e_real ur5e_two_body_speed(const ur5e_region *region, ur5e_real mobility, ur5e_real force)
{
    const ur5e_real depth = UR5E_POW(force/region->hertz_stiffness, UR5E_R(2.0)/UR5E_R(3.0));
    return UR5E_SQRT(mobility*force*(force/region->stiffness + UR5E_R(0.8)*depth));
}

/* Modes of a phase. */
static int modes_of(ur5e_impact *impact, int which)
{
    ur5e_phase *const phase = &impact->phase[which];
    phase->drift = UR5E_R(0.0);
    phase->modes.noise = UR5E_R(0.0);
    phase->damped = false;
    for (int i = 0; i < UR5E_N; ++i) {
        phase->damping[i] = UR5E_R(0.0);
    }
    if (which == UR5E_LOOSE) {
        return ur5e_free_modes(&impact->arrival, impact->p, &phase->modes, impact->carried);
    }
    if (impact->motors == UR5E_MOTORS_DRIVEN) {
        return ur5e_driven_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < UR5E_N; ++i) {
        phase->damping[i] = UR5E_DAMPING_GAIN(impact->p, i);
        phase->damped = phase->damped || phase->damping[i] > UR5E_R(0.0);
    }
    return ur5e_servo_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
}

#if !UR5E_STRUCTURED
static ur5e_real mobility_of(const ur5e_modes *modes)
{
    ur5e_real sum = UR5E_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        sum += modes->row[i]*modes->row[i];
    }
    return sum;
}
#endif

/* Times at which a phase begins and ends. */
static ur5e_real time_of(const ur5e_impact *impact, int which)
{
    const ur5e_real horizon = UR5E_HORIZON(impact->p);
    const ur5e_real until = which < impact->last ? UR5E_REACTION_TIME(impact->p) : horizon;
    return which > impact->first ? horizon - UR5E_REACTION_TIME(impact->p) : until;
}

static void steps_of(ur5e_impact *impact, int which)
{
    ur5e_phase *const phase = &impact->phase[which];
    const ur5e_real time = time_of(impact, which);
    phase->blurred = phase->modes.noise*time*time > BLURS;
    ur5e_phase_steps(impact, time, phase);
    const ur5e_real numbers[2] = {phase->level[0].h, phase->level[UR5E_LEVELS - 1].h};
    if (ur5e_check_positive(numbers, 2) != UR5E_OK) {
        impact->status = UR5E_SINGULAR;
    }
}

void ur5e_impact_let_go(ur5e_impact *impact)
{
    if (!impact->phase[UR5E_LOOSE].ready) {
        impact->status = modes_of(impact, UR5E_LOOSE);
        if (impact->status == UR5E_OK) {
            steps_of(impact, UR5E_LOOSE);
        }
    }
}

/* Mobilities of the contact, and modes where those need them. */
static void weigh(ur5e_impact *impact)
{
    const ur5e_real body = impact->gives_way ? UR5E_R(1.0)/impact->region->effective_mass : UR5E_R(0.0);
    ur5e_real mobility = UR5E_R(0.0);
#if UR5E_STRUCTURED
    impact->status = ur5e_mobilities(&impact->arrival, impact->p, &mobility, &impact->rotors);
#else
    for (int k = impact->first; k <= impact->last && impact->status == UR5E_OK; ++k) {
        impact->status = modes_of(impact, k);
        mobility = UR5E_FMAX(mobility, mobility_of(&impact->phase[k].modes));
    }
    impact->rotors = UR5E_R(0.0);
    const bool held = !UR5E_ELASTIC && impact->last == UR5E_LED && impact->motors == UR5E_MOTORS_DRIVEN;
    if (!(mobility > UR5E_LEAST_MOBILITY) && !held) {
        impact->status = UR5E_SINGULAR;
    }
#endif
    impact->mobility = UR5E_FMAX(mobility, UR5E_LEAST_MOBILITY) + body;
}

int ur5e_impact_prepare(const ur5e_region *region, const ur5e_params *p, int motors,
    ur5e_real force, ur5e_impact *impact)
{
    const ur5e_real reaction = UR5E_REACTION_TIME(p);
    const bool loose = motors == UR5E_MOTORS_FREE || !(reaction > UR5E_R(0.0));
    impact->region = region;
    impact->p = p;
    impact->motors = motors;
    impact->gives_way = region->clamped == 0;
    impact->first = loose ? UR5E_LOOSE : UR5E_LED;
    impact->last = loose || reaction < UR5E_HORIZON(p) ? UR5E_LOOSE : UR5E_LED;
    impact->status = UR5E_OK;
    impact->phase[UR5E_LED].ready = false;
    impact->phase[UR5E_LOOSE].ready = false;
    weigh(impact);
    if (impact->status != UR5E_OK) {
        return impact->status;
    }
    const ur5e_real size =
        force > UR5E_R(0.0) ? force : ur5e_two_body_force(region, impact->mobility, -force);
    impact->scale = UR5E_R(0.4)*size;
    impact->hold = region->stiffness + region->damping*region->damping*impact->mobility;
    const ur5e_real damped = region->damping*UR5E_SQRT(impact->mobility/region->stiffness);
    impact->smooth = UR5E_R(1.0)/(UR5E_R(1.0) + UR5E_R(4.0)*damped);
    impact->skin_rate = skin_stiffness(region, size)*impact->mobility;
    const ur5e_real numbers[3] = {impact->mobility, impact->scale, impact->skin_rate};
    if (!ur5e_all_finite(numbers, 3) || ur5e_check_positive(numbers, 3) != UR5E_OK) {
        return UR5E_SINGULAR;
    }
#if UR5E_STRUCTURED
    impact->status = modes_of(impact, impact->first);
    if (impact->status == UR5E_OK) {
        steps_of(impact, impact->first);
    }
#else
    for (int k = impact->first; k <= impact->last; ++k) {
        steps_of(impact, k);
    }
#endif
    return impact->status;
}
