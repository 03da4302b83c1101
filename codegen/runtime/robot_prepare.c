/* SPDX-License-Identifier: 0BSD */
/* What impacts of robot_ are prepared with: modes, mobilities and steps. */
#include "robot_impact.h"

/* Share of an approach that rounding may change, at the worst: what it does is a tenth of that. */
#define BLURS ROBOT_R(1.6e-2)
/* Share of how far robot and body give way that rounding may change: a slow servo that pressed was 1.6 off. */
#define BLURS_SPRING ROBOT_R(4e-3)
/*
 * Least smoothness, however hard the damper: with less a light leg's steps were used up for nothing (5.8 % of plain
 * inputs, 4.6 % with this, errors as before).
 */
#define LEAST_SMOOTH ROBOT_R(0.05)

void robot_impact_forget(robot_impact *impact)
{
    impact->phase[ROBOT_LED].known = false;
    impact->phase[ROBOT_LOOSE].known = false;
}

/* Takes the body out of modes that are known, whose order does not matter. */
static void take_body_out(robot_phase *phase)
{
    robot_modes *const modes = &phase->modes;
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

static int led_modes(robot_impact *impact, robot_phase *phase)
{
    if (impact->motors == ROBOT_MOTORS_DRIVEN) {
        return robot_driven_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < ROBOT_N; ++i) {
        const robot_real gain = ROBOT_DAMPING_GAIN(impact->p, i);
        phase->damping[ROBOT_DAMPERS - ROBOT_N + i] += gain;
        phase->damped = phase->damped || gain > ROBOT_R(0.0);
    }
    return robot_servo_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
}

/* Modes of a phase. */
static int modes_of(robot_impact *impact, int which)
{
    robot_phase *const phase = &impact->phase[which];
    if (phase->known && (which == ROBOT_LOOSE || impact->led == impact->motors)) {
        take_body_out(phase);
        return ROBOT_OK;
    }
    phase->has_body = false;
    phase->drift = ROBOT_R(0.0);
    phase->damped = ROBOT_DAMPED != 0;
    for (int i = 0; i < ROBOT_DAMPERS; ++i) {
        phase->damping[i] = ROBOT_R(0.0);
    }
#if ROBOT_DAMPED
    for (int i = 0; i < ROBOT_N; ++i) {
        phase->damping[i] = robot_joint_damping[i];
    }
#endif
    const int status = which == ROBOT_LED ? led_modes(impact, phase)
        : robot_free_modes(&impact->arrival, impact->p, &phase->modes);
    phase->known = status == ROBOT_OK;
    impact->led = which == ROBOT_LED ? impact->motors : impact->led;
    return status;
}

/*
 * What rounding may change of an approach within a time, as a share of it. An entry of a stiffness over modes i and
 * j errs by about sqrt(n_i n_j) for the noise n of their squared frequencies; it takes start_i t of one motion to
 * row_j t^2 of the other, or less where one of them swings. Before motors are let go no mode starts off the motion
 * before: its start is what a pull that grows with time leads it to, of which it takes no more than it has turned.
 */
static robot_real blur_of(const robot_impact *impact, const robot_phase *phase, robot_real time)
{
    const robot_modes *const modes = &phase->modes;
    const bool led = phase == &impact->phase[ROBOT_LED];
    robot_real rows = ROBOT_R(0.0);
    robot_real starts = ROBOT_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        if (!(modes->noise[i] > ROBOT_R(0.0))) {
            continue;
        }
        const robot_real known = ROBOT_FMAX(ROBOT_FABS(modes->squared[i]) - modes->noise[i], ROBOT_R(0.0));
        const robot_real turns = known*time*time;
        const robot_real off = time*ROBOT_SQRT(modes->noise[i]/ROBOT_FMAX(turns, ROBOT_R(1.0)));
        const robot_real pulled = led ? ROBOT_FMIN(turns, ROBOT_R(1.0)) : ROBOT_R(1.0);
        rows += ROBOT_FABS(modes->row[i])*off;
        starts += ROBOT_FABS(modes->start[i])*pulled*off;
    }
    return rows*ROBOT_FMAX(starts, rows/impact->mobility);
}

#if !ROBOT_STRUCTURED
/* What rounding may change of how far contact point and body give way to a force within a time, as a share of it. */
static robot_real blur_of_spring(const robot_region *region, const robot_modes *modes, robot_real time)
{
    const robot_real square = time*time;
    robot_real gives = ROBOT_R(1.0)/region->stiffness;
    robot_real off = ROBOT_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const robot_real known = ROBOT_FMAX(ROBOT_FABS(modes->squared[i]) - modes->noise[i], ROBOT_R(0.0));
        const robot_real turns = ROBOT_FMAX(known*square, ROBOT_R(2.0));
        const robot_real bends = modes->row[i]*modes->row[i]*square/turns;
        gives += bends;
        off += bends*modes->noise[i]*square/ROBOT_FMAX(turns, ROBOT_R(12.0));
    }
    return off/gives;
}

static robot_real mobility_of(const robot_modes *modes)
{
    robot_real sum = ROBOT_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        sum += modes->row[i]*modes->row[i];
    }
    return sum;
}
#endif

/* Times at which a phase begins and ends. */
static robot_real time_of(const robot_impact *impact, int which)
{
    const robot_real horizon = ROBOT_HORIZON(impact->p);
    const robot_real until = which < impact->last ? ROBOT_REACTION_TIME(impact->p) : horizon;
    return which > impact->first ? horizon - ROBOT_REACTION_TIME(impact->p) : until;
}

static void steps_of(robot_impact *impact, int which)
{
    robot_phase *const phase = &impact->phase[which];
    const robot_real time = time_of(impact, which);
    phase->blur = blur_of(impact, phase, time);
    phase->blurred = phase->blur > BLURS;
#if !ROBOT_STRUCTURED
    phase->blurred = phase->blurred || blur_of_spring(impact->region, &phase->modes, time) > BLURS_SPRING;
#endif
    robot_phase_steps(impact, time, phase);
    const robot_real numbers[2] = {phase->level[0].h, phase->level[ROBOT_LEVELS - 1].h};
    if (robot_check_positive(numbers, 2) != ROBOT_OK) {
        impact->status = ROBOT_SINGULAR;
    }
}

void robot_impact_let_go(robot_impact *impact)
{
    if (!impact->phase[ROBOT_LOOSE].ready) {
        impact->status = modes_of(impact, ROBOT_LOOSE);
        if (impact->status == ROBOT_OK) {
            steps_of(impact, ROBOT_LOOSE);
        }
    }
}

/* Mobilities of the contact, and modes where those need them. */
static void weigh(robot_impact *impact)
{
    const robot_real body = impact->gives_way ? ROBOT_R(1.0)/impact->region->effective_mass : ROBOT_R(0.0);
    robot_real mobility = ROBOT_R(0.0);
#if ROBOT_STRUCTURED
    impact->status = robot_mobilities(
        &impact->arrival, impact->p, impact->phase[ROBOT_LOOSE].modes.shape, &mobility, &impact->rotors);
#else
    for (int k = impact->first; k <= impact->last && impact->status == ROBOT_OK; ++k) {
        impact->status = modes_of(impact, k);
        mobility = ROBOT_FMAX(mobility, mobility_of(&impact->phase[k].modes));
    }
    impact->rotors = ROBOT_R(0.0);
    const bool held = !ROBOT_ELASTIC && impact->last == ROBOT_LED && impact->motors == ROBOT_MOTORS_DRIVEN;
    if (!(mobility > ROBOT_LEAST_MOBILITY) && !held) {
        impact->status = ROBOT_SINGULAR;
    }
#endif
    impact->mobility = ROBOT_FMAX(mobility, ROBOT_LEAST_MOBILITY) + body;
}

int robot_impact_prepare(const robot_region *region, const robot_params *p, int motors,
    robot_real force, robot_impact *impact)
{
    const robot_real reaction = ROBOT_REACTION_TIME(p);
    const bool loose = motors == ROBOT_MOTORS_FREE || !(reaction > ROBOT_R(0.0));
    impact->region = region;
    impact->p = p;
    impact->motors = motors;
    impact->gives_way = region->clamped == 0;
    impact->first = loose ? ROBOT_LOOSE : ROBOT_LED;
    impact->last = loose || reaction < ROBOT_HORIZON(p) ? ROBOT_LOOSE : ROBOT_LED;
    impact->status = ROBOT_OK;
    impact->phase[ROBOT_LED].ready = false;
    impact->phase[ROBOT_LOOSE].ready = false;
    weigh(impact);
    if (impact->status != ROBOT_OK) {
        return impact->status;
    }
    const robot_real size =
        force > ROBOT_R(0.0) ? force : robot_two_body_force(region, impact->mobility, -force);
    const robot_real reached = region->stiffness*ROBOT_HORIZON(p) + region->damping; /* by the horizon, at 1 m/s */
    impact->scale = ROBOT_R(0.5)*(force > ROBOT_R(0.0) ? size : ROBOT_FMIN(size, -force*reached));
    impact->hold = region->stiffness + region->damping*region->damping*impact->mobility;
    const robot_real damped = region->damping*ROBOT_SQRT(impact->mobility/region->stiffness);
    impact->smooth = ROBOT_FMAX(ROBOT_R(1.0)/(ROBOT_R(1.0) + ROBOT_R(4.0)*damped), LEAST_SMOOTH);
    impact->sure = impact->smooth < ROBOT_HARD ? 1 : 2;
    impact->skin_rate = robot_law_stiffness(region, size)*impact->mobility;
    const robot_real numbers[3] = {impact->mobility, impact->scale, impact->skin_rate};
    if (!robot_all_finite(numbers, 3) || robot_check_positive(numbers, 3) != ROBOT_OK) {
        return ROBOT_SINGULAR;
    }
#if ROBOT_STRUCTURED
    impact->status = modes_of(impact, impact->first);
    if (impact->status == ROBOT_OK) {
        steps_of(impact, impact->first);
    }
#else
    for (int k = impact->first; k <= impact->last; ++k) {
        steps_of(impact, k);
    }
#endif
    return impact->status;
}
