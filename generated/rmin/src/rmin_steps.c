/* SPDX-License-Identifier: 0BSD */
/* Steps in time of rmin_'s modes. */
#include "rmin_impact.h"

/* Most radians of the contact's own vibration, and of any mode's, in the longest step. */
#define CONTACT_STEP RMIN_R(1.0)
#define MODE_STEP RMIN_R(5.6)
/* Most damping of joints and of a servo in the longest step, as a share of what it acts on. */
#define SERVO_STEP RMIN_R(0.1)
/*
 * A mode stands if its motion about where the force bends it is less than this share of the
 * displacement, in a contact as fast as `contact`.
 */
#define STANDS RMIN_R(1e-5)
/*
 * Nor may the damper's jump at first touch, c v of a force of about v sqrt(k m), be felt in its motion
 * through the damper, by more than this share of the force.
 */
#define FELT RMIN_R(2e-4)
/* Nor may it swing as motors are released so that spring and damper feel more than this share of it. */
#define LEFT RMIN_R(5e-5)
/*
 * Where the damper's jump at first touch is more than this share of the force, squared, the longest
 * step is at most so many times as long as the skin takes for it, c over its stiffness.
 */
#define JUMPS RMIN_R(0.1)
#define JUMP_STEP RMIN_R(24.0)
/* Steps counted; more than any budget has. */
#define MOST RMIN_R(1e6)

static void exchange(rmin_modes *modes, int i, int j)
{
    const rmin_real squared = modes->squared[i];
    const rmin_real noise = modes->noise[i];
    const rmin_real row = modes->row[i];
    const rmin_real start = modes->start[i];
    modes->squared[i] = modes->squared[j];
    modes->noise[i] = modes->noise[j];
    modes->row[i] = modes->row[j];
    modes->start[i] = modes->start[j];
    modes->squared[j] = squared;
    modes->noise[j] = noise;
    modes->row[j] = row;
    modes->start[j] = start;
    for (int k = 0; k < RMIN_SYSTEM && i != j; ++k) {
        const rmin_real shape = modes->shape[i][k];
        modes->shape[i][k] = modes->shape[j][k];
        modes->shape[j][k] = shape;
    }
}

/* Puts modes that stand behind those that move, whose order stays. */
static void let_stand(const rmin_impact *impact, rmin_real contact, bool released, rmin_phase *phase)
{
    rmin_modes *const modes = &phase->modes;
    const rmin_region *const region = impact->region;
    const rmin_real heavy = contact*contact/(STANDS*impact->mobility);
    const rmin_real twice = region->damping*region->damping/FELT;
    const rmin_real jump = twice*twice*impact->mobility/region->stiffness;
    rmin_real swing = RMIN_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const rmin_real along = modes->row[i]*modes->start[i];
        swing = RMIN_FMAX(swing, along*along/RMIN_FMAX(modes->squared[i], contact));
    }
    swing *= STANDS*STANDS;
    int active = 0;
    phase->compliance = RMIN_R(0.0);
    phase->reach = RMIN_R(0.0);
    phase->settles = !phase->damped;
    for (int i = 0; i < modes->count; ++i) {
        const bool body = impact->gives_way && i == modes->count - 1;
        const rmin_real weight = modes->row[i]*modes->row[i];
        const rmin_real along = modes->row[i]*modes->start[i];
        const rmin_real held = region->stiffness
            + region->damping*RMIN_SQRT(RMIN_FMAX(modes->squared[i], RMIN_R(0.0)));
        const bool stands = !phase->damped && weight*heavy < modes->squared[i]*modes->squared[i]
            && weight*weight*jump < modes->squared[i]
            && (!released || weight*held < LEFT*modes->squared[i])
            && along*along <= swing*modes->squared[i];
        if (i >= modes->rigid && !body) {
            phase->settles = phase->settles && modes->squared[i] > RMIN_R(0.0);
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
static void mode_steps(rmin_phase *phase, int i)
{
    const rmin_real one = RMIN_R(1.0);
    const rmin_real row = phase->modes.row[i];
    rmin_real h = phase->level[RMIN_LEVELS - 1].h;
    rmin_real t = phase->modes.squared[i]*h*h;
    /* sin(a)/a, (1 - cos(a))/a^2 and (a - sin(a))/a^3 over t = a^2 */
    rmin_real lean = RMIN_R(1.0)/RMIN_R(6.0)
        - t*(one/RMIN_R(120.0) - t*(one/RMIN_R(5040.0) - t/RMIN_R(362880.0)));
    rmin_real bend = RMIN_R(0.5)
        - t*(one/RMIN_R(24.0) - t*(one/RMIN_R(720.0) - t/RMIN_R(40320.0)));
    rmin_real sine = one - t*lean;
    for (int k = RMIN_LEVELS - 1; k >= 0; --k) {
        rmin_level *const level = &phase->level[k];
        rmin_mode_step *const step = &level->mode[i];
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
        lean = RMIN_R(0.25)*(lean + sine*bend);
        bend = RMIN_R(0.5)*sine*sine;
        sine *= step->cosine;
        t *= RMIN_R(4.0);
        h += h;
    }
}

/* Most that joints and a servo's gains damp a mode, 1/s. */
static rmin_real damping_rate(const rmin_phase *phase)
{
    rmin_real rate = RMIN_R(0.0);
    for (int i = 0; i < RMIN_DAMPERS && phase->damped; ++i) {
        rmin_real of_motor = RMIN_R(0.0);
        for (int k = 0; k < phase->modes.count; ++k) {
            const rmin_real shape = phase->modes.shape[k][RMIN_SYSTEM - RMIN_DAMPERS + i];
            of_motor += shape*shape;
        }
        rate = RMIN_FMAX(rate, phase->damping[i]*of_motor);
    }
    return rate;
}

void rmin_phase_steps(const rmin_impact *impact, rmin_real time, rmin_phase *phase)
{
    const rmin_region *const region = impact->region;
    rmin_modes *const modes = &phase->modes;
    const rmin_real spring = region->stiffness*impact->mobility;
    const rmin_real damper = RMIN_R(0.5)*region->damping*impact->mobility;
    const rmin_real contact = RMIN_FMIN(spring + damper*damper, impact->skin_rate);
    const bool released = phase == &impact->phase[RMIN_LOOSE] && impact->first == RMIN_LED;
    if (impact->gives_way) {
        const int body = modes->count < RMIN_MODES ? modes->count : RMIN_MODES - 1; /* the former */
        modes->squared[body] = RMIN_R(0.0);
        modes->noise[body] = RMIN_R(0.0);
        modes->row[body] = RMIN_R(1.0)/RMIN_SQRT(region->effective_mass);
        modes->start[body] = RMIN_R(0.0);
        for (int k = 0; k < RMIN_SYSTEM; ++k) {
            modes->shape[body][k] = RMIN_R(0.0);
        }
        modes->count = body + 1;
    }
    phase->has_body = impact->gives_way;
    let_stand(impact, contact, released, phase);
    rmin_real moving = RMIN_R(0.0);
    rmin_real rate2 = RMIN_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        moving += modes->row[i]*modes->row[i];
        rate2 = RMIN_FMAX(rate2, RMIN_FABS(modes->squared[i])/(MODE_STEP*MODE_STEP));
    }
    const rmin_real share = RMIN_FMIN(moving/impact->mobility, RMIN_R(1.0));
    rate2 = RMIN_FMAX(rate2, share*contact/(CONTACT_STEP*CONTACT_STEP));
    const rmin_real jump = region->damping*impact->mobility;
    const rmin_real rise = jump*region->damping > JUMPS*region->stiffness
        ? impact->skin_rate/(JUMP_STEP*jump) : RMIN_R(0.0);
    const rmin_real slowest = RMIN_FMAX(RMIN_R(1.0)/time, rise);
    const rmin_real rate = RMIN_FMAX(slowest, RMIN_FMAX(RMIN_SQRT(rate2), damping_rate(phase)/SERVO_STEP));
    const rmin_real wanted = time*rate;
    phase->steps = wanted < MOST ? (int)wanted + 1 : (int)MOST;
    rmin_real h = wanted < MOST ? time/(rmin_real)phase->steps : RMIN_R(1.0)/rate;
    for (int k = 0; k < RMIN_LEVELS; ++k) {
        rmin_level *const level = &phase->level[k];
        level->h = h;
        level->relax = region->damping > RMIN_R(0.0)
            ? RMIN_EXP(-RMIN_FMIN(region->stiffness*h/region->damping, RMIN_R(80.0))) : RMIN_R(0.0);
        for (int end = 0; end < 2; ++end) {
            level->push[end] = RMIN_R(0.0);
            level->kick[end] = RMIN_R(0.0);
        }
        h *= RMIN_R(0.5);
    }
    for (int i = 0; i < phase->active; ++i) {
        mode_steps(phase, i);
    }
    phase->ready = true;
}
