/* SPDX-License-Identifier: 0BSD */
/*
 * When the rest of an impact of panda_ cannot be harder than what was.
 *
 * The contact point is at x = r + w: r is the part of motors, or of links and rotors as one, against the
 * body's own mass; w the part of what vibrates, of energy E. The contact force only pushes r back, so once
 * r' < 0 it stays so, r does not grow, and with the energy V of skin, body and standing modes, E + V does
 * not either: (E + V)' = f r' - c s'^2 <= 0. At the largest force F of a later contact f = k s + c x' with
 * x' <= w', which takes F^2/(2 K) in w' and s (panda_bound.c), its work in the skin (0.4 F depth in
 * Hertz's), and depth + s - r = w takes w^2/(2 reach) in the vibration. With less than that there is no such F.
 *
 * Driven motors that are let go later: seen from their motion before, E is of links and rotors, these
 * move at most sqrt(2 E rotors) on, and the rest holds if r' < 0 by more than that; not where gravity or springs
 * of the model file pull, nor where joints damp: motors held against these.
 */
#include "panda_state.h"

/* Place and velocity of the contact point by a mode, after the force that is due. */
static panda_real place_of(const panda_state *s, int mode)
{
    return panda_felt_place(&s->due.level->mode[mode], s->motion->place[mode], s->due.mean, s->due.rise);
}

static panda_real rate_of(const panda_state *s, int mode)
{
    const panda_level *const level = s->due.level;
    return panda_felt_rate(&level->mode[mode], s->motion->rate[mode], s->due.mean, s->due.rise*level->per);
}

bool panda_is_settled(const panda_state *s, panda_real force, panda_real depth, panda_real share)
{
    const panda_impact *const impact = s->impact;
    const panda_phase *const phase = s->phase;
    const panda_modes *const modes = &phase->modes;
    const panda_region *const region = impact->region;
    const int body = phase->active - (impact->gives_way ? 1 : 0);
    panda_real r = s->drifted;
    panda_real away = phase->drift*s->speed;
    for (int i = 0; i < modes->rigid; ++i) {
        r += place_of(s, i);
        away += rate_of(s, i);
    }
    if (impact->gives_way && body >= 0) { /* it always is */
        r += place_of(s, body);
        away += rate_of(s, body);
    }
    if (!phase->settles || !(away < PANDA_R(0.0))) {
        return false;
    }
    const bool is_hertz = region->law == NULL;
    const panda_real bent = s->touching ? s->x - s->u : s->rest;
    panda_real twice = region->stiffness*bent*bent + phase->compliance*s->f*s->f
        + (is_hertz ? PANDA_R(0.8) : PANDA_R(2.0))*s->f*s->now; /* no law that rises takes more */
    for (int i = modes->rigid; i < body; ++i) {
        const panda_real per = PANDA_R(1.0)/modes->row[i];
        const panda_real amplitude = per*place_of(s, i);
        const panda_real rate = per*rate_of(s, i);
        twice += rate*rate + modes->squared[i]*amplitude*amplitude;
    }
    if (phase == &impact->phase[PANDA_LED] && impact->last == PANDA_LOOSE
        && (!PANDA_STRUCTURED || !(away*away > twice*impact->rotors))) {
        return false;
    }
    const panda_real slip = region->damping*PANDA_SQRT(twice*impact->mobility);
    const panda_real pressed = PANDA_FMAX(force - slip, PANDA_R(0.0))/region->stiffness;
    const panda_real gap = PANDA_FMAX(depth + pressed - r, PANDA_R(0.0));
    const panda_real skin = is_hertz ? PANDA_R(0.8)*force*depth : panda_law_twice_work(region, force);
    const panda_real needed = force*force/impact->hold + skin;
    return twice*phase->reach <= share*(needed*phase->reach + gap*gap);
}
