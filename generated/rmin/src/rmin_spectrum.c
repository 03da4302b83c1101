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
 * Steps of QR, which takes one an eigenvalue to four digits and two to all: of 60,000 compliances of seven joints
 * none took more than 13, of as many servos of 14 coordinates none more than 30. What is not done by then fails.
 */
#define MOST_STEPS(size) (2*(size) + 2)
#define MOST_STEPS_TO_ALL_DIGITS(size) (3*(size))

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

/*
 * Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. Of each
 * reflection, v stays in A's own row.
 */
static void reflect(int size, rmin_matrix A, rmin_real *d, rmin_real *e, rmin_matrix Q)
{
    rmin_real scale[RMIN_SYSTEM]; /* 2/v'v */
    for (int k = 0; k + 1 < size; ++k) {
        rmin_real *const v = A[k];
        const rmin_real first = v[k + 1];
        rmin_real square = RMIN_R(0.0);
        for (int i = k + 2; i < size; ++i) {
            square += v[i]*v[i];
        }
        d[k] = v[k];
        e[k] = first;
        scale[k] = RMIN_R(0.0);
        if (square > RMIN_R(0.0)) {
            const rmin_real length = RMIN_SQRT(square + first*first);
            e[k] = first > RMIN_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = RMIN_R(1.0)/(length*(length + RMIN_FABS(first)));
            turn(k + 1, size, v, scale[k], A);
        }
    }
    d[size - 1] = A[size - 1][size - 1];
    Q[size - 1][size - 1] = RMIN_R(1.0);
    for (int k = size - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const rmin_real *const v = A[k];
        const int next = k + 1; /* row and column that were none but for a 1 where they meet */
        const rmin_real lead = scale[k]*v[next];
        Q[next][next] = RMIN_R(1.0) - lead*v[next];
        for (int j = next + 1; j < size; ++j) {
            Q[next][j] = -lead*v[j];
        }
        for (int i = next + 1; i < size; ++i) {
            rmin_real along = RMIN_R(0.0);
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
    Q[0][0] = RMIN_R(1.0);
    for (int i = 1; i < size; ++i) {
        Q[0][i] = RMIN_R(0.0);
        Q[i][0] = RMIN_R(0.0);
    }
}

/* One QR step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, int size, rmin_real *d, rmin_real *e, rmin_matrix Q)
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
        rmin_turn(size, c, s, Q[k], Q[k + 1]);
    }
}

/* Whether an entry beside the diagonal is more than none. */
static bool counts(int row, const rmin_real *d, const rmin_real *e, rmin_real small, rmin_real noise)
{
    return e[row]*e[row] > noise + small*RMIN_FABS(d[row]*d[row + 1]);
}

bool rmin_spectrum(int size, rmin_real small, rmin_matrix A, rmin_real *values, rmin_matrix vectors)
{
    rmin_real e[RMIN_SYSTEM];
    rmin_real all = RMIN_R(0.0);
    reflect(size, A, values, e, vectors);
    for (int i = 0; i < size; ++i) {
        all += RMIN_FABS(values[i]);
    }
    const rmin_real noise = RMIN_EPSILON*RMIN_EPSILON*all*all;
    int last = size - 1;
    const int most = small > RMIN_EPSILON ? MOST_STEPS(size) : MOST_STEPS_TO_ALL_DIGITS(size);
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
