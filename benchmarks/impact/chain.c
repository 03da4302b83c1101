/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * From a robot's configuration to the peak force of an impact: the generated package reduces the
 * robot to a chain of masses, and a leapfrog integrates the chain until the contact is lost.
 * Usage: chain STEPS REPEATS k_h c_h k_f speed n[3] q[JOINTS] springs[JOINTS] rotors[JOINTS]
 * Prints the peak force [N], ns to reduce the robot, and ns to reduce it and simulate.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include PACKAGE

enum { BATCHES = 20 }; /* the quickest counts */

typedef struct {
    double k_h, c_h, k_f, speed;
} contact_t;

/* Largest force of the first contact. The step is a share of the first mass's half period on the
 * body, or less where a spring is stiffer. The body's node x_0 follows c_h x_0' = f - k_h x_0
 * (implicit trapezoid, two Newton steps); a parabola through three forces gives the peak. */
static double peak_force(const CHAIN *chain, const contact_t *c, int steps)
{
    enum { N = sizeof chain->mass / sizeof chain->mass[0] };
    double x[N], v[N], y = 0, force = 0, peak = 0, last = 0, before = 0;
    double fastest = 0;
    for (int i = 0; i < N; i++) {
        double k = (i ? chain->stiffness[i - 1] : 0) + (i + 1 < N ? chain->stiffness[i] : 0);
        fastest = fmax(fastest, 2 * k / chain->mass[i]);
        x[i] = 0;
        v[i] = c->speed;
    }
    const double period = 3.14159265358979 * sqrt(chain->mass[0] / c->k_h);
    const double h = fmin(period / steps, 0.5 / sqrt(fastest + 1e-30));
    const double drag = 2 * c->c_h / h;
    for (long step = 0; step < 1000000; step++) {
        for (int i = 0; i < N; i++) x[i] += h * v[i];
        const double known = drag * y + force - c->k_h * y;
        double root = 0, skin = 0;
        for (int k = 0; k < 2; k++) {
            skin = fmax(x[0] - y, 0);
            root = sqrt(skin);
            y -= ((drag + c->k_h) * y - c->k_f * skin * root - known)
                 / (drag + c->k_h + 1.5 * c->k_f * root);
        }
        skin = fmax(x[0] - y, 0);
        force = c->k_f * skin * sqrt(skin);
        if (last >= before && last > force) {
            const double slope = force - before, bend = force - 2 * last + before;
            peak = fmax(peak, last - slope * slope / (8 * bend));
        }
        before = last;
        last = force;
        if (skin <= 0 && step > 2) break;
        double pull = 0;
        for (int i = 0; i < N; i++) {
            const double next = i + 1 < N ? chain->stiffness[i] * (x[i + 1] - x[i]) : 0;
            v[i] += h * (next - pull - (i ? 0 : force)) / chain->mass[i];
            pull = next;
        }
    }
    return peak;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int main(int count, char **text)
{
    double numbers[64];
    for (int i = 1; i < count && i <= 64; i++) numbers[i - 1] = atof(text[i]);
    const int steps = (int)numbers[0], repeats = (int)numbers[1];
    const contact_t contact = {numbers[2], numbers[3], numbers[4], numbers[5]};
    const double *n = numbers + 6, *q = numbers + 9;
    PARAMS p;
    DEFAULT_PARAMS(&p);
    for (int i = 0; i < JOINTS; i++) {
        p.rotor_inertia[i] = q[2 * JOINTS + i];
#ifdef ELASTIC
        p.joint_stiffness[i] = q[JOINTS + i];
#endif
    }
    double moving[JOINTS], peak = 0, least[2] = {INFINITY, INFINITY}, sum = 0;
    CHAIN chain;
    for (int batch = 0; batch < BATCHES; batch++) {
        for (int what = 0; what < 2; what++) {
            const double start = now();
            for (int r = 0; r < repeats; r++) {
                for (int i = 0; i < JOINTS; i++) moving[i] = q[i] + 1e-9 * r;
                if (REDUCE(moving, n, &p, &chain) != 0) return 1;
                if (what) peak = peak_force(&chain, &contact, steps);
                sum += chain.mass[0] + peak;
            }
            least[what] = fmin(least[what], (now() - start) / repeats);
        }
    }
    printf("%.9g %.6g %.6g %g\n", peak, least[0], least[1], sum > 0 ? 0.0 : 1.0);
    return 0;
}
