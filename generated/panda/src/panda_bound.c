/* SPDX-License-Identifier: 0BSD */
/*
 * A force that no impact of panda_ exceeds, for when the steps there are do not do.
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
#include "panda_impact.h"

/* y^2 for y^2 = y sqrt(2 t K) + c. */
static panda_real while_driven(panda_real time, panda_real hold, panda_real damping)
{
    const panda_real pull = PANDA_SQRT(PANDA_R(2.0)*time*hold);
    const panda_real y = PANDA_R(0.5)*(pull + PANDA_SQRT(pull*pull + PANDA_R(4.0)*damping));
    return y*y;
}

panda_real panda_twice_energy(const panda_impact *impact)
{
#if PANDA_STRUCTURED
    const panda_real together = panda_together(&impact->arrival, impact->p);
    if (together > PANDA_R(0.0)) {
        const panda_real body =
            impact->gives_way ? PANDA_R(1.0)/impact->region->effective_mass : PANDA_R(0.0);
        return PANDA_R(1.0)/(together + body);
    }
#endif
    return panda_twice_energy_of_arrival(&impact->arrival, impact->p);
}

panda_real panda_twice_energy_of_arrival(const panda_arrival *arrival, const panda_params *p)
{
    panda_real sum = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j < PANDA_N; ++j) {
            sum += arrival->rates[i]*arrival->links.M[i][j]*arrival->rates[j];
        }
#if PANDA_ELASTIC
        sum += PANDA_ROTOR(p, i)*arrival->rates[i]*arrival->rates[i];
#endif
    }
    (void)p;
    return sum;
}

/* Whether no motion lowers the energy of springs and gravity, and the motion before raises none. */
static bool is_held_by_nothing(const panda_impact *impact)
{
#if PANDA_POTENTIAL
    for (int i = 0; i < PANDA_N; ++i) {
        panda_real pull = PANDA_R(0.0);
        panda_real size = PANDA_R(0.0);
        for (int j = 0; j < PANDA_N; ++j) {
            pull += impact->arrival.links.K[i][j]*impact->arrival.rates[j];
            size += PANDA_FABS(impact->arrival.links.K[i][j]);
        }
        if (PANDA_FABS(pull) > PANDA_R(16.0)*PANDA_EPSILON*size) {
            return false;
        }
    }
    const panda_modes *const modes = &impact->phase[impact->last].modes;
    panda_real largest = PANDA_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        largest = PANDA_FMAX(largest, modes->squared[i]);
    }
    for (int i = 0; i < modes->count; ++i) {
        if (modes->squared[i] < PANDA_R(-16.0)*PANDA_EPSILON*largest) {
            return false;
        }
    }
#else
    (void)impact;
#endif
    return true;
}

panda_real panda_bound(const panda_impact *impact)
{
    return is_held_by_nothing(impact) ? panda_bound_by(impact, impact->hold, panda_twice_energy(impact)) : PANDA_R(0.0);
}

panda_real panda_bound_by(const panda_impact *impact, panda_real hold, panda_real twice)
{
    const panda_real horizon = PANDA_HORIZON(impact->p);
    const panda_real always = while_driven(horizon, hold, impact->region->damping);
    if (PANDA_DAMPED) {
        return always;
    }
    if (impact->first == PANDA_LOOSE) {
        return PANDA_SQRT(twice*hold);
    }
    const panda_real reaction = PANDA_FMIN(PANDA_REACTION_TIME(impact->p), horizon);
    const panda_real until = while_driven(reaction, hold, impact->region->damping);
    const panda_real root = PANDA_SQRT(PANDA_R(2.0)*until*reaction) + PANDA_SQRT(twice);
    return PANDA_FMIN(always, PANDA_FMAX(until, root*PANDA_SQRT(hold)));
}
