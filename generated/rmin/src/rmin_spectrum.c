/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of rmin_: Householder's reflections to three diagonals, then QR steps
 * with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Errors are as for the largest eigenvalue: of a compliance the slow modes, which count, come out with all
 * their digits; the fastest keep few when there are frequencies a thousand times lower. Joints come in the order
 * from the base, so that compliances fall from the first row on, and small eigenvalues are found first, at the end.
 */
#include "rmin_impact.h"

/*
 * Steps of QR to all digits, about two an eigenvalue: of 60,000 servos of 14 coordinates none took more than 30.
 * What is not done by then fails.
 */
#define MOST_STEPS(size) (3*(size))

/* One reflection I - scale v v' of rows and columns from first on: A - v w' - w v'. */
static void turn(int first, int size, const rmin_real *v, rmin_real scale, rmin_matrix A)
{
    rmin_real w[RMIN_SYSTEM];
    rmin_real along = RMIN_R(0.0);
    for (int i = first; i < size; ++i) {
        rmin_real sum = RMIN_R(0.0);
        for (int j = first; j < size; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= RMIN_R(0.5)*scale;
    for (int i = first; i < size; ++i) {
        w[i] -= along*v[i];
        const rmin_real vi = v[i];
        const rmin_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            const rmin_real entry = A[i][j] - vi*w[j] - wi*v[j];
            A[i][j] = entry;
            A[j][i] = entry;
        }
    }
}

/* The same of a vector. */
static void mirror(int first, int size, const rmin_real *v, rmin_real scale, rmin_real *x)
{
    rmin_real along = RMIN_R(0.0);
    for (int i = first; i < size; ++i) {
        along += x[i]*v[i];
    }
    along *= scale;
    for (int i = first; i < size; ++i) {
        x[i] -= along*v[i];
    }
}

/* Turns a vector by the rotations of one step, of each row. */
static void turn_on(int first, int last, const rmin_rotation *by, rmin_real *x)
{
    rmin_real here = x[first];
    for (int k = first; k < last; ++k) {
        const rmin_real c = by[k].c;
        const rmin_real s = by[k].s;
        const rmin_real next = x[k + 1];
        x[k] = c*here + s*next;
        here = c*next - s*here;
    }
    x[last] = here;
}

/* Reflects A to three diagonals d and e, and vectors with it. Of each reflection, v stays in A's own row. */
static void reflect(int size, rmin_matrix A, rmin_real *d, rmin_real *e, int count, rmin_vectors x,
    rmin_turns *turns)
{
    for (int k = 0; k + 1 < size; ++k) {
        rmin_real *const v = A[k];
        const rmin_real first = v[k + 1];
        rmin_real square = RMIN_R(0.0);
        rmin_real scale = RMIN_R(0.0); /* 2/v'v */
        for (int i = k + 2; i < size; ++i) {
            square += v[i]*v[i];
        }
        d[k] = v[k];
        e[k] = first;
        if (square > RMIN_R(0.0)) {
            const rmin_real length = RMIN_SQRT(square + first*first);
            e[k] = first > RMIN_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale = RMIN_R(1.0)/(length*(length + RMIN_FABS(first)));
            turn(k + 1, size, v, scale, A);
            for (int m = 0; m < count; ++m) {
                mirror(k + 1, size, v, scale, x[m]);
            }
        }
        if (turns != NULL) {
            turns->scale[k] = scale;
            for (int i = k + 1; i < size; ++i) {
                turns->v[k][i] = v[i];
            }
        }
    }
    d[size - 1] = A[size - 1][size - 1];
}

/* One QR step on rows first to last; writes the rotation of each. */
static void chase(int first, int last, rmin_real *d, rmin_real *e, rmin_rotation *by)
{
    const rmin_real end = e[last - 1];
    const rmin_real half = RMIN_R(0.5)*(d[last - 1] - d[last]);
    const rmin_real length = RMIN_SQRT(half*half + end*end);
    rmin_real x = d[first] - d[last] + end*end/(half < RMIN_R(0.0) ? half - length : half + length);
    rmin_real z = e[first];
    for (int k = first; k < last; ++k) {
        const rmin_real r = RMIN_SQRT(x*x + z*z);
        const rmin_real inverse = RMIN_R(1.0)/r;
        const bool turns = r > RMIN_R(0.0);
        const rmin_real c = turns ? x*inverse : RMIN_R(1.0);
        const rmin_real s = turns ? z*inverse : RMIN_R(0.0);
        if (k > first) {
            e[k - 1] = r;
        }
        const rmin_real u = s*(d[k + 1] - d[k]) + RMIN_R(2.0)*c*e[k];
        d[k] += s*u;
        d[k + 1] -= s*u;
        e[k] = c*u - e[k];
        if (k + 1 < last) {
            x = e[k];
            z = s*e[k + 1];
            e[k + 1] *= c;
        }
        by[k].c = c;
        by[k].s = s;
    }
}

/* Whether an entry beside the diagonal is more than none. */
static bool counts(int row, const rmin_real *d, const rmin_real *e, rmin_real small, rmin_real noise)
{
    return e[row]*e[row] > noise + small*RMIN_FABS(d[row]*d[row + 1]);
}

bool rmin_spectrum(int size, rmin_real small, rmin_matrix A, rmin_real *values, int count, rmin_vectors x,
    rmin_turns *turns)
{
    rmin_real e[RMIN_SYSTEM];
    rmin_rotation by[RMIN_SYSTEM];
    int kept = 0;
    rmin_real all = RMIN_R(0.0);
    reflect(size, A, values, e, count, x, turns);
    for (int i = 0; i < size; ++i) {
        all += RMIN_FABS(values[i]);
    }
    const rmin_real noise = RMIN_EPSILON*RMIN_EPSILON*all*all;
    int last = size - 1;
    const int most = turns != NULL ? RMIN_MOST_QR : MOST_STEPS(size);
    for (int step = 0; step <= most; ++step) {
        while (last > 0 && !counts(last - 1, values, e, small, noise)) {
            --last;
        }
        if (last == 0) {
            if (turns != NULL) {
                turns->steps = step;
                turns->count = kept;
            }
            return true;
        }
        int first = last - 1;
        while (first > 0 && counts(first - 1, values, e, small, noise)) {
            --first;
        }
        if (step == most) {
            return false;
        }
        chase(first, last, values, e, by);
        if (turns != NULL) {
            turns->first[step] = (unsigned char)first;
            turns->last[step] = (unsigned char)last;
            for (int k = first; k < last; ++k) {
                if (kept == RMIN_MOST_ROTATIONS) {
                    return false;
                }
                turns->by[kept] = by[k];
                ++kept;
            }
        }
        for (int m = 0; m < count; ++m) {
            turn_on(first, last, by, x[m]);
        }
    }
    return false;
}

#if RMIN_STRUCTURED
/* x -= scale (v'x) v of two vectors. */
static void mirror_both(int first, const rmin_real *v, rmin_real scale, rmin_real *x, rmin_real *y)
{
    rmin_real along_x = RMIN_R(0.0);
    rmin_real along_y = RMIN_R(0.0);
    for (int i = first; i < RMIN_N; ++i) {
        const rmin_real vi = v[i];
        along_x += x[i]*vi;
        along_y += y[i]*vi;
    }
    along_x *= scale;
    along_y *= scale;
    for (int i = first; i < RMIN_N; ++i) {
        const rmin_real vi = v[i];
        x[i] -= along_x*vi;
        y[i] -= along_y*vi;
    }
}

void rmin_decompose(const rmin_turns *turns, rmin_real x[RMIN_N], rmin_real y[RMIN_N])
{
    const rmin_rotation *by = turns->by;
    for (int k = 0; k + 2 < RMIN_N; ++k) {
        mirror_both(k + 1, turns->v[k], turns->scale[k], x, y);
    }
    for (int step = 0; step < turns->steps; ++step) {
        const int first = turns->first[step];
        const int last = turns->last[step];
        rmin_real x0 = x[first];
        rmin_real y0 = y[first];
        for (int k = first; k < last; ++k) {
            const rmin_real c = by->c;
            const rmin_real s = by->s;
            const rmin_real x1 = x[k + 1];
            const rmin_real y1 = y[k + 1];
            x[k] = c*x0 + s*x1;
            y[k] = c*y0 + s*y1;
            x0 = c*x1 - s*x0;
            y0 = c*y1 - s*y0;
            ++by;
        }
        x[last] = x0;
        y[last] = y0;
    }
}

void rmin_compose(const rmin_turns *turns, rmin_real x[RMIN_N], rmin_real y[RMIN_N])
{
    const rmin_rotation *by = &turns->by[turns->count];
    for (int step = turns->steps - 1; step >= 0; --step) {
        const int first = turns->first[step];
        const int last = turns->last[step];
        rmin_real x1 = x[last];
        rmin_real y1 = y[last];
        for (int k = last - 1; k >= first; --k) {
            --by;
            const rmin_real c = by->c;
            const rmin_real s = by->s;
            const rmin_real x0 = x[k];
            const rmin_real y0 = y[k];
            x[k + 1] = c*x1 + s*x0;
            y[k + 1] = c*y1 + s*y0;
            x1 = c*x0 - s*x1;
            y1 = c*y0 - s*y1;
        }
        x[first] = x1;
        y[first] = y1;
    }
    for (int k = RMIN_N - 3; k >= 0; --k) {
        mirror_both(k + 1, turns->v[k], turns->scale[k], x, y);
    }
}
#endif
