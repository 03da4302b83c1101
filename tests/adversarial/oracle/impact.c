/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * Largest force of many impacts: the tests' own integrator, for searches of millions of them.
 *
 * With z the deviation from the motion before the impact, in coordinates of unit mass,
 *     z'' + D z' + K z = -row f - pull v t,   x = v t + row.z,
 * and a body k s + c s' = f = skin d^1.5 whose end, of some mass or none that moves, is at b:
 *     d = x - b - s > 0,   mass b'' = f.
 * All that is linear goes by matrices' exponentials (no modes, none left out), over steps in which
 * the force is a parabola through its values at the step's ends and one step before. Only that is
 * approximate; a step is halved where the force is not nearly straight. One equation in the root of
 * d is solved a step. Matrices are symmetric, or stored by columns.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#define MOST 32            /* coordinates */
#define STATES (2*MOST)    /* z, then z' over `rate` */
#define LEVELS 24
#define TAYLOR 24

enum { LOOSE_ALONE = 1, LED_FIRST = 2 }; /* what to integrate: the larger force counts */

typedef struct {
    const double *stiffness, *damping, *row, *pull; /* matrices with rows of `stride` */
    long size, stride;
} law;

typedef struct {
    law led, loose; /* coordinates of `led` are the first of `loose`; the others stand still */
    long runs;
    double release, horizon;
    double stiffness, damping, mass, skin; /* mass 0: its end is held */
    double scale;     /* force by which bends are measured from the start, N */
    double tolerance; /* most bend of the force over a step, over the largest force */
    double longest, shortest; /* steps, s */
} impact;

/* A response to f = 1, f = s and f = s^2, s being the time since the step began. */
typedef struct {
    double one, time, square;
} response;

typedef struct {
    double h, fade; /* fade: what is left of s without a force */
    double turn[STATES*STATES]; /* z at its end from z at its start, by columns */
    double one[STATES], time[STATES], square[STATES];
    double pull_one[STATES], pull_time[STATES];
    response body, speed, bent; /* of the body's end, its velocity, its deflection */
    response gap; /* of x - b */
    response closing; /* of its rate */
} level;

typedef struct {
    long size, states, levels;
    double rate;
    double row[MOST];
    int pulled;
    level level[LEVELS];
} prepared;

typedef struct {
    double z[STATES];
    double body, speed, bent;
    double time;
    double before, now; /* forces */
    double shallow, depth; /* d with these */
    double h; /* of the last step */
    long past; /* steps in contact */
    long at;   /* level */
    double peak, when;
    long steps;
} state;

static prepared led_steps, loose_steps; /* one at a time in a process */

static double largest(const law *of, const double *x)
{
    double sum = 0.0;
    for (long i = 0; i < of->size; ++i) {
        double row = 0.0;
        for (long j = 0; j < of->size; ++j) {
            row += fabs(x[i*of->stride + j]);
        }
        sum = row > sum ? row : sum;
    }
    return sum;
}

/* y = A x + y */
static void apply(long n, const double *restrict A, const double *restrict x, double *restrict y)
{
    for (long j = 0; j < n; ++j) {
        const double factor = x[j];
        const double *const column = &A[j*n];
        for (long i = 0; i < n; ++i) {
            y[i] += factor*column[i];
        }
    }
}

/* What a step twice as long does. */
static void twice(const prepared *p, const level *a, level *b)
{
    const long n = p->states;
    b->h = 2.0*a->h;
    memset(b->turn, 0, sizeof(double)*(size_t)(n*n));
    for (long j = 0; j < n; ++j) {
        apply(n, a->turn, &a->turn[j*n], &b->turn[j*n]);
    }
    for (long i = 0; i < n; ++i) {
        b->one[i] = a->one[i];
        b->time[i] = a->time[i] + a->h*a->one[i];
        b->square[i] = a->square[i] + a->h*(2.0*a->time[i] + a->h*a->one[i]);
        b->pull_one[i] = a->pull_one[i];
        b->pull_time[i] = a->pull_time[i] + a->h*a->pull_one[i];
    }
    apply(n, a->turn, a->one, b->one);
    apply(n, a->turn, a->time, b->time);
    apply(n, a->turn, a->square, b->square);
    if (p->pulled) {
        apply(n, a->turn, a->pull_one, b->pull_one);
        apply(n, a->turn, a->pull_time, b->pull_time);
    }
}

/* A = [0, rate; -K/rate, -D], by columns. */
static void rates(const prepared *p, const law *of, double *A)
{
    const long m = p->size;
    const long n = p->states;
    memset(A, 0, sizeof(double)*(size_t)(n*n));
    for (long j = 0; j < m; ++j) {
        A[(m + j)*n + j] = p->rate;
        for (long i = 0; i < m; ++i) {
            A[j*n + m + i] = -of->stiffness[i*of->stride + j]/p->rate;
            A[(m + j)*n + m + i] = -of->damping[i*of->stride + j];
        }
    }
}

/* exp(A h) and the responses to forces, by their series: A h is small. */
static void series(const prepared *p, const law *of, const double *A, double h, level *l)
{
    static double term[STATES*STATES];
    static double next[STATES*STATES];
    const long m = p->size;
    const long n = p->states;
    const size_t bytes = sizeof(double)*(size_t)(n*n);
    double push[STATES] = {0};
    double pull[STATES] = {0};
    for (long i = 0; i < m; ++i) {
        push[m + i] = -of->row[i]/p->rate;
        pull[m + i] = -of->pull[i]/p->rate;
    }
    memset(l, 0, sizeof *l);
    l->h = h;
    memset(term, 0, bytes);
    for (long i = 0; i < n; ++i) {
        term[i*n + i] = 1.0;
    }
    for (long k = 0; k < TAYLOR; ++k) { /* term = (A h)^k/k! */
        double pushed[STATES] = {0};
        double pulled[STATES] = {0};
        apply(n, term, push, pushed);
        apply(n, term, pull, pulled);
        const double first = h/(double)(k + 1);
        const double second = first*h/(double)(k + 2);
        const double third = 2.0*second*h/(double)(k + 3);
        for (long i = 0; i < n; ++i) {
            l->one[i] += first*pushed[i];
            l->time[i] += second*pushed[i];
            l->square[i] += third*pushed[i];
            l->pull_one[i] += first*pulled[i];
            l->pull_time[i] += second*pulled[i];
        }
        double size = 0.0;
        for (long i = 0; i < n*n; ++i) {
            l->turn[i] += term[i];
            size = fmax(size, fabs(term[i]));
        }
        if (size < 1e-18) {
            break;
        }
        memset(next, 0, bytes);
        for (long j = 0; j < n; ++j) {
            apply(n, A, &term[j*n], &next[j*n]);
        }
        for (long i = 0; i < n*n; ++i) {
            term[i] = next[i]*h/(double)(k + 1);
        }
    }
}

/* Body and what it gives way: c s' = f - k s, mass b'' = f. */
static void body_steps(const impact *p, const prepared *linear, level *l)
{
    const double h = l->h;
    const double light = p->mass > 0.0 ? 1.0/p->mass : 0.0;
    l->body = (response){h*h/2.0*light, h*h*h/6.0*light, h*h*h*h/12.0*light};
    l->speed = (response){h*light, h*h/2.0*light, h*h*h/3.0*light};
    const double a = p->damping > 0.0 ? p->stiffness*h/p->damping : 1e300;
    l->fade = exp(-a);
    if (a < 0.5) {
        double of[4] = {0};
        for (int n = 1; n < 4; ++n) { /* sum of (-a)^j/(j + n)! */
            double term = n == 1 ? 1.0 : n == 2 ? 0.5 : 1.0/6.0;
            for (int j = 0; j < 20; ++j) {
                of[n] += term;
                term *= -a/(double)(j + n + 1);
            }
        }
        l->bent = (response){h/p->damping*of[1], h*h/p->damping*of[2], 2.0*h*h*h/p->damping*of[3]};
    } else {
        const double lag = p->damping/p->stiffness;
        l->bent.one = -expm1(-a)/p->stiffness;
        l->bent.time = h/p->stiffness - lag*l->bent.one;
        l->bent.square = h*h/p->stiffness - 2.0*lag*l->bent.time;
    }
    l->gap = (response){-l->body.one, -l->body.time, -l->body.square};
    l->closing = (response){-l->speed.one, -l->speed.time, -l->speed.square};
    for (long i = 0; i < linear->size; ++i) {
        const double row = linear->row[i];
        const double rate = row*linear->rate;
        const long j = linear->size + i;
        l->gap.one += row*l->one[i];
        l->gap.time += row*l->time[i];
        l->gap.square += row*l->square[i];
        l->closing.one += rate*l->one[j];
        l->closing.time += rate*l->time[j];
        l->closing.square += rate*l->square[j];
    }
}

static void prepare(const impact *p, const law *of, prepared *out)
{
    static double A[STATES*STATES];
    static level spare;
    const long m = of->size;
    out->size = m;
    out->states = 2*m;
    out->rate = fmax(sqrt(largest(of, of->stiffness)), 1.0);
    out->pulled = 0;
    for (long i = 0; i < m; ++i) {
        out->row[i] = of->row[i];
        out->pulled |= fabs(of->pull[i]) > 0.0;
    }
    const double norm = 2.0*out->rate + largest(of, of->damping);
    out->levels = 1;
    for (double h = p->shortest; h < 0.75*p->longest && out->levels < LEVELS; h *= 2.0) {
        ++out->levels;
    }
    double h = p->shortest;
    int halvings = 0;
    for (; norm*h > 0.25; h *= 0.5) {
        ++halvings;
    }
    rates(out, of, A);
    level *const first = &out->level[0]; /* the shortest */
    series(out, of, A, h, first);
    for (int k = 0; k < halvings; ++k) {
        twice(out, first, &spare);
        *first = spare;
    }
    for (long k = 1; k < out->levels; ++k) {
        twice(out, &out->level[k - 1], &out->level[k]);
    }
    for (long k = 0; k < out->levels; ++k) {
        body_steps(p, out, &out->level[k]);
    }
}

/* Root of d, where d + soft f = open and f = skin d^1.5. */
static double root_of(double skin, double open, double soft, double guess)
{
    if (!(open > 0.0)) {
        return 0.0;
    }
    const double cubic = soft*skin;
    double root = guess > 0.0 ? guess : sqrt(open);
    for (int k = 0; k < 100; ++k) { /* from above, after the first step */
        const double over = root*root*(1.0 + cubic*root) - open;
        const double change = over/(root*(2.0 + 3.0*cubic*root));
        root -= change;
        if (fabs(change) <= 1e-13*root) {
            break;
        }
    }
    return root;
}

/* What a force now + t by time + t^2 by square adds at the end of a step. */
static double effect(const response *r, const response *by)
{
    return r->one*by->one + r->time*by->time + r->square*by->square;
}

static void see(state *s, double f, double h)
{
    double top = f;
    if (s->past > 0 && s->now >= s->before && f < s->now) {
        const double up = (s->now - s->before)/s->h;
        const double bend = ((f - s->now)/h - up)/(h + s->h);
        const double slope = up + bend*s->h;
        top = s->now - 0.25*slope*slope/bend;
    }
    if (top > s->peak) {
        s->peak = top;
        s->when = s->time + h;
    }
}

/*
 * Whether the damper follows the skin within a step, so that d' may be a backward difference and its
 * force c s' = c (x - b - d)' is that of the step's end.
 */
static int is_quick(const impact *p, double root, double h)
{
    return p->damping > 0.0 && h*(p->stiffness + 1.5*p->skin*root) > p->damping;
}

/* d' = lag d + memory at a step's end, of second order but for the first steps in contact. */
static void rate_of_depth(const state *s, double h, double *lag, double *memory)
{
    const double ratio = s->past > 0 ? h/s->h : 1.0;
    *lag = 1.0/h;
    *memory = -s->depth/h;
    if (s->past > 1) {
        *lag = (1.0 + 2.0*ratio)/((1.0 + ratio)*h);
        *memory = (ratio*ratio/(1.0 + ratio)*s->shallow - (1.0 + ratio)*s->depth)/h;
    }
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
    double root = root_of(p->skin, open, soft, sqrt(s->depth));
    const int quick = is_quick(p, s->past > 1 ? sqrt(s->depth) : root, h);
    if (quick) {
        double lag;
        double memory;
        rate_of_depth(s, h, &lag, &memory);
        const double hold = p->stiffness + p->damping*lag;
        const double slows = -effect(&l->closing, &share);
        open = (p->stiffness*gap + p->damping*(closing - memory))/hold;
        soft = (1.0 + p->stiffness*yields + p->damping*slows)/hold;
        root = root_of(p->skin, open, soft, sqrt(s->depth));
    }
    const double f = p->skin*root*root*root;
    const double straight = s->past > 0 ? s->now + (s->now - s->before)*ratio : s->now;
    const double off = fabs(f - straight)*(s->past > 0 ? ratio/(1.0 + ratio) : 0.5);
    const double size = p->tolerance*fmax(p->scale, s->peak);
    ++s->steps;
    if (s->at > 0 && !(off <= size && soft > 0.0)) {
        --s->at;
        return;
    }
    see(s, f, h);
    const response by = {known.one, known.time + f*share.time, known.square + f*share.square};
    for (long i = 0; i < n; ++i) {
        s->z[i] = z[i] + by.one*l->one[i] + by.time*l->time[i] + by.square*l->square[i];
    }
    s->body += h*s->speed + effect(&l->body, &by);
    s->speed += effect(&l->speed, &by);
    s->bent = quick && f > 0.0 ? gap - yields*f - root*root
        : l->fade*s->bent + effect(&l->bent, &by);
    s->past = f > 0.0 || s->now > 0.0 ? s->past + 1 : 0;
    s->before = s->now;
    s->now = f;
    s->shallow = s->depth;
    s->depth = root*root;
    s->h = h;
    s->time += h;
    if (8.0*off <= size) {
        ++s->at;
    }
}

static void run(const impact *p, const prepared *linear, double speed, double until, state *s)
{
    s->at = 0;
    for (;;) {
        const double left = until - s->time;
        if (s->at >= linear->levels) {
            s->at = linear->levels - 1;
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

static double one_force(const impact *p, double speed, int led, long *steps)
{
    state s;
    memset(&s, 0, sizeof s);
    if (led) {
        run(p, &led_steps, speed, fmin(p->release, p->horizon), &s);
        if (p->release < p->horizon) {
            release(p, &s);
        }
    }
    if (!led || p->release < p->horizon) {
        run(p, &loose_steps, speed, p->horizon, &s);
    }
    *steps += s.steps;
    return s.peak;
}

/* Largest force at each of some speeds. */
static long forces(const impact *p, long speeds, const double *speed, double *out)
{
    long steps = 0;
    if ((p->runs & LED_FIRST) != 0) {
        prepare(p, &p->led, &led_steps);
    }
    if ((p->runs & LOOSE_ALONE) != 0 || p->release < p->horizon) {
        prepare(p, &p->loose, &loose_steps);
    }
    for (long k = 0; k < speeds; ++k) {
        out[k] = 0.0;
        if ((p->runs & LOOSE_ALONE) != 0) {
            out[k] = fmax(out[k], one_force(p, speed[k], 0, &steps));
        }
        if ((p->runs & LED_FIRST) != 0) {
            out[k] = fmax(out[k], one_force(p, speed[k], 1, &steps));
        }
    }
    return steps;
}

long largest_forces(long count, const impact *p, long speeds, const double *speed, double *out);

/* Largest forces [N] of many impacts, each at some speeds; returns the steps it took. */
long largest_forces(long count, const impact *p, long speeds, const double *speed, double *out)
{
    long steps = 0;
    for (long k = 0; k < count; ++k) {
        steps += forces(&p[k], speeds, &speed[k*speeds], &out[k*speeds]);
    }
    return steps;
}

/* Calls of a package, for all rows of arrays. */
typedef int (*in_double)(const void *, const void *, double, const void *, const void *, void *);
typedef int (*in_float)(const void *, const void *, float, const void *, const void *, void *);

typedef struct {
    const char *q, *n, *numbers, *regions, *params;
    char *out;
    int *status;
    long joints, region, param, result; /* sizes of rows, bytes but for joints */
} table;

void call_double(in_double entry, long count, const table *t);
void call_float(in_float entry, long count, const table *t);

void call_double(in_double entry, long count, const table *t)
{
    for (long k = 0; k < count; ++k) {
        t->status[k] = entry(t->q + k*t->joints*8, t->n + k*24, ((const double *)t->numbers)[k],
            t->regions + k*t->region, t->params + k*t->param, t->out + k*t->result);
    }
}

void call_float(in_float entry, long count, const table *t)
{
    for (long k = 0; k < count; ++k) {
        t->status[k] = entry(t->q + k*t->joints*4, t->n + k*12, ((const float *)t->numbers)[k],
            t->regions + k*t->region, t->params + k*t->param, t->out + k*t->result);
    }
}
