/* SPDX-License-Identifier: 0BSD */
/*
 * When the rest of an impact of rr_ cannot be harder than what was.
 *
 * The contact point is at x = r + w: r is the part of motors, or of links and rotors as one, against the
 * body's own mass; w the part of what vibrates, of energy E. The contact force only pushes r back, so once
 * r' < 0 it stays so, r does not grow, and with the energy V of skin, body and standing modes, E + V does
 * not either: (E + V)' = f r' - c s'^2 <= 0. At the largest force F of a later contact f = k s + c x' with
 * x' <= w', which takes F^2/(2 K) in w' and s (rr_bound.c), its work in the skin (0.4 F depth in
 * Hertz's), and depth + s - r = w takes w^2/(2 reach) in the vibration. With less than that there is no such F.
 *
 * Driven motors that are let go later: seen from their motion before, E is of links and rotors, these
 * move at most sqrt(2 E rotors) on, and the rest holds if r' < 0 by more than that; not where gravity or springs
 * of the model file pull, nor where joints damp: motors held against these.
 */
#include "rr_state.h"

/* Place and velocity of the contact point by a mode, after the force that is due. */
static rr_real place_of(const rr_state *s, int mode)
{
    return rr_felt_place(&s->due.level->mode[mode], s->motion->place[mode], s->due.mean, s->due.rise);
}

static rr_real rate_of(const rr_state *s, int mode)
{
    const rr_level *const level = s->due.level;
    return rr_felt_rate(&level->mode[mode], s->motion->rate[mode], s->due.mean, s->due.rise*level->per);
}

bool rr_is_settled(const rr_state *s, rr_real force, rr_real depth, rr_real share)
{
    const rr_impact *const impact = s->impact;
    const rr_phase *const phase = s->phase;
    const rr_modes *const modes = &phase->modes;
    const rr_region *const region = impact->region;
    const int body = phase->active - (impact->gives_way ? 1 : 0);
    rr_real r = s->drifted;
    rr_real away = phase->drift*s->speed;
    for (int i = 0; i < modes->rigid; ++i) {
        r += place_of(s, i);
        away += rate_of(s, i);
    }
    if (impact->gives_way && body >= 0) { /* it always is */
        r += place_of(s, body);
        away += rate_of(s, body);
    }
    if (!phase->settles || !(away < RR_R(0.0))) {
        return false;
    }
    const bool is_hertz = region->law == NULL;
    const rr_real bent = s->touching ? s->x - s->u : s->rest;
    rr_real twice = region->stiffness*bent*bent + phase->compliance*s->f*s->f
        + (is_hertz ? RR_R(0.8) : RR_R(2.0))*s->f*s->now; /* no law that rises takes more */
    for (int i = modes->rigid; i < body; ++i) {
        const rr_real per = RR_R(1.0)/modes->row[i];
        const rr_real amplitude = per*place_of(s, i);
        const rr_real rate = per*rate_of(s, i);
        twice += rate*rate + modes->squared[i]*amplitude*amplitude;
    }
    if (phase == &impact->phase[RR_LED] && impact->last == RR_LOOSE
        && (!RR_STRUCTURED || !(away*away > twice*impact->rotors))) {
        return false;
    }
    const rr_real slip = region->damping*RR_SQRT(twice*impact->mobility);
    const rr_real pressed = RR_FMAX(force - slip, RR_R(0.0))/region->stiffness;
    const rr_real gap = RR_FMAX(depth + pressed - r, RR_R(0.0));
    const rr_real skin = is_hertz ? RR_R(0.8)*force*depth : rr_law_twice_work(region, force);
    const rr_real needed = force*force/impact->hold + skin;
    return twice*phase->reach <= share*(needed*phase->reach + gap*gap);
}
