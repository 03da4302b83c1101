/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of rr_: Householder's reflections to three diagonals, then QR steps
 * with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Errors are as for the largest eigenvalue: of a compliance the slow modes, which count, come out with all
 * their digits; the fastest keep few when there are frequencies a thousand times lower. Joints come in the order
 * from the base, so that compliances fall from the first row on, and small eigenvalues are found first, at the end.
 */
#include "rr_impact.h"

/*
 * Steps of QR, which takes one an eigenvalue to four digits and two to all: of 60,000 compliances of seven joints
 * none took more than 13, of as many servos of 14 coordinates none more than 30. What is not done by then fails.
 */
#define MOST_STEPS(size) (2*(size) + 2)
#define MOST_STEPS_TO_ALL_DIGITS(size) (3*(size))

/* One reflection I - scale v v' of rows and columns from first on: A - v w' - w v'. */
static void turn(int first, int size, const rr_real *v, rr_real scale, rr_matrix A)
{
    rr_real w[RR_SYSTEM];
    rr_real along = RR_R(0.0);
    for (int i = first; i < size; ++i) {
        rr_real sum = RR_R(0.0);
        for (int j = first; j < size; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= RR_R(0.5)*scale;
    for (int i = first; i < size; ++i) {
        w[i] -= along*v[i];
        const rr_real vi = v[i];
        const rr_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            const rr_real entry = A[i][j] - vi*w[j] - wi*v[j];
            A[i][j] = entry;
            A[j][i] = entry;
        }
    }
}

/*
 * Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. Of each
 * reflection, v stays in A's own row.
 */
static void reflect(int size, rr_matrix A, rr_real *d, rr_real *e, rr_matrix Q)
{
    rr_real scale[RR_SYSTEM]; /* 2/v'v */
    for (int k = 0; k + 1 < size; ++k) {
        rr_real *const v = A[k];
        const rr_real first = v[k + 1];
        rr_real square = RR_R(0.0);
        for (int i = k + 2; i < size; ++i) {
            square += v[i]*v[i];
        }
        d[k] = v[k];
        e[k] = first;
        scale[k] = RR_R(0.0);
        if (square > RR_R(0.0)) {
            const rr_real length = RR_SQRT(square + first*first);
            e[k] = first > RR_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = RR_R(1.0)/(length*(length + RR_FABS(first)));
            turn(k + 1, size, v, scale[k], A);
        }
    }
    d[size - 1] = A[size - 1][size - 1];
    Q[size - 1][size - 1] = RR_R(1.0);
    for (int k = size - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const rr_real *const v = A[k];
        const int next = k + 1; /* row and column that were none but for a 1 where they meet */
        const rr_real lead = scale[k]*v[next];
        Q[next][next] = RR_R(1.0) - lead*v[next];
        for (int j = next + 1; j < size; ++j) {
            Q[next][j] = -lead*v[j];
        }
        for (int i = next + 1; i < size; ++i) {
            rr_real along = RR_R(0.0);
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
    Q[0][0] = RR_R(1.0);
    for (int i = 1; i < size; ++i) {
        Q[0][i] = RR_R(0.0);
        Q[i][0] = RR_R(0.0);
    }
}

/* One QR step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, int size, rr_real *d, rr_real *e, rr_matrix Q)
{
    const rr_real end = e[last - 1];
    const rr_real half = RR_R(0.5)*(d[last - 1] - d[last]);
    const rr_real length = RR_SQRT(half*half + end*end);
    rr_real x = d[first] - d[last] + end*end/(half < RR_R(0.0) ? half - length : half + length);
    rr_real z = e[first];
    for (int k = first; k < last; ++k) {
        const rr_real r = RR_SQRT(x*x + z*z);
        const rr_real inverse = RR_R(1.0)/r;
        const bool turns = r > RR_R(0.0);
        const rr_real c = turns ? x*inverse : RR_R(1.0);
        const rr_real s = turns ? z*inverse : RR_R(0.0);
        if (k > first) {
            e[k - 1] = r;
        }
        const rr_real u = s*(d[k + 1] - d[k]) + RR_R(2.0)*c*e[k];
        d[k] += s*u;
        d[k + 1] -= s*u;
        e[k] = c*u - e[k];
        if (k + 1 < last) {
            x = e[k];
            z = s*e[k + 1];
            e[k + 1] *= c;
        }
        rr_turn(size, c, s, Q[k], Q[k + 1]);
    }
}

/* Whether an entry beside the diagonal is more than none. */
static bool counts(int row, const rr_real *d, const rr_real *e, rr_real small, rr_real noise)
{
    return e[row]*e[row] > noise + small*RR_FABS(d[row]*d[row + 1]);
}

bool rr_spectrum(int size, rr_real small, rr_matrix A, rr_real *values, rr_matrix vectors)
{
    rr_real e[RR_SYSTEM];
    rr_real all = RR_R(0.0);
    reflect(size, A, values, e, vectors);
    for (int i = 0; i < size; ++i) {
        all += RR_FABS(values[i]);
    }
    const rr_real noise = RR_EPSILON*RR_EPSILON*all*all;
    int last = size - 1;
    const int most = small > RR_EPSILON ? MOST_STEPS(size) : MOST_STEPS_TO_ALL_DIGITS(size);
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
