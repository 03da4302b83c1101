/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of ur5e_: Householder's reflections to three diagonals, then QR steps
 * with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Errors are as for the largest eigenvalue: of a compliance the slow modes, which count, come out with all
 * their digits; the fastest keep few when there are frequencies a thousand times lower. Joints come in the order
 * from the base, so that compliances fall from the first row on, and small eigenvalues are found first, at the end.
 */
#include "ur5e_impact.h"

/*
 * Steps of QR, which takes one an eigenvalue to four digits and two to all: of 60,000 compliances of seven joints
 * none took more than 13, of as many servos of 14 coordinates none more than 30. What is not done by then fails.
 */
#define MOST_STEPS(size) (2*(size) + 2)
#define MOST_STEPS_TO_ALL_DIGITS(size) (3*(size))

/* One reflection I - scale v v' of rows and columns from first on: A - v w' - w v'. */
static void turn(int first, int size, const ur5e_real *v, ur5e_real scale, ur5e_matrix A)
{
    ur5e_real w[UR5E_SYSTEM];
    ur5e_real along = UR5E_R(0.0);
    for (int i = first; i < size; ++i) {
        ur5e_real sum = UR5E_R(0.0);
        for (int j = first; j < size; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= UR5E_R(0.5)*scale;
    for (int i = first; i < size; ++i) {
        w[i] -= along*v[i];
        const ur5e_real vi = v[i];
        const ur5e_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            const ur5e_real entry = A[i][j] - vi*w[j] - wi*v[j];
            A[i][j] = entry;
            A[j][i] = entry;
        }
    }
}

/*
 * Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. Of each
 * reflection, v stays in A's own row.
 */
static void reflect(int size, ur5e_matrix A, ur5e_real *d, ur5e_real *e, ur5e_matrix Q)
{
    ur5e_real scale[UR5E_SYSTEM]; /* 2/v'v */
    for (int k = 0; k + 1 < size; ++k) {
        ur5e_real *const v = A[k];
        const ur5e_real first = v[k + 1];
        ur5e_real square = UR5E_R(0.0);
        for (int i = k + 2; i < size; ++i) {
            square += v[i]*v[i];
        }
        d[k] = v[k];
        e[k] = first;
        scale[k] = UR5E_R(0.0);
        if (square > UR5E_R(0.0)) {
            const ur5e_real length = UR5E_SQRT(square + first*first);
            e[k] = first > UR5E_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = UR5E_R(1.0)/(length*(length + UR5E_FABS(first)));
            turn(k + 1, size, v, scale[k], A);
        }
    }
    d[size - 1] = A[size - 1][size - 1];
    Q[size - 1][size - 1] = UR5E_R(1.0);
    for (int k = size - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const ur5e_real *const v = A[k];
        const int next = k + 1; /* row and column that were none but for a 1 where they meet */
        const ur5e_real lead = scale[k]*v[next];
        Q[next][next] = UR5E_R(1.0) - lead*v[next];
        for (int j = next + 1; j < size; ++j) {
            Q[next][j] = -lead*v[j];
        }
        for (int i = next + 1; i < size; ++i) {
            ur5e_real along = UR5E_R(0.0);
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
    Q[0][0] = UR5E_R(1.0);
    for (int i = 1; i < size; ++i) {
        Q[0][i] = UR5E_R(0.0);
        Q[i][0] = UR5E_R(0.0);
    }
}

/* One QR step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, int size, ur5e_real *d, ur5e_real *e, ur5e_matrix Q)
{
    const ur5e_real end = e[last - 1];
    const ur5e_real half = UR5E_R(0.5)*(d[last - 1] - d[last]);
    const ur5e_real length = UR5E_SQRT(half*half + end*end);
    ur5e_real x = d[first] - d[last] + end*end/(half < UR5E_R(0.0) ? half - length : half + length);
    ur5e_real z = e[first];
    for (int k = first; k < last; ++k) {
        const ur5e_real r = UR5E_SQRT(x*x + z*z);
        const ur5e_real inverse = UR5E_R(1.0)/r;
        const bool turns = r > UR5E_R(0.0);
        const ur5e_real c = turns ? x*inverse : UR5E_R(1.0);
        const ur5e_real s = turns ? z*inverse : UR5E_R(0.0);
        if (k > first) {
            e[k - 1] = r;
        }
        const ur5e_real u = s*(d[k + 1] - d[k]) + UR5E_R(2.0)*c*e[k];
        d[k] += s*u;
        d[k + 1] -= s*u;
        e[k] = c*u - e[k];
        if (k + 1 < last) {
            x = e[k];
            z = s*e[k + 1];
            e[k + 1] *= c;
        }
        ur5e_turn(size, c, s, Q[k], Q[k + 1]);
    }
}

/* Whether an entry beside the diagonal is more than none. */
static bool counts(int row, const ur5e_real *d, const ur5e_real *e, ur5e_real small, ur5e_real noise)
{
    return e[row]*e[row] > noise + small*UR5E_FABS(d[row]*d[row + 1]);
}

bool ur5e_spectrum(int size, ur5e_real small, ur5e_matrix A, ur5e_real *values, ur5e_matrix vectors)
{
    ur5e_real e[UR5E_SYSTEM];
    ur5e_real all = UR5E_R(0.0);
    reflect(size, A, values, e, vectors);
    for (int i = 0; i < size; ++i) {
        all += UR5E_FABS(values[i]);
    }
    const ur5e_real noise = UR5E_EPSILON*UR5E_EPSILON*all*all;
    int last = size - 1;
    const int most = small > UR5E_EPSILON ? MOST_STEPS(size) : MOST_STEPS_TO_ALL_DIGITS(size);
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
