/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of rmin_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f = k_f d^1.5 = k_h s + c_h s' with s = x - u, where x is how far the
 * contact point has come and u = d + (compliance of modes that stand) f. x' is exact at every node and u'
 * a backward difference, so that no damping makes it unstable. The force is quadratic between nodes;
 * steps are halved where it bends too much for that.
 */
#include "rmin_impact.h"

/* Half the second difference of the force, over its size, above which a step is halved. */
#define BENDS RMIN_R(0.005)
#define BENDS_ROUGH RMIN_R(0.04)
/* Share of it below which the next step is doubled: a doubled one bends four times as much. */
#define STRAIGHT RMIN_R(0.15)
/* Halley's iterations, and the relative change after which the next would be nothing. */
#define ITERATIONS 32
#define CLOSE RMIN_R(0.01)

typedef struct {
    const rmin_impact *impact;
    const rmin_phase *phase;
    rmin_real speed;
    rmin_real scale; /* of forces, N */
    int level;
    int ticks; /* of the shortest step, until the phase is over */
    rmin_real time;
    rmin_real drifted; /* by the motors, m */
    rmin_real amplitude[RMIN_MODES], rate[RMIN_MODES];
    bool touching;
    int past; /* steps since the touch */
    rmin_real h, x; /* last step, contact point */
    rmin_real f, rise; /* force, and by how much it grew in the last step */
    rmin_real u, u_before, root; /* deformation of the skin; root of its depth */
    rmin_real rest; /* deflection of the body out of contact */
} state;

/* A step on trial. */
typedef struct {
    rmin_real amplitude[RMIN_MODES], rate[RMIN_MODES];
    rmin_real x, v; /* of the contact point without the force at the end */
    rmin_real f, bend, base, share; /* force at the end; how it bends on the way */
    rmin_real u, root;
} trial;

/* A servo's damping over a time, to second order: rate -= time S'DS (rate - what it is led by). */
static void damp(const rmin_phase *phase, rmin_real speed, rmin_real time, rmin_real *rate)
{
    rmin_real halfway[RMIN_MODES];
    for (int round = 0; round < 2; ++round) {
        const rmin_real span = round == 0 ? RMIN_R(0.5)*time : time;
        const rmin_real *const from = round == 0 ? rate : halfway;
        rmin_real torque[RMIN_N];
        for (int j = 0; j < RMIN_N; ++j) {
            const rmin_real *const shape = phase->modes.shape[RMIN_SYSTEM - RMIN_N + j];
            rmin_real turned = RMIN_R(0.0);
            for (int i = 0; i < phase->active; ++i) {
                turned += shape[i]*(from[i] - speed*phase->modes.start[i]);
            }
            torque[j] = span*phase->damping[j]*turned;
        }
        for (int i = 0; i < phase->active; ++i) {
            rmin_real change = RMIN_R(0.0);
            for (int j = 0; j < RMIN_N; ++j) {
                change += phase->modes.shape[RMIN_SYSTEM - RMIN_N + j][i]*torque[j];
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
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = &phase->level[s->level];
    const rmin_real *rate = s->rate;
    rmin_real damped[RMIN_MODES];
    if (phase->damped) {
        for (int i = 0; i < phase->active; ++i) {
            damped[i] = s->rate[i];
        }
        damp(phase, s->speed, RMIN_R(0.5)*level->h, damped);
        rate = damped;
    }
    const rmin_real drift = phase->drift*s->speed;
    rmin_real x = s->drifted + drift*level->h;
    rmin_real v = drift;
    for (int i = 0; i < phase->active; ++i) {
        const rmin_mode_step *const step = &level->mode[i];
        const rmin_real a = s->amplitude[i];
        const rmin_real b = rate[i];
        t->amplitude[i] = step->cosine*a + step->sine*b;
        t->rate[i] = step->back*a + step->cosine*b;
        x += phase->modes.row[i]*t->amplitude[i];
        v += phase->modes.row[i]*t->rate[i];
    }
    t->x = x;
    t->v = v;
}

/* The root of u^2 + cubic u^3 = depth > 0. */
static rmin_real root_of(rmin_real depth, rmin_real cubic, rmin_real guess)
{
    rmin_real u = guess;
    if (!(u > RMIN_R(0.0))) {
        const rmin_real light = RMIN_SQRT(depth);
        u = light/RMIN_SQRT(RMIN_SQRT(RMIN_R(1.0) + cubic*light));
    }
    for (int i = 0; i < ITERATIONS; ++i) {
        const rmin_real bend = RMIN_R(1.0) + RMIN_R(3.0)*cubic*u;
        const rmin_real slope = u*(RMIN_R(1.0) + bend);
        const rmin_real over = u*u*(RMIN_R(1.0) + cubic*u) - depth;
        const rmin_real change = over*slope/(slope*slope - over*bend);
        u -= change;
        if (RMIN_FABS(change) <= CLOSE*u) {
            break;
        }
    }
    return u;
}

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
static void press(const state *s, trial *t)
{
    const rmin_impact *const impact = s->impact;
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = &phase->level[s->level];
    const rmin_real one = RMIN_R(1.0);
    const rmin_real h = level->h;
    rmin_real lag = one/h; /* backward difference: u' = lag u + memory */
    rmin_real memory = -s->u/h;
    t->share = RMIN_R(0.0);
    t->base = RMIN_R(0.0);
    if (s->past > 0) {
        const rmin_real ratio = h/s->h;
        t->share = ratio/(one + ratio)/RMIN_R(6.0);
        t->base = t->share*(s->f + ratio*s->rise);
        lag = (one + ratio + ratio)/((one + ratio)*h);
        memory = (ratio*ratio/(one + ratio)*s->u_before - (one + ratio)*s->u)/h;
    }
    const rmin_real first = s->f + t->base;
    const rmin_real x = t->x - level->push[0]*first - level->push[1]*t->base;
    const rmin_real v = t->v - level->kick[0]*first - level->kick[1]*t->base;
    const rmin_real yields = (one - t->share)*level->push[1] - t->share*level->push[0];
    const rmin_real slows = (one - t->share)*level->kick[1] - t->share*level->kick[0];
    const rmin_real hold = impact->stiffness + impact->damping*lag;
    const rmin_real pressed = impact->stiffness*x + impact->damping*(v - memory);
    const rmin_real soft =
        one + impact->stiffness*yields + impact->damping*slows + hold*phase->compliance;
    t->f = RMIN_R(0.0);
    t->u = RMIN_R(0.0);
    t->root = RMIN_R(0.0);
    if (pressed > RMIN_R(0.0)) {
        t->root = root_of(pressed/hold, impact->skin*soft/hold, s->root);
        t->f = impact->skin*t->root*t->root*t->root;
        t->u = t->root*t->root + phase->compliance*t->f;
    }
    t->x = x - yields*t->f;
    t->bend = RMIN_R(6.0)*(t->share*(t->f - s->f) - (t->base - t->share*s->f));
}

/* Takes the step: forces that are linear over it, with the mean of what the bend adds. */
static void take(const trial *t, state *s)
{
    const rmin_phase *const phase = s->phase;
    const rmin_level *const level = &phase->level[s->level];
    const rmin_real first = s->f + t->base - t->share*t->f;
    const rmin_real last = t->base + (RMIN_R(1.0) - t->share)*t->f;
    for (int i = 0; i < phase->active; ++i) {
        const rmin_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push[0]*first - step->push[1]*last;
        s->rate[i] = t->rate[i] - step->kick[0]*first - step->kick[1]*last;
    }
}

/* Advances the clock, and lengthens the next step where it may. */
static void tick(state *s, bool longer)
{
    const rmin_level *const level = &s->phase->level[s->level];
    s->h = level->h;
    s->time += level->h;
    s->drifted += s->phase->drift*s->speed*level->h;
    s->ticks -= 1 << (RMIN_LEVELS - 1 - s->level);
    if (longer && s->level > 0 && s->ticks % (1 << (RMIN_LEVELS - s->level)) == 0) {
        --s->level;
    }
}

/* Notes a top of the parabola through the last three forces. */
static void see(const state *s, rmin_real f, rmin_real h, rmin_peak *peak)
{
    rmin_real force = f;
    rmin_real time = s->time + h;
    if (s->past > 0 && s->rise >= RMIN_R(0.0) && f < s->f) {
        const rmin_real before = s->rise/s->h;
        const rmin_real after = (f - s->f)/h;
        const rmin_real bend = (after - before)/(h + s->h);
        const rmin_real slope = before + bend*s->h;
        force = s->f - RMIN_R(0.25)*slope*slope/bend;
        time = s->time - RMIN_R(0.5)*slope/bend;
    }
    if (force > peak->force) {
        peak->force = force;
        peak->time = time;
        peak->contact = peak->contacts;
    }
}

/* A step in contact; false if it must be shorter. */
static bool step_pressed(state *s, trial *t, rmin_real bends, rmin_peak *peak)
{
    press(s, t);
    const rmin_real size = RMIN_FMAX(s->scale, peak->force);
    const rmin_real bent = RMIN_FABS(t->bend);
    if (s->level < RMIN_LEVELS - 1 && !(bent <= bends*size)) {
        ++s->level;
        return false;
    }
    const rmin_level *const level = &s->phase->level[s->level];
    take(t, s);
    see(s, t->f, level->h, peak);
    const rmin_real rest = (s->x - s->u)*level->relax;
    s->rise = t->f - s->f;
    s->f = t->f;
    s->u_before = s->u;
    s->u = t->u;
    s->root = t->root;
    s->x = t->x;
    ++s->past;
    if (!(t->f > RMIN_R(0.0))) {
        s->touching = false;
        s->rest = RMIN_FMAX(s->x, rest);
    }
    tick(s, bent <= STRAIGHT*bends*size && s->past > 1);
    return true;
}

/* A step out of contact; false if it must be shorter, or is one in contact. */
static bool step_apart(state *s, trial *t, rmin_peak *peak)
{
    const rmin_level *const level = &s->phase->level[s->level];
    const rmin_real rest = s->rest*level->relax;
    if (t->x > rest) {
        if (s->level < RMIN_LEVELS - 1) {
            ++s->level;
            return false;
        }
        s->touching = true;
        s->past = 0;
        s->u = s->x - s->rest;
        s->f = RMIN_R(0.0);
        s->rise = RMIN_R(0.0);
        s->root = RMIN_R(0.0);
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
static void coordinates_of(const state *s, rmin_real *place, rmin_real *rate)
{
    const rmin_modes *const modes = &s->phase->modes;
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        place[j] = RMIN_R(0.0);
        rate[j] = RMIN_R(0.0);
        for (int i = 0; i < s->phase->active; ++i) {
            const rmin_real led = modes->start[i]*s->speed;
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
    const rmin_impact *const impact = s->impact;
    const rmin_phase *const next = &impact->phase[1];
    const rmin_modes *const modes = &next->modes;
    rmin_real place[RMIN_SYSTEM];
    rmin_real rate[RMIN_SYSTEM];
    rmin_real a[RMIN_MODES];
    rmin_real b[RMIN_MODES];
    coordinates_of(s, place, rate);
#if RMIN_STRUCTURED
    rmin_real x = s->speed*s->time;
    rmin_real v = s->speed;
    for (int j = 0; j < RMIN_N; ++j) {
        const rmin_real row = impact->arrival.row[j];
        x += row*place[j] - impact->carried[j]*(place[j] - place[RMIN_N + j]);
        v += row*rate[j] - impact->carried[j]*(rate[j] - rate[RMIN_N + j]);
        place[j] = impact->springs[j]*(place[j] - place[RMIN_N + j]);
        rate[j] = impact->springs[j]*(rate[j] - rate[RMIN_N + j]);
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
    for (int i = 1; i < next->active; ++i) {
        a[i] = RMIN_R(0.0);
        b[i] = RMIN_R(0.0);
        for (int j = 0; j < RMIN_N; ++j) {
            a[i] += modes->shape[j][i]*place[j];
            b[i] += modes->shape[j][i]*rate[j];
        }
        if (modes->squared[i] > RMIN_R(0.0)) {
            a[i] /= modes->squared[i];
            b[i] /= modes->squared[i];
        }
    }
#else
    rmin_real momentum[RMIN_SYSTEM];
    rmin_real carry[RMIN_SYSTEM];
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        const rmin_real before = s->speed*impact->arrival.rates[j % RMIN_N];
        place[j] += before*s->time;
        rate[j] += before;
    }
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        momentum[j] = RMIN_R(0.0);
        carry[j] = RMIN_R(0.0);
        if (j < RMIN_N) {
            for (int k = 0; k < RMIN_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*rate[k];
                carry[j] += impact->arrival.links.M[j][k]*place[k];
            }
        }
#if RMIN_ELASTIC
        if (j >= RMIN_N) {
            momentum[j] = impact->rotors[j - RMIN_N]*rate[j];
            carry[j] = impact->rotors[j - RMIN_N]*place[j];
        }
#endif
    }
    for (int i = 0; i < next->active; ++i) {
        a[i] = RMIN_R(0.0);
        b[i] = RMIN_R(0.0);
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
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
    const rmin_real h = s->phase->level[s->level].h;
    s->phase = next;
    s->drifted = RMIN_R(0.0);
    s->level = 0;
    for (int k = 0; k < RMIN_LEVELS - 1; ++k) { /* the longest step that is no longer than the last */
        s->level = next->level[k].h > RMIN_R(1.01)*h ? k + 1 : s->level;
    }
    s->ticks = next->steps*(1 << (RMIN_LEVELS - 1));
}

static void start(const rmin_impact *impact, rmin_real speed, state *s)
{
    const rmin_phase *const phase = &impact->phase[0];
    const rmin_real zero = RMIN_R(0.0);
    s->impact = impact;
    s->phase = phase;
    s->speed = speed;
    s->scale = impact->scale;
    s->level = RMIN_LEVELS - 1;
    s->ticks = phase->steps*(1 << (RMIN_LEVELS - 1));
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

void rmin_impact_run(const rmin_impact *impact, rmin_real speed, rmin_budget *budget,
    rmin_peak *peak)
{
    const rmin_real bends = impact->smooth*(budget->rough ? BENDS_ROUGH : BENDS);
    state s;
    trial t;
    start(impact, speed, &s);
    peak->force = RMIN_R(0.0);
    peak->time = RMIN_R(0.0);
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
                damp(s.phase, speed, RMIN_R(0.5)*s.h, s.rate);
            }
            if (peak->force > budget->stop_above && s.f < peak->force) {
                peak->ended = true;
                return;
            }
        }
    }
    peak->ended = true;
}
