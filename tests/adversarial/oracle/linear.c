/* SPDX-License-Identifier: BSD-3-Clause */
/* What a linear robot does in steps of all lengths, by matrices' exponentials. */
#include "oracle.h"

#define TAYLOR 24

static double largest(const robot *of, const double *x)
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

void apply(long n, const double *restrict A, const double *restrict x, double *restrict y)
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
static void rates(const prepared *p, const robot *of, double *A)
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
static void series(const prepared *p, const robot *of, const double *A, double h, level *l)
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

void prepare(const impact *p, const robot *of, prepared *out)
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
    out->pressed = out->levels;
    out->levels = p->flies && out->levels + FLIGHT <= LEVELS ? out->levels + FLIGHT : out->levels;
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
