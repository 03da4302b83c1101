/* SPDX-License-Identifier: 0BSD */
/* Steps in time of robot_'s modes. */
#include "robot_impact.h"

/*
 * Most radians of the contact's own vibration, and of any mode's, in the longest step; and of the former while they
 * touch: a force that turns looks straight over more.
 */
#define CONTACT_STEP ROBOT_R(1.0)
#define PRESSED_STEP ROBOT_R(0.5)
#define MODE_STEP ROBOT_R(5.6)
/* Most damping of joints and of a servo in the longest step, as a share of what it acts on. */
#define SERVO_STEP ROBOT_R(0.1)
/*
 * A mode stands if its motion about where the force bends it is less than this share of the
 * displacement, in a contact as fast as `contact`, or as the time there is.
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
/*
 * Least that a mode moves the contact point by, 1/sqrt(kg): modes are followed by that, and what they do themselves is
 * told from it. It must not be felt: rotors of 1e30 kg m^2 turn with amplitudes of 1e15 m sqrt(kg).
 */
#define LEAST_ROW ROBOT_R(1e-25)
/* Steps counted; more than any budget has. */
#define MOST ROBOT_R(1e6)

static void exchange(robot_modes *modes, int i, int j)
{
    const robot_real squared = modes->squared[i];
    const robot_real noise = modes->noise[i];
    const robot_real row = modes->row[i];
    const robot_real start = modes->start[i];
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
    const bool pushes_on = phase->drift > ROBOT_R(0.0) && !impact->gives_way;
    phase->settles = !phase->damped && !pushes_on;
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
static void mode_steps(robot_phase *phase)
{
    const robot_modes *const modes = &phase->modes;
    const robot_real one = ROBOT_R(1.0);
    const robot_real h = phase->level[ROBOT_LEVELS - 1].h;
    for (int i = 0; i < phase->active; ++i) {
        const robot_real squared = modes->squared[i];
        const robot_real weight = modes->row[i]*modes->row[i];
        const robot_real t = squared*h*h;
        robot_real late = h*h*(one/ROBOT_R(6.0)
            - t*(one/ROBOT_R(120.0) - t*(one/ROBOT_R(5040.0) - t/ROBOT_R(362880.0)))); /* (wh - sin(wh))/(w^3 h) */
        robot_real push = h*h*(ROBOT_R(0.5)
            - t*(one/ROBOT_R(24.0) - t*(one/ROBOT_R(720.0) - t/ROBOT_R(40320.0)))); /* (1 - cos(wh))/w^2 */
        robot_real sine = h*(one - squared*late); /* sin(wh)/w */
        for (int k = ROBOT_LEVELS - 1; k >= 0; --k) {
            robot_level *const level = &phase->level[k];
            robot_mode_step *const step = &level->mode[i];
            const robot_real cosine = one - squared*push;
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
            push = ROBOT_R(2.0)*sine*sine;
            sine *= ROBOT_R(2.0)*cosine;
        }
    }
    for (int k = 0; k < ROBOT_LEVELS; ++k) {
        robot_level *const level = &phase->level[k];
        level->grow = level->push*level->per;
    }
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
        modes->from[body] = body;
        for (int k = 0; k < ROBOT_SYSTEM; ++k) {
            modes->shape[body][k] = ROBOT_R(0.0);
        }
        modes->count = body + 1;
    }
    phase->has_body = impact->gives_way;
    for (int i = 0; i < modes->count; ++i) {
        modes->row[i] = ROBOT_FABS(modes->row[i]) > LEAST_ROW ? modes->row[i] : LEAST_ROW;
    }
    const robot_real end = ROBOT_R(1.0)/ROBOT_HORIZON(impact->p);
    let_stand(impact, ROBOT_FMAX(contact, end*end), released, phase);
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
    const robot_real rate = ROBOT_FMAX(slowest, ROBOT_FMAX(ROBOT_SQRT(rate2), robot_damping_rate(phase)/SERVO_STEP));
    const robot_real wanted = time*rate;
    phase->steps = wanted < MOST ? (int)wanted + 1 : (int)MOST;
    const robot_real h = wanted < MOST ? time/(robot_real)phase->steps : ROBOT_R(1.0)/rate;
    phase->longest_pressed = share*contact*h*h > PRESSED_STEP*PRESSED_STEP ? 1 : 0;
    robot_real shortest = h;
    robot_real per = ROBOT_R(1.0)/h;
    for (int k = 0; k < ROBOT_LEVELS; ++k) {
        robot_level *const level = &phase->level[k];
        level->h = shortest;
        level->per = per;
        level->push = ROBOT_R(0.0);
        level->late = ROBOT_R(0.0);
        level->kick = ROBOT_R(0.0);
        shortest *= ROBOT_R(0.5);
        per += per;
    }
    shortest = region->stiffness*phase->level[ROBOT_LEVELS - 1].h;
    robot_real relax = region->damping > ROBOT_R(0.0)
        ? ROBOT_EXP(-ROBOT_FMIN(shortest/region->damping, ROBOT_R(80.0))) : ROBOT_R(0.0);
    for (int k = ROBOT_LEVELS - 1; k >= 0; --k) {
        phase->level[k].relax = relax;
        relax *= relax;
    }
    mode_steps(phase);
    if (phase->damped) {
        robot_slowing(phase);
    }
    phase->ready = true;
}
