/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of rmin_ of N rows: Householder's reflections to three diagonals,
 * then QL steps with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Of a compliance the slow modes, which count, come out with all their digits; the fastest keep few
 * when there are frequencies a thousand times lower.
 */
#include "rmin_impact.h"

/*
 * Square of an entry beside the diagonal, over the product of its neighbours on it, below which it counts
 * as none: energies change by less than its root.
 */
#define SMALL RMIN_R(1e-8)
/* QL takes 1 to 2 steps an eigenvalue; from there on it is not going to end. */
#define MOST_STEPS (12*RMIN_N)

/* One reflection I - scale v v' of rows and columns first to last: A - v w' - w v'. */
static void turn(int first, const rmin_real v[RMIN_N], rmin_real scale, rmin_square A)
{
    rmin_real w[RMIN_N];
    rmin_real along = RMIN_R(0.0);
    for (int i = first; i < RMIN_N; ++i) {
        rmin_real sum = RMIN_R(0.0);
        for (int j = first; j < RMIN_N; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= RMIN_R(0.5)*scale;
    for (int i = first; i < RMIN_N; ++i) {
        w[i] -= along*v[i];
        const rmin_real vi = v[i];
        const rmin_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            A[i][j] -= vi*w[j] + wi*v[j];
            A[j][i] = A[i][j];
        }
    }
}

/* Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. */
static void reflect(rmin_square A, rmin_real d[RMIN_N], rmin_real e[RMIN_N], rmin_square Q)
{
    rmin_square vectors; /* of each reflection */
    rmin_real scale[RMIN_N]; /* 2/v'v */
    for (int k = 0; k + 1 < RMIN_N; ++k) {
        rmin_real *const v = vectors[k];
        const rmin_real first = A[k][k + 1];
        rmin_real square = RMIN_R(0.0);
        for (int i = k + 2; i < RMIN_N; ++i) {
            v[i] = A[k][i];
            square += v[i]*v[i];
        }
        d[k] = A[k][k];
        e[k] = first;
        scale[k] = RMIN_R(0.0);
        if (square > RMIN_R(0.0)) {
            const rmin_real length = RMIN_SQRT(square + first*first);
            e[k] = first > RMIN_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = RMIN_R(1.0)/(length*(length + RMIN_FABS(first)));
            turn(k + 1, v, scale[k], A);
        }
    }
    d[RMIN_N - 1] = A[RMIN_N - 1][RMIN_N - 1];
    e[RMIN_N - 1] = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j < RMIN_N; ++j) {
            Q[i][j] = RMIN_R(0.0);
        }
        Q[i][i] = RMIN_R(1.0);
    }
    for (int k = RMIN_N - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const rmin_real *const v = vectors[k];
        for (int i = k + 1; i < RMIN_N && scale[k] > RMIN_R(0.0); ++i) {
            rmin_real along = RMIN_R(0.0);
            for (int j = k + 1; j < RMIN_N; ++j) {
                along += Q[i][j]*v[j];
            }
            along *= scale[k];
            for (int j = k + 1; j < RMIN_N; ++j) {
                Q[i][j] -= along*v[j];
            }
        }
    }
}

/* One QL step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, rmin_real d[RMIN_N], rmin_real e[RMIN_N], rmin_square Q)
{
    const rmin_real one = RMIN_R(1.0);
    const rmin_real half = RMIN_R(0.5)*(d[first + 1] - d[first])/e[first];
    const rmin_real length = RMIN_FABS(half) + RMIN_SQRT(half*half + one);
    rmin_real g = d[last] - d[first] + e[first]/(half < RMIN_R(0.0) ? -length : length);
    rmin_real s = one;
    rmin_real c = one;
    rmin_real p = RMIN_R(0.0);
    for (int i = last - 1; i >= first; --i) {
        const rmin_real f = s*e[i];
        const rmin_real b = c*e[i];
        const rmin_real r = RMIN_SQRT(f*f + g*g);
        e[i + 1] = r;
        if (!(r > RMIN_R(0.0))) {
            d[i + 1] -= p;
            e[last] = RMIN_R(0.0);
            return;
        }
        s = f/r;
        c = g/r;
        g = d[i + 1] - p;
        const rmin_real t = (d[i] - g)*s + RMIN_R(2.0)*c*b;
        p = s*t;
        d[i + 1] = g + p;
        g = c*t - b;
        for (int j = 0; j < RMIN_N; ++j) {
            const rmin_real x = Q[i][j];
            const rmin_real y = Q[i + 1][j];
            Q[i + 1][j] = s*x + c*y;
            Q[i][j] = c*x - s*y;
        }
    }
    d[first] -= p;
    e[first] = g;
    e[last] = RMIN_R(0.0);
}

/* Whether an entry between two of the diagonal is more than none. */
static bool counts(rmin_real before, rmin_real after, rmin_real entry)
{
    const rmin_real noise = RMIN_EPSILON*(RMIN_FABS(before) + RMIN_FABS(after));
    return entry*entry > RMIN_FMAX(SMALL*RMIN_FABS(before*after), noise*noise);
}

/* Last row of the block that begins at a row. */
static int end_of_block(int first, const rmin_real values[RMIN_N], const rmin_real e[RMIN_N])
{
    int last = first;
    while (last + 1 < RMIN_N && counts(values[last], values[last + 1], e[last])) {
        ++last;
    }
    return last;
}

bool rmin_spectrum(rmin_square A, rmin_real values[RMIN_N], rmin_square vectors)
{
    rmin_real e[RMIN_N];
    reflect(A, values, e, vectors);
    int first = 0;
    for (int step = 0; step <= MOST_STEPS; ++step) {
        while (first < RMIN_N && end_of_block(first, values, e) == first) {
            ++first;
        }
        if (first == RMIN_N) {
            return true;
        }
        if (step < MOST_STEPS) {
            chase(first, end_of_block(first, values, e), values, e, vectors);
        }
    }
    return false;
}
