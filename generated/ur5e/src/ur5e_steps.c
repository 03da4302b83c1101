/* SPDX-License-Identifier: 0BSD */
/* Steps in time of ur5e_'s modes. */
#include "ur5e_impact.h"

/* Most radians of the contact's own vibration, and of any mode's, in the longest step. */
#define CONTACT_STEP UR5E_R(1.0)
#define MODE_STEP UR5E_R(5.6)
/* Most damping of joints and of a servo in the longest step, as a share of what it acts on. */
#define SERVO_STEP UR5E_R(0.1)
/*
 * A mode stands if its motion about where the force bends it is less than this share of the
 * displacement, in a contact as fast as `contact`.
 */
#define STANDS UR5E_R(1e-5)
/*
 * Nor may the damper's jump at first touch, c v of a force of about v sqrt(k m), be felt in its motion
 * through the damper, by more than this share of the force.
 */
#define FELT UR5E_R(2e-4)
/* Nor may it swing as motors are released so that spring and damper feel more than this share of it. */
#define LEFT UR5E_R(5e-5)
/*
 * Where the damper's jump at first touch is more than this share of the force, squared, the longest
 * step is at most so many times as long as the skin takes for it, c over its stiffness.
 */
#define JUMPS UR5E_R(0.1)
#define JUMP_STEP UR5E_R(24.0)
/* Steps counted; more than any budget has. */
#define MOST UR5E_R(1e6)

static void exchange(ur5e_modes *modes, int i, int j)
{
    const ur5e_real squared = modes->squared[i];
    const ur5e_real noise = modes->noise[i];
    const ur5e_real row = modes->row[i];
    const ur5e_real start = modes->start[i];
    modes->squared[i] = modes->squared[j];
    modes->noise[i] = modes->noise[j];
    modes->row[i] = modes->row[j];
    modes->start[i] = modes->start[j];
    modes->squared[j] = squared;
    modes->noise[j] = noise;
    modes->row[j] = row;
    modes->start[j] = start;
    for (int k = 0; k < UR5E_SYSTEM && i != j; ++k) {
        const ur5e_real shape = modes->shape[i][k];
        modes->shape[i][k] = modes->shape[j][k];
        modes->shape[j][k] = shape;
    }
}

/* Puts modes that stand behind those that move, whose order stays. */
static void let_stand(const ur5e_impact *impact, ur5e_real contact, bool released, ur5e_phase *phase)
{
    ur5e_modes *const modes = &phase->modes;
    const ur5e_region *const region = impact->region;
    const ur5e_real heavy = contact*contact/(STANDS*impact->mobility);
    const ur5e_real twice = region->damping*region->damping/FELT;
    const ur5e_real jump = twice*twice*impact->mobility/region->stiffness;
    ur5e_real swing = UR5E_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const ur5e_real along = modes->row[i]*modes->start[i];
        swing = UR5E_FMAX(swing, along*along/UR5E_FMAX(modes->squared[i], contact));
    }
    swing *= STANDS*STANDS;
    int active = 0;
    phase->compliance = UR5E_R(0.0);
    phase->reach = UR5E_R(0.0);
    phase->settles = !phase->damped;
    for (int i = 0; i < modes->count; ++i) {
        const bool body = impact->gives_way && i == modes->count - 1;
        const ur5e_real weight = modes->row[i]*modes->row[i];
        const ur5e_real along = modes->row[i]*modes->start[i];
        const ur5e_real held = region->stiffness
            + region->damping*UR5E_SQRT(UR5E_FMAX(modes->squared[i], UR5E_R(0.0)));
        const bool stands = !phase->damped && weight*heavy < modes->squared[i]*modes->squared[i]
            && weight*weight*jump < modes->squared[i]
            && (!released || weight*held < LEFT*modes->squared[i])
            && along*along <= swing*modes->squared[i];
        if (i >= modes->rigid && !body) {
            phase->settles = phase->settles && modes->squared[i] > UR5E_R(0.0);
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
static void mode_steps(ur5e_phase *phase, int i)
{
    const ur5e_real one = UR5E_R(1.0);
    const ur5e_real row = phase->modes.row[i];
    ur5e_real h = phase->level[UR5E_LEVELS - 1].h;
    ur5e_real t = phase->modes.squared[i]*h*h;
    /* sin(a)/a, (1 - cos(a))/a^2 and (a - sin(a))/a^3 over t = a^2 */
    ur5e_real lean = UR5E_R(1.0)/UR5E_R(6.0)
        - t*(one/UR5E_R(120.0) - t*(one/UR5E_R(5040.0) - t/UR5E_R(362880.0)));
    ur5e_real bend = UR5E_R(0.5)
        - t*(one/UR5E_R(24.0) - t*(one/UR5E_R(720.0) - t/UR5E_R(40320.0)));
    ur5e_real sine = one - t*lean;
    for (int k = UR5E_LEVELS - 1; k >= 0; --k) {
        ur5e_level *const level = &phase->level[k];
        ur5e_mode_step *const step = &level->mode[i];
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
        lean = UR5E_R(0.25)*(lean + sine*bend);
        bend = UR5E_R(0.5)*sine*sine;
        sine *= step->cosine;
        t *= UR5E_R(4.0);
        h += h;
    }
}

/* Most that joints and a servo's gains damp a mode, 1/s. */
static ur5e_real damping_rate(const ur5e_phase *phase)
{
    ur5e_real rate = UR5E_R(0.0);
    for (int i = 0; i < UR5E_DAMPERS && phase->damped; ++i) {
        ur5e_real of_motor = UR5E_R(0.0);
        for (int k = 0; k < phase->modes.count; ++k) {
            const ur5e_real shape = phase->modes.shape[k][UR5E_SYSTEM - UR5E_DAMPERS + i];
            of_motor += shape*shape;
        }
        rate = UR5E_FMAX(rate, phase->damping[i]*of_motor);
    }
    return rate;
}

void ur5e_phase_steps(const ur5e_impact *impact, ur5e_real time, ur5e_phase *phase)
{
    const ur5e_region *const region = impact->region;
    ur5e_modes *const modes = &phase->modes;
    const ur5e_real spring = region->stiffness*impact->mobility;
    const ur5e_real damper = UR5E_R(0.5)*region->damping*impact->mobility;
    const ur5e_real contact = UR5E_FMIN(spring + damper*damper, impact->skin_rate);
    const bool released = phase == &impact->phase[UR5E_LOOSE] && impact->first == UR5E_LED;
    if (impact->gives_way) {
        const int body = modes->count < UR5E_MODES ? modes->count : UR5E_MODES - 1; /* the former */
        modes->squared[body] = UR5E_R(0.0);
        modes->noise[body] = UR5E_R(0.0);
        modes->row[body] = UR5E_R(1.0)/UR5E_SQRT(region->effective_mass);
        modes->start[body] = UR5E_R(0.0);
        for (int k = 0; k < UR5E_SYSTEM; ++k) {
            modes->shape[body][k] = UR5E_R(0.0);
        }
        modes->count = body + 1;
    }
    phase->has_body = impact->gives_way;
    let_stand(impact, contact, released, phase);
    ur5e_real moving = UR5E_R(0.0);
    ur5e_real rate2 = UR5E_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        moving += modes->row[i]*modes->row[i];
        rate2 = UR5E_FMAX(rate2, UR5E_FABS(modes->squared[i])/(MODE_STEP*MODE_STEP));
    }
    const ur5e_real share = UR5E_FMIN(moving/impact->mobility, UR5E_R(1.0));
    rate2 = UR5E_FMAX(rate2, share*contact/(CONTACT_STEP*CONTACT_STEP));
    const ur5e_real jump = region->damping*impact->mobility;
    const ur5e_real rise = jump*region->damping > JUMPS*region->stiffness
        ? impact->skin_rate/(JUMP_STEP*jump) : UR5E_R(0.0);
    const ur5e_real slowest = UR5E_FMAX(UR5E_R(1.0)/time, rise);
    const ur5e_real rate = UR5E_FMAX(slowest, UR5E_FMAX(UR5E_SQRT(rate2), damping_rate(phase)/SERVO_STEP));
    const ur5e_real wanted = time*rate;
    phase->steps = wanted < MOST ? (int)wanted + 1 : (int)MOST;
    ur5e_real h = wanted < MOST ? time/(ur5e_real)phase->steps : UR5E_R(1.0)/rate;
    for (int k = 0; k < UR5E_LEVELS; ++k) {
        ur5e_level *const level = &phase->level[k];
        level->h = h;
        level->relax = region->damping > UR5E_R(0.0)
            ? UR5E_EXP(-UR5E_FMIN(region->stiffness*h/region->damping, UR5E_R(80.0))) : UR5E_R(0.0);
        for (int end = 0; end < 2; ++end) {
            level->push[end] = UR5E_R(0.0);
            level->kick[end] = UR5E_R(0.0);
        }
        h *= UR5E_R(0.5);
    }
    for (int i = 0; i < phase->active; ++i) {
        mode_steps(phase, i);
    }
    phase->ready = true;
}
