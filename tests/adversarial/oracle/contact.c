/* SPDX-License-Identifier: BSD-3-Clause */
/* Laws of contact, and the body that they press. */
#include "oracle.h"

/* c s' = f - k s, mass b'' = f. */
void body_steps(const impact *p, const prepared *linear, level *l)
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

/* Root of d, where d + soft f = open > 0 and f = skin d^1.5. */
static double root_of(double skin, double open, double soft, double guess)
{
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

/* The last point at which depth + soft force is at most a number; the last but one where all are. */
static long piece_of(const impact *p, double soft, double sum)
{
    long low = 0;
    long high = p->points - 1;
    while (high - low > 1) {
        const long middle = (low + high)/2;
        if (p->depths[middle] + soft*p->law[middle] <= sum) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static double slope_of(const impact *p, long i)
{
    return (p->law[i + 1] - p->law[i])/(p->depths[i + 1] - p->depths[i]);
}

double depth_of(const impact *p, double open, double soft, double guess)
{
    if (!(open > 0.0)) {
        return 0.0;
    }
    if (p->points == 0) {
        const double root = root_of(p->skin, open, soft, sqrt(guess));
        return root*root;
    }
    const long i = piece_of(p, soft, open);
    const double rest = open - p->depths[i] - soft*p->law[i];
    return p->depths[i] + rest/(1.0 + soft*slope_of(p, i));
}

double force_at(const impact *p, double depth)
{
    if (p->points == 0) {
        return p->skin*depth*sqrt(depth);
    }
    const long i = piece_of(p, 0.0, depth);
    return depth > 0.0 ? p->law[i] + (depth - p->depths[i])*slope_of(p, i) : 0.0;
}

double stiffness_at(const impact *p, double depth)
{
    return p->points == 0 ? 1.5*p->skin*sqrt(depth) : slope_of(p, piece_of(p, 0.0, depth));
}
