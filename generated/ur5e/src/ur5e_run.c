/* SPDX-License-Identifier: 0BSD */
/* An impact of ur5e_ over time: all contacts up to the horizon, or until none can be harder. */
#include "ur5e_state.h"

/* Half the second difference of the force, over its size, above which a step is halved. */
#define BENDS UR5E_R(0.0125)
#define BENDS_ROUGH UR5E_R(0.15)
/* Share of it below which the next step is doubled: a doubled one bends four times as much. */
#define STRAIGHT UR5E_R(0.12)
/* Level of the shortest step, in rough runs. */
#define SHORTEST (UR5E_LEVELS - 1)
#define SHORTEST_ROUGH 2
/* Steps in contact after which it is looked whether the rest matters. */
#define LOOKS 2
/* Share of what a harder contact takes up to which rough runs take it to be out of reach. */
#define ROUGHLY UR5E_R(1.3)
/* Advances the clock, and lengthens the next step where it may. */
static void tick(ur5e_state *s, bool longer)
{
    const ur5e_level *const level = &s->phase->level[s->level];
    s->h_before = s->h;
    s->h = level->h;
    s->time += level->h;
    s->drifted += s->phase->drift*s->speed*level->h;
    s->ticks -= 1 << (UR5E_LEVELS - 1 - s->level);
    if (longer && s->level > 0 && s->ticks % (1 << (UR5E_LEVELS - s->level)) == 0) {
        --s->level;
    }
}

/* Notes a top of the parabola through the last three forces. */
static void see(const ur5e_state *s, ur5e_real f, ur5e_real h, ur5e_peak *peak)
{
    ur5e_real force = f;
    ur5e_real time = s->time + h;
    if (s->past > 0 && s->rise >= UR5E_R(0.0) && f < s->f) {
        const ur5e_real before = s->rise/s->h;
        const ur5e_real after = (f - s->f)/h;
        const ur5e_real bend = (after - before)/(h + s->h);
        const ur5e_real slope = before + bend*s->h;
        force = s->f - UR5E_R(0.25)*slope*slope/bend;
        time = s->time - UR5E_R(0.5)*slope/bend;
    }
    if (force > peak->force) {
        peak->force = force;
        peak->time = time;
        peak->contact = peak->contacts;
    }
}

/* A step in contact; false if it must be shorter. */
static bool step_pressed(ur5e_state *s, ur5e_trial *t, ur5e_real bends, int shortest, ur5e_peak *peak)
{
    ur5e_press(s, t);
    const ur5e_real size = UR5E_FMAX(s->scale, peak->force);
    const ur5e_real bent = UR5E_R(6.0)*UR5E_FABS(t->bump);
    if (s->level < shortest && !(bent <= bends*size)) {
        ++s->level;
        return false;
    }
    const ur5e_level *const level = &s->phase->level[s->level];
    ur5e_take(t, s);
    s->depth = t->f > peak->force ? t->root*t->root : s->depth;
    see(s, t->f, level->h, peak);
    const ur5e_real rest = (s->x - s->u)*level->relax;
    s->bump = t->bump;
    s->rise = t->f - s->f;
    s->f = t->f;
    s->u_before = s->u;
    s->u = t->u;
    s->root = t->root;
    s->x = t->x;
    ++s->past;
    if (!(t->f > UR5E_R(0.0))) {
        s->touching = false;
        s->rest = UR5E_FMAX(s->x, rest);
    }
    tick(s, bent <= STRAIGHT*bends*size && s->past > 1);
    return true;
}

/* A step out of contact; false if it must be shorter, or is one in contact. */
static bool step_apart(ur5e_state *s, ur5e_trial *t, int shortest, ur5e_peak *peak)
{
    const ur5e_level *const level = &s->phase->level[s->level];
    const ur5e_real rest = s->rest*level->relax;
    if (t->x > rest) {
        if (s->level < shortest) {
            ++s->level;
            return false;
        }
        s->touching = true;
        s->past = 0;
        s->u = s->x - s->rest;
        s->f = UR5E_R(0.0);
        s->rise = UR5E_R(0.0);
        s->root = UR5E_R(0.0);
        ++peak->contacts;
        return false;
    }
    for (int i = 0; i < s->phase->active; ++i) {
        s->amplitude[i] = t->amplitude[i];
        s->rate[i] = t->rate[i];
    }
    s->rest = rest;
    s->x = t->x;
    tick(s, true);
    return true;
}

static void start(ur5e_impact *impact, ur5e_real speed, bool rough, ur5e_state *s)
{
    const ur5e_phase *const phase = &impact->phase[impact->first];
    const ur5e_real zero = UR5E_R(0.0);
    s->impact = impact;
    s->phase = phase;
    s->speed = speed;
    s->scale = impact->scale;
    s->level = rough ? SHORTEST_ROUGH : SHORTEST;
    s->ticks = phase->steps*(1 << (UR5E_LEVELS - 1));
    s->time = zero;
    s->drifted = zero;
    for (int i = 0; i < phase->active; ++i) {
        s->amplitude[i] = zero;
        s->rate[i] = phase->modes.start[i]*speed;
    }
    s->touching = true;
    s->past = 0;
    s->h = zero;
    s->h_before = zero;
    s->bump = zero;
    s->x = zero;
    s->f = zero;
    s->rise = zero;
    s->u = zero;
    s->u_before = zero;
    s->root = zero;
    s->rest = zero;
    s->depth = zero;
}

/* Steps through a phase; false if the steps do not do. */
static bool run_phase(ur5e_state *s, ur5e_budget *budget, ur5e_peak *peak)
{
    const ur5e_real bends = s->impact->smooth*(budget->rough ? BENDS_ROUGH : BENDS);
    const ur5e_real share = budget->rough ? ROUGHLY : UR5E_R(1.0);
    const int shortest = budget->rough ? SHORTEST_ROUGH : SHORTEST;
    ur5e_trial t;
    while (s->ticks > 0) {
        if (budget->steps <= 0) {
            return false;
        }
        --budget->steps;
        ur5e_glide(s, &t);
        const bool taken = s->touching ? step_pressed(s, &t, bends, shortest, peak)
            : step_apart(s, &t, shortest, peak);
        if (taken && s->phase->damped) {
            ur5e_damp(s->phase, s->speed, UR5E_R(0.5)*s->h, s->rate);
        }
        const bool falls = taken && s->f < peak->force;
        const bool looks = falls && (s->past % LOOKS == 0 || !s->touching);
        if ((falls && peak->force > budget->stop_above)
            || (looks && ur5e_is_settled(s, peak->force, share))) {
            peak->ended = true;
            return true;
        }
    }
    return true;
}

void ur5e_impact_run(ur5e_impact *impact, ur5e_real speed, ur5e_budget *budget, ur5e_peak *peak)
{
    ur5e_state s;
    start(impact, speed, budget->rough, &s);
    peak->force = UR5E_R(0.0);
    peak->time = UR5E_R(0.0);
    peak->contact = 1;
    peak->contacts = 1;
    peak->ended = false;
    for (int k = impact->first; k <= impact->last && !peak->ended; ++k) {
        if (k > impact->first) {
            ur5e_impact_let_go(impact);
            if (impact->status != UR5E_OK) {
                return;
            }
            ur5e_release(&s);
        }
        if (impact->phase[k].blurred || !run_phase(&s, budget, peak)) {
            return;
        }
    }
    peak->ended = true;
}
