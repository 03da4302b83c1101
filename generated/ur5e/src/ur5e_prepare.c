/* SPDX-License-Identifier: 0BSD */
/* What impacts of ur5e_ are prepared with: modes, mobilities and steps. */
#include "ur5e_impact.h"

/* Share of an approach that rounding may change, at the worst: what it does is a tenth of that. */
#define BLURS UR5E_R(1.6e-2)
/* Share of how far robot and body give way that rounding may change: a slow servo that pressed was 1.6 off. */
#define BLURS_SPRING UR5E_R(4e-3)
/*
 * Least smoothness, however hard the damper: with less a light leg's steps were used up for nothing (5.8 % of plain
 * inputs, 4.6 % with this, errors as before).
 */
#define LEAST_SMOOTH UR5E_R(0.05)

void ur5e_impact_forget(ur5e_impact *impact)
{
    impact->phase[UR5E_LED].known = false;
    impact->phase[UR5E_LOOSE].known = false;
}

/* Takes the body out of modes that are known, whose order does not matter. */
static void take_body_out(ur5e_phase *phase)
{
    ur5e_modes *const modes = &phase->modes;
    const int last = modes->count - 1;
    const int body = phase->active - 1;
    if (phase->has_body && body >= 0 && body <= last) {
        modes->squared[body] = modes->squared[last];
        modes->noise[body] = modes->noise[last];
        modes->row[body] = modes->row[last];
        modes->start[body] = modes->start[last];
        modes->from[body] = modes->from[last];
        modes->count = last;
    }
    phase->has_body = false;
}

static int led_modes(ur5e_impact *impact, ur5e_phase *phase)
{
    if (impact->motors == UR5E_MOTORS_DRIVEN) {
        return ur5e_driven_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < UR5E_N; ++i) {
        const ur5e_real gain = UR5E_DAMPING_GAIN(impact->p, i);
        phase->damping[UR5E_DAMPERS - UR5E_N + i] += gain;
        phase->damped = phase->damped || gain > UR5E_R(0.0);
    }
    return ur5e_servo_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
}

/* Modes of a phase. */
static int modes_of(ur5e_impact *impact, int which)
{
    ur5e_phase *const phase = &impact->phase[which];
    if (phase->known && (which == UR5E_LOOSE || impact->led == impact->motors)) {
        take_body_out(phase);
        return UR5E_OK;
    }
    phase->has_body = false;
    phase->drift = UR5E_R(0.0);
    phase->damped = UR5E_DAMPED != 0;
    for (int i = 0; i < UR5E_DAMPERS; ++i) {
        phase->damping[i] = UR5E_R(0.0);
    }
#if UR5E_DAMPED
    for (int i = 0; i < UR5E_N; ++i) {
        phase->damping[i] = ur5e_joint_damping[i];
    }
#endif
    const int status = which == UR5E_LED ? led_modes(impact, phase)
        : ur5e_free_modes(&impact->arrival, impact->p, &phase->modes);
    phase->known = status == UR5E_OK;
    impact->led = which == UR5E_LED ? impact->motors : impact->led;
    return status;
}

/*
 * What rounding may change of an approach within a time, as a share of it. An entry of a stiffness over modes i and
 * j errs by about sqrt(n_i n_j) for the noise n of their squared frequencies; it takes start_i t of one motion to
 * row_j t^2 of the other, or less where one of them swings. Before motors are let go no mode starts off the motion
 * before: its start is what a pull that grows with time leads it to, of which it takes no more than it has turned.
 */
static ur5e_real blur_of(const ur5e_impact *impact, const ur5e_phase *phase, ur5e_real time)
{
    const ur5e_modes *const modes = &phase->modes;
    const bool led = phase == &impact->phase[UR5E_LED];
    ur5e_real rows = UR5E_R(0.0);
    ur5e_real starts = UR5E_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        if (!(modes->noise[i] > UR5E_R(0.0))) {
            continue;
        }
        const ur5e_real known = UR5E_FMAX(UR5E_FABS(modes->squared[i]) - modes->noise[i], UR5E_R(0.0));
        const ur5e_real turns = known*time*time;
        const ur5e_real off = time*UR5E_SQRT(modes->noise[i]/UR5E_FMAX(turns, UR5E_R(1.0)));
        const ur5e_real pulled = led ? UR5E_FMIN(turns, UR5E_R(1.0)) : UR5E_R(1.0);
        rows += UR5E_FABS(modes->row[i])*off;
        starts += UR5E_FABS(modes->start[i])*pulled*off;
    }
    return rows*UR5E_FMAX(starts, rows/impact->mobility);
}

#if !UR5E_STRUCTURED
/* What rounding may change of how far contact point and body give way to a force within a time, as a share of it. */
static ur5e_real blur_of_spring(const ur5e_region *region, const ur5e_modes *modes, ur5e_real time)
{
    const ur5e_real square = time*time;
    ur5e_real gives = UR5E_R(1.0)/region->stiffness;
    ur5e_real off = UR5E_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const ur5e_real known = UR5E_FMAX(UR5E_FABS(modes->squared[i]) - modes->noise[i], UR5E_R(0.0));
        const ur5e_real turns = UR5E_FMAX(known*square, UR5E_R(2.0));
        const ur5e_real bends = modes->row[i]*modes->row[i]*square/turns;
        gives += bends;
        off += bends*modes->noise[i]*square/UR5E_FMAX(turns, UR5E_R(12.0));
    }
    return off/gives;
}

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
    phase->blur = blur_of(impact, phase, time);
    phase->blurred = phase->blur > BLURS;
#if !UR5E_STRUCTURED
    phase->blurred = phase->blurred || blur_of_spring(impact->region, &phase->modes, time) > BLURS_SPRING;
#endif
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
    impact->status = ur5e_mobilities(
        &impact->arrival, impact->p, impact->phase[UR5E_LOOSE].modes.shape, &mobility, &impact->rotors);
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
    const ur5e_real reached = region->stiffness*UR5E_HORIZON(p) + region->damping; /* by the horizon, at 1 m/s */
    impact->scale = UR5E_R(0.5)*(force > UR5E_R(0.0) ? size : UR5E_FMIN(size, -force*reached));
    impact->hold = region->stiffness + region->damping*region->damping*impact->mobility;
    const ur5e_real damped = region->damping*UR5E_SQRT(impact->mobility/region->stiffness);
    impact->smooth = UR5E_FMAX(UR5E_R(1.0)/(UR5E_R(1.0) + UR5E_R(4.0)*damped), LEAST_SMOOTH);
    impact->sure = impact->smooth < UR5E_HARD ? 1 : 2;
    impact->skin_rate = ur5e_law_stiffness(region, size)*impact->mobility;
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
