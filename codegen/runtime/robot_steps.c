/* SPDX-License-Identifier: 0BSD */
/* Steps in time of robot_'s modes. */
#include "robot_impact.h"

/* Most radians of the contact's own vibration, and of any mode's, in the longest step. */
#define CONTACT_STEP ROBOT_R(1.0)
#define MODE_STEP ROBOT_R(5.6)
/* Most damping of joints and of a servo in the longest step, as a share of what it acts on. */
#define SERVO_STEP ROBOT_R(0.1)
/*
 * A mode stands if its motion about where the force bends it is less than this share of the
 * displacement, in a contact as fast as `contact`.
 */
#define STANDS ROBOT_R(1e-5)
/*
 * Nor may the damper's jump at first touch, c v of a force of about v sqrt(k m), be felt in its motion
 * through the damper, by more than this share of the force.
 */
#define FELT ROBOT_R(2e-4)
/* Nor may it swing as motors are released so that spring and damper feel more than this share of it. */
#define LEFT ROBOT_R(5e-5)
/*
 * Where the damper's jump at first touch is more than this share of the force, squared, the longest
 * step is at most so many times as long as the skin takes for it, c over its stiffness.
 */
#define JUMPS ROBOT_R(0.1)
#define JUMP_STEP ROBOT_R(24.0)
/* Steps counted; more than any budget has. */
#define MOST ROBOT_R(1e6)

static void exchange(robot_modes *modes, int i, int j)
{
    const robot_real squared = modes->squared[i];
    const robot_real noise = modes->noise[i];
    const robot_real row = modes->row[i];
    const robot_real start = modes->start[i];
    modes->squared[i] = modes->squared[j];
    modes->noise[i] = modes->noise[j];
    modes->row[i] = modes->row[j];
    modes->start[i] = modes->start[j];
    modes->squared[j] = squared;
    modes->noise[j] = noise;
    modes->row[j] = row;
    modes->start[j] = start;
    for (int k = 0; k < ROBOT_SYSTEM && i != j; ++k) {
        const robot_real shape = modes->shape[i][k];
        modes->shape[i][k] = modes->shape[j][k];
        modes->shape[j][k] = shape;
    }
}

/* Puts modes that stand behind those that move, whose order stays. */
static void let_stand(const robot_impact *impact, robot_real contact, bool released, robot_phase *phase)
{
    robot_modes *const modes = &phase->modes;
    const robot_region *const region = impact->region;
    const robot_real heavy = contact*contact/(STANDS*impact->mobility);
    const robot_real twice = region->damping*region->damping/FELT;
    const robot_real jump = twice*twice*impact->mobility/region->stiffness;
    robot_real swing = ROBOT_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const robot_real along = modes->row[i]*modes->start[i];
        swing = ROBOT_FMAX(swing, along*along/ROBOT_FMAX(modes->squared[i], contact));
    }
    swing *= STANDS*STANDS;
    int active = 0;
    phase->compliance = ROBOT_R(0.0);
    phase->reach = ROBOT_R(0.0);
    phase->settles = !phase->damped;
    for (int i = 0; i < modes->count; ++i) {
        const bool body = impact->gives_way && i == modes->count - 1;
        const robot_real weight = modes->row[i]*modes->row[i];
        const robot_real along = modes->row[i]*modes->start[i];
        const robot_real held = region->stiffness
            + region->damping*ROBOT_SQRT(ROBOT_FMAX(modes->squared[i], ROBOT_R(0.0)));
        const bool stands = !phase->damped && weight*heavy < modes->squared[i]*modes->squared[i]
            && weight*weight*jump < modes->squared[i]
            && (!released || weight*held < LEFT*modes->squared[i])
            && along*along <= swing*modes->squared[i];
        if (i >= modes->rigid && !body) {
            phase->settles = phase->settles && modes->squared[i] > ROBOT_R(0.0);
            phase->reach += weight/modes->squared[i];
        }
        if (stands) {
            phase->compliance += weight/modes->squared[i];
        } else {
            phase->blurred = phase->blurred || !(modes->squared[i] < modes->fastest);
            exchange(modes, active < i ? active : i, i); /* it is never more */
            ++active;
        }
    }
    phase->active = active < modes->count ? active : modes->count;
}

/* Steps of one mode at all levels: a series for the shortest, from which the others follow. */
static void mode_steps(robot_phase *phase, int i)
{
    const robot_real one = ROBOT_R(1.0);
    const robot_real row = phase->modes.row[i];
    robot_real h = phase->level[ROBOT_LEVELS - 1].h;
    robot_real t = phase->modes.squared[i]*h*h;
    /* sin(a)/a, (1 - cos(a))/a^2 and (a - sin(a))/a^3 over t = a^2 */
    robot_real lean = ROBOT_R(1.0)/ROBOT_R(6.0)
        - t*(one/ROBOT_R(120.0) - t*(one/ROBOT_R(5040.0) - t/ROBOT_R(362880.0)));
    robot_real bend = ROBOT_R(0.5)
        - t*(one/ROBOT_R(24.0) - t*(one/ROBOT_R(720.0) - t/ROBOT_R(40320.0)));
    robot_real sine = one - t*lean;
    for (int k = ROBOT_LEVELS - 1; k >= 0; --k) {
        robot_level *const level = &phase->level[k];
        robot_mode_step *const step = &level->mode[i];
        step->cosine = one - t*bend;
        step->sine = h*sine;
        step->back = -phase->modes.squared[i]*h*sine;
        step->push[0] = row*h*h*(bend - lean);
        step->push[1] = row*h*h*lean;
        step->kick[0] = row*h*(sine - bend);
        step->kick[1] = row*h*bend;
        for (int end = 0; end < 2; ++end) {
            level->push[end] += row*step->push[end];
            level->kick[end] += row*step->kick[end];
        }
        lean = ROBOT_R(0.25)*(lean + sine*bend);
        bend = ROBOT_R(0.5)*sine*sine;
        sine *= step->cosine;
        t *= ROBOT_R(4.0);
        h += h;
    }
}

/* Most that joints and a servo's gains damp a mode, 1/s. */
static robot_real damping_rate(const robot_phase *phase)
{
    robot_real rate = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_DAMPERS && phase->damped; ++i) {
        robot_real of_motor = ROBOT_R(0.0);
        for (int k = 0; k < phase->modes.count; ++k) {
            const robot_real shape = phase->modes.shape[k][ROBOT_SYSTEM - ROBOT_DAMPERS + i];
            of_motor += shape*shape;
        }
        rate = ROBOT_FMAX(rate, phase->damping[i]*of_motor);
    }
    return rate;
}

void robot_phase_steps(const robot_impact *impact, robot_real time, robot_phase *phase)
{
    const robot_region *const region = impact->region;
    robot_modes *const modes = &phase->modes;
    const robot_real spring = region->stiffness*impact->mobility;
    const robot_real damper = ROBOT_R(0.5)*region->damping*impact->mobility;
    const robot_real contact = ROBOT_FMIN(spring + damper*damper, impact->skin_rate);
    const bool released = phase == &impact->phase[ROBOT_LOOSE] && impact->first == ROBOT_LED;
    if (impact->gives_way) {
        const int body = modes->count < ROBOT_MODES ? modes->count : ROBOT_MODES - 1; /* the former */
        modes->squared[body] = ROBOT_R(0.0);
        modes->noise[body] = ROBOT_R(0.0);
        modes->row[body] = ROBOT_R(1.0)/ROBOT_SQRT(region->effective_mass);
        modes->start[body] = ROBOT_R(0.0);
        for (int k = 0; k < ROBOT_SYSTEM; ++k) {
            modes->shape[body][k] = ROBOT_R(0.0);
        }
        modes->count = body + 1;
    }
    phase->has_body = impact->gives_way;
    let_stand(impact, contact, released, phase);
    robot_real moving = ROBOT_R(0.0);
    robot_real rate2 = ROBOT_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        moving += modes->row[i]*modes->row[i];
        rate2 = ROBOT_FMAX(rate2, ROBOT_FABS(modes->squared[i])/(MODE_STEP*MODE_STEP));
    }
    const robot_real share = ROBOT_FMIN(moving/impact->mobility, ROBOT_R(1.0));
    rate2 = ROBOT_FMAX(rate2, share*contact/(CONTACT_STEP*CONTACT_STEP));
    const robot_real jump = region->damping*impact->mobility;
    const robot_real rise = jump*region->damping > JUMPS*region->stiffness
        ? impact->skin_rate/(JUMP_STEP*jump) : ROBOT_R(0.0);
    const robot_real slowest = ROBOT_FMAX(ROBOT_R(1.0)/time, rise);
    const robot_real rate = ROBOT_FMAX(slowest, ROBOT_FMAX(ROBOT_SQRT(rate2), damping_rate(phase)/SERVO_STEP));
    const robot_real wanted = time*rate;
    phase->steps = wanted < MOST ? (int)wanted + 1 : (int)MOST;
    robot_real h = wanted < MOST ? time/(robot_real)phase->steps : ROBOT_R(1.0)/rate;
    for (int k = 0; k < ROBOT_LEVELS; ++k) {
        robot_level *const level = &phase->level[k];
        level->h = h;
        level->relax = region->damping > ROBOT_R(0.0)
            ? ROBOT_EXP(-ROBOT_FMIN(region->stiffness*h/region->damping, ROBOT_R(80.0))) : ROBOT_R(0.0);
        for (int end = 0; end < 2; ++end) {
            level->push[end] = ROBOT_R(0.0);
            level->kick[end] = ROBOT_R(0.0);
        }
        h *= ROBOT_R(0.5);
    }
    for (int i = 0; i < phase->active; ++i) {
        mode_steps(phase, i);
    }
    phase->ready = true;
}
