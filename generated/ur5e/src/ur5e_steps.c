/* SPDX-License-Identifier: 0BSD */
/* Steps in time of ur5e_'s modes. */
#include "ur5e_impact.h"

/*
 * Most radians of the contact's own vibration, and of any mode's, in the longest step; and of the former while they
 * touch: a force that turns looks straight over more.
 */
#define CONTACT_STEP UR5E_R(1.0)
#define PRESSED_STEP UR5E_R(0.5)
#define MODE_STEP UR5E_R(5.6)
/* Most damping of joints and of a servo in the longest step, as a share of what it acts on. */
#define SERVO_STEP UR5E_R(0.1)
/*
 * A mode stands if its motion about where the force bends it is less than this share of the
 * displacement, in a contact as fast as `contact`, or as the time there is.
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
/*
 * Least that a mode moves the contact point by, 1/sqrt(kg): modes are followed by that, and what they do themselves is
 * told from it. It must not be felt: rotors of 1e30 kg m^2 turn with amplitudes of 1e15 m sqrt(kg).
 */
#define LEAST_ROW UR5E_R(1e-25)
/* Steps counted; more than any budget has. */
#define MOST UR5E_R(1e6)

static void exchange(ur5e_modes *modes, int i, int j)
{
    const ur5e_real squared = modes->squared[i];
    const ur5e_real noise = modes->noise[i];
    const ur5e_real row = modes->row[i];
    const ur5e_real start = modes->start[i];
    const int from = modes->from[i];
    modes->squared[i] = modes->squared[j];
    modes->noise[i] = modes->noise[j];
    modes->row[i] = modes->row[j];
    modes->start[i] = modes->start[j];
    modes->squared[j] = squared;
    modes->noise[j] = noise;
    modes->row[j] = row;
    modes->start[j] = start;
    modes->from[i] = modes->from[j];
    modes->from[j] = from;
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
    const bool pushes_on = phase->drift > UR5E_R(0.0) && !impact->gives_way;
    phase->settles = !phase->damped && !pushes_on;
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
            if (active < i) {
                exchange(modes, active, i);
            }
            ++active;
        }
    }
    phase->active = active < modes->count ? active : modes->count;
}

/*
 * Steps of all modes at all levels: a series for the shortest, from which the others follow by the sine and
 * cosine of twice an angle.
 */
static void mode_steps(ur5e_phase *phase)
{
    const ur5e_modes *const modes = &phase->modes;
    const ur5e_real one = UR5E_R(1.0);
    const ur5e_real h = phase->level[UR5E_LEVELS - 1].h;
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_real squared = modes->squared[i];
        const ur5e_real weight = modes->row[i]*modes->row[i];
        const ur5e_real t = squared*h*h;
        ur5e_real late = h*h*(one/UR5E_R(6.0)
            - t*(one/UR5E_R(120.0) - t*(one/UR5E_R(5040.0) - t/UR5E_R(362880.0)))); /* (wh - sin(wh))/(w^3 h) */
        ur5e_real push = h*h*(UR5E_R(0.5)
            - t*(one/UR5E_R(24.0) - t*(one/UR5E_R(720.0) - t/UR5E_R(40320.0)))); /* (1 - cos(wh))/w^2 */
        ur5e_real sine = h*(one - squared*late); /* sin(wh)/w */
        for (int k = UR5E_LEVELS - 1; k >= 0; --k) {
            ur5e_level *const level = &phase->level[k];
            ur5e_mode_step *const step = &level->mode[i];
            const ur5e_real cosine = one - squared*push;
            step->cosine = cosine;
            step->sine = sine;
            step->back = -squared*sine;
            step->push = weight*push;
            step->late = weight*late;
            step->kick = weight*sine;
            level->push += step->push;
            level->late += step->late;
            level->kick += step->kick;
            late += sine*push*level->per;
            push = UR5E_R(2.0)*sine*sine;
            sine *= UR5E_R(2.0)*cosine;
        }
    }
    for (int k = 0; k < UR5E_LEVELS; ++k) {
        ur5e_level *const level = &phase->level[k];
        level->grow = level->push*level->per;
    }
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
        modes->from[body] = body;
        for (int k = 0; k < UR5E_SYSTEM; ++k) {
            modes->shape[body][k] = UR5E_R(0.0);
        }
        modes->count = body + 1;
    }
    phase->has_body = impact->gives_way;
    for (int i = 0; i < modes->count; ++i) {
        modes->row[i] = UR5E_FABS(modes->row[i]) > LEAST_ROW ? modes->row[i] : LEAST_ROW;
    }
    const ur5e_real end = UR5E_R(1.0)/UR5E_HORIZON(impact->p);
    let_stand(impact, UR5E_FMAX(contact, end*end), released, phase);
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
    const ur5e_real rate = UR5E_FMAX(slowest, UR5E_FMAX(UR5E_SQRT(rate2), ur5e_damping_rate(phase)/SERVO_STEP));
    const ur5e_real wanted = time*rate;
    phase->steps = wanted < MOST ? (int)wanted + 1 : (int)MOST;
    const ur5e_real h = wanted < MOST ? time/(ur5e_real)phase->steps : UR5E_R(1.0)/rate;
    phase->longest_pressed = share*contact*h*h > PRESSED_STEP*PRESSED_STEP ? 1 : 0;
    ur5e_real shortest = h;
    ur5e_real per = UR5E_R(1.0)/h;
    for (int k = 0; k < UR5E_LEVELS; ++k) {
        ur5e_level *const level = &phase->level[k];
        level->h = shortest;
        level->per = per;
        level->push = UR5E_R(0.0);
        level->late = UR5E_R(0.0);
        level->kick = UR5E_R(0.0);
        shortest *= UR5E_R(0.5);
        per += per;
    }
    shortest = region->stiffness*phase->level[UR5E_LEVELS - 1].h;
    ur5e_real relax = region->damping > UR5E_R(0.0)
        ? UR5E_EXP(-UR5E_FMIN(shortest/region->damping, UR5E_R(80.0))) : UR5E_R(0.0);
    for (int k = UR5E_LEVELS - 1; k >= 0; --k) {
        phase->level[k].relax = relax;
        relax *= relax;
    }
    mode_steps(phase);
    if (phase->damped) {
        ur5e_slowing(phase);
    }
    phase->ready = true;
}
