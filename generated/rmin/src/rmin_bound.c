/* SPDX-License-Identifier: 0BSD */
/*
 * A force that no impact of rmin_ exceeds, for when the steps there are do not do.
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
#include "rmin_impact.h"

/* y^2 for y^2 = y sqrt(2 t K) + c. */
static rmin_real while_driven(rmin_real time, rmin_real hold, rmin_real damping)
{
    const rmin_real pull = RMIN_SQRT(RMIN_R(2.0)*time*hold);
    const rmin_real y = RMIN_R(0.5)*(pull + RMIN_SQRT(pull*pull + RMIN_R(4.0)*damping));
    return y*y;
}

rmin_real rmin_twice_energy(const rmin_impact *impact)
{
#if RMIN_STRUCTURED
    const rmin_real together = rmin_together(&impact->arrival, impact->p);
    if (together > RMIN_R(0.0)) {
        const rmin_real body =
            impact->gives_way ? RMIN_R(1.0)/impact->region->effective_mass : RMIN_R(0.0);
        return RMIN_R(1.0)/(together + body);
    }
#endif
    return rmin_twice_energy_of_arrival(&impact->arrival, impact->p);
}

rmin_real rmin_twice_energy_of_arrival(const rmin_arrival *arrival, const rmin_params *p)
{
    rmin_real sum = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j < RMIN_N; ++j) {
            sum += arrival->rates[i]*arrival->links.M[i][j]*arrival->rates[j];
        }
#if RMIN_ELASTIC
        sum += RMIN_ROTOR(p, i)*arrival->rates[i]*arrival->rates[i];
#endif
    }
    (void)p;
    return sum;
}

/* Whether no motion lowers the energy of springs and gravity, and the motion before raises none. */
static bool is_held_by_nothing(const rmin_impact *impact)
{
#if RMIN_POTENTIAL
    for (int i = 0; i < RMIN_N; ++i) {
        rmin_real pull = RMIN_R(0.0);
        rmin_real size = RMIN_R(0.0);
        for (int j = 0; j < RMIN_N; ++j) {
            pull += impact->arrival.links.K[i][j]*impact->arrival.rates[j];
            size += RMIN_FABS(impact->arrival.links.K[i][j]);
        }
        if (RMIN_FABS(pull) > RMIN_R(16.0)*RMIN_EPSILON*size) {
            return false;
        }
    }
    const rmin_modes *const modes = &impact->phase[impact->last].modes;
    rmin_real largest = RMIN_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        largest = RMIN_FMAX(largest, modes->squared[i]);
    }
    for (int i = 0; i < modes->count; ++i) {
        if (modes->squared[i] < RMIN_R(-16.0)*RMIN_EPSILON*largest) {
            return false;
        }
    }
#else
    (void)impact;
#endif
    return true;
}

rmin_real rmin_bound(const rmin_impact *impact)
{
    return is_held_by_nothing(impact) ? rmin_bound_by(impact, impact->hold, rmin_twice_energy(impact)) : RMIN_R(0.0);
}

rmin_real rmin_bound_by(const rmin_impact *impact, rmin_real hold, rmin_real twice)
{
    const rmin_real horizon = RMIN_HORIZON(impact->p);
    const rmin_real always = while_driven(horizon, hold, impact->region->damping);
    if (RMIN_DAMPED) {
        return always;
    }
    if (impact->first == RMIN_LOOSE) {
        return RMIN_SQRT(twice*hold);
    }
    const rmin_real reaction = RMIN_FMIN(RMIN_REACTION_TIME(impact->p), horizon);
    const rmin_real until = while_driven(reaction, hold, impact->region->damping);
    const rmin_real root = RMIN_SQRT(RMIN_R(2.0)*until*reaction) + RMIN_SQRT(twice);
    return RMIN_FMIN(always, RMIN_FMAX(until, root*RMIN_SQRT(hold)));
}
