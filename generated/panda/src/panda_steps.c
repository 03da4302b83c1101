/* SPDX-License-Identifier: 0BSD */
/* Steps in time of panda_'s modes. */
#include "panda_impact.h"

/*
 * Most radians of the contact's own vibration, and of any mode's, in the longest step; and of the former while they
 * touch: a force that turns looks straight over more.
 */
#define CONTACT_STEP PANDA_R(1.0)
#define PRESSED_STEP PANDA_R(0.5)
#define MODE_STEP PANDA_R(5.6)
/* Most damping of joints and of a servo in the longest step, as a share of what it acts on. */
#define SERVO_STEP PANDA_R(0.1)
/*
 * A mode stands if its motion about where the force bends it is less than this share of the
 * displacement, in a contact as fast as `contact`, or as the time there is.
 */
#define STANDS PANDA_R(1e-5)
/*
 * Nor may the damper's jump at first touch, c v of a force of about v sqrt(k m), be felt in its motion
 * through the damper, by more than this share of the force.
 */
#define FELT PANDA_R(2e-4)
/* Nor may it swing as motors are released so that spring and damper feel more than this share of it. */
#define LEFT PANDA_R(5e-5)
/*
 * Where the damper's jump at first touch is more than this share of the force, squared, the longest
 * step is at most so many times as long as the skin takes for it, c over its stiffness.
 */
#define JUMPS PANDA_R(0.1)
#define JUMP_STEP PANDA_R(24.0)
/*
 * Least that a mode moves the contact point by, 1/sqrt(kg): modes are followed by that, and what they do themselves is
 * told from it. It must not be felt: rotors of 1e30 kg m^2 turn with amplitudes of 1e15 m sqrt(kg).
 */
#define LEAST_ROW PANDA_R(1e-25)
/* Steps counted; more than any budget has. */
#define MOST PANDA_R(1e6)

static void exchange(panda_modes *modes, int i, int j)
{
    const panda_real squared = modes->squared[i];
    const panda_real noise = modes->noise[i];
    const panda_real row = modes->row[i];
    const panda_real start = modes->start[i];
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
static void let_stand(const panda_impact *impact, panda_real contact, bool released, panda_phase *phase)
{
    panda_modes *const modes = &phase->modes;
    const panda_region *const region = impact->region;
    const panda_real heavy = contact*contact/(STANDS*impact->mobility);
    const panda_real twice = region->damping*region->damping/FELT;
    const panda_real jump = twice*twice*impact->mobility/region->stiffness;
    panda_real swing = PANDA_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const panda_real along = modes->row[i]*modes->start[i];
        swing = PANDA_FMAX(swing, along*along/PANDA_FMAX(modes->squared[i], contact));
    }
    swing *= STANDS*STANDS;
    int active = 0;
    phase->compliance = PANDA_R(0.0);
    phase->reach = PANDA_R(0.0);
    const bool pushes_on = phase->drift > PANDA_R(0.0) && !impact->gives_way;
    phase->settles = !phase->damped && !pushes_on;
    for (int i = 0; i < modes->count; ++i) {
        const bool body = impact->gives_way && i == modes->count - 1;
        const panda_real weight = modes->row[i]*modes->row[i];
        const panda_real along = modes->row[i]*modes->start[i];
        const panda_real held = region->stiffness
            + region->damping*PANDA_SQRT(PANDA_FMAX(modes->squared[i], PANDA_R(0.0)));
        const bool stands = !phase->damped && weight*heavy < modes->squared[i]*modes->squared[i]
            && weight*weight*jump < modes->squared[i]
            && (!released || weight*held < LEFT*modes->squared[i])
            && along*along <= swing*modes->squared[i];
        if (i >= modes->rigid && !body) {
            phase->settles = phase->settles && modes->squared[i] > PANDA_R(0.0);
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
static void mode_steps(panda_phase *phase)
{
    const panda_modes *const modes = &phase->modes;
    const panda_real one = PANDA_R(1.0);
    const panda_real h = phase->level[PANDA_LEVELS - 1].h;
    for (int i = 0; i < phase->active; ++i) {
        const panda_real squared = modes->squared[i];
        const panda_real weight = modes->row[i]*modes->row[i];
        const panda_real t = squared*h*h;
        panda_real late = h*h*(one/PANDA_R(6.0)
            - t*(one/PANDA_R(120.0) - t*(one/PANDA_R(5040.0) - t/PANDA_R(362880.0)))); /* (wh - sin(wh))/(w^3 h) */
        panda_real push = h*h*(PANDA_R(0.5)
            - t*(one/PANDA_R(24.0) - t*(one/PANDA_R(720.0) - t/PANDA_R(40320.0)))); /* (1 - cos(wh))/w^2 */
        panda_real sine = h*(one - squared*late); /* sin(wh)/w */
        for (int k = PANDA_LEVELS - 1; k >= 0; --k) {
            panda_level *const level = &phase->level[k];
            panda_mode_step *const step = &level->mode[i];
            const panda_real cosine = one - squared*push;
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
            push = PANDA_R(2.0)*sine*sine;
            sine *= PANDA_R(2.0)*cosine;
        }
    }
    for (int k = 0; k < PANDA_LEVELS; ++k) {
        panda_level *const level = &phase->level[k];
        level->grow = level->push*level->per;
    }
}

void panda_phase_steps(const panda_impact *impact, panda_real time, panda_phase *phase)
{
    const panda_region *const region = impact->region;
    panda_modes *const modes = &phase->modes;
    const panda_real spring = region->stiffness*impact->mobility;
    const panda_real damper = PANDA_R(0.5)*region->damping*impact->mobility;
    const panda_real contact = PANDA_FMIN(spring + damper*damper, impact->skin_rate);
    const bool released = phase == &impact->phase[PANDA_LOOSE] && impact->first == PANDA_LED;
    if (impact->gives_way) {
        const int body = modes->count < PANDA_MODES ? modes->count : PANDA_MODES - 1; /* the former */
        modes->squared[body] = PANDA_R(0.0);
        modes->noise[body] = PANDA_R(0.0);
        modes->row[body] = PANDA_R(1.0)/PANDA_SQRT(region->effective_mass);
        modes->start[body] = PANDA_R(0.0);
        modes->from[body] = body;
        for (int k = 0; k < PANDA_SYSTEM; ++k) {
            modes->shape[body][k] = PANDA_R(0.0);
        }
        modes->count = body + 1;
    }
    phase->has_body = impact->gives_way;
    for (int i = 0; i < modes->count; ++i) {
        modes->row[i] = PANDA_FABS(modes->row[i]) > LEAST_ROW ? modes->row[i] : LEAST_ROW;
    }
    const panda_real end = PANDA_R(1.0)/PANDA_HORIZON(impact->p);
    let_stand(impact, PANDA_FMAX(contact, end*end), released, phase);
    panda_real moving = PANDA_R(0.0);
    panda_real rate2 = PANDA_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        moving += modes->row[i]*modes->row[i];
        rate2 = PANDA_FMAX(rate2, PANDA_FABS(modes->squared[i])/(MODE_STEP*MODE_STEP));
    }
    const panda_real share = PANDA_FMIN(moving/impact->mobility, PANDA_R(1.0));
    rate2 = PANDA_FMAX(rate2, share*contact/(CONTACT_STEP*CONTACT_STEP));
    const panda_real jump = region->damping*impact->mobility;
    const panda_real rise = jump*region->damping > JUMPS*region->stiffness
        ? impact->skin_rate/(JUMP_STEP*jump) : PANDA_R(0.0);
    const panda_real slowest = PANDA_FMAX(PANDA_R(1.0)/time, rise);
    const panda_real rate = PANDA_FMAX(slowest, PANDA_FMAX(PANDA_SQRT(rate2), panda_damping_rate(phase)/SERVO_STEP));
    const panda_real wanted = time*rate;
    phase->steps = wanted < MOST ? (int)wanted + 1 : (int)MOST;
    const panda_real h = wanted < MOST ? time/(panda_real)phase->steps : PANDA_R(1.0)/rate;
    phase->longest_pressed = share*contact*h*h > PRESSED_STEP*PRESSED_STEP ? 1 : 0;
    panda_real shortest = h;
    panda_real per = PANDA_R(1.0)/h;
    for (int k = 0; k < PANDA_LEVELS; ++k) {
        panda_level *const level = &phase->level[k];
        level->h = shortest;
        level->per = per;
        level->push = PANDA_R(0.0);
        level->late = PANDA_R(0.0);
        level->kick = PANDA_R(0.0);
        shortest *= PANDA_R(0.5);
        per += per;
    }
    shortest = region->stiffness*phase->level[PANDA_LEVELS - 1].h;
    panda_real relax = region->damping > PANDA_R(0.0)
        ? PANDA_EXP(-PANDA_FMIN(shortest/region->damping, PANDA_R(80.0))) : PANDA_R(0.0);
    for (int k = PANDA_LEVELS - 1; k >= 0; --k) {
        phase->level[k].relax = relax;
        relax *= relax;
    }
    mode_steps(phase);
    if (phase->damped) {
        panda_slowing(phase);
    }
    phase->ready = true;
}
