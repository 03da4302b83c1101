/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The impact that panda_peak_force integrates, by a textbook Runge-Kutta method: the same chain
 * with free motors, the same contact law. The step follows the fastest rate there is: a mode of the
 * chain, or the node between skin and body, which is stiff.
 */
#include "rk4.h"

#include <math.h>

enum { MASSES = PANDA_CHAIN_ORDER, NODE = 2 * MASSES, BODY, STATES = BODY + 2 };
enum { TRIALS = 16, STEPS = 1000000 };

typedef struct {
    panda_chain_t chain;
    panda_region body;
    double fastest; /* no mode of the chain is faster, rad/s */
} impact;

static double contact_force(const impact *c, const double *x)
{
    const double skin = x[0] - x[NODE];
    return skin > 0 ? c->body.hertz_stiffness * skin * sqrt(skin) : 0;
}

/* x: positions and velocities of the masses, the node, the body's position and velocity. */
static void derivative(const impact *c, const double *x, double *rate)
{
    const double f = contact_force(c, x);
    double pull = -f;
    for (int i = 0; i < MASSES; i++) {
        const double next = i + 1 < MASSES ? c->chain.stiffness[i] * (x[i + 1] - x[i]) : 0;
        rate[i] = x[MASSES + i];
        rate[MASSES + i] = (pull + next) / c->chain.mass[i];
        pull = -next;
    }
    const double velocity = c->body.clamped ? 0 : x[BODY + 1];
    rate[NODE] = velocity + (f - c->body.stiffness * (x[NODE] - x[BODY])) / c->body.damping;
    rate[BODY] = velocity;
    rate[BODY + 1] = c->body.clamped ? 0 : f / c->body.effective_mass;
}

static void step(const impact *c, double *x, double h)
{
    static const double at[3] = {0.5, 0.5, 1}, weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
    double rate[STATES], moved[STATES], sum[STATES];
    derivative(c, x, rate);
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < STATES; i++) sum[i] = (k ? sum[i] : x[i]) + h * weight[k] * rate[i];
        if (k == 3) break;
        for (int i = 0; i < STATES; i++) moved[i] = x[i] + h * at[k] * rate[i];
        derivative(c, moved, rate);
    }
    for (int i = 0; i < STATES; i++) x[i] = sum[i];
}

/* The fastest rate at a depth of the skin, 1/s. */
static double rate(const impact *c, double skin)
{
    const double stiffness = c->body.stiffness + 1.5 * c->body.hertz_stiffness * sqrt(skin);
    return fmax(c->fastest, stiffness / c->body.damping);
}

static double peak(const impact *c, double speed, double share)
{
    double x[STATES] = {0}, highest = 0;
    for (int i = 0; i < MASSES; i++) x[MASSES + i] = speed;
    for (long k = 0; k < STEPS; k++) {
        double skin = fmax(x[0] - x[NODE], 0);
        skin += fmax(x[MASSES], 0) * share / rate(c, skin); /* at most, by the end of the step */
        step(c, x, share / rate(c, skin));
        const double f = contact_force(c, x);
        if (!(f > 0)) return highest;
        highest = fmax(highest, f);
    }
    return NAN;
}

static int prepare(const sample *s, impact *c)
{
    double squared = 0, before = 0;
    c->body = s->region;
    if (panda_chain(s->q, s->n, &s->p, &c->chain) != PANDA_OK) return 0;
    for (int i = 0; i < MASSES; i++) { /* Gershgorin's circles */
        const double after = i + 1 < MASSES ? c->chain.stiffness[i] : 0;
        squared = fmax(squared, 2 * (before + after) / c->chain.mass[i]);
        before = after;
    }
    c->fastest = sqrt(squared);
    return 1;
}

double rk4_peak_force(const sample *s, double share)
{
    impact c;
    return prepare(s, &c) ? peak(&c, s->speed, share) : NAN;
}

double rk4_safe_speed(const sample *s, double limit, double share)
{
    impact c;
    if (!prepare(s, &c)) return NAN;
    double speed = 0.8 * limit / sqrt(c.body.stiffness * c.chain.mass[0]);
    for (int trial = 0; trial < TRIALS; trial++) {
        const double f = peak(&c, speed, share);
        if (f <= RK4_KEPT * limit && f >= RK4_NEAR * limit) return speed;
        speed *= (RK4_KEPT + RK4_NEAR) / 2 * limit / f; /* forces grow about as fast as speed */
    }
    return NAN;
}
