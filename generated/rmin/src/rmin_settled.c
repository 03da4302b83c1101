/* SPDX-License-Identifier: 0BSD */
/*
 * When the rest of an impact of rmin_ cannot be harder than what was.
 *
 * The contact point is at x = r + w: r is the part of motors, or of links and rotors as one, against the
 * body's own mass; w the part of what vibrates, of energy E. The contact force only pushes r back, so once
 * r' < 0 it stays so, r does not grow, and with the energy V of skin, body and standing modes, E + V does
 * not either: (E + V)' = f r' - c s'^2 <= 0. At the largest force F of a later contact f = k s + c x' with
 * x' <= w', which takes F^2/(2 K) in w' and s (rmin_bound.c), its work in the skin (0.4 F depth in
 * Hertz's), and depth + s - r = w takes w^2/(2 reach) in the vibration. With less than that there is no such F.
 *
 * Driven motors that are let go later: seen from their motion before, E is of links and rotors, these
 * move at most sqrt(2 E rotors) on, and the rest holds if r' < 0 by more than that; not where gravity or springs
 * of the model file pull, nor where joints damp: motors held against these.
 */
#include "rmin_state.h"

/* Place and velocity of the contact point by a mode, after the force that is due. */
static rmin_real place_of(const rmin_state *s, int mode)
{
    return rmin_felt_place(&s->due.level->mode[mode], s->motion->place[mode], s->due.mean, s->due.rise);
}

static rmin_real rate_of(const rmin_state *s, int mode)
{
    const rmin_level *const level = s->due.level;
    return rmin_felt_rate(&level->mode[mode], s->motion->rate[mode], s->due.mean, s->due.rise*level->per);
}

bool rmin_is_settled(const rmin_state *s, rmin_real force, rmin_real depth, rmin_real share)
{
    const rmin_impact *const impact = s->impact;
    const rmin_phase *const phase = s->phase;
    const rmin_modes *const modes = &phase->modes;
    const rmin_region *const region = impact->region;
    const int body = phase->active - (impact->gives_way ? 1 : 0);
    rmin_real r = s->drifted;
    rmin_real away = phase->drift*s->speed;
    for (int i = 0; i < modes->rigid; ++i) {
        r += place_of(s, i);
        away += rate_of(s, i);
    }
    if (impact->gives_way && body >= 0) { /* it always is */
        r += place_of(s, body);
        away += rate_of(s, body);
    }
    if (!phase->settles || !(away < RMIN_R(0.0))) {
        return false;
    }
    const bool is_hertz = region->law == NULL;
    const rmin_real bent = s->touching ? s->x - s->u : s->rest;
    rmin_real twice = region->stiffness*bent*bent + phase->compliance*s->f*s->f
        + (is_hertz ? RMIN_R(0.8) : RMIN_R(2.0))*s->f*s->now; /* no law that rises takes more */
    for (int i = modes->rigid; i < body; ++i) {
        const rmin_real per = RMIN_R(1.0)/modes->row[i];
        const rmin_real amplitude = per*place_of(s, i);
        const rmin_real rate = per*rate_of(s, i);
        twice += rate*rate + modes->squared[i]*amplitude*amplitude;
    }
    if (phase == &impact->phase[RMIN_LED] && impact->last == RMIN_LOOSE
        && (!RMIN_STRUCTURED || !(away*away > twice*impact->rotors))) {
        return false;
    }
    const rmin_real slip = region->damping*RMIN_SQRT(twice*impact->mobility);
    const rmin_real pressed = RMIN_FMAX(force - slip, RMIN_R(0.0))/region->stiffness;
    const rmin_real gap = RMIN_FMAX(depth + pressed - r, RMIN_R(0.0));
    const rmin_real skin = is_hertz ? RMIN_R(0.8)*force*depth : rmin_law_twice_work(region, force);
    const rmin_real needed = force*force/impact->hold + skin;
    return twice*phase->reach <= share*(needed*phase->reach + gap*gap);
}
