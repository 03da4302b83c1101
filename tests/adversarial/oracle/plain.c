/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Largest force of an impact on a robot with elastic joints, by Runge and Kutta's method in short steps:
 * links y and motors t as displacements from first touch, as they are written down, with neither modes nor
 * matrices' exponentials. The tests' own integrator, to compare packages with.
 */
#include <math.h>

#define MOST 24 /* joints */

enum { FREE = 1, DRIVEN = 2, SERVO = 3 };

typedef struct {
    int n, motors;
    const double *inverse; /* M^-1, n x n */
    const double *row, *rates, *springs, *rotors, *gains, *damping_gains;
    double speed, stiffness, damping, mass, skin; /* mass 0: clamped */
    double reaction, horizon, step;
} impact;

/* links, rates, motors, rates; way and velocity of the body; deflection of the body where damped */
typedef struct {
    double y[MOST], v[MOST], m[MOST], w[MOST], body, body_v, s;
} state;

static double force_of(const impact *p, const state *x)
{
    double depth = -x->body;
    for (int i = 0; i < p->n; ++i) {
        depth += p->row[i]*x->y[i];
    }
    if (p->damping > 0.0) {
        depth -= x->s;
        return depth > 0.0 ? p->skin*depth*sqrt(depth) : 0.0;
    }
    if (!(depth > 0.0)) {
        return 0.0;
    }
    double d = depth; /* k (depth - d) = skin d^1.5, from above */
    for (int i = 0; i < 60; ++i) {
        const double over = p->skin*d*sqrt(d) - p->stiffness*(depth - d);
        const double change = over/(1.5*p->skin*sqrt(d) + p->stiffness);
        d -= change;
        if (d < 1e-18) {
            d = 1e-18;
        }
        if (fabs(change) <= 1e-14*depth) {
            break;
        }
    }
    return p->stiffness*(depth - d);
}

static double slope_of(const impact *p, double time, const state *x, state *d)
{
    const double f = force_of(p, x);
    double torque[MOST];
    for (int i = 0; i < p->n; ++i) {
        const double led = p->speed*p->rates[i];
        const double spring = p->springs[i]*(x->y[i] - x->m[i]);
        torque[i] = -spring - p->row[i]*f;
        double drive = 0.0;
        if (p->motors == SERVO && time < p->reaction) {
            drive = p->gains[i]*(led*time - x->m[i]) + p->damping_gains[i]*(led - x->w[i]);
        }
        const int driven = p->motors == DRIVEN && time < p->reaction;
        d->w[i] = driven ? 0.0 : (spring + drive)/p->rotors[i];
        d->m[i] = x->w[i];
        d->y[i] = x->v[i];
    }
    for (int i = 0; i < p->n; ++i) {
        d->v[i] = 0.0;
        for (int j = 0; j < p->n; ++j) {
            d->v[i] += p->inverse[i*p->n + j]*torque[j];
        }
    }
    d->body = x->body_v;
    d->body_v = p->mass > 0.0 ? f/p->mass : 0.0;
    d->s = p->damping > 0.0 ? (f - p->stiffness*x->s)/p->damping : 0.0;
    return f;
}

static void add(int n, const state *x, const state *d, double h, state *out)
{
    for (int i = 0; i < n; ++i) {
        out->y[i] = x->y[i] + h*d->y[i];
        out->v[i] = x->v[i] + h*d->v[i];
        out->m[i] = x->m[i] + h*d->m[i];
        out->w[i] = x->w[i] + h*d->w[i];
    }
    out->body = x->body + h*d->body;
    out->body_v = x->body_v + h*d->body_v;
    out->s = x->s + h*d->s;
}

double largest_force(const impact *p);

double largest_force(const impact *p)
{
    state x = {0};
    for (int i = 0; i < p->n; ++i) {
        x.v[i] = p->speed*p->rates[i];
        x.w[i] = x.v[i];
    }
    double best = 0.0;
    double time = 0.0;
    for (int phase = 0; phase < 2; ++phase) {
        const double until = phase == 0 ? fmin(p->reaction, p->horizon) : p->horizon;
        const long steps = (long)ceil((until - time)/p->step);
        const double h = steps > 0 ? (until - time)/(double)steps : 0.0;
        const double start = time;
        /* in the second phase motors are released: the time only says so */
        const double shift = phase == 0 ? 0.0 : 1e-12;
        for (long k = 0; k < steps; ++k) {
            state a;
            state b;
            state c;
            state d;
            state y;
            time = start + (double)k*h;
            const double inside = phase == 0 ? 1.0 - 1e-9 : 1.0;
            const double f = slope_of(p, time*inside + shift, &x, &a);
            add(p->n, &x, &a, 0.5*h, &y);
            slope_of(p, (time + 0.5*h)*inside + shift, &y, &b);
            add(p->n, &x, &b, 0.5*h, &y);
            slope_of(p, (time + 0.5*h)*inside + shift, &y, &c);
            add(p->n, &x, &c, h, &y);
            slope_of(p, (time + h)*inside + shift, &y, &d);
            add(p->n, &x, &a, h/6.0, &x);
            add(p->n, &x, &b, h/3.0, &x);
            add(p->n, &x, &c, h/3.0, &x);
            add(p->n, &x, &d, h/6.0, &x);
            best = f > best ? f : best;
        }
        time = until;
    }
    const double f = force_of(p, &x);
    return f > best ? f : best;
}
