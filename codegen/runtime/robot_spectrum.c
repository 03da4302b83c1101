/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of robot_ of N rows: Householder's reflections to three diagonals,
 * then QL steps with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Of a compliance the slow modes, which count, come out with all their digits; the fastest keep few
 * when there are frequencies a thousand times lower.
 */
#include "robot_impact.h"

/*
 * Square of an entry beside the diagonal, over the product of its neighbours on it, below which it counts
 * as none: energies change by less than its root.
 */
#define SMALL ROBOT_R(1e-8)
/* QL takes 1 to 2 steps an eigenvalue; from there on it is not going to end. */
#define MOST_STEPS (12*ROBOT_N)

/* One reflection I - scale v v' of rows and columns first to last: A - v w' - w v'. */
static void turn(int first, const robot_real v[ROBOT_N], robot_real scale, robot_square A)
{
    robot_real w[ROBOT_N];
    robot_real along = ROBOT_R(0.0);
    for (int i = first; i < ROBOT_N; ++i) {
        robot_real sum = ROBOT_R(0.0);
        for (int j = first; j < ROBOT_N; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= ROBOT_R(0.5)*scale;
    for (int i = first; i < ROBOT_N; ++i) {
        w[i] -= along*v[i];
        const robot_real vi = v[i];
        const robot_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            A[i][j] -= vi*w[j] + wi*v[j];
            A[j][i] = A[i][j];
        }
    }
}

/* Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. */
static void reflect(robot_square A, robot_real d[ROBOT_N], robot_real e[ROBOT_N], robot_square Q)
{
    robot_square vectors; /* of each reflection */
    robot_real scale[ROBOT_N]; /* 2/v'v */
    for (int k = 0; k + 1 < ROBOT_N; ++k) {
        robot_real *const v = vectors[k];
        const robot_real first = A[k][k + 1];
        robot_real square = ROBOT_R(0.0);
        for (int i = k + 2; i < ROBOT_N; ++i) {
            v[i] = A[k][i];
            square += v[i]*v[i];
        }
        d[k] = A[k][k];
        e[k] = first;
        scale[k] = ROBOT_R(0.0);
        if (square > ROBOT_R(0.0)) {
            const robot_real length = ROBOT_SQRT(square + first*first);
            e[k] = first > ROBOT_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = ROBOT_R(1.0)/(length*(length + ROBOT_FABS(first)));
            turn(k + 1, v, scale[k], A);
        }
    }
    d[ROBOT_N - 1] = A[ROBOT_N - 1][ROBOT_N - 1];
    e[ROBOT_N - 1] = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j < ROBOT_N; ++j) {
            Q[i][j] = ROBOT_R(0.0);
        }
        Q[i][i] = ROBOT_R(1.0);
    }
    for (int k = ROBOT_N - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const robot_real *const v = vectors[k];
        for (int i = k + 1; i < ROBOT_N && scale[k] > ROBOT_R(0.0); ++i) {
            robot_real along = ROBOT_R(0.0);
            for (int j = k + 1; j < ROBOT_N; ++j) {
                along += Q[i][j]*v[j];
            }
            along *= scale[k];
            for (int j = k + 1; j < ROBOT_N; ++j) {
                Q[i][j] -= along*v[j];
            }
        }
    }
}

/* One QL step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, robot_real d[ROBOT_N], robot_real e[ROBOT_N], robot_square Q)
{
    const robot_real one = ROBOT_R(1.0);
    const robot_real half = ROBOT_R(0.5)*(d[first + 1] - d[first])/e[first];
    const robot_real length = ROBOT_FABS(half) + ROBOT_SQRT(half*half + one);
    robot_real g = d[last] - d[first] + e[first]/(half < ROBOT_R(0.0) ? -length : length);
    robot_real s = one;
    robot_real c = one;
    robot_real p = ROBOT_R(0.0);
    for (int i = last - 1; i >= first; --i) {
        const robot_real f = s*e[i];
        const robot_real b = c*e[i];
        const robot_real r = ROBOT_SQRT(f*f + g*g);
        e[i + 1] = r;
        if (!(r > ROBOT_R(0.0))) {
            d[i + 1] -= p;
            e[last] = ROBOT_R(0.0);
            return;
        }
        s = f/r;
        c = g/r;
        g = d[i + 1] - p;
        const robot_real t = (d[i] - g)*s + ROBOT_R(2.0)*c*b;
        p = s*t;
        d[i + 1] = g + p;
        g = c*t - b;
        for (int j = 0; j < ROBOT_N; ++j) {
            const robot_real x = Q[i][j];
            const robot_real y = Q[i + 1][j];
            Q[i + 1][j] = s*x + c*y;
            Q[i][j] = c*x - s*y;
        }
    }
    d[first] -= p;
    e[first] = g;
    e[last] = ROBOT_R(0.0);
}

/* Whether an entry between two of the diagonal is more than none. */
static bool counts(robot_real before, robot_real after, robot_real entry)
{
    const robot_real noise = ROBOT_EPSILON*(ROBOT_FABS(before) + ROBOT_FABS(after));
    return entry*entry > ROBOT_FMAX(SMALL*ROBOT_FABS(before*after), noise*noise);
}

/* Last row of the block that begins at a row. */
static int end_of_block(int first, const robot_real values[ROBOT_N], const robot_real e[ROBOT_N])
{
    int last = first;
    while (last + 1 < ROBOT_N && counts(values[last], values[last + 1], e[last])) {
        ++last;
    }
    return last;
}

bool robot_spectrum(robot_square A, robot_real values[ROBOT_N], robot_square vectors)
{
    robot_real e[ROBOT_N];
    reflect(A, values, e, vectors);
    int first = 0;
    for (int step = 0; step <= MOST_STEPS; ++step) {
        while (first < ROBOT_N && end_of_block(first, values, e) == first) {
            ++first;
        }
        if (first == ROBOT_N) {
            return true;
        }
        if (step < MOST_STEPS) {
            chase(first, end_of_block(first, values, e), values, e, vectors);
        }
    }
    return false;
}
