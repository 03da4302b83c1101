/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of panda_: Householder's reflections to three diagonals, then QR steps
 * with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Errors are as for the largest eigenvalue: of a compliance the slow modes, which count, come out with all
 * their digits; the fastest keep few when there are frequencies a thousand times lower. Joints come in the order
 * from the base, so that compliances fall from the first row on, and small eigenvalues are found first, at the end.
 */
#include "panda_impact.h"

/*
 * Steps of QR, which takes one an eigenvalue to four digits and two to all: of 60,000 compliances of seven joints
 * none took more than 13, of as many servos of 14 coordinates none more than 30. What is not done by then fails.
 */
#define MOST_STEPS(size) (2*(size) + 2)
#define MOST_STEPS_TO_ALL_DIGITS(size) (3*(size))

/* One reflection I - scale v v' of rows and columns from first on: A - v w' - w v'. */
static void turn(int first, int size, const panda_real *v, panda_real scale, panda_matrix A)
{
    panda_real w[PANDA_SYSTEM];
    panda_real along = PANDA_R(0.0);
    for (int i = first; i < size; ++i) {
        panda_real sum = PANDA_R(0.0);
        for (int j = first; j < size; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= PANDA_R(0.5)*scale;
    for (int i = first; i < size; ++i) {
        w[i] -= along*v[i];
        const panda_real vi = v[i];
        const panda_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            const panda_real entry = A[i][j] - vi*w[j] - wi*v[j];
            A[i][j] = entry;
            A[j][i] = entry;
        }
    }
}

/*
 * Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. Of each
 * reflection, v stays in A's own row.
 */
static void reflect(int size, panda_matrix A, panda_real *d, panda_real *e, panda_matrix Q)
{
    panda_real scale[PANDA_SYSTEM]; /* 2/v'v */
    for (int k = 0; k + 1 < size; ++k) {
        panda_real *const v = A[k];
        const panda_real first = v[k + 1];
        panda_real square = PANDA_R(0.0);
        for (int i = k + 2; i < size; ++i) {
            square += v[i]*v[i];
        }
        d[k] = v[k];
        e[k] = first;
        scale[k] = PANDA_R(0.0);
        if (square > PANDA_R(0.0)) {
            const panda_real length = PANDA_SQRT(square + first*first);
            e[k] = first > PANDA_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = PANDA_R(1.0)/(length*(length + PANDA_FABS(first)));
            turn(k + 1, size, v, scale[k], A);
        }
    }
    d[size - 1] = A[size - 1][size - 1];
    Q[size - 1][size - 1] = PANDA_R(1.0);
    for (int k = size - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const panda_real *const v = A[k];
        const int next = k + 1; /* row and column that were none but for a 1 where they meet */
        const panda_real lead = scale[k]*v[next];
        Q[next][next] = PANDA_R(1.0) - lead*v[next];
        for (int j = next + 1; j < size; ++j) {
            Q[next][j] = -lead*v[j];
        }
        for (int i = next + 1; i < size; ++i) {
            panda_real along = PANDA_R(0.0);
            for (int j = next + 1; j < size; ++j) {
                along += Q[i][j]*v[j];
            }
            along *= scale[k];
            for (int j = next + 1; j < size; ++j) {
                Q[i][j] -= along*v[j];
            }
            Q[i][next] = -along*v[next];
        }
    }
    Q[0][0] = PANDA_R(1.0);
    for (int i = 1; i < size; ++i) {
        Q[0][i] = PANDA_R(0.0);
        Q[i][0] = PANDA_R(0.0);
    }
}

/* One QR step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, int size, panda_real *d, panda_real *e, panda_matrix Q)
{
    const panda_real end = e[last - 1];
    const panda_real half = PANDA_R(0.5)*(d[last - 1] - d[last]);
    const panda_real length = PANDA_SQRT(half*half + end*end);
    panda_real x = d[first] - d[last] + end*end/(half < PANDA_R(0.0) ? half - length : half + length);
    panda_real z = e[first];
    for (int k = first; k < last; ++k) {
        const panda_real r = PANDA_SQRT(x*x + z*z);
        const panda_real inverse = PANDA_R(1.0)/r;
        const bool turns = r > PANDA_R(0.0);
        const panda_real c = turns ? x*inverse : PANDA_R(1.0);
        const panda_real s = turns ? z*inverse : PANDA_R(0.0);
        if (k > first) {
            e[k - 1] = r;
        }
        const panda_real u = s*(d[k + 1] - d[k]) + PANDA_R(2.0)*c*e[k];
        d[k] += s*u;
        d[k + 1] -= s*u;
        e[k] = c*u - e[k];
        if (k + 1 < last) {
            x = e[k];
            z = s*e[k + 1];
            e[k + 1] *= c;
        }
        panda_turn(size, c, s, Q[k], Q[k + 1]);
    }
}

/* Whether an entry beside the diagonal is more than none. */
static bool counts(int row, const panda_real *d, const panda_real *e, panda_real small, panda_real noise)
{
    return e[row]*e[row] > noise + small*PANDA_FABS(d[row]*d[row + 1]);
}

bool panda_spectrum(int size, panda_real small, panda_matrix A, panda_real *values, panda_matrix vectors)
{
    panda_real e[PANDA_SYSTEM];
    panda_real all = PANDA_R(0.0);
    reflect(size, A, values, e, vectors);
    for (int i = 0; i < size; ++i) {
        all += PANDA_FABS(values[i]);
    }
    const panda_real noise = PANDA_EPSILON*PANDA_EPSILON*all*all;
    int last = size - 1;
    const int most = small > PANDA_EPSILON ? MOST_STEPS(size) : MOST_STEPS_TO_ALL_DIGITS(size);
    for (int step = 0; step <= most; ++step) {
        while (last > 0 && !counts(last - 1, values, e, small, noise)) {
            --last;
        }
        if (last == 0) {
            return true;
        }
        int first = last - 1;
        while (first > 0 && counts(first - 1, values, e, small, noise)) {
            --first;
        }
        chase(first, last, size, values, e, vectors);
    }
    return false;
}
