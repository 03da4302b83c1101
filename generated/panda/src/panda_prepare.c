/* SPDX-License-Identifier: 0BSD */
/* What impacts of panda_ are prepared with: modes, mobilities and steps. */
#include "panda_impact.h"

/* Share of an approach that rounding may change, at the worst: what it does is a tenth of that. */
#define BLURS PANDA_R(1.6e-2)
/* Share of how far robot and body give way that rounding may change: a slow servo that pressed was 1.6 off. */
#define BLURS_SPRING PANDA_R(4e-3)
/*
 * Least smoothness, however hard the damper: with less a light leg's steps were used up for nothing (5.8 % of plain
 * inputs, 4.6 % with this, errors as before).
 */
#define LEAST_SMOOTH PANDA_R(0.05)

void panda_impact_forget(panda_impact *impact)
{
    impact->phase[PANDA_LED].known = false;
    impact->phase[PANDA_LOOSE].known = false;
}

/* Takes the body out of modes that are known, whose order does not matter. */
static void take_body_out(panda_phase *phase)
{
    panda_modes *const modes = &phase->modes;
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

static int led_modes(panda_impact *impact, panda_phase *phase)
{
    if (impact->motors == PANDA_MOTORS_DRIVEN) {
        return panda_driven_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < PANDA_N; ++i) {
        const panda_real gain = PANDA_DAMPING_GAIN(impact->p, i);
        phase->damping[PANDA_DAMPERS - PANDA_N + i] += gain;
        phase->damped = phase->damped || gain > PANDA_R(0.0);
    }
    return panda_servo_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
}

/* Modes of a phase. */
static int modes_of(panda_impact *impact, int which)
{
    panda_phase *const phase = &impact->phase[which];
    if (phase->known && (which == PANDA_LOOSE || impact->led == impact->motors)) {
        take_body_out(phase);
        return PANDA_OK;
    }
    phase->has_body = false;
    phase->drift = PANDA_R(0.0);
    phase->damped = PANDA_DAMPED != 0;
    for (int i = 0; i < PANDA_DAMPERS; ++i) {
        phase->damping[i] = PANDA_R(0.0);
    }
#if PANDA_DAMPED
    for (int i = 0; i < PANDA_N; ++i) {
        phase->damping[i] = panda_joint_damping[i];
    }
#endif
    const int status = which == PANDA_LED ? led_modes(impact, phase)
        : panda_free_modes(&impact->arrival, impact->p, &phase->modes);
    phase->known = status == PANDA_OK;
    impact->led = which == PANDA_LED ? impact->motors : impact->led;
    return status;
}

/*
 * What rounding may change of an approach within a time, as a share of it. An entry of a stiffness over modes i and
 * j errs by about sqrt(n_i n_j) for the noise n of their squared frequencies; it takes start_i t of one motion to
 * row_j t^2 of the other, or less where one of them swings. Before motors are let go no mode starts off the motion
 * before: its start is what a pull that grows with time leads it to, of which it takes no more than it has turned.
 */
static panda_real blur_of(const panda_impact *impact, const panda_phase *phase, panda_real time)
{
    const panda_modes *const modes = &phase->modes;
    const bool led = phase == &impact->phase[PANDA_LED];
    panda_real rows = PANDA_R(0.0);
    panda_real starts = PANDA_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        if (!(modes->noise[i] > PANDA_R(0.0))) {
            continue;
        }
        const panda_real known = PANDA_FMAX(PANDA_FABS(modes->squared[i]) - modes->noise[i], PANDA_R(0.0));
        const panda_real turns = known*time*time;
        const panda_real off = time*PANDA_SQRT(modes->noise[i]/PANDA_FMAX(turns, PANDA_R(1.0)));
        const panda_real pulled = led ? PANDA_FMIN(turns, PANDA_R(1.0)) : PANDA_R(1.0);
        rows += PANDA_FABS(modes->row[i])*off;
        starts += PANDA_FABS(modes->start[i])*pulled*off;
    }
    return rows*PANDA_FMAX(starts, rows/impact->mobility);
}

#if !PANDA_STRUCTURED
/* What rounding may change of how far contact point and body give way to a force within a time, as a share of it. */
static panda_real blur_of_spring(const panda_region *region, const panda_modes *modes, panda_real time)
{
    const panda_real square = time*time;
    panda_real gives = PANDA_R(1.0)/region->stiffness;
    panda_real off = PANDA_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const panda_real known = PANDA_FMAX(PANDA_FABS(modes->squared[i]) - modes->noise[i], PANDA_R(0.0));
        const panda_real turns = PANDA_FMAX(known*square, PANDA_R(2.0));
        const panda_real bends = modes->row[i]*modes->row[i]*square/turns;
        gives += bends;
        off += bends*modes->noise[i]*square/PANDA_FMAX(turns, PANDA_R(12.0));
    }
    return off/gives;
}

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
    phase->blur = blur_of(impact, phase, time);
    phase->blurred = phase->blur > BLURS;
#if !PANDA_STRUCTURED
    phase->blurred = phase->blurred || blur_of_spring(impact->region, &phase->modes, time) > BLURS_SPRING;
#endif
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
    impact->status = panda_mobilities(
        &impact->arrival, impact->p, impact->phase[PANDA_LOOSE].modes.shape, &mobility, &impact->rotors);
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
    const panda_real reached = region->stiffness*PANDA_HORIZON(p) + region->damping; /* by the horizon, at 1 m/s */
    impact->scale = PANDA_R(0.5)*(force > PANDA_R(0.0) ? size : PANDA_FMIN(size, -force*reached));
    impact->hold = region->stiffness + region->damping*region->damping*impact->mobility;
    const panda_real damped = region->damping*PANDA_SQRT(impact->mobility/region->stiffness);
    impact->smooth = PANDA_FMAX(PANDA_R(1.0)/(PANDA_R(1.0) + PANDA_R(4.0)*damped), LEAST_SMOOTH);
    impact->sure = impact->smooth < PANDA_HARD ? 1 : 2;
    impact->skin_rate = panda_law_stiffness(region, size)*impact->mobility;
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
