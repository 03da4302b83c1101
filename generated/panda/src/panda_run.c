/* SPDX-License-Identifier: 0BSD */
/* An impact of panda_ over time: all contacts up to the horizon, or until none can be harder. */
#include "panda_state.h"

/* Half the second difference of the force, over its size, above which a step is halved. */
#define BENDS PANDA_R(0.025)
#define BENDS_ROUGH PANDA_R(0.15)
/* Share of it that is allowed where contacts before may have left an error. */
#define BENDS_FINE PANDA_R(0.1)
/*
 * Below the largest force so far mostly only what comes later counts: these shares of half the second difference, and
 * of half the third, stand for the former from the fourth node of a contact on, where they are less. With half of each
 * a Panda's second contact was 0.7 % too weak.
 */
#define BENDS_BELOW PANDA_R(0.6)
#define TWISTS_BELOW PANDA_R(1.6)
/* Share of it below which the next step is doubled: a doubled one bends four times as much. */
#define STRAIGHT PANDA_R(0.22)
/* Force from which robot and body may part within a step, over the bend that is allowed. */
#define PARTS PANDA_R(4.0)
/* Share of that by which the force may be larger within a step than at its ends. */
#define LEAPS PANDA_R(0.5)
/* Bend over the shortest step, over what is allowed, from which on the force of a law through points is unknown. */
#define TORN PANDA_R(32.0)
/* Shortest steps past the horizon, lest a law through points gets stiff just before it. */
#define BEYOND 2
/* Levels of the shortest step: in contact, out of it (so near is the touch), in rough runs. */
#define SHORTEST (PANDA_LEVELS - 1)
#define SHORTEST_APART 4
#define SHORTEST_ROUGH 2
/*
 * Share of the time that rounding may shift a force which still rises at the horizon by, over the share of an approach
 * that it may change: a stiff body met again just before was 0.16 of it off, and its force by 2.5 %.
 */
#define SHIFTS PANDA_R(0.5)
/* Steps of a falling force, or of none, after which it is looked whether the rest matters. */
#define LOOKS 3
/* Share of a first step within which the damper has to press the skin in, and the share of that time missed. */
#define BRIEF PANDA_R(0.3)
#define MISSED PANDA_R(1.2)
/* Level of such a first step. */
#define LONGEST 4
#define LONGEST_ROUGH 1
/* Share of the largest force below which a rough run ends: what it finds is a guess. */
#define GUESSED PANDA_R(0.5)
/* Share of what a harder contact takes up to which rough runs take it to be out of reach. */
#define ROUGHLY PANDA_R(3.0)
/*
 * Most contacts of an impact whose forces are known: where a robot chatters on a body that hardly damps, each
 * depends on the one before, and errors grow from one to the next. Random arms and bodies make six at most.
 */
#define MOST_CONTACTS 8

/* What became of a step. */
typedef enum {
    TO_BE_SHORTER, /* or it is one in contact */
    TAKEN,
    TAKEN_AND_STRAIGHT
} outcome;

/* Changes the length of the next step. */
static void change_level(panda_state *s, int level)
{
    s->level = level;
    s->step = &s->phase->level[level];
    s->even = 0;
}

void panda_phase_begin(const panda_phase *phase, int level, panda_state *s)
{
    s->phase = phase;
    s->ticks = phase->steps*(1 << (PANDA_LEVELS - 1));
    s->drift = phase->drift*s->speed;
    s->drifted = PANDA_R(0.0);
    s->owed = PANDA_R(0.0);
    change_level(s, level);
    s->due.level = s->step; /* the former phase's may have fewer modes, whose rest no one wrote */
    s->due.mean = PANDA_R(0.0);
    s->due.rise = PANDA_R(0.0);
}

/* Advances the clock, and lengthens the next step where it may. */
static void tick(panda_state *s, bool longer)
{
    const panda_real h = s->step->h;
    const int ticks = s->ticks - (1 << (PANDA_LEVELS - 1 - s->level));
    s->h_before = s->h;
    s->h = h;
    s->per = s->step->per;
    s->time += h;
    s->owed = PANDA_R(0.5)*h;
    s->drifted += s->drift*h;
    s->ticks = ticks;
    ++s->even;
    if (longer && s->level > 0 && ticks % (1 << (PANDA_LEVELS - s->level)) == 0) {
        change_level(s, s->level - 1);
    }
}

/* Notes a force if it is the largest; `since` is its time less that of the last node. */
static bool see(const panda_state *s, panda_real force, panda_real since, panda_peak *peak)
{
    const panda_real most = force + s->swings;
    const bool largest = most > peak->force;
    if (largest) {
        peak->force = most;
        peak->time = s->time + since;
        peak->contact = peak->contacts;
    }
    return largest;
}

/* Notes the force at a top, or where the horizon cuts it off. */
static void see_most(const panda_state *s, panda_real force, panda_real since, panda_peak *peak)
{
    (void)see(s, force, since, peak);
    if (peak->contacts > s->impact->sure) {
        peak->later = PANDA_FMAX(peak->later, force + s->swings);
    }
}

/* Notes a top of the cubic through the last four forces, near that of the parabola through three. */
static void see_top(const panda_state *s, const panda_trial *t, panda_peak *peak)
{
    const panda_real h = s->step->h;
    const panda_real before = s->rise/s->h;
    const panda_real after = (t->f - s->f)/h;
    const panda_real bend = (after - before)/(h + s->h);
    const panda_real slope = before + bend*s->h;
    const panda_real since = PANDA_R(-0.5)*slope/bend;
    panda_real force = s->f + PANDA_R(0.5)*slope*since;
    if (s->past > 1) {
        const panda_real bent = PANDA_R(-6.0)*s->bump/(s->h*s->h); /* at the last node */
        const panda_real twist = (bend - bent)/(h + s->h + s->h_before);
        force += twist*since*(since + s->h)*(since - h);
    }
    see_most(s, force, since, peak);
}

/* By how much the force bends over a step, as far as that matters. */
static panda_real bend_of(const panda_state *s, const panda_trial *t, const panda_peak *peak)
{
    const panda_real bent = PANDA_R(6.0)*PANDA_FABS(t->bump);
    if (s->all_count || s->past <= 2 || !(s->f < peak->force)) {
        return bent;
    }
    const panda_real ratio = s->pace.ratio;
    const panda_real twisted = PANDA_R(6.0)*PANDA_FABS(t->bump - ratio*ratio*s->bump);
    return PANDA_FMIN(bent, PANDA_FMAX(BENDS_BELOW*bent, TWISTS_BELOW*twisted));
}

/* A step in contact. */
static outcome step_pressed(panda_state *s, panda_trial *t, panda_real bends, int shortest, panda_peak *peak)
{
    panda_press(s, t);
    const panda_real allowed = bends*PANDA_FMAX(s->scale, peak->force);
    const panda_real bent = bend_of(s, t, peak);
    const panda_real rise = t->f - s->f;
    const bool parts = !(t->f > PANDA_R(0.0));
    panda_real between = PANDA_R(0.0); /* nodes of a law through points, where it leaps there */
    bool slips = false;
    if (s->region->law != NULL) {
        const panda_real force = panda_force_between(s, t);
        between = force > PANDA_FMAX(s->f, t->f) + LEAPS*allowed ? force : PANDA_R(0.0);
        slips = between > PANDA_R(0.0) || panda_slip_off(s, t) > LEAPS*allowed;
        peak->torn = peak->torn || (s->level >= SHORTEST && bent > TORN*allowed);
    }
    if (s->level < shortest && (!(bent <= allowed) || (parts && s->f > PARTS*allowed) || slips)) {
        change_level(s, s->level + 1);
        return TO_BE_SHORTER;
    }
    panda_take(s, t->mean, rise);
    const bool rises = rise >= PANDA_R(0.0);
    if (rises && see(s, t->f, s->step->h, peak)) {
        s->depth = t->depth;
    }
    if (!rises && s->past > 0 && s->rise >= PANDA_R(0.0)) {
        see_top(s, t, peak);
    }
    if (between > PANDA_R(0.0)) {
        peak->force = PANDA_FMAX(peak->force, between + s->swings);
    }
    if (parts) {
        s->touching = false;
        s->rest = PANDA_FMAX(t->x, (s->x - s->u)*s->step->relax);
    }
    const panda_real most = STRAIGHT*allowed;
    const bool straight = bent <= most && s->bent <= most && s->past > 0;
    s->bent = bent;
    s->bump = t->bump;
    s->rise = rise;
    s->f = t->f;
    s->u_third = s->u_before;
    s->u_before = s->u;
    s->u = t->u;
    s->now = t->depth;
    s->root = t->root;
    s->x = t->x;
    ++s->past;
    return straight ? TAKEN_AND_STRAIGHT : TAKEN;
}

/* They touch: the contact begins with no force. */
static void touch(panda_state *s)
{
    s->touching = true;
    s->past = 0;
    s->even = 0;
    s->u = s->x - s->rest;
    s->f = PANDA_R(0.0);
    s->rise = PANDA_R(0.0);
    s->bump = PANDA_R(0.0);
    s->bent = PANDA_R(0.0);
    s->now = PANDA_R(0.0);
    s->root = PANDA_R(0.0);
}

/* A step out of contact. */
static outcome step_apart(panda_state *s, const panda_trial *t, int shortest, panda_peak *peak)
{
    const panda_real rest = s->rest*s->step->relax;
    if (t->x > rest) {
        if (s->level < shortest) { /* to a step that ends before they touch, if both approach evenly */
            panda_real share = PANDA_R(2.0)*(s->rest - s->x)/(s->rest - s->x + t->x - rest);
            int level = s->level + 1;
            while (level < shortest && !(share >= PANDA_R(1.0))) {
                share += share;
                ++level;
            }
            change_level(s, level);
        } else {
            touch(s);
            ++peak->contacts;
        }
        return TO_BE_SHORTER;
    }
    panda_take(s, PANDA_R(0.0), PANDA_R(0.0));
    s->rest = rest;
    s->x = t->x;
    return TAKEN_AND_STRAIGHT;
}

/*
 * A damper that meets the skin at once pushes c v as soon as the skin is deep enough, after a time of depth/v:
 * where that is brief the first step is long, and begins with what c v is on average.
 */
static void begin(const panda_region *region, int longest, panda_state *s)
{
    const panda_real pushed = region->damping*s->speed;
    const panda_real slow = panda_law_depth(region, pushed)/s->speed;
    if (s->phase->level[longest].h*BRIEF >= slow) {
        change_level(s, longest);
    }
    const panda_real share = PANDA_R(1.0) - MISSED*slow/s->step->h;
    if (share > PANDA_R(0.0)) {
        s->f = share*pushed;
        s->now = panda_law_depth(region, s->f);
        s->u = s->now + s->phase->compliance*s->f;
    }
}

static void start(panda_impact *impact, panda_real speed, bool rough, panda_state *s)
{
    const panda_phase *const phase = &impact->phase[impact->first];
    const panda_real zero = PANDA_R(0.0);
    s->impact = impact;
    s->region = impact->region;
    s->speed = speed;
    s->all_count = false;
    s->scale = impact->scale;
    panda_phase_begin(phase, rough ? SHORTEST_ROUGH : SHORTEST, s);
    s->time = zero;
    s->motion = &s->motions[0];
    s->trial = &s->motions[1];
    for (int i = 0; i < phase->active; ++i) {
        s->motion->place[i] = zero;
        s->motion->rate[i] = phase->modes.row[i]*phase->modes.start[i]*speed;
    }
    s->h = zero;
    s->h_before = zero;
    s->per = zero;
    s->x = zero;
    s->rest = zero;
    s->u_before = zero;
    s->u_third = zero;
    touch(s);
    s->depth = zero;
    s->swings = zero;
    begin(impact->region, rough ? LONGEST_ROUGH : LONGEST, s);
}

/* Steps through a phase, a rough run until its force has fallen; false if the steps do not do. */
static bool run_phase(panda_state *s, panda_budget *budget, panda_peak *peak)
{
    const bool rough = budget->rough;
    const panda_real fine = budget->fine ? BENDS_FINE : PANDA_R(1.0);
    const panda_real bends = fine*s->impact->smooth*(rough ? BENDS_ROUGH : BENDS);
    const panda_real share = rough ? ROUGHLY : PANDA_R(1.0);
    const int shortest = rough ? SHORTEST_ROUGH : SHORTEST;
    panda_trial t;
    int falls = 0; /* steps of a falling force, or of none, since it was looked whether the rest matters */
    while (s->ticks > 0) {
        if (budget->steps <= 0) {
            return false;
        }
        --budget->steps;
        if (falls >= LOOKS) { /* a look takes as long as a step */
            falls = 0;
            if (panda_is_settled(s, peak->force - s->swings, s->depth, share)) {
                peak->ended = true;
                return true;
            }
            continue;
        }
        panda_glide(s, &t);
        const outcome was = s->touching ? step_pressed(s, &t, bends, shortest, peak)
            : step_apart(s, &t, rough ? SHORTEST_ROUGH : SHORTEST_APART, peak);
        if (was == TO_BE_SHORTER) {
            if (peak->contacts > MOST_CONTACTS) {
                return false;
            }
            continue;
        }
        const bool is_longest = s->touching && !rough && s->level <= s->phase->longest_pressed;
        tick(s, was == TAKEN_AND_STRAIGHT && !is_longest);
        if (budget->watch != NULL) {
            peak->ended = panda_pass(s, budget->watch);
        } else if (s->f + s->swings < peak->force) {
            falls += s->phase->settles && !(s->rise > PANDA_R(0.0)) ? 1 : 0;
            peak->ended = peak->force > budget->stop_above || (rough && s->f < GUESSED*peak->force);
        } else {
            peak->ended = false;
        }
        if (peak->ended) {
            return true;
        }
    }
    return true;
}

void panda_impact_run(panda_impact *impact, panda_real speed, panda_budget *budget, panda_peak *peak)
{
    panda_state s;
    peak->force = PANDA_R(0.0);
    peak->later = PANDA_R(0.0);
    peak->torn = false;
    peak->time = PANDA_R(0.0);
    peak->contact = 1;
    peak->contacts = 1;
    peak->ended = false;
    budget->steps -= PANDA_STEPS_OF_RUN;
    if (budget->steps <= 0 || impact->phase[impact->first].blurred) {
        return;
    }
    start(impact, speed, budget->rough, &s);
    s.all_count = budget->fine || budget->watch != NULL;
    bool goes_on = run_phase(&s, budget, peak);
    if (goes_on && !peak->ended && impact->last > impact->first) {
        panda_impact_let_go(impact);
        if (impact->status != PANDA_OK || impact->phase[impact->last].blurred) {
            return;
        }
        panda_release(&s);
        goes_on = run_phase(&s, budget, peak);
    }
    if (goes_on && !peak->ended && impact->region->law != NULL) {
        s.ticks = BEYOND;
        change_level(&s, SHORTEST);
        goes_on = run_phase(&s, budget, peak);
    }
    if (goes_on && !peak->ended && s.rise > PANDA_R(0.0)) { /* cut off by the horizon */
        see_most(&s, s.f + SHIFTS*s.phase->blur*s.time*s.rise/s.h, PANDA_R(0.0), peak);
    }
    peak->ended = goes_on;
}
