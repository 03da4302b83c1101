/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of rr_ of N rows: Householder's reflections to three diagonals,
 * then QL steps with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Of a compliance the slow modes, which count, come out with all their digits; the fastest keep few
 * when there are frequencies a thousand times lower.
 */
#include "rr_impact.h"

/*
 * Square of an entry beside the diagonal, over the product of its neighbours on it, below which it counts
 * as none: energies change by less than its root.
 */
#define SMALL RR_R(1e-8)
/* QL takes 1 to 2 steps an eigenvalue; from there on it is not going to end. */
#define MOST_STEPS (12*RR_N)

/* One reflection I - scale v v' of rows and columns first to last: A - v w' - w v'. */
static void turn(int first, const rr_real v[RR_N], rr_real scale, rr_square A)
{
    rr_real w[RR_N];
    rr_real along = RR_R(0.0);
    for (int i = first; i < RR_N; ++i) {
        rr_real sum = RR_R(0.0);
        for (int j = first; j < RR_N; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= RR_R(0.5)*scale;
    for (int i = first; i < RR_N; ++i) {
        w[i] -= along*v[i];
        const rr_real vi = v[i];
        const rr_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            A[i][j] -= vi*w[j] + wi*v[j];
            A[j][i] = A[i][j];
        }
    }
}

/* Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. */
static void reflect(rr_square A, rr_real d[RR_N], rr_real e[RR_N], rr_square Q)
{
    rr_square vectors; /* of each reflection */
    rr_real scale[RR_N]; /* 2/v'v */
    for (int k = 0; k + 1 < RR_N; ++k) {
        rr_real *const v = vectors[k];
        const rr_real first = A[k][k + 1];
        rr_real square = RR_R(0.0);
        for (int i = k + 2; i < RR_N; ++i) {
            v[i] = A[k][i];
            square += v[i]*v[i];
        }
        d[k] = A[k][k];
        e[k] = first;
        scale[k] = RR_R(0.0);
        if (square > RR_R(0.0)) {
            const rr_real length = RR_SQRT(square + first*first);
            e[k] = first > RR_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = RR_R(1.0)/(length*(length + RR_FABS(first)));
            turn(k + 1, v, scale[k], A);
        }
    }
    d[RR_N - 1] = A[RR_N - 1][RR_N - 1];
    e[RR_N - 1] = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j < RR_N; ++j) {
            Q[i][j] = RR_R(0.0);
        }
        Q[i][i] = RR_R(1.0);
    }
    for (int k = RR_N - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const rr_real *const v = vectors[k];
        for (int i = k + 1; i < RR_N && scale[k] > RR_R(0.0); ++i) {
            rr_real along = RR_R(0.0);
            for (int j = k + 1; j < RR_N; ++j) {
                along += Q[i][j]*v[j];
            }
            along *= scale[k];
            for (int j = k + 1; j < RR_N; ++j) {
                Q[i][j] -= along*v[j];
            }
        }
    }
}

/* One QL step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, rr_real d[RR_N], rr_real e[RR_N], rr_square Q)
{
    const rr_real one = RR_R(1.0);
    const rr_real half = RR_R(0.5)*(d[first + 1] - d[first])/e[first];
    const rr_real length = RR_FABS(half) + RR_SQRT(half*half + one);
    rr_real g = d[last] - d[first] + e[first]/(half < RR_R(0.0) ? -length : length);
    rr_real s = one;
    rr_real c = one;
    rr_real p = RR_R(0.0);
    for (int i = last - 1; i >= first; --i) {
        const rr_real f = s*e[i];
        const rr_real b = c*e[i];
        const rr_real r = RR_SQRT(f*f + g*g);
        e[i + 1] = r;
        if (!(r > RR_R(0.0))) {
            d[i + 1] -= p;
            e[last] = RR_R(0.0);
            return;
        }
        s = f/r;
        c = g/r;
        g = d[i + 1] - p;
        const rr_real t = (d[i] - g)*s + RR_R(2.0)*c*b;
        p = s*t;
        d[i + 1] = g + p;
        g = c*t - b;
        for (int j = 0; j < RR_N; ++j) {
            const rr_real x = Q[i][j];
            const rr_real y = Q[i + 1][j];
            Q[i + 1][j] = s*x + c*y;
            Q[i][j] = c*x - s*y;
        }
    }
    d[first] -= p;
    e[first] = g;
    e[last] = RR_R(0.0);
}

/* Whether an entry between two of the diagonal is more than none. */
static bool counts(rr_real before, rr_real after, rr_real entry)
{
    const rr_real noise = RR_EPSILON*(RR_FABS(before) + RR_FABS(after));
    return entry*entry > RR_FMAX(SMALL*RR_FABS(before*after), noise*noise);
}

/* Last row of the block that begins at a row. */
static int end_of_block(int first, const rr_real values[RR_N], const rr_real e[RR_N])
{
    int last = first;
    while (last + 1 < RR_N && counts(values[last], values[last + 1], e[last])) {
        ++last;
    }
    return last;
}

bool rr_spectrum(rr_square A, rr_real values[RR_N], rr_square vectors)
{
    rr_real e[RR_N];
    reflect(A, values, e, vectors);
    int first = 0;
    for (int step = 0; step <= MOST_STEPS; ++step) {
        while (first < RR_N && end_of_block(first, values, e) == first) {
            ++first;
        }
        if (first == RR_N) {
            return true;
        }
        if (step < MOST_STEPS) {
            chase(first, end_of_block(first, values, e), values, e, vectors);
        }
    }
    return false;
}
