/* SPDX-License-Identifier: 0BSD */
/*
 * A force that no impact of ur5e_ exceeds, for when the steps there are do not do.
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
#include "ur5e_impact.h"

/* y^2 for y^2 = y sqrt(2 t K) + c. */
static ur5e_real while_driven(ur5e_real time, ur5e_real hold, ur5e_real damping)
{
    const ur5e_real pull = UR5E_SQRT(UR5E_R(2.0)*time*hold);
    const ur5e_real y = UR5E_R(0.5)*(pull + UR5E_SQRT(pull*pull + UR5E_R(4.0)*damping));
    return y*y;
}

ur5e_real ur5e_twice_energy(const ur5e_impact *impact)
{
#if UR5E_STRUCTURED
    const ur5e_real together = ur5e_together(&impact->arrival, impact->p);
    if (together > UR5E_R(0.0)) {
        const ur5e_real body =
            impact->gives_way ? UR5E_R(1.0)/impact->region->effective_mass : UR5E_R(0.0);
        return UR5E_R(1.0)/(together + body);
    }
#endif
    return ur5e_twice_energy_of_arrival(&impact->arrival, impact->p);
}

ur5e_real ur5e_twice_energy_of_arrival(const ur5e_arrival *arrival, const ur5e_params *p)
{
    ur5e_real sum = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j < UR5E_N; ++j) {
            sum += arrival->rates[i]*arrival->links.M[i][j]*arrival->rates[j];
        }
#if UR5E_ELASTIC
        sum += UR5E_ROTOR(p, i)*arrival->rates[i]*arrival->rates[i];
#endif
    }
    (void)p;
    return sum;
}

/* Whether no motion lowers the energy of springs and gravity, and the motion before raises none. */
static bool is_held_by_nothing(const ur5e_impact *impact)
{
#if UR5E_POTENTIAL
    for (int i = 0; i < UR5E_N; ++i) {
        ur5e_real pull = UR5E_R(0.0);
        ur5e_real size = UR5E_R(0.0);
        for (int j = 0; j < UR5E_N; ++j) {
            pull += impact->arrival.links.K[i][j]*impact->arrival.rates[j];
            size += UR5E_FABS(impact->arrival.links.K[i][j]);
        }
        if (UR5E_FABS(pull) > UR5E_R(16.0)*UR5E_EPSILON*size) {
            return false;
        }
    }
    const ur5e_modes *const modes = &impact->phase[impact->last].modes;
    ur5e_real largest = UR5E_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        largest = UR5E_FMAX(largest, modes->squared[i]);
    }
    for (int i = 0; i < modes->count; ++i) {
        if (modes->squared[i] < UR5E_R(-16.0)*UR5E_EPSILON*largest) {
            return false;
        }
    }
#else
    (void)impact;
#endif
    return true;
}

ur5e_real ur5e_bound(const ur5e_impact *impact)
{
    return is_held_by_nothing(impact) ? ur5e_bound_by(impact, impact->hold, ur5e_twice_energy(impact)) : UR5E_R(0.0);
}

ur5e_real ur5e_bound_by(const ur5e_impact *impact, ur5e_real hold, ur5e_real twice)
{
    const ur5e_real horizon = UR5E_HORIZON(impact->p);
    const ur5e_real always = while_driven(horizon, hold, impact->region->damping);
    if (UR5E_DAMPED) {
        return always;
    }
    if (impact->first == UR5E_LOOSE) {
        return UR5E_SQRT(twice*hold);
    }
    const ur5e_real reaction = UR5E_FMIN(UR5E_REACTION_TIME(impact->p), horizon);
    const ur5e_real until = while_driven(reaction, hold, impact->region->damping);
    const ur5e_real root = UR5E_SQRT(UR5E_R(2.0)*until*reaction) + UR5E_SQRT(twice);
    return UR5E_FMIN(always, UR5E_FMAX(until, root*UR5E_SQRT(hold)));
}
