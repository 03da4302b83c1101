/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of ur5e_ of N rows: Householder's reflections to three diagonals,
 * then QL steps with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Of a compliance the slow modes, which count, come out with all their digits; the fastest keep few
 * when there are frequencies a thousand times lower.
 */
#include "ur5e_impact.h"

/*
 * Square of an entry beside the diagonal, over the product of its neighbours on it, below which it counts
 * as none: energies change by less than its root.
 */
#define SMALL UR5E_R(1e-8)
/* QL takes 1 to 2 steps an eigenvalue; from there on it is not going to end. */
#define MOST_STEPS (12*UR5E_N)

/* One reflection I - scale v v' of rows and columns first to last: A - v w' - w v'. */
static void turn(int first, const ur5e_real v[UR5E_N], ur5e_real scale, ur5e_square A)
{
    ur5e_real w[UR5E_N];
    ur5e_real along = UR5E_R(0.0);
    for (int i = first; i < UR5E_N; ++i) {
        ur5e_real sum = UR5E_R(0.0);
        for (int j = first; j < UR5E_N; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= UR5E_R(0.5)*scale;
    for (int i = first; i < UR5E_N; ++i) {
        w[i] -= along*v[i];
        const ur5e_real vi = v[i];
        const ur5e_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            A[i][j] -= vi*w[j] + wi*v[j];
            A[j][i] = A[i][j];
        }
    }
}

/* Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. */
static void reflect(ur5e_square A, ur5e_real d[UR5E_N], ur5e_real e[UR5E_N], ur5e_square Q)
{
    ur5e_square vectors; /* of each reflection */
    ur5e_real scale[UR5E_N]; /* 2/v'v */
    for (int k = 0; k + 1 < UR5E_N; ++k) {
        ur5e_real *const v = vectors[k];
        const ur5e_real first = A[k][k + 1];
        ur5e_real square = UR5E_R(0.0);
        for (int i = k + 2; i < UR5E_N; ++i) {
            v[i] = A[k][i];
            square += v[i]*v[i];
        }
        d[k] = A[k][k];
        e[k] = first;
        scale[k] = UR5E_R(0.0);
        if (square > UR5E_R(0.0)) {
            const ur5e_real length = UR5E_SQRT(square + first*first);
            e[k] = first > UR5E_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = UR5E_R(1.0)/(length*(length + UR5E_FABS(first)));
            turn(k + 1, v, scale[k], A);
        }
    }
    d[UR5E_N - 1] = A[UR5E_N - 1][UR5E_N - 1];
    e[UR5E_N - 1] = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j < UR5E_N; ++j) {
            Q[i][j] = UR5E_R(0.0);
        }
        Q[i][i] = UR5E_R(1.0);
    }
    for (int k = UR5E_N - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const ur5e_real *const v = vectors[k];
        for (int i = k + 1; i < UR5E_N && scale[k] > UR5E_R(0.0); ++i) {
            ur5e_real along = UR5E_R(0.0);
            for (int j = k + 1; j < UR5E_N; ++j) {
                along += Q[i][j]*v[j];
            }
            along *= scale[k];
            for (int j = k + 1; j < UR5E_N; ++j) {
                Q[i][j] -= along*v[j];
            }
        }
    }
}

/* One QL step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, ur5e_real d[UR5E_N], ur5e_real e[UR5E_N], ur5e_square Q)
{
    const ur5e_real one = UR5E_R(1.0);
    const ur5e_real half = UR5E_R(0.5)*(d[first + 1] - d[first])/e[first];
    const ur5e_real length = UR5E_FABS(half) + UR5E_SQRT(half*half + one);
    ur5e_real g = d[last] - d[first] + e[first]/(half < UR5E_R(0.0) ? -length : length);
    ur5e_real s = one;
    ur5e_real c = one;
    ur5e_real p = UR5E_R(0.0);
    for (int i = last - 1; i >= first; --i) {
        const ur5e_real f = s*e[i];
        const ur5e_real b = c*e[i];
        const ur5e_real r = UR5E_SQRT(f*f + g*g);
        e[i + 1] = r;
        if (!(r > UR5E_R(0.0))) {
            d[i + 1] -= p;
            e[last] = UR5E_R(0.0);
            return;
        }
        s = f/r;
        c = g/r;
        g = d[i + 1] - p;
        const ur5e_real t = (d[i] - g)*s + UR5E_R(2.0)*c*b;
        p = s*t;
        d[i + 1] = g + p;
        g = c*t - b;
        for (int j = 0; j < UR5E_N; ++j) {
            const ur5e_real x = Q[i][j];
            const ur5e_real y = Q[i + 1][j];
            Q[i + 1][j] = s*x + c*y;
            Q[i][j] = c*x - s*y;
        }
    }
    d[first] -= p;
    e[first] = g;
    e[last] = UR5E_R(0.0);
}

/* Whether an entry between two of the diagonal is more than none. */
static bool counts(ur5e_real before, ur5e_real after, ur5e_real entry)
{
    const ur5e_real noise = UR5E_EPSILON*(UR5E_FABS(before) + UR5E_FABS(after));
    return entry*entry > UR5E_FMAX(SMALL*UR5E_FABS(before*after), noise*noise);
}

/* Last row of the block that begins at a row. */
static int end_of_block(int first, const ur5e_real values[UR5E_N], const ur5e_real e[UR5E_N])
{
    int last = first;
    while (last + 1 < UR5E_N && counts(values[last], values[last + 1], e[last])) {
        ++last;
    }
    return last;
}

bool ur5e_spectrum(ur5e_square A, ur5e_real values[UR5E_N], ur5e_square vectors)
{
    ur5e_real e[UR5E_N];
    reflect(A, values, e, vectors);
    int first = 0;
    for (int step = 0; step <= MOST_STEPS; ++step) {
        while (first < UR5E_N && end_of_block(first, values, e) == first) {
            ++first;
        }
        if (first == UR5E_N) {
            return true;
        }
        if (step < MOST_STEPS) {
            chase(first, end_of_block(first, values, e), values, e, vectors);
        }
    }
    return false;
}
