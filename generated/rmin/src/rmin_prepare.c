/* SPDX-License-Identifier: 0BSD */
/* What impacts of rmin_ are prepared with: modes, mobilities and steps. */
#include "rmin_impact.h"

/* Share of an approach that rounding may change, at the worst: what it does is a tenth of that. */
#define BLURS RMIN_R(1.6e-2)
/* Share of how far robot and body give way that rounding may change: a slow servo that pressed was 1.6 off. */
#define BLURS_SPRING RMIN_R(4e-3)
/*
 * Least smoothness, however hard the damper: with less a light leg's steps were used up for nothing (5.8 % of plain
 * inputs, 4.6 % with this, errors as before).
 */
#define LEAST_SMOOTH RMIN_R(0.05)

void rmin_impact_forget(rmin_impact *impact)
{
    impact->phase[RMIN_LED].known = false;
    impact->phase[RMIN_LOOSE].known = false;
}

/* Takes the body out of modes that are known, whose order does not matter. */
static void take_body_out(rmin_phase *phase)
{
    rmin_modes *const modes = &phase->modes;
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

static int led_modes(rmin_impact *impact, rmin_phase *phase)
{
    if (impact->motors == RMIN_MOTORS_DRIVEN) {
        return rmin_driven_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < RMIN_N; ++i) {
        const rmin_real gain = RMIN_DAMPING_GAIN(impact->p, i);
        phase->damping[RMIN_DAMPERS - RMIN_N + i] += gain;
        phase->damped = phase->damped || gain > RMIN_R(0.0);
    }
    return rmin_servo_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
}

/* Modes of a phase. */
static int modes_of(rmin_impact *impact, int which)
{
    rmin_phase *const phase = &impact->phase[which];
    if (phase->known && (which == RMIN_LOOSE || impact->led == impact->motors)) {
        take_body_out(phase);
        return RMIN_OK;
    }
    phase->has_body = false;
    phase->drift = RMIN_R(0.0);
    phase->damped = RMIN_DAMPED != 0;
    for (int i = 0; i < RMIN_DAMPERS; ++i) {
        phase->damping[i] = RMIN_R(0.0);
    }
#if RMIN_DAMPED
    for (int i = 0; i < RMIN_N; ++i) {
        phase->damping[i] = rmin_joint_damping[i];
    }
#endif
    const int status = which == RMIN_LED ? led_modes(impact, phase)
        : rmin_free_modes(&impact->arrival, impact->p, &phase->modes);
    phase->known = status == RMIN_OK;
    impact->led = which == RMIN_LED ? impact->motors : impact->led;
    return status;
}

/*
 * What rounding may change of an approach within a time, as a share of it. An entry of a stiffness over modes i and
 * j errs by about sqrt(n_i n_j) for the noise n of their squared frequencies; it takes start_i t of one motion to
 * row_j t^2 of the other, or less where one of them swings. Before motors are let go no mode starts off the motion
 * before: its start is what a pull that grows with time leads it to, of which it takes no more than it has turned.
 */
static rmin_real blur_of(const rmin_impact *impact, const rmin_phase *phase, rmin_real time)
{
    const rmin_modes *const modes = &phase->modes;
    const bool led = phase == &impact->phase[RMIN_LED];
    rmin_real rows = RMIN_R(0.0);
    rmin_real starts = RMIN_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        if (!(modes->noise[i] > RMIN_R(0.0))) {
            continue;
        }
        const rmin_real known = RMIN_FMAX(RMIN_FABS(modes->squared[i]) - modes->noise[i], RMIN_R(0.0));
        const rmin_real turns = known*time*time;
        const rmin_real off = time*RMIN_SQRT(modes->noise[i]/RMIN_FMAX(turns, RMIN_R(1.0)));
        const rmin_real pulled = led ? RMIN_FMIN(turns, RMIN_R(1.0)) : RMIN_R(1.0);
        rows += RMIN_FABS(modes->row[i])*off;
        starts += RMIN_FABS(modes->start[i])*pulled*off;
    }
    return rows*RMIN_FMAX(starts, rows/impact->mobility);
}

#if !RMIN_STRUCTURED
/* What rounding may change of how far contact point and body give way to a force within a time, as a share of it. */
static rmin_real blur_of_spring(const rmin_region *region, const rmin_modes *modes, rmin_real time)
{
    const rmin_real square = time*time;
    rmin_real gives = RMIN_R(1.0)/region->stiffness;
    rmin_real off = RMIN_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const rmin_real known = RMIN_FMAX(RMIN_FABS(modes->squared[i]) - modes->noise[i], RMIN_R(0.0));
        const rmin_real turns = RMIN_FMAX(known*square, RMIN_R(2.0));
        const rmin_real bends = modes->row[i]*modes->row[i]*square/turns;
        gives += bends;
        off += bends*modes->noise[i]*square/RMIN_FMAX(turns, RMIN_R(12.0));
    }
    return off/gives;
}

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
    phase->blur = blur_of(impact, phase, time);
    phase->blurred = phase->blur > BLURS;
#if !RMIN_STRUCTURED
    phase->blurred = phase->blurred || blur_of_spring(impact->region, &phase->modes, time) > BLURS_SPRING;
#endif
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
    impact->status = rmin_mobilities(
        &impact->arrival, impact->p, impact->phase[RMIN_LOOSE].modes.shape, &mobility, &impact->rotors);
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
    const rmin_real reached = region->stiffness*RMIN_HORIZON(p) + region->damping; /* by the horizon, at 1 m/s */
    impact->scale = RMIN_R(0.5)*(force > RMIN_R(0.0) ? size : RMIN_FMIN(size, -force*reached));
    impact->hold = region->stiffness + region->damping*region->damping*impact->mobility;
    const rmin_real damped = region->damping*RMIN_SQRT(impact->mobility/region->stiffness);
    impact->smooth = RMIN_FMAX(RMIN_R(1.0)/(RMIN_R(1.0) + RMIN_R(4.0)*damped), LEAST_SMOOTH);
    impact->sure = impact->smooth < RMIN_HARD ? 1 : 2;
    impact->skin_rate = rmin_law_stiffness(region, size)*impact->mobility;
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
