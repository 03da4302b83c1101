/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of ur5e_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f = k_f d^1.5 = k_h s + c_h s' with s = x - u, where x is how far the
 * contact point has come and u = d + (compliance of modes that stand) f. x' is exact at every node and u'
 * a backward difference, so that no damping makes it unstable. The force is quadratic between nodes;
 * steps are halved where it bends too much for that.
 */
#include "ur5e_impact.h"

/* Half the second difference of the force, over its size, above which a step is halved. */
#define BENDS UR5E_R(0.005)
#define BENDS_ROUGH UR5E_R(0.04)
/* Share of it below which the next step is doubled: a doubled one bends four times as much. */
#define STRAIGHT UR5E_R(0.15)
/* Halley's iterations, and the relative change after which the next would be nothing. */
#define ITERATIONS 32
#define CLOSE UR5E_R(0.01)

typedef struct {
    const ur5e_impact *impact;
    const ur5e_phase *phase;
    ur5e_real speed;
    ur5e_real scale; /* of forces, N */
    int level;
    int ticks; /* of the shortest step, until the phase is over */
    ur5e_real time;
    ur5e_real drifted; /* by the motors, m */
    ur5e_real amplitude[UR5E_MODES], rate[UR5E_MODES];
    bool touching;
    int past; /* steps since the touch */
    ur5e_real h, x; /* last step, contact point */
    ur5e_real f, rise; /* force, and by how much it grew in the last step */
    ur5e_real u, u_before, root; /* deformation of the skin; root of its depth */
    ur5e_real rest; /* deflection of the body out of contact */
} state;

/* A step on trial. */
typedef struct {
    ur5e_real amplitude[UR5E_MODES], rate[UR5E_MODES];
    ur5e_real x, v; /* of the contact point without the force at the end */
    ur5e_real f, bend, base, share; /* force at the end; how it bends on the way */
    ur5e_real u, root;
} trial;

/* A servo's damping over a time, to second order: rate -= time S'DS (rate - what it is led by). */
static void damp(const ur5e_phase *phase, ur5e_real speed, ur5e_real time, ur5e_real *rate)
{
    ur5e_real halfway[UR5E_MODES];
    for (int round = 0; round < 2; ++round) {
        const ur5e_real span = round == 0 ? UR5E_R(0.5)*time : time;
        const ur5e_real *const from = round == 0 ? rate : halfway;
        ur5e_real torque[UR5E_N];
        for (int j = 0; j < UR5E_N; ++j) {
            const ur5e_real *const shape = phase->modes.shape[UR5E_SYSTEM - UR5E_N + j];
            ur5e_real turned = UR5E_R(0.0);
            for (int i = 0; i < phase->active; ++i) {
                turned += shape[i]*(from[i] - speed*phase->modes.start[i]);
            }
            torque[j] = span*phase->damping[j]*turned;
        }
        for (int i = 0; i < phase->active; ++i) {
            ur5e_real change = UR5E_R(0.0);
            for (int j = 0; j < UR5E_N; ++j) {
                change += phase->modes.shape[UR5E_SYSTEM - UR5E_N + j][i]*torque[j];
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
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = &phase->level[s->level];
    const ur5e_real *rate = s->rate;
    ur5e_real damped[UR5E_MODES];
    if (phase->damped) {
        for (int i = 0; i < phase->active; ++i) {
            damped[i] = s->rate[i];
        }
        damp(phase, s->speed, UR5E_R(0.5)*level->h, damped);
        rate = damped;
    }
    const ur5e_real drift = phase->drift*s->speed;
    ur5e_real x = s->drifted + drift*level->h;
    ur5e_real v = drift;
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_mode_step *const step = &level->mode[i];
        const ur5e_real a = s->amplitude[i];
        const ur5e_real b = rate[i];
        t->amplitude[i] = step->cosine*a + step->sine*b;
        t->rate[i] = step->back*a + step->cosine*b;
        x += phase->modes.row[i]*t->amplitude[i];
        v += phase->modes.row[i]*t->rate[i];
    }
    t->x = x;
    t->v = v;
}

/* The root of u^2 + cubic u^3 = depth > 0. */
static ur5e_real root_of(ur5e_real depth, ur5e_real cubic, ur5e_real guess)
{
    ur5e_real u = guess;
    if (!(u > UR5E_R(0.0))) {
        const ur5e_real light = UR5E_SQRT(depth);
        u = light/UR5E_SQRT(UR5E_SQRT(UR5E_R(1.0) + cubic*light));
    }
    for (int i = 0; i < ITERATIONS; ++i) {
        const ur5e_real bend = UR5E_R(1.0) + UR5E_R(3.0)*cubic*u;
        const ur5e_real slope = u*(UR5E_R(1.0) + bend);
        const ur5e_real over = u*u*(UR5E_R(1.0) + cubic*u) - depth;
        const ur5e_real change = over*slope/(slope*slope - over*bend);
        u -= change;
        if (UR5E_FABS(change) <= CLOSE*u) {
            break;
        }
    }
    return u;
}

/* Finds the force at the end of a step in contact; 0 where robot and body part. */
static void press(const state *s, trial *t)
{
    const ur5e_impact *const impact = s->impact;
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = &phase->level[s->level];
    const ur5e_real one = UR5E_R(1.0);
    const ur5e_real h = level->h;
    ur5e_real lag = one/h; /* backward difference: u' = lag u + memory */
    ur5e_real memory = -s->u/h;
    t->share = UR5E_R(0.0);
    t->base = UR5E_R(0.0);
    if (s->past > 0) {
        const ur5e_real ratio = h/s->h;
        t->share = ratio/(one + ratio)/UR5E_R(6.0);
        t->base = t->share*(s->f + ratio*s->rise);
        lag = (one + ratio + ratio)/((one + ratio)*h);
        memory = (ratio*ratio/(one + ratio)*s->u_before - (one + ratio)*s->u)/h;
    }
    const ur5e_real first = s->f + t->base;
    const ur5e_real x = t->x - level->push[0]*first - level->push[1]*t->base;
    const ur5e_real v = t->v - level->kick[0]*first - level->kick[1]*t->base;
    const ur5e_real yields = (one - t->share)*level->push[1] - t->share*level->push[0];
    const ur5e_real slows = (one - t->share)*level->kick[1] - t->share*level->kick[0];
    const ur5e_real hold = impact->stiffness + impact->damping*lag;
    const ur5e_real pressed = impact->stiffness*x + impact->damping*(v - memory);
    const ur5e_real soft =
        one + impact->stiffness*yields + impact->damping*slows + hold*phase->compliance;
    t->f = UR5E_R(0.0);
    t->u = UR5E_R(0.0);
    t->root = UR5E_R(0.0);
    if (pressed > UR5E_R(0.0)) {
        t->root = root_of(pressed/hold, impact->skin*soft/hold, s->root);
        t->f = impact->skin*t->root*t->root*t->root;
        t->u = t->root*t->root + phase->compliance*t->f;
    }
    t->x = x - yields*t->f;
    t->bend = UR5E_R(6.0)*(t->share*(t->f - s->f) - (t->base - t->share*s->f));
}

/* Takes the step: forces that are linear over it, with the mean of what the bend adds. */
static void take(const trial *t, state *s)
{
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = &phase->level[s->level];
    const ur5e_real first = s->f + t->base - t->share*t->f;
    const ur5e_real last = t->base + (UR5E_R(1.0) - t->share)*t->f;
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push[0]*first - step->push[1]*last;
        s->rate[i] = t->rate[i] - step->kick[0]*first - step->kick[1]*last;
    }
}

/* Advances the clock, and lengthens the next step where it may. */
static void tick(state *s, bool longer)
{
    const ur5e_level *const level = &s->phase->level[s->level];
    s->h = level->h;
    s->time += level->h;
    s->drifted += s->phase->drift*s->speed*level->h;
    s->ticks -= 1 << (UR5E_LEVELS - 1 - s->level);
    if (longer && s->level > 0 && s->ticks % (1 << (UR5E_LEVELS - s->level)) == 0) {
        --s->level;
    }
}

/* Notes a top of the parabola through the last three forces. */
static void see(const state *s, ur5e_real f, ur5e_real h, ur5e_peak *peak)
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
static bool step_pressed(state *s, trial *t, ur5e_real bends, ur5e_peak *peak)
{
    press(s, t);
    const ur5e_real size = UR5E_FMAX(s->scale, peak->force);
    const ur5e_real bent = UR5E_FABS(t->bend);
    if (s->level < UR5E_LEVELS - 1 && !(bent <= bends*size)) {
        ++s->level;
        return false;
    }
    const ur5e_level *const level = &s->phase->level[s->level];
    take(t, s);
    see(s, t->f, level->h, peak);
    const ur5e_real rest = (s->x - s->u)*level->relax;
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
static bool step_apart(state *s, trial *t, ur5e_peak *peak)
{
    const ur5e_level *const level = &s->phase->level[s->level];
    const ur5e_real rest = s->rest*level->relax;
    if (t->x > rest) {
        if (s->level < UR5E_LEVELS - 1) {
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

/* Displacements and velocities over links and motors beside the motion before, from a phase's modes. */
static void coordinates_of(const state *s, ur5e_real *place, ur5e_real *rate)
{
    const ur5e_modes *const modes = &s->phase->modes;
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        place[j] = UR5E_R(0.0);
        rate[j] = UR5E_R(0.0);
        for (int i = 0; i < s->phase->active; ++i) {
            const ur5e_real led = modes->start[i]*s->speed;
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
    const ur5e_impact *const impact = s->impact;
    const ur5e_phase *const next = &impact->phase[1];
    const ur5e_modes *const modes = &next->modes;
    ur5e_real place[UR5E_SYSTEM];
    ur5e_real rate[UR5E_SYSTEM];
    ur5e_real a[UR5E_MODES];
    ur5e_real b[UR5E_MODES];
    coordinates_of(s, place, rate);
#if UR5E_STRUCTURED
    ur5e_real x = s->speed*s->time;
    ur5e_real v = s->speed;
    for (int j = 0; j < UR5E_N; ++j) {
        const ur5e_real row = impact->arrival.row[j];
        x += row*place[j] - impact->carried[j]*(place[j] - place[UR5E_N + j]);
        v += row*rate[j] - impact->carried[j]*(rate[j] - rate[UR5E_N + j]);
        place[j] = impact->springs[j]*(place[j] - place[UR5E_N + j]);
        rate[j] = impact->springs[j]*(rate[j] - rate[UR5E_N + j]);
    }
    a[0] = x/modes->row[0];
    b[0] = v/modes->row[0];
    for (int i = 1; i < next->active; ++i) {
        a[i] = UR5E_R(0.0);
        b[i] = UR5E_R(0.0);
        for (int j = 0; j < UR5E_N; ++j) {
            a[i] += modes->shape[j][i]*place[j];
            b[i] += modes->shape[j][i]*rate[j];
        }
        if (modes->squared[i] > UR5E_R(0.0)) {
            a[i] /= modes->squared[i];
            b[i] /= modes->squared[i];
        }
    }
#else
    ur5e_real momentum[UR5E_SYSTEM];
    ur5e_real carry[UR5E_SYSTEM];
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        const ur5e_real before = s->speed*impact->arrival.rates[j % UR5E_N];
        place[j] += before*s->time;
        rate[j] += before;
    }
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        momentum[j] = UR5E_R(0.0);
        carry[j] = UR5E_R(0.0);
        if (j < UR5E_N) {
            for (int k = 0; k < UR5E_N; ++k) {
                momentum[j] += impact->arrival.links.M[j][k]*rate[k];
                carry[j] += impact->arrival.links.M[j][k]*place[k];
            }
        }
#if UR5E_ELASTIC
        if (j >= UR5E_N) {
            momentum[j] = impact->rotors[j - UR5E_N]*rate[j];
            carry[j] = impact->rotors[j - UR5E_N]*place[j];
        }
#endif
    }
    for (int i = 0; i < next->active; ++i) {
        a[i] = UR5E_R(0.0);
        b[i] = UR5E_R(0.0);
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
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
    const ur5e_real h = s->phase->level[s->level].h;
    s->phase = next;
    s->drifted = UR5E_R(0.0);
    s->level = 0;
    for (int k = 0; k < UR5E_LEVELS - 1; ++k) { /* the longest step that is no longer than the last */
        s->level = next->level[k].h > UR5E_R(1.01)*h ? k + 1 : s->level;
    }
    s->ticks = next->steps*(1 << (UR5E_LEVELS - 1));
}

static void start(const ur5e_impact *impact, ur5e_real speed, state *s)
{
    const ur5e_phase *const phase = &impact->phase[0];
    const ur5e_real zero = UR5E_R(0.0);
    s->impact = impact;
    s->phase = phase;
    s->speed = speed;
    s->scale = impact->scale;
    s->level = UR5E_LEVELS - 1;
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
    s->x = zero;
    s->f = zero;
    s->rise = zero;
    s->u = zero;
    s->u_before = zero;
    s->root = zero;
    s->rest = zero;
}

void ur5e_impact_run(const ur5e_impact *impact, ur5e_real speed, ur5e_budget *budget,
    ur5e_peak *peak)
{
    const ur5e_real bends = impact->smooth*(budget->rough ? BENDS_ROUGH : BENDS);
    state s;
    trial t;
    start(impact, speed, &s);
    peak->force = UR5E_R(0.0);
    peak->time = UR5E_R(0.0);
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
                damp(s.phase, speed, UR5E_R(0.5)*s.h, s.rate);
            }
            if (peak->force > budget->stop_above && s.f < peak->force) {
                peak->ended = true;
                return;
            }
        }
    }
    peak->ended = true;
}
