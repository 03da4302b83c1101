/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of panda_ of N rows: Householder's reflections to three diagonals,
 * then QL steps with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Of a compliance the slow modes, which count, come out with all their digits; the fastest keep few
 * when there are frequencies a thousand times lower.
 */
#include "panda_impact.h"

/*
 * Square of an entry beside the diagonal, over the product of its neighbours on it, below which it counts
 * as none: energies change by less than its root.
 */
#define SMALL PANDA_R(1e-8)
/* QL takes 1 to 2 steps an eigenvalue; from there on it is not going to end. */
#define MOST_STEPS (12*PANDA_N)

/* One reflection I - scale v v' of rows and columns first to last: A - v w' - w v'. */
static void turn(int first, const panda_real v[PANDA_N], panda_real scale, panda_square A)
{
    panda_real w[PANDA_N];
    panda_real along = PANDA_R(0.0);
    for (int i = first; i < PANDA_N; ++i) {
        panda_real sum = PANDA_R(0.0);
        for (int j = first; j < PANDA_N; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= PANDA_R(0.5)*scale;
    for (int i = first; i < PANDA_N; ++i) {
        w[i] -= along*v[i];
        const panda_real vi = v[i];
        const panda_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            A[i][j] -= vi*w[j] + wi*v[j];
            A[j][i] = A[i][j];
        }
    }
}

/* Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. */
static void reflect(panda_square A, panda_real d[PANDA_N], panda_real e[PANDA_N], panda_square Q)
{
    panda_square vectors; /* of each reflection */
    panda_real scale[PANDA_N]; /* 2/v'v */
    for (int k = 0; k + 1 < PANDA_N; ++k) {
        panda_real *const v = vectors[k];
        const panda_real first = A[k][k + 1];
        panda_real square = PANDA_R(0.0);
        for (int i = k + 2; i < PANDA_N; ++i) {
            v[i] = A[k][i];
            square += v[i]*v[i];
        }
        d[k] = A[k][k];
        e[k] = first;
        scale[k] = PANDA_R(0.0);
        if (square > PANDA_R(0.0)) {
            const panda_real length = PANDA_SQRT(square + first*first);
            e[k] = first > PANDA_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = PANDA_R(1.0)/(length*(length + PANDA_FABS(first)));
            turn(k + 1, v, scale[k], A);
        }
    }
    d[PANDA_N - 1] = A[PANDA_N - 1][PANDA_N - 1];
    e[PANDA_N - 1] = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j < PANDA_N; ++j) {
            Q[i][j] = PANDA_R(0.0);
        }
        Q[i][i] = PANDA_R(1.0);
    }
    for (int k = PANDA_N - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const panda_real *const v = vectors[k];
        for (int i = k + 1; i < PANDA_N && scale[k] > PANDA_R(0.0); ++i) {
            panda_real along = PANDA_R(0.0);
            for (int j = k + 1; j < PANDA_N; ++j) {
                along += Q[i][j]*v[j];
            }
            along *= scale[k];
            for (int j = k + 1; j < PANDA_N; ++j) {
                Q[i][j] -= along*v[j];
            }
        }
    }
}

/* One QL step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, panda_real d[PANDA_N], panda_real e[PANDA_N], panda_square Q)
{
    const panda_real one = PANDA_R(1.0);
    const panda_real half = PANDA_R(0.5)*(d[first + 1] - d[first])/e[first];
    const panda_real length = PANDA_FABS(half) + PANDA_SQRT(half*half + one);
    panda_real g = d[last] - d[first] + e[first]/(half < PANDA_R(0.0) ? -length : length);
    panda_real s = one;
    panda_real c = one;
    panda_real p = PANDA_R(0.0);
    for (int i = last - 1; i >= first; --i) {
        const panda_real f = s*e[i];
        const panda_real b = c*e[i];
        const panda_real r = PANDA_SQRT(f*f + g*g);
        e[i + 1] = r;
        if (!(r > PANDA_R(0.0))) {
            d[i + 1] -= p;
            e[last] = PANDA_R(0.0);
            return;
        }
        s = f/r;
        c = g/r;
        g = d[i + 1] - p;
        const panda_real t = (d[i] - g)*s + PANDA_R(2.0)*c*b;
        p = s*t;
        d[i + 1] = g + p;
        g = c*t - b;
        for (int j = 0; j < PANDA_N; ++j) {
            const panda_real x = Q[i][j];
            const panda_real y = Q[i + 1][j];
            Q[i + 1][j] = s*x + c*y;
            Q[i][j] = c*x - s*y;
        }
    }
    d[first] -= p;
    e[first] = g;
    e[last] = PANDA_R(0.0);
}

/* Whether an entry between two of the diagonal is more than none. */
static bool counts(panda_real before, panda_real after, panda_real entry)
{
    const panda_real noise = PANDA_EPSILON*(PANDA_FABS(before) + PANDA_FABS(after));
    return entry*entry > PANDA_FMAX(SMALL*PANDA_FABS(before*after), noise*noise);
}

/* Last row of the block that begins at a row. */
static int end_of_block(int first, const panda_real values[PANDA_N], const panda_real e[PANDA_N])
{
    int last = first;
    while (last + 1 < PANDA_N && counts(values[last], values[last + 1], e[last])) {
        ++last;
    }
    return last;
}

bool panda_spectrum(panda_square A, panda_real values[PANDA_N], panda_square vectors)
{
    panda_real e[PANDA_N];
    reflect(A, values, e, vectors);
    int first = 0;
    for (int step = 0; step <= MOST_STEPS; ++step) {
        while (first < PANDA_N && end_of_block(first, values, e) == first) {
            ++first;
        }
        if (first == PANDA_N) {
            return true;
        }
        if (step < MOST_STEPS) {
            chase(first, end_of_block(first, values, e), values, e, vectors);
        }
    }
    return false;
}
