/* SPDX-License-Identifier: 0BSD */
/*
 * One impact of ur5e_ over time: all contacts up to the horizon.
 *
 * Skin and body in series: f(d) = k_h s + c_h s' with s = x - u, where x is how far the contact point
 * has come, u = d + (compliance of modes that stand) f, and f(d) = k_f d^1.5 or a law of ur5e_law.c. x' is
 * exact at every node and u' a backward difference, so that no damping makes it unstable. The force is
 * quadratic between nodes; steps are halved where it bends too much for that.
 */
#include "ur5e_state.h"

/* Halley's iterations, and the relative change after which the next, a fourth of its cube, is nothing. */
#define ITERATIONS 8
#define CLOSE UR5E_R(0.03)
/* Steps of one length after which the next is as the last was. */
#define LIKE 3

void ur5e_damp(const ur5e_phase *phase, ur5e_real speed, ur5e_real time, ur5e_real *rate)
{
    const ur5e_modes *const modes = &phase->modes;
    ur5e_real turned[UR5E_DAMPERS];
    ur5e_real impulse[UR5E_DAMPERS]; /* of each damper, to first and then to second order */
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        turned[j] = UR5E_R(0.0);
    }
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_real *const shape = &modes->shape[i][UR5E_SYSTEM - UR5E_DAMPERS];
        const ur5e_real led = rate[i] - speed*modes->start[i];
        for (int j = 0; j < UR5E_DAMPERS; ++j) {
            turned[j] += shape[j]*led;
        }
    }
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        ur5e_real slowed = UR5E_R(0.0);
        for (int k = 0; k < UR5E_DAMPERS; ++k) {
            slowed += phase->together[j][k]*impulse[k];
        }
        turned[j] -= UR5E_R(0.5)*slowed;
    }
    for (int j = 0; j < UR5E_DAMPERS; ++j) {
        impulse[j] = time*phase->damping[j]*turned[j];
    }
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_real *const shape = &modes->shape[i][UR5E_SYSTEM - UR5E_DAMPERS];
        ur5e_real change = UR5E_R(0.0);
        for (int j = 0; j < UR5E_DAMPERS; ++j) {
            change += shape[j]*impulse[j];
        }
        rate[i] -= change;
    }
}

void ur5e_glide(const ur5e_state *s, ur5e_trial *t)
{
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    const ur5e_real *rate = s->rate;
    ur5e_real damped[UR5E_MODES];
    if (phase->damped) {
        for (int i = 0; i < phase->active; ++i) {
            damped[i] = s->rate[i];
        }
        ur5e_damp(phase, s->speed, s->owed + UR5E_R(0.5)*level->h, damped);
        rate = damped;
    }
    ur5e_real x = s->drifted + s->drift*level->h;
    ur5e_real v = s->drift;
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

/* What steps of one length have in common, as far as those before them were as long. */
static void set_pace(ur5e_state *s)
{
    const ur5e_region *const region = s->impact->region;
    const ur5e_level *const level = s->step;
    const ur5e_real one = UR5E_R(1.0);
    ur5e_pace *const pace = &s->pace;
    ur5e_real ratio = UR5E_R(0.0);
    ur5e_real more = one; /* of the bend at the last node is that halfway, less that of the one before */
    pace->before = UR5E_R(0.0);
    if (s->past > 0) {
        ratio = level->h/s->h;
        if (s->past > 1) {
            const ur5e_real lead = (UR5E_R(0.5)*level->h + s->h)/(level->h + s->h + s->h_before);
            more += lead;
            pace->before = lead*ratio*ratio;
        }
    }
    const ur5e_real rate = one/level->h;
    const ur5e_real early = ratio/(one + ratio);
    pace->ratio = ratio;
    pace->share = early/UR5E_R(6.0);
    pace->more = more;
    const ur5e_real lag = (one + early)*rate;
    pace->u = (one + ratio)*rate;
    pace->u_before = ratio*early*rate;
    const ur5e_real share = pace->share*more;
    pace->yields = (one - share)*level->push[1] - share*level->push[0];
    const ur5e_real slows = (one - share)*level->kick[1] - share*level->kick[0];
    pace->hold = region->stiffness + region->damping*lag;
    pace->soft = one + region->stiffness*pace->yields + region->damping*slows + pace->hold*s->phase->compliance;
}

void ur5e_press(ur5e_state *s, ur5e_trial *t)
{
    const ur5e_region *const region = s->impact->region;
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    const ur5e_pace *const pace = &s->pace;
    if (s->even < LIKE) {
        set_pace(s);
    }
    const ur5e_real plain = pace->share*(s->f + pace->ratio*s->rise);
    t->share = pace->more*pace->share;
    t->base = pace->more*plain - pace->before*s->bump;
    const ur5e_real first = s->f + t->base;
    const ur5e_real x = t->x - level->push[0]*first - level->push[1]*t->base;
    const ur5e_real v = t->v - level->kick[0]*first - level->kick[1]*t->base;
    const ur5e_real slip = v + pace->u*s->u - pace->u_before*s->u_before; /* less what u' gains by u */
    const ur5e_real pressed = region->stiffness*x + region->damping*slip;
    if (pressed > UR5E_R(0.0)) {
        if (region->law == NULL) {
            const ur5e_real per = UR5E_R(1.0)/pace->hold;
            const ur5e_real guess = s->root + pace->ratio*(s->root - s->root_before);
            t->root = root_of(pressed*per, region->hertz_stiffness*pace->soft*per, guess);
            t->depth = t->root*t->root;
            t->f = region->hertz_stiffness*t->root*t->depth;
        } else {
            t->root = UR5E_R(0.0);
            t->f = ur5e_law_press(region, pace->hold, pace->soft, pressed, &t->depth);
        }
        t->u = t->depth + phase->compliance*t->f;
        t->x = x - pace->yields*t->f;
        t->bump = plain - pace->share*t->f;
    } else { /* they part on the way: a force that falls evenly ends there */
        const ur5e_real from = pace->hold*s->now + pace->soft*s->f;
        t->base = from > UR5E_R(0.0) ? UR5E_R(0.5)*s->f*pressed/(from - pressed) : UR5E_R(0.0);
        t->share = UR5E_R(0.0);
        t->x -= level->push[0]*(s->f + t->base) + level->push[1]*t->base;
        t->bump = UR5E_R(0.0);
        t->f = UR5E_R(0.0);
        t->u = UR5E_R(0.0);
        t->root = UR5E_R(0.0);
        t->depth = UR5E_R(0.0);
    }
}

void ur5e_take(const ur5e_trial *t, ur5e_state *s)
{
    const ur5e_phase *const phase = s->phase;
    const ur5e_level *const level = s->step;
    const ur5e_real first = s->f + t->base - t->share*t->f;
    const ur5e_real last = t->base + (UR5E_R(1.0) - t->share)*t->f;
    for (int i = 0; i < phase->active; ++i) {
        const ur5e_mode_step *const step = &level->mode[i];
        s->amplitude[i] = t->amplitude[i] - step->push[0]*first - step->push[1]*last;
        s->rate[i] = t->rate[i] - step->kick[0]*first - step->kick[1]*last;
    }
}
