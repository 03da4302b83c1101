/* SPDX-License-Identifier: 0BSD */
/* Steps in time of rr_'s modes. */
#include "rr_impact.h"

/*
 * Most radians of the contact's own vibration, and of any mode's, in the longest step; and of the former while they
 * touch: a force that turns looks straight over more.
 */
#define CONTACT_STEP RR_R(1.0)
#define PRESSED_STEP RR_R(0.5)
#define MODE_STEP RR_R(5.6)
/* Most damping of joints and of a servo in the longest step, as a share of what it acts on. */
#define SERVO_STEP RR_R(0.1)
/*
 * A mode stands if its motion about where the force bends it is less than this share of the
 * displacement, in a contact as fast as `contact`, or as the time there is.
 */
#define STANDS RR_R(1e-5)
/*
 * Nor may the damper's jump at first touch, c v of a force of about v sqrt(k m), be felt in its motion
 * through the damper, by more than this share of the force.
 */
#define FELT RR_R(2e-4)
/* Nor may it swing as motors are released so that spring and damper feel more than this share of it. */
#define LEFT RR_R(5e-5)
/*
 * Where the damper's jump at first touch is more than this share of the force, squared, the longest
 * step is at most so many times as long as the skin takes for it, c over its stiffness.
 */
#define JUMPS RR_R(0.1)
#define JUMP_STEP RR_R(24.0)
/*
 * Least that a mode moves the contact point by, 1/sqrt(kg): modes are followed by that, and what they do themselves is
 * told from it. It must not be felt: rotors of 1e30 kg m^2 turn with amplitudes of 1e15 m sqrt(kg).
 */
#define LEAST_ROW RR_R(1e-25)
/* Steps counted; more than any budget has. */
#define MOST RR_R(1e6)

static void exchange(rr_modes *modes, int i, int j)
{
    const rr_real squared = modes->squared[i];
    const rr_real noise = modes->noise[i];
    const rr_real row = modes->row[i];
    const rr_real start = modes->start[i];
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
static void let_stand(const rr_impact *impact, rr_real contact, bool released, rr_phase *phase)
{
    rr_modes *const modes = &phase->modes;
    const rr_region *const region = impact->region;
    const rr_real heavy = contact*contact/(STANDS*impact->mobility);
    const rr_real twice = region->damping*region->damping/FELT;
    const rr_real jump = twice*twice*impact->mobility/region->stiffness;
    rr_real swing = RR_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        const rr_real along = modes->row[i]*modes->start[i];
        swing = RR_FMAX(swing, along*along/RR_FMAX(modes->squared[i], contact));
    }
    swing *= STANDS*STANDS;
    int active = 0;
    phase->compliance = RR_R(0.0);
    phase->reach = RR_R(0.0);
    const bool pushes_on = phase->drift > RR_R(0.0) && !impact->gives_way;
    phase->settles = !phase->damped && !pushes_on;
    for (int i = 0; i < modes->count; ++i) {
        const bool body = impact->gives_way && i == modes->count - 1;
        const rr_real weight = modes->row[i]*modes->row[i];
        const rr_real along = modes->row[i]*modes->start[i];
        const rr_real held = region->stiffness
            + region->damping*RR_SQRT(RR_FMAX(modes->squared[i], RR_R(0.0)));
        const bool stands = !phase->damped && weight*heavy < modes->squared[i]*modes->squared[i]
            && weight*weight*jump < modes->squared[i]
            && (!released || weight*held < LEFT*modes->squared[i])
            && along*along <= swing*modes->squared[i];
        if (i >= modes->rigid && !body) {
            phase->settles = phase->settles && modes->squared[i] > RR_R(0.0);
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
static void mode_steps(rr_phase *phase)
{
    const rr_modes *const modes = &phase->modes;
    const rr_real one = RR_R(1.0);
    const rr_real h = phase->level[RR_LEVELS - 1].h;
    for (int i = 0; i < phase->active; ++i) {
        const rr_real squared = modes->squared[i];
        const rr_real weight = modes->row[i]*modes->row[i];
        const rr_real t = squared*h*h;
        rr_real late = h*h*(one/RR_R(6.0)
            - t*(one/RR_R(120.0) - t*(one/RR_R(5040.0) - t/RR_R(362880.0)))); /* (wh - sin(wh))/(w^3 h) */
        rr_real push = h*h*(RR_R(0.5)
            - t*(one/RR_R(24.0) - t*(one/RR_R(720.0) - t/RR_R(40320.0)))); /* (1 - cos(wh))/w^2 */
        rr_real sine = h*(one - squared*late); /* sin(wh)/w */
        for (int k = RR_LEVELS - 1; k >= 0; --k) {
            rr_level *const level = &phase->level[k];
            rr_mode_step *const step = &level->mode[i];
            const rr_real cosine = one - squared*push;
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
            push = RR_R(2.0)*sine*sine;
            sine *= RR_R(2.0)*cosine;
        }
    }
    for (int k = 0; k < RR_LEVELS; ++k) {
        rr_level *const level = &phase->level[k];
        level->grow = level->push*level->per;
    }
}

void rr_phase_steps(const rr_impact *impact, rr_real time, rr_phase *phase)
{
    const rr_region *const region = impact->region;
    rr_modes *const modes = &phase->modes;
    const rr_real spring = region->stiffness*impact->mobility;
    const rr_real damper = RR_R(0.5)*region->damping*impact->mobility;
    const rr_real contact = RR_FMIN(spring + damper*damper, impact->skin_rate);
    const bool released = phase == &impact->phase[RR_LOOSE] && impact->first == RR_LED;
    if (impact->gives_way) {
        const int body = modes->count < RR_MODES ? modes->count : RR_MODES - 1; /* the former */
        modes->squared[body] = RR_R(0.0);
        modes->noise[body] = RR_R(0.0);
        modes->row[body] = RR_R(1.0)/RR_SQRT(region->effective_mass);
        modes->start[body] = RR_R(0.0);
        modes->from[body] = body;
        for (int k = 0; k < RR_SYSTEM; ++k) {
            modes->shape[body][k] = RR_R(0.0);
        }
        modes->count = body + 1;
    }
    phase->has_body = impact->gives_way;
    for (int i = 0; i < modes->count; ++i) {
        modes->row[i] = RR_FABS(modes->row[i]) > LEAST_ROW ? modes->row[i] : LEAST_ROW;
    }
    const rr_real end = RR_R(1.0)/RR_HORIZON(impact->p);
    let_stand(impact, RR_FMAX(contact, end*end), released, phase);
    rr_real moving = RR_R(0.0);
    rr_real rate2 = RR_R(0.0);
    for (int i = 0; i < phase->active; ++i) {
        moving += modes->row[i]*modes->row[i];
        rate2 = RR_FMAX(rate2, RR_FABS(modes->squared[i])/(MODE_STEP*MODE_STEP));
    }
    const rr_real share = RR_FMIN(moving/impact->mobility, RR_R(1.0));
    rate2 = RR_FMAX(rate2, share*contact/(CONTACT_STEP*CONTACT_STEP));
    const rr_real jump = region->damping*impact->mobility;
    const rr_real rise = jump*region->damping > JUMPS*region->stiffness
        ? impact->skin_rate/(JUMP_STEP*jump) : RR_R(0.0);
    const rr_real slowest = RR_FMAX(RR_R(1.0)/time, rise);
    const rr_real rate = RR_FMAX(slowest, RR_FMAX(RR_SQRT(rate2), rr_damping_rate(phase)/SERVO_STEP));
    const rr_real wanted = time*rate;
    phase->steps = wanted < MOST ? (int)wanted + 1 : (int)MOST;
    const rr_real h = wanted < MOST ? time/(rr_real)phase->steps : RR_R(1.0)/rate;
    phase->longest_pressed = share*contact*h*h > PRESSED_STEP*PRESSED_STEP ? 1 : 0;
    rr_real shortest = h;
    rr_real per = RR_R(1.0)/h;
    for (int k = 0; k < RR_LEVELS; ++k) {
        rr_level *const level = &phase->level[k];
        level->h = shortest;
        level->per = per;
        level->push = RR_R(0.0);
        level->late = RR_R(0.0);
        level->kick = RR_R(0.0);
        shortest *= RR_R(0.5);
        per += per;
    }
    shortest = region->stiffness*phase->level[RR_LEVELS - 1].h;
    rr_real relax = region->damping > RR_R(0.0)
        ? RR_EXP(-RR_FMIN(shortest/region->damping, RR_R(80.0))) : RR_R(0.0);
    for (int k = RR_LEVELS - 1; k >= 0; --k) {
        phase->level[k].relax = relax;
        relax *= relax;
    }
    mode_steps(phase);
    if (phase->damped) {
        rr_slowing(phase);
    }
    phase->ready = true;
}
