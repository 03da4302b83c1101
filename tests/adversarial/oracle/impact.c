/* SPDX-License-Identifier: BSD-3-Clause */
/* Impacts over time, step by step. */
#include "oracle.h"

static prepared led_steps, loose_steps; /* one at a time in a process */

/* What a force now + t by time + t^2 by square adds at the end of a step. */
static double effect(const response *r, const response *by)
{
    return r->one*by->one + r->time*by->time + r->square*by->square;
}

/* Notes a force, and the top before it: no more above the nodes than steps bend, or it is a corner. */
static void see(const impact *p, state *s, double f, double h, double bends)
{
    double top = f;
    if (s->past > 0 && s->now >= s->before && f < s->now) {
        const double up = (s->now - s->before)/s->h;
        const double bend = ((f - s->now)/h - up)/(h + s->h);
        const double slope = up + bend*s->h;
        top = s->now + fmin(-0.25*slope*slope/bend, bends);
    }
    const double until = s->time + h;
    if (until <= p->counts*(1.0 + 1e-6)) {
        s->peak = fmax(s->peak, top);
    }
    if (until >= p->late) {
        s->late = fmax(s->late, s->time >= p->late ? top : f);
    }
}

/*
 * Whether the damper follows the skin within a step, so that d' may be a backward difference and its
 * force c s' = c (x - b - d)' is that of the step's end.
 */
static int is_quick(const impact *p, double depth, double h)
{
    return p->damping > 0.0 && h*(p->stiffness + stiffness_at(p, depth)) > p->damping;
}

/* d' = lag d + memory at a step's end; of second order, but in first steps in contact and at corners of laws. */
static void rate_of_depth(const impact *p, const state *s, double h, double *lag, double *memory)
{
    const double ratio = s->past > 0 ? h/s->h : 1.0;
    *lag = 1.0/h;
    *memory = -s->depth/h;
    if (s->past > 1 && !(p->points > 0 && s->at == 0)) {
        *lag = (1.0 + 2.0*ratio)/((1.0 + ratio)*h);
        *memory = (ratio*ratio/(1.0 + ratio)*s->shallow - (1.0 + ratio)*s->depth)/h;
    }
}

/*
 * How long robot and body stay apart, whatever vibrates: nothing adds to its energy, so that row z' is at most
 * |row| times the root of twice that, and rounding.
 */
static double apart(const prepared *linear, const robot *of, double speed, const state *s)
{
    const long m = linear->size;
    double gap = speed*s->time - s->body;
    double twice = 0.0;
    double row = 0.0;
    for (long i = 0; i < m; ++i) {
        const double rate = linear->rate*s->z[m + i];
        double held = 0.0;
        double size = 0.0;
        for (long j = 0; j < m; ++j) {
            const double pull = of->stiffness[i*of->stride + j]*s->z[j];
            held += pull;
            size += fabs(pull);
        }
        gap += linear->row[i]*s->z[i];
        twice += rate*rate + s->z[i]*held + 1e-14*fabs(s->z[i])*size;
        row += linear->row[i]*linear->row[i];
    }
    const double closing = speed - s->speed + sqrt(row*fmax(twice, 0.0));
    return -gap/fmax(closing, 1e-300);
}

/* A step, or none if it must be shorter. */
static void step(const impact *p, const prepared *linear, double speed, state *s)
{
    const level *const l = &linear->level[s->at];
    const double h = l->h;
    const double ratio = s->past > 0 ? h/s->h : 1.0;
    const long n = linear->states;
    const long m = linear->size;
    double z[STATES];
    for (long i = 0; i < n; ++i) {
        z[i] = linear->pulled ? speed*(s->time*l->pull_one[i] + l->pull_time[i]) : 0.0;
    }
    apply(n, l->turn, s->z, z);
    double gap = speed*(s->time + h) - s->body - h*s->speed;
    double closing = speed - s->speed;
    for (long i = 0; i < m; ++i) {
        gap += linear->row[i]*z[i];
        closing += linear->row[i]*linear->rate*z[m + i];
    }
    /* force over the step: known + f share */
    response known = {s->now, -s->now/h, 0.0};
    response share = {0.0, 1.0/h, 0.0};
    if (s->past > 1) { /* (base + bend f) t (t - h) more */
        const double bend = 1.0/(h*(h + s->h));
        const double base = -(s->now/h + (s->now - s->before)/s->h)/(h + s->h);
        known.time -= base*h;
        known.square = base;
        share.time -= bend*h;
        share.square = bend;
    }
    gap += effect(&l->gap, &known);
    closing += effect(&l->closing, &known);
    const double yields = -effect(&l->gap, &share);
    double open = gap - l->fade*s->bent - effect(&l->bent, &known);
    double soft = yields + effect(&l->bent, &share);
    double depth = depth_of(p, open, soft, s->depth);
    const int quick = is_quick(p, s->past > 1 ? s->depth : depth, h);
    if (quick) {
        double lag;
        double memory;
        rate_of_depth(p, s, h, &lag, &memory);
        const double hold = p->stiffness + p->damping*lag;
        const double slows = -effect(&l->closing, &share);
        open = (p->stiffness*gap + p->damping*(closing - memory))/hold;
        soft = (1.0 + p->stiffness*yields + p->damping*slows)/hold;
        depth = depth_of(p, open, soft, s->depth);
    }
    const double f = force_at(p, depth);
    const double straight = s->past > 0 ? s->now + (s->now - s->before)*ratio : s->now;
    const double off = fabs(f - straight)*(s->past > 0 ? ratio/(1.0 + ratio) : 0.5);
    const double size = p->tolerance*fmax(p->scale, s->peak);
    ++s->steps;
    if (s->at > 0 && !(off <= size && soft > 0.0)) {
        --s->at;
        return;
    }
    see(p, s, f, h, size);
    const response by = {known.one, known.time + f*share.time, known.square + f*share.square};
    for (long i = 0; i < n; ++i) {
        s->z[i] = z[i] + by.one*l->one[i] + by.time*l->time[i] + by.square*l->square[i];
    }
    s->body += h*s->speed + effect(&l->body, &by);
    s->speed += effect(&l->speed, &by);
    s->bent = quick && f > 0.0 ? gap - yields*f - depth
        : l->fade*s->bent + effect(&l->bent, &by);
    s->past = f > 0.0 || s->now > 0.0 ? s->past + 1 : 0;
    s->before = s->now;
    s->now = f;
    s->shallow = s->depth;
    s->depth = depth;
    s->h = h;
    s->time += h;
    if (8.0*off <= size) {
        ++s->at;
    }
}

/* A step on which they stay apart. */
static void fly(const prepared *linear, long at, state *s)
{
    const level *const l = &linear->level[at];
    double z[STATES] = {0};
    apply(linear->states, l->turn, s->z, z);
    memcpy(s->z, z, sizeof(double)*(size_t)linear->states);
    s->body += l->h*s->speed;
    s->bent *= l->fade;
    s->h = l->h;
    s->time += l->h;
    s->past = 0;
    s->before = 0.0;
    s->shallow = 0.0;
    s->depth = 0.0;
    ++s->steps;
}

static void run(const impact *p, const robot *of, const prepared *linear, double speed, double until, state *s)
{
    s->at = 0;
    for (;;) {
        const double left = until - s->time;
        if (s->at >= linear->pressed) {
            s->at = linear->pressed - 1;
        }
        if (p->flies && s->time > 0.0 && !(s->now > 0.0)) {
            const double most = fmin(apart(linear, of, speed, s), left);
            long at = linear->levels - 1;
            while (at >= linear->pressed && linear->level[at].h > most) {
                --at;
            }
            if (at >= linear->pressed) {
                fly(linear, at, s);
                continue;
            }
        }
        while (s->at > 0 && linear->level[s->at].h > left) {
            --s->at;
        }
        if (linear->level[s->at].h > left*(1.0 + 1e-6)) {
            return;
        }
        step(p, linear, speed, s);
    }
}

static void release(const impact *p, state *s)
{
    double z[STATES] = {0};
    const long from = p->led.size;
    for (long i = 0; i < from; ++i) {
        z[i] = s->z[i];
        z[p->loose.size + i] = s->z[from + i]*led_steps.rate/loose_steps.rate;
    }
    memcpy(s->z, z, sizeof z);
    s->past = s->past > 1 ? 1 : s->past; /* the force's bend jumps */
}

/* Integrates an impact at one speed. */
static long follow(const impact *p, double speed, int led, double *peak, double *late)
{
    state s;
    memset(&s, 0, sizeof s);
    if (led) {
        run(p, &p->led, &led_steps, speed, fmin(p->release, p->horizon), &s);
        if (p->release < p->horizon) {
            release(p, &s);
        }
    }
    if (!led || p->release < p->horizon) {
        run(p, &p->loose, &loose_steps, speed, p->horizon, &s);
    }
    *peak = fmax(*peak, s.peak);
    *late = fmax(*late, s.late);
    return s.steps;
}

long largest_forces(long count, const impact *p, long speeds, const double *speed, double *out, double *late)
{
    long steps = 0;
    for (long k = 0; k < count; ++k) {
        const int alone = (p[k].runs & LOOSE_ALONE) != 0;
        const int led = (p[k].runs & LED_FIRST) != 0;
        if (led) {
            prepare(&p[k], &p[k].led, &led_steps);
        }
        if (alone || p[k].release < p[k].horizon) {
            prepare(&p[k], &p[k].loose, &loose_steps);
        }
        for (long i = k*speeds; i < (k + 1)*speeds; ++i) {
            out[i] = 0.0;
            late[i] = 0.0;
            steps += alone ? follow(&p[k], speed[i], 0, &out[i], &late[i]) : 0;
            steps += led ? follow(&p[k], speed[i], 1, &out[i], &late[i]) : 0;
        }
    }
    return steps;
}
