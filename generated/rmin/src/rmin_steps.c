/* SPDX-License-Identifier: 0BSD */
/* Steps in time of rmin_'s modes. */
#include "rmin_impact.h"

/*
 * Most radians of the contact's own vibration, and of any mode's, in the longest step; and of the former while they
 * touch: a force that turns looks straight over more.
 */
#define CONTACT_STEP RMIN_R(1.0)
#define PRESSED_STEP RMIN_R(0.5)
#define MODE_STEP RMIN_R(5.6)
/* Most damping of joints and of a servo in the longest step, as a share of what it acts on. */
#define SERVO_STEP RMIN_R(0.1)
/*
 * A mode stands if its motion about where the force bends it is less than this share of the
 * displacement, in a contact as fast as `contact`, or as the time there is.
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
/*
 * Least that a mode moves the contact point by, 1/sqrt(kg): modes are followed by that, and what they do themselves is
 * told from it. It must not be felt: rotors of 1e30 kg m^2 turn with amplitudes of 1e15 m sqrt(kg).
 */
#define LEAST_ROW RMIN_R(1e-25)
/* Steps counted; more than any budget has. */
#define MOST RMIN_R(1e6)

static void exchange(rmin_modes *modes, int i, int j)
{
    const rmin_real squared = modes->squared[i];
    const rmin_real noise = modes->noise[i];
    const rmin_real row = modes->row[i];
    const rmin_real start = modes->start[i];
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
    const bool pushes_on = phase->drift > RMIN_R(0.0) && !impact->gives_way;
    phase->settles = !phase->damped && !pushes_on;
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
static void mode_steps(rmin_phase *phase)
{
    const rmin_modes *const modes = &phase->modes;
    const rmin_real one = RMIN_R(1.0);
    const rmin_real h = phase->level[RMIN_LEVELS - 1].h;
    for (int i = 0; i < phase->active; ++i) {
        const rmin_real squared = modes->squared[i];
        const rmin_real weight = modes->row[i]*modes->row[i];
        const rmin_real t = squared*h*h;
        rmin_real late = h*h*(one/RMIN_R(6.0)
            - t*(one/RMIN_R(120.0) - t*(one/RMIN_R(5040.0) - t/RMIN_R(362880.0)))); /* (wh - sin(wh))/(w^3 h) */
        rmin_real push = h*h*(RMIN_R(0.5)
            - t*(one/RMIN_R(24.0) - t*(one/RMIN_R(720.0) - t/RMIN_R(40320.0)))); /* (1 - cos(wh))/w^2 */
        rmin_real sine = h*(one - squared*late); /* sin(wh)/w */
        for (int k = RMIN_LEVELS - 1; k >= 0; --k) {
            rmin_level *const level = &phase->level[k];
            rmin_mode_step *const step = &level->mode[i];
            const rmin_real cosine = one - squared*push;
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
            push = RMIN_R(2.0)*sine*sine;
            sine *= RMIN_R(2.0)*cosine;
        }
    }
    for (int k = 0; k < RMIN_LEVELS; ++k) {
        rmin_level *const level = &phase->level[k];
        level->grow = level->push*level->per;
    }
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
        modes->from[body] = body;
        for (int k = 0; k < RMIN_SYSTEM; ++k) {
            modes->shape[body][k] = RMIN_R(0.0);
        }
        modes->count = body + 1;
    }
    phase->has_body = impact->gives_way;
    for (int i = 0; i < modes->count; ++i) {
        modes->row[i] = RMIN_FABS(modes->row[i]) > LEAST_ROW ? modes->row[i] : LEAST_ROW;
    }
    const rmin_real end = RMIN_R(1.0)/RMIN_HORIZON(impact->p);
    let_stand(impact, RMIN_FMAX(contact, end*end), released, phase);
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
    const rmin_real rate = RMIN_FMAX(slowest, RMIN_FMAX(RMIN_SQRT(rate2), rmin_damping_rate(phase)/SERVO_STEP));
    const rmin_real wanted = time*rate;
    phase->steps = wanted < MOST ? (int)wanted + 1 : (int)MOST;
    const rmin_real h = wanted < MOST ? time/(rmin_real)phase->steps : RMIN_R(1.0)/rate;
    phase->longest_pressed = share*contact*h*h > PRESSED_STEP*PRESSED_STEP ? 1 : 0;
    rmin_real shortest = h;
    rmin_real per = RMIN_R(1.0)/h;
    for (int k = 0; k < RMIN_LEVELS; ++k) {
        rmin_level *const level = &phase->level[k];
        level->h = shortest;
        level->per = per;
        level->push = RMIN_R(0.0);
        level->late = RMIN_R(0.0);
        level->kick = RMIN_R(0.0);
        shortest *= RMIN_R(0.5);
        per += per;
    }
    shortest = region->stiffness*phase->level[RMIN_LEVELS - 1].h;
    rmin_real relax = region->damping > RMIN_R(0.0)
        ? RMIN_EXP(-RMIN_FMIN(shortest/region->damping, RMIN_R(80.0))) : RMIN_R(0.0);
    for (int k = RMIN_LEVELS - 1; k >= 0; --k) {
        phase->level[k].relax = relax;
        relax *= relax;
    }
    mode_steps(phase);
    if (phase->damped) {
        rmin_slowing(phase);
    }
    phase->ready = true;
}
