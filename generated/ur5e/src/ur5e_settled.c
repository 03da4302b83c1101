/* SPDX-License-Identifier: 0BSD */
/*
 * When the rest of an impact of ur5e_ cannot be harder than what was.
 *
 * The contact point is at x = r + w: r is the part of motors, or of links and rotors as one, against the
 * body's own mass; w the part of what vibrates, of energy E. The contact force only pushes r back, so once
 * r' < 0 it stays so, r does not grow, and with the energy V of skin, body and standing modes, E + V does
 * not either: (E + V)' = f r' - c s'^2 <= 0. At the largest force F of a later contact f = k s + c x' with
 * x' <= w', which takes F^2/(2 K) in w' and s (ur5e_bound.c), its work in the skin (0.4 F depth in
 * Hertz's), and depth + s - r = w takes w^2/(2 reach) in the vibration. With less than that there is no such F.
 *
 * Driven motors that are let go later: seen from their motion before, E is of links and rotors, these
 * move at most sqrt(2 E rotors) on, and the rest holds if r' < 0 by more than that; not where gravity or springs
 * of the model file pull, nor where joints damp: motors held against these.
 */
#include "ur5e_state.h"

/* Place and velocity of the contact point by a mode, after the force that is due. */
static ur5e_real place_of(const ur5e_state *s, int mode)
{
    return ur5e_felt_place(&s->due.level->mode[mode], s->motion->place[mode], s->due.mean, s->due.rise);
}

static ur5e_real rate_of(const ur5e_state *s, int mode)
{
    const ur5e_level *const level = s->due.level;
    return ur5e_felt_rate(&level->mode[mode], s->motion->rate[mode], s->due.mean, s->due.rise*level->per);
}

bool ur5e_is_settled(const ur5e_state *s, ur5e_real force, ur5e_real depth, ur5e_real share)
{
    const ur5e_impact *const impact = s->impact;
    const ur5e_phase *const phase = s->phase;
    const ur5e_modes *const modes = &phase->modes;
    const ur5e_region *const region = impact->region;
    const int body = phase->active - (impact->gives_way ? 1 : 0);
    ur5e_real r = s->drifted;
    ur5e_real away = phase->drift*s->speed;
    for (int i = 0; i < modes->rigid; ++i) {
        r += place_of(s, i);
        away += rate_of(s, i);
    }
    if (impact->gives_way && body >= 0) { /* it always is */
        r += place_of(s, body);
        away += rate_of(s, body);
    }
    if (!phase->settles || !(away < UR5E_R(0.0))) {
        return false;
    }
    const bool is_hertz = region->law == NULL;
    const ur5e_real bent = s->touching ? s->x - s->u : s->rest;
    ur5e_real twice = region->stiffness*bent*bent + phase->compliance*s->f*s->f
        + (is_hertz ? UR5E_R(0.8) : UR5E_R(2.0))*s->f*s->now; /* no law that rises takes more */
    for (int i = modes->rigid; i < body; ++i) {
        const ur5e_real per = UR5E_R(1.0)/modes->row[i];
        const ur5e_real amplitude = per*place_of(s, i);
        const ur5e_real rate = per*rate_of(s, i);
        twice += rate*rate + modes->squared[i]*amplitude*amplitude;
    }
    if (phase == &impact->phase[UR5E_LED] && impact->last == UR5E_LOOSE
        && (!UR5E_STRUCTURED || !(away*away > twice*impact->rotors))) {
        return false;
    }
    const ur5e_real slip = region->damping*UR5E_SQRT(twice*impact->mobility);
    const ur5e_real pressed = UR5E_FMAX(force - slip, UR5E_R(0.0))/region->stiffness;
    const ur5e_real gap = UR5E_FMAX(depth + pressed - r, UR5E_R(0.0));
    const ur5e_real skin = is_hertz ? UR5E_R(0.8)*force*depth : ur5e_law_twice_work(region, force);
    const ur5e_real needed = force*force/impact->hold + skin;
    return twice*phase->reach <= share*(needed*phase->reach + gap*gap);
}
