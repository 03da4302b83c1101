/* SPDX-License-Identifier: 0BSD */
/* What impacts of rr_ are prepared with: modes, mobilities and steps. */
#include "rr_impact.h"

/* Share of an approach that rounding may change, at the worst: what it does is a tenth of that. */
#define BLURS RR_R(1.6e-2)
/* Share of how far robot and body give way that rounding may change: a slow servo that pressed was 1.6 off. */
#define BLURS_SPRING RR_R(4e-3)
/*
 * Least smoothness, however hard the damper: with less a light leg's steps were used up for nothing (5.8 % of plain
 * inputs, 4.6 % with this, errors as before).
 */
#define LEAST_SMOOTH RR_R(0.05)

void rr_impact_forget(rr_impact *impact)
{
    impact->phase[RR_LED].known = false;
    impact->phase[RR_LOOSE].known = false;
}

/* Takes the body out of modes that are known, whose order does not matter. */
static void take_body_out(rr_phase *phase)
{
    rr_modes *const modes = &phase->modes;
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

static int led_modes(rr_impact *impact, rr_phase *phase)
{
    if (impact->motors == RR_MOTORS_DRIVEN) {
        return rr_driven_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
    }
    for (int i = 0; i < RR_N; ++i) {
        const rr_real gain = RR_DAMPING_GAIN(impact->p, i);
        phase->damping[RR_DAMPERS - RR_N + i] += gain;
        phase->damped = phase->damped || gain > RR_R(0.0);
    }
    return rr_servo_modes(&impact->arrival, impact->p, &phase->modes, &phase->drift);
}

/* Modes of a phase. */
static int modes_of(rr_impact *impact, int which)
{
    rr_phase *const phase = &impact->phase[which];
    if (phase->known && (which == RR_LOOSE || impact->led == impact->motors)) {
        take_body_out(phase);
        return RR_OK;
    }
    phase->has_body = false;
    phase->drift = RR_R(0.0);
    phase->damped = RR_DAMPED != 0;
    for (int i = 0; i < RR_DAMPERS; ++i) {
        phase->damping[i] = RR_R(0.0);
    }
#if RR_DAMPED
    for (int i = 0; i < RR_N; ++i) {
        phase->damping[i] = rr_joint_damping[i];
    }
#endif
    const int status = which == RR_LED ? led_modes(impact, phase)
        : rr_free_modes(&impact->arrival, impact->p, &phase->modes);
    phase->known = status == RR_OK;
    impact->led = which == RR_LED ? impact->motors : impact->led;
    return status;
}

/*
 * What rounding may change of an approach within a time, as a share of it. An entry of a stiffness over modes i and
 * j errs by about sqrt(n_i n_j) for the noise n of their squared frequencies; it takes start_i t of one motion to
 * row_j t^2 of the other, or less where one of them swings. Before motors are let go no mode starts off the motion
 * before: its start is what a pull that grows with time leads it to, of which it takes no more than it has turned.
 */
static rr_real blur_of(const rr_impact *impact, const rr_phase *phase, rr_real time)
{
    const rr_modes *const modes = &phase->modes;
    const bool led = phase == &impact->phase[RR_LED];
    rr_real rows = RR_R(0.0);
    rr_real starts = RR_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        if (!(modes->noise[i] > RR_R(0.0))) {
            continue;
        }
        const rr_real known = RR_FMAX(RR_FABS(modes->squared[i]) - modes->noise[i], RR_R(0.0));
        const rr_real turns = known*time*time;
        const rr_real off = time*RR_SQRT(modes->noise[i]/RR_FMAX(turns, RR_R(1.0)));
        const rr_real pulled = led ? RR_FMIN(turns, RR_R(1.0)) : RR_R(1.0);
        rows += RR_FABS(modes->row[i])*off;
        starts += RR_FABS(modes->start[i])*pulled*off;
    }
    return rows*RR_FMAX(starts, rows/impact->mobility);
}

#if !RR_STRUCTURED
/* What rounding may change of how far contact point and body give way to a force within a time, as a share of it. */
static rr_real blur_of_spring(const rr_region *region, const rr_modes *modes, rr_real time)
{
    const rr_real square = time*time;
    rr_real gives = RR_R(1.0)/region->stiffness;
    rr_real off = RR_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const rr_real known = RR_FMAX(RR_FABS(modes->squared[i]) - modes->noise[i], RR_R(0.0));
        const rr_real turns = RR_FMAX(known*square, RR_R(2.0));
        const rr_real bends = modes->row[i]*modes->row[i]*square/turns;
        gives += bends;
        off += bends*modes->noise[i]*square/RR_FMAX(turns, RR_R(12.0));
    }
    return off/gives;
}

static rr_real mobility_of(const rr_modes *modes)
{
    rr_real sum = RR_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        sum += modes->row[i]*modes->row[i];
    }
    return sum;
}
#endif

/* Times at which a phase begins and ends. */
static rr_real time_of(const rr_impact *impact, int which)
{
    const rr_real horizon = RR_HORIZON(impact->p);
    const rr_real until = which < impact->last ? RR_REACTION_TIME(impact->p) : horizon;
    return which > impact->first ? horizon - RR_REACTION_TIME(impact->p) : until;
}

static void steps_of(rr_impact *impact, int which)
{
    rr_phase *const phase = &impact->phase[which];
    const rr_real time = time_of(impact, which);
    phase->blur = blur_of(impact, phase, time);
    phase->blurred = phase->blur > BLURS;
#if !RR_STRUCTURED
    phase->blurred = phase->blurred || blur_of_spring(impact->region, &phase->modes, time) > BLURS_SPRING;
#endif
    rr_phase_steps(impact, time, phase);
    const rr_real numbers[2] = {phase->level[0].h, phase->level[RR_LEVELS - 1].h};
    if (rr_check_positive(numbers, 2) != RR_OK) {
        impact->status = RR_SINGULAR;
    }
}

void rr_impact_let_go(rr_impact *impact)
{
    if (!impact->phase[RR_LOOSE].ready) {
        impact->status = modes_of(impact, RR_LOOSE);
        if (impact->status == RR_OK) {
            steps_of(impact, RR_LOOSE);
        }
    }
}

/* Mobilities of the contact, and modes where those need them. */
static void weigh(rr_impact *impact)
{
    const rr_real body = impact->gives_way ? RR_R(1.0)/impact->region->effective_mass : RR_R(0.0);
    rr_real mobility = RR_R(0.0);
#if RR_STRUCTURED
    impact->status = rr_mobilities(
        &impact->arrival, impact->p, impact->phase[RR_LOOSE].modes.shape, &mobility, &impact->rotors);
#else
    for (int k = impact->first; k <= impact->last && impact->status == RR_OK; ++k) {
        impact->status = modes_of(impact, k);
        mobility = RR_FMAX(mobility, mobility_of(&impact->phase[k].modes));
    }
    impact->rotors = RR_R(0.0);
    const bool held = !RR_ELASTIC && impact->last == RR_LED && impact->motors == RR_MOTORS_DRIVEN;
    if (!(mobility > RR_LEAST_MOBILITY) && !held) {
        impact->status = RR_SINGULAR;
    }
#endif
    impact->mobility = RR_FMAX(mobility, RR_LEAST_MOBILITY) + body;
}

int rr_impact_prepare(const rr_region *region, const rr_params *p, int motors,
    rr_real force, rr_impact *impact)
{
    const rr_real reaction = RR_REACTION_TIME(p);
    const bool loose = motors == RR_MOTORS_FREE || !(reaction > RR_R(0.0));
    impact->region = region;
    impact->p = p;
    impact->motors = motors;
    impact->gives_way = region->clamped == 0;
    impact->first = loose ? RR_LOOSE : RR_LED;
    impact->last = loose || reaction < RR_HORIZON(p) ? RR_LOOSE : RR_LED;
    impact->status = RR_OK;
    impact->phase[RR_LED].ready = false;
    impact->phase[RR_LOOSE].ready = false;
    weigh(impact);
    if (impact->status != RR_OK) {
        return impact->status;
    }
    const rr_real size =
        force > RR_R(0.0) ? force : rr_two_body_force(region, impact->mobility, -force);
    const rr_real reached = region->stiffness*RR_HORIZON(p) + region->damping; /* by the horizon, at 1 m/s */
    impact->scale = RR_R(0.5)*(force > RR_R(0.0) ? size : RR_FMIN(size, -force*reached));
    impact->hold = region->stiffness + region->damping*region->damping*impact->mobility;
    const rr_real damped = region->damping*RR_SQRT(impact->mobility/region->stiffness);
    impact->smooth = RR_FMAX(RR_R(1.0)/(RR_R(1.0) + RR_R(4.0)*damped), LEAST_SMOOTH);
    impact->sure = impact->smooth < RR_HARD ? 1 : 2;
    impact->skin_rate = rr_law_stiffness(region, size)*impact->mobility;
    const rr_real numbers[3] = {impact->mobility, impact->scale, impact->skin_rate};
    if (!rr_all_finite(numbers, 3) || rr_check_positive(numbers, 3) != RR_OK) {
        return RR_SINGULAR;
    }
#if RR_STRUCTURED
    impact->status = modes_of(impact, impact->first);
    if (impact->status == RR_OK) {
        steps_of(impact, impact->first);
    }
#else
    for (int k = impact->first; k <= impact->last; ++k) {
        steps_of(impact, k);
    }
#endif
    return impact->status;
}
