/* SPDX-License-Identifier: 0BSD */
/*
 * A force that no impact of rr_ exceeds, for when the steps there are do not do.
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
#include "rr_impact.h"

/* y^2 for y^2 = y sqrt(2 t K) + c. */
static rr_real while_driven(rr_real time, rr_real hold, rr_real damping)
{
    const rr_real pull = RR_SQRT(RR_R(2.0)*time*hold);
    const rr_real y = RR_R(0.5)*(pull + RR_SQRT(pull*pull + RR_R(4.0)*damping));
    return y*y;
}

rr_real rr_twice_energy(const rr_impact *impact)
{
#if RR_STRUCTURED
    const rr_real together = rr_together(&impact->arrival, impact->p);
    if (together > RR_R(0.0)) {
        const rr_real body =
            impact->gives_way ? RR_R(1.0)/impact->region->effective_mass : RR_R(0.0);
        return RR_R(1.0)/(together + body);
    }
#endif
    return rr_twice_energy_of_arrival(&impact->arrival, impact->p);
}

rr_real rr_twice_energy_of_arrival(const rr_arrival *arrival, const rr_params *p)
{
    rr_real sum = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j < RR_N; ++j) {
            sum += arrival->rates[i]*arrival->links.M[i][j]*arrival->rates[j];
        }
#if RR_ELASTIC
        sum += RR_ROTOR(p, i)*arrival->rates[i]*arrival->rates[i];
#endif
    }
    (void)p;
    return sum;
}

/* Whether no motion lowers the energy of springs and gravity, and the motion before raises none. */
static bool is_held_by_nothing(const rr_impact *impact)
{
#if RR_POTENTIAL
    for (int i = 0; i < RR_N; ++i) {
        rr_real pull = RR_R(0.0);
        rr_real size = RR_R(0.0);
        for (int j = 0; j < RR_N; ++j) {
            pull += impact->arrival.links.K[i][j]*impact->arrival.rates[j];
            size += RR_FABS(impact->arrival.links.K[i][j]);
        }
        if (RR_FABS(pull) > RR_R(16.0)*RR_EPSILON*size) {
            return false;
        }
    }
    const rr_modes *const modes = &impact->phase[impact->last].modes;
    rr_real largest = RR_R(0.0);
    for (int i = 0; i < modes->count; ++i) {
        largest = RR_FMAX(largest, modes->squared[i]);
    }
    for (int i = 0; i < modes->count; ++i) {
        if (modes->squared[i] < RR_R(-16.0)*RR_EPSILON*largest) {
            return false;
        }
    }
#else
    (void)impact;
#endif
    return true;
}

rr_real rr_bound(const rr_impact *impact)
{
    return is_held_by_nothing(impact) ? rr_bound_by(impact, impact->hold, rr_twice_energy(impact)) : RR_R(0.0);
}

rr_real rr_bound_by(const rr_impact *impact, rr_real hold, rr_real twice)
{
    const rr_real horizon = RR_HORIZON(impact->p);
    const rr_real always = while_driven(horizon, hold, impact->region->damping);
    if (RR_DAMPED) {
        return always;
    }
    if (impact->first == RR_LOOSE) {
        return RR_SQRT(twice*hold);
    }
    const rr_real reaction = RR_FMIN(RR_REACTION_TIME(impact->p), horizon);
    const rr_real until = while_driven(reaction, hold, impact->region->damping);
    const rr_real root = RR_SQRT(RR_R(2.0)*until*reaction) + RR_SQRT(twice);
    return RR_FMIN(always, RR_FMAX(until, root*RR_SQRT(hold)));
}
