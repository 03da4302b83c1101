/* SPDX-License-Identifier: 0BSD */
/*
 * A force that no impact of robot_ exceeds, for when the steps there are do not do.
 *
 * At the largest force the skin is not getting deeper, so that f = k s + c s' <= k s + c u with u the
 * speed at which contact point and body approach. Kinetic energy is at least u^2/(2 mobility), so that with an
 * energy E in robot and body, f^2 <= 2 E (k + c^2 mobility).
 *
 * Motors free: E is what the robot arrives with, v^2/2 r'(M + B)r for joint velocities r v; where nothing
 * but joints' springs pulls only the motion of links, rotors and body that is the contact point's has
 * to do with it: E = v^2/2 over the mobility of that.
 *
 * Motors that drive or servo: in axes that go on with the motion before, the only one who does work is
 * the body, whose end comes at speed v: E <= v F t after a time t, and f <= k s + c u + c v. So F =
 * y^2 v with y^2 <= y sqrt(2 t K) + c, K = k + c^2 mobility. Released after t, the robot has at most
 * (sqrt(E) + sqrt(v^2/2 r'(M + B)r))^2, as the energies of both motions add like squares of lengths.
 * Joints with damping of their own: motors are taken to go on with what that needed before, so the same holds
 * whatever motors do, to the horizon.
 */
#include "robot_impact.h"

/* y^2 for y^2 = y sqrt(2 t K) + c. */
static robot_real while_driven(robot_real time, robot_real hold, robot_real damping)
{
    const robot_real pull = ROBOT_SQRT(ROBOT_R(2.0)*time*hold);
    const robot_real y = ROBOT_R(0.5)*(pull + ROBOT_SQRT(pull*pull + ROBOT_R(4.0)*damping));
    return y*y;
}

robot_real robot_twice_energy(const robot_impact *impact)
{
#if ROBOT_STRUCTURED
    const robot_real together = robot_together(&impact->arrival, impact->p);
    if (together > ROBOT_R(0.0)) {
        const robot_real body =
            impact->gives_way ? ROBOT_R(1.0)/impact->region->effective_mass : ROBOT_R(0.0);
        return ROBOT_R(1.0)/(together + body);
    }
#endif
    return robot_twice_energy_of_arrival(&impact->arrival, impact->p);
}

robot_real robot_twice_energy_of_arrival(const robot_arrival *arrival, const robot_params *p)
{
    robot_real sum = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j < ROBOT_N; ++j) {
            sum += arrival->rates[i]*arrival->links.M[i][j]*arrival->rates[j];
        }
#if ROBOT_ELASTIC
        sum += ROBOT_ROTOR(p, i)*arrival->rates[i]*arrival->rates[i];
#endif
    }
    (void)p;
    return sum;
}

/* Whether no motion lowers the energy of springs and gravity, and the motion before raises none. */
static bool is_held_by_nothing(const robot_impact *impact)
{
#if ROBOT_POTENTIAL
    for (int i = 0; i < ROBOT_N; ++i) {
        robot_real pull = ROBOT_R(0.0);
        robot_real size = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_N; ++j) {
            pull += impact->arrival.links.K[i][j]*impact->arrival.rates[j];
            size += ROBOT_FABS(impact->arrival.links.K[i][j]);
        }
        if (ROBOT_FABS(pull) > ROBOT_R(16.0)*ROBOT_EPSILON*size) {
            return false;
        }
    }
    const robot_modes *const modes = &impact->phase[impact->last].modes;
    robot_real largest = ROBOT_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        largest = ROBOT_FMAX(largest, modes->squared[i]);
    }
    for (int i = 0; i < modes->count; ++i) {
        if (modes->squared[i] < ROBOT_R(-16.0)*ROBOT_EPSILON*largest) {
            return false;
        }
    }
#else
    (void)impact;
#endif
    return true;
}

robot_real robot_bound(const robot_impact *impact)
{
    return is_held_by_nothing(impact) ? robot_bound_by(impact, impact->hold, robot_twice_energy(impact)) : ROBOT_R(0.0);
}

robot_real robot_bound_by(const robot_impact *impact, robot_real hold, robot_real twice)
{
    const robot_real horizon = ROBOT_HORIZON(impact->p);
    const robot_real always = while_driven(horizon, hold, impact->region->damping);
    if (ROBOT_DAMPED) {
        return always;
    }
    if (impact->first == ROBOT_LOOSE) {
        return ROBOT_SQRT(twice*hold);
    }
    const robot_real reaction = ROBOT_FMIN(ROBOT_REACTION_TIME(impact->p), horizon);
    const robot_real until = while_driven(reaction, hold, impact->region->damping);
    const robot_real root = ROBOT_SQRT(ROBOT_R(2.0)*until*reaction) + ROBOT_SQRT(twice);
    return ROBOT_FMIN(always, ROBOT_FMAX(until, root*ROBOT_SQRT(hold)));
}
