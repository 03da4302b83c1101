/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of panda_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f = k_f d^1.5 = k_h s + c_h s' with s = x - u, where x is how far the
 * contact point has come and u = d + (compliance of modes that stand) f. x' is exact at every node and u'
 * a backward difference, so that no damping makes it unstable. The force is quadratic between nodes;
 * steps are halved where it bends too much for that.
 */
#include "panda_impact.h"

/* Half the second difference of the force, over its size, above which a step is halved. */
#define BENDS PANDA_R(0.005)
#define BENDS_ROUGH PANDA_R(0.04)
/* Share of it below which the next step is doubled: a doubled one bends four times as much. */
#define STRAIGHT PANDA_R(0.15)
/* Halley's iterations, and the relative change after which the next would be nothing. */
#define ITERATIONS 32
#define CLOSE PANDA_R(0.01)

typedef struct {
    const panda_impact *impact;
    const panda_phase *phase;
    panda_real speed;
    panda_real scale; /* of forces, N */
    int level;
    int ticks; /* of the shortest step, until the phase is over */
    panda_real time;
    panda_real drifted; /* by the motors, m */
    panda_real amplitude[PANDA_MODES], rate[PANDA_MODES];
    bool touching;
    int past; /* steps since the touch */
    panda_real h, x; /* last step, contact point */
    panda_real f, rise; /* force, and by how much it grew in the last step */
    panda_real u, u_before, root; /* deformation of the skin; root of its depth */
    panda_real rest; /* deflection of the body out of contact */
} state;

/* A step on trial. */
typedef struct {
    panda_real amplitude[PANDA_MODES], rate[PANDA_MODES];
    panda_real x, v; /* of the contact point without the force at the end */
    panda_real f, bend, base, share; /* force at the end; how it bends on the way */
    panda_real u, root;
} trial;

/* A servo's damping over a time, to second order: rate -= time S'DS (rate - what it is led by). */
static void damp(const panda_phase *phase, panda_real speed, panda_real time, panda_real *rate)
{
    panda_real halfway[PANDA_MODES];
    for (int round = 0; round < 2; ++round) {
        const panda_real span = round == 0 ? PANDA_R(0.5)*time : time;
        const panda_real *const from = round == 0 ? rate : halfway;
        panda_real torque[PANDA_N];
        for (int j = 0; j < PANDA_N; ++j) {
            const panda_real *const shape = phase->modes.shape[PANDA_SYSTEM - PANDA_N + j];
            panda_real turned = PANDA_R(0.0);
            for (int i = 0; i < phase->active; ++i) {
                turned += shape[i]*(from[i] - speed*phase->modes.start[i]);
            }
            torque[j] = span*phase->damping[j]*turned;
        }
        for (int i = 0; i < phase->active; ++i) {
            panda_real change = PANDA_R(0.0);
            for (int j = 0; j < PANDA_N; ++j) {
                change += phase->modes.shape[PANDA_SYSTEM - PANDA_N + j][i]*torque[j];
            }
            if (round == 0) {
                halfway[i] = rate[i] - change;
            } else {
                rate[i] -= change;
            }
        }
    }
}

/* Moves all modes by a step without forces. */
static void glide(const state *s, trial *t)
{
    const panda_phase *const phase = s->phase;
    const panda_level *const level = &phase->level[s->level];
    const panda_real *rate = s->rate;
    panda_real damped[PANDA_MODES];
    if (phase->damped) {
        for (int i = 0; i < phase->active; ++i) {
            damped[i] = s->rate[i];
        }
        damp(phase, s->speed, PANDA_R(0.5)*level->h, damped);
        rate = damped;
    }
    const panda_real drift = phase->drift*s->speed;
    panda_real x = s->drifted + drift*level->h;
    panda_real v = drift;
    for (int i = 0; i < phase->active; ++i) {
        const panda_mode_step *const step = &level->mode[i];
        const panda_real a = s->amplitude[i];
        const panda_real b = rate[i];
        t->amplitude[i] = step->cosine*a + step->sine*b;
        t->rate[i] = step->back*a + step->cosine*b;
        x += phase->modes.row[i]*t->amplitude[i];
        v += phase->modes.row[i]*t->rate[i];
    }
    t->x = x;
    t->v = v;
}

/* The root of u^2 + cubic u^3 = depth > 0. */
static panda_real root_of(panda_real depth, panda_real cubic, panda_real guess)
{
    panda_real u = guess;
    if (!(u > PANDA_R(0.0))) {
        const panda_real light = PANDA_SQRT(depth);
        u = light/PANDA_SQRT(PANDA_SQRT(PANDA_R(1.0) + cubic*light));
    }
    for (int i = 0; i < ITERATIONS; ++i) {
        const panda_real bend = PANDA_R(1.0) + PANDA_R(3.0)*cubic*u;
        const panda_real slope = u*(PANDA_R(1.0) + bend);
        const panda_real over = u*u*(PANDA_R(1.0) + cubic*u) - depth;
        const panda_real change = over*slope/(slope*slope - over*bend);
        u -= change;
        if (PANDA_FABS(change) <= CLOSE*u) {
            break;
        }
    }
    return u;
}

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
static void press(const state *s, trial *t)
{
    const panda_impact *const impact = s->impact;
    const panda_phase *const phase = s->phase;
    const panda_level *const level = &phase->level[s->level];
    const panda_real one = PANDA_R(1.0);
    const panda_real h = level->h;
    panda_real lag = one/h; /* backward difference: u' = lag u + memory */
    panda_real memory = -s->u/h;
    t->share = PANDA_R(0.0);
    t->base = PANDA_R(0.0);
    if (s->past > 0) {
        const panda_real ratio = h/s->h;
        t->share = ratio/(one + ratio)/PANDA_R(6.0);
        t->base = t->share*(s->f + ratio*s->rise);
        lag = (one + ratio + ratio)/((one + ratio)*h);
        memory = (ratio*ratio/(one + ratio)*s->u_before - (one + ratio)*s->u)/h;
    }
    const panda_real first = s->f + t->base;
    const panda_real x = t->x - level->push[0]*first - level->push[1]*t->base;
    const panda_real v = t->v - level->kick[0]*first - level->kick[1]*t->base;
    const panda_real yields = (one - t->share)*level->push[1] - t->share*level->push[0];
    const panda_real slows = (one - t->share)*level->kick[1] - t->share*level->kick[0];
    const panda_real hold = impact->stiffness + impact->damping*lag;
    const panda_real pressed = impact->stiffness*x + impact->damping*(v - memory);
    const panda_real soft =
        one + impact->stiffness*yields + impact->damping*slows + hold*phase->compliance;
    t->f = PANDA_R(0.0);
    t->u = PANDA_R(0.0);
    t->root = PANDA_R(0.0);
    if (pressed > PANDA_R(0.0)) {
        t->root = root_of(pressed/hold, impact->skin*soft/hold, s->root);
        t->f = impact->skin*t->root*t->root*t->root;
        t->u = t->root*t->root + phase->compliance*t->f;
    }
    t->x = x - yields*t->f;
    t->bend = PANDA_R(6.0)*(t->share*(t->f - s->f) - (t->base - t->share*s->f));
}

/* Takes the step: forces that are linear over it, with the mean of what the bend adds. */
static void take(const trial *t, state *s)
{
    const panda_phase *const phase = s->phase;
    const panda_level *const level = &phase->level[s->level];
    const panda_real first = s->f + t->base - t->share*t->f;
    const panda_real last = t->base + (PANDA_R(1.0) - t->share)*t->f;
    for (int i = 0; i < phase->active; ++i) {
        const panda_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push[0]*first - step->push[1]*last;
        s->rate[i] = t->rate[i] - step->kick[0]*first - step->kick[1]*last;
    }
}

/* Advances the clock, and lengthens the next step where it may. */
static void tick(state *s, bool longer)
{
    const panda_level *const level = &s->phase->level[s->level];
    s->h = level->h;
    s->time += level->h;
    s->drifted += s->phase->drift*s->speed*level->h;
    s->ticks -= 1 << (PANDA_LEVELS - 1 - s->level);
    if (longer && s->level > 0 && s->ticks % (1 << (PANDA_LEVELS - s->level)) == 0) {
        --s->level;
    }
}

/* Notes a top of the parabola through the last three forces. */
static void see(const state *s, panda_real f, panda_real h, panda_peak *peak)
{
    panda_real force = f;
    panda_real time = s->time + h;
    if (s->past > 0 && s->rise >= PANDA_R(0.0) && f < s->f) {
        const panda_real before = s->rise/s->h;
        const panda_real after = (f - s->f)/h;
        const panda_real bend = (after - before)/(h + s->h);
        const panda_real slope = before + bend*s->h;
        force = s->f - PANDA_R(0.25)*slope*slope/bend;
        time = s->time - PANDA_R(0.5)*slope/bend;
    }
    if (force > peak->force) {
        peak->force = force;
        peak->time = time;
        peak->contact = peak->contacts;
    }
}

/* A step in contact; false if it must be shorter. */
static bool step_pressed(state *s, trial *t, panda_real bends, panda_peak *peak)
{
    press(s, t);
    const panda_real size = PANDA_FMAX(s->scale, peak->force);
    const panda_real bent = PANDA_FABS(t->bend);
    if (s->level < PANDA_LEVELS - 1 && !(bent <= bends*size)) {
        ++s->level;
        return false;
    }
    const panda_level *const level = &s->phase->level[s->level];
    take(t, s);
    see(s, t->f, level->h, peak);
    const panda_real rest = (s->x - s->u)*level->relax;
    s->rise = t->f - s->f;
    s->f = t->f;
    s->u_before = s->u;
    s->u = t->u;
    s->root = t->root;
    s->x = t->x;
    ++s->past;
    if (!(t->f > PANDA_R(0.0))) {
        s->touching = false;
        s->rest = PANDA_FMAX(s->x, rest);
    }
    tick(s, bent <= STRAIGHT*bends*size && s->past > 1);
    return true;
}

/* A step out of contact; false if it must be shorter, or is one in contact. */
static bool step_apart(state *s, trial *t, panda_peak *peak)
{
    const panda_level *const level = &s->phase->level[s->level];
    const panda_real rest = s->rest*level->relax;
    if (t->x > rest) {
        if (s->level < PANDA_LEVELS - 1) {
            ++s->level;
            return false;
        }
        s->touching = true;
        s->past = 0;
        s->u = s->x - s->rest;
        s->f = PANDA_R(0.0);
        s->rise = PANDA_R(0.0);
        s->root = PANDA_R(0.0);
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

/* Displacements and velocities over links and motors beside the motion before, from a phase's modes. */
static void coordinates_of(const state *s, panda_real *place, panda_real *rate)
{
    const panda_modes *const modes = &s->phase->modes;
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        place[j] = PANDA_R(0.0);
        rate[j] = PANDA_R(0.0);
        for (int i = 0; i < s->phase->active; ++i) {
            const panda_real led = modes->start[i]*s->speed;
            place[j] += modes->shape[j][i]*(s->amplitude[i] - led*s->time);
            rate[j] += modes->shape[j][i]*(s->rate[i] - led);
        }
        for (int i = s->phase->active; i < modes->count; ++i) {
            place[j] -= modes->shape[j][i]*modes->row[i]/modes->squared[i]*s->f;
        }
    }
}

/* Goes over from motors that drive or servo to motors that are free. */
static void release(state *s)
{
    const panda_impact *const impact = s->impact;
    const panda_phase *const next = &impact->phase[1];
    const panda_modes *const modes = &next->modes;
    panda_real place[PANDA_SYSTEM];
    panda_real rate[PANDA_SYSTEM];
    panda_real a[PANDA_MODES];
    panda_real b[PANDA_MODES];
    coordinates_of(s, place, rate);
#if PANDA_STRUCTURED
    panda_real x = s->speed*s->time;
    panda_real v = s->speed;
    for (int j = 0; j < PANDA_N; ++j) {
        const panda_real row = impact->arrival.row[j];
        x += row*place[j] - impact->carried[j]*(place[j] - place[PANDA_N + j]);
        v += row*rate[j] - impact->carried[j]*(rate[j] - rate[PANDA_N + j]);
        place[j] = impact->springs[j]*(place[j] - place[PANDA_N + j]);
        rate[j] = impact->springs[j]*(rate[j] - rate[PANDA_N + j]);
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
    for (int i = 1; i < next->active; ++i) {
        a[i] = PANDA_R(0.0);
        b[i] = PANDA_R(0.0);
        for (int j = 0; j < PANDA_N; ++j) {
            a[i] += modes->shape[j][i]*place[j];
            b[i] += modes->shape[j][i]*rate[j];
        }
        if (modes->squared[i] > PANDA_R(0.0)) {
            a[i] /= modes->squared[i];
            b[i] /= modes->squared[i];
        }
    }
#else
    panda_real momentum[PANDA_SYSTEM];
    panda_real carry[PANDA_SYSTEM];
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        const panda_real before = s->speed*impact->arrival.rates[j % PANDA_N];
        place[j] += before*s->time;
        rate[j] += before;
    }
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        momentum[j] = PANDA_R(0.0);
        carry[j] = PANDA_R(0.0);
        if (j < PANDA_N) {
            for (int k = 0; k < PANDA_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*rate[k];
                carry[j] += impact->arrival.links.M[j][k]*place[k];
            }
        }
#if PANDA_ELASTIC
        if (j >= PANDA_N) {
            momentum[j] = impact->rotors[j - PANDA_N]*rate[j];
            carry[j] = impact->rotors[j - PANDA_N]*place[j];
        }
#endif
    }
    for (int i = 0; i < next->active; ++i) {
        a[i] = PANDA_R(0.0);
        b[i] = PANDA_R(0.0);
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            a[i] += modes->shape[j][i]*carry[j];
            b[i] += modes->shape[j][i]*momentum[j];
        }
    }
#endif
    /* The body is the last of the modes that move: at least one does. */
    if (impact->gives_way && next->active > 0 && s->phase->active > 0) {
        a[next->active - 1] = s->amplitude[s->phase->active - 1];
        b[next->active - 1] = s->rate[s->phase->active - 1];
    }
    for (int i = 0; i < next->active; ++i) {
        s->amplitude[i] = a[i];
        s->rate[i] = b[i];
    }
    const panda_real h = s->phase->level[s->level].h;
    s->phase = next;
    s->drifted = PANDA_R(0.0);
    s->level = 0;
    for (int k = 0; k < PANDA_LEVELS - 1; ++k) { /* the longest step that is no longer than the last */
        s->level = next->level[k].h > PANDA_R(1.01)*h ? k + 1 : s->level;
    }
    s->ticks = next->steps*(1 << (PANDA_LEVELS - 1));
}

static void start(const panda_impact *impact, panda_real speed, state *s)
{
    const panda_phase *const phase = &impact->phase[0];
    const panda_real zero = PANDA_R(0.0);
    s->impact = impact;
    s->phase = phase;
    s->speed = speed;
    s->scale = impact->scale;
    s->level = PANDA_LEVELS - 1;
    s->ticks = phase->steps*(1 << (PANDA_LEVELS - 1));
    s->time = zero;
    s->drifted = zero;
    for (int i = 0; i < phase->active; ++i) {
        s->amplitude[i] = zero;
        s->rate[i] = phase->modes.start[i]*speed;
    }
    s->touching = true;
    s->past = 0;
    s->h = zero;
    s->x = zero;
    s->f = zero;
    s->rise = zero;
    s->u = zero;
    s->u_before = zero;
    s->root = zero;
    s->rest = zero;
}

void panda_impact_run(const panda_impact *impact, panda_real speed, panda_budget *budget,
    panda_peak *peak)
{
    const panda_real bends = impact->smooth*(budget->rough ? BENDS_ROUGH : BENDS);
    state s;
    trial t;
    start(impact, speed, &s);
    peak->force = PANDA_R(0.0);
    peak->time = PANDA_R(0.0);
    peak->contact = 1;
    peak->contacts = 1;
    peak->ended = false;
    if (impact->blurred) {
        return;
    }
    for (int k = 0; k < impact->phases; ++k) {
        if (k > 0) {
            release(&s);
        }
        while (s.ticks > 0) {
            if (budget->steps <= 0) {
                return;
            }
            --budget->steps;
            glide(&s, &t);
            const bool taken =
                s.touching ? step_pressed(&s, &t, bends, peak) : step_apart(&s, &t, peak);
            if (taken && s.phase->damped) {
                damp(s.phase, speed, PANDA_R(0.5)*s.h, s.rate);
            }
            if (peak->force > budget->stop_above && s.f < peak->force) {
                peak->ended = true;
                return;
            }
        }
    }
    peak->ended = true;
}
