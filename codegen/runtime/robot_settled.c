/* SPDX-License-Identifier: 0BSD */
/*
 * When the rest of an impact of robot_ cannot be harder than what was.
 *
 * The contact point is at x = r + w: r is the part of motors, or of links and rotors as one, against the
 * body's own mass; w the part of what vibrates, of energy E. The contact force only pushes r back, so once
 * r' < 0 it stays so, r does not grow, and with the energy V of skin, body and standing modes, E + V does
 * not either: (E + V)' = f r' - c s'^2 <= 0. At the largest force F of a later contact f = k s + c x' with
 * x' <= w', which takes F^2/(2 K) in w' and s (robot_bound.c), its work in the skin (0.4 F depth in
 * Hertz's), and depth + s - r = w takes w^2/(2 reach) in the vibration. With less than that there is no such F.
 *
 * Driven motors that are let go later: seen from their motion before, E is of links and rotors, these
 * move at most sqrt(2 E rotors) on, and the rest holds if r' < 0 by more than that; not where gravity or springs
 * of the model file pull, nor where joints damp: motors held against these.
 */
#include "robot_state.h"

/* Place and velocity of the contact point by a mode, after the force that is due. */
static robot_real place_of(const robot_state *s, int mode)
{
    return robot_felt_place(&s->due.level->mode[mode], s->motion->place[mode], s->due.mean, s->due.rise);
}

static robot_real rate_of(const robot_state *s, int mode)
{
    const robot_level *const level = s->due.level;
    return robot_felt_rate(&level->mode[mode], s->motion->rate[mode], s->due.mean, s->due.rise*level->per);
}

bool robot_is_settled(const robot_state *s, robot_real force, robot_real depth, robot_real share)
{
    const robot_impact *const impact = s->impact;
    const robot_phase *const phase = s->phase;
    const robot_modes *const modes = &phase->modes;
    const robot_region *const region = impact->region;
    const int body = phase->active - (impact->gives_way ? 1 : 0);
    robot_real r = s->drifted;
    robot_real away = phase->drift*s->speed;
    for (int i = 0; i < modes->rigid; ++i) {
        r += place_of(s, i);
        away += rate_of(s, i);
    }
    if (impact->gives_way && body >= 0) { /* it always is */
        r += place_of(s, body);
        away += rate_of(s, body);
    }
    if (!phase->settles || !(away < ROBOT_R(0.0))) {
        return false;
    }
    const bool is_hertz = region->law == NULL;
    const robot_real bent = s->touching ? s->x - s->u : s->rest;
    robot_real twice = region->stiffness*bent*bent + phase->compliance*s->f*s->f
        + (is_hertz ? ROBOT_R(0.8) : ROBOT_R(2.0))*s->f*s->now; /* no law that rises takes more */
    for (int i = modes->rigid; i < body; ++i) {
        const robot_real per = ROBOT_R(1.0)/modes->row[i];
        const robot_real amplitude = per*place_of(s, i);
        const robot_real rate = per*rate_of(s, i);
        twice += rate*rate + modes->squared[i]*amplitude*amplitude;
    }
    if (phase == &impact->phase[ROBOT_LED] && impact->last == ROBOT_LOOSE
        && (!ROBOT_STRUCTURED || !(away*away > twice*impact->rotors))) {
        return false;
    }
    const robot_real slip = region->damping*ROBOT_SQRT(twice*impact->mobility);
    const robot_real pressed = ROBOT_FMAX(force - slip, ROBOT_R(0.0))/region->stiffness;
    const robot_real gap = ROBOT_FMAX(depth + pressed - r, ROBOT_R(0.0));
    const robot_real skin = is_hertz ? ROBOT_R(0.8)*force*depth : robot_law_twice_work(region, force);
    const robot_real needed = force*force/impact->hold + skin;
    return twice*phase->reach <= share*(needed*phase->reach + gap*gap);
}
