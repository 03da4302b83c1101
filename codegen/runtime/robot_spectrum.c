/* SPDX-License-Identifier: 0BSD */
/*
 * Eigenvectors of a symmetric matrix of robot_: Householder's reflections to three diagonals, then QR steps
 * with implicit shifts (Golub and Van Loan, Matrix Computations, 8.3).
 *
 * Errors are as for the largest eigenvalue: of a compliance the slow modes, which count, come out with all
 * their digits; the fastest keep few when there are frequencies a thousand times lower. Joints come in the order
 * from the base, so that compliances fall from the first row on, and small eigenvalues are found first, at the end.
 */
#include "robot_impact.h"

/*
 * Steps of QR, which takes one an eigenvalue to four digits and two to all: of 60,000 compliances of seven joints
 * none took more than 13, of as many servos of 14 coordinates none more than 30. What is not done by then fails.
 */
#define MOST_STEPS(size) (2*(size) + 2)
#define MOST_STEPS_TO_ALL_DIGITS(size) (3*(size))

/* One reflection I - scale v v' of rows and columns from first on: A - v w' - w v'. */
static void turn(int first, int size, const robot_real *v, robot_real scale, robot_matrix A)
{
    robot_real w[ROBOT_SYSTEM];
    robot_real along = ROBOT_R(0.0);
    for (int i = first; i < size; ++i) {
        robot_real sum = ROBOT_R(0.0);
        for (int j = first; j < size; ++j) {
            sum += A[i][j]*v[j];
        }
        w[i] = scale*sum;
        along += w[i]*v[i];
    }
    along *= ROBOT_R(0.5)*scale;
    for (int i = first; i < size; ++i) {
        w[i] -= along*v[i];
        const robot_real vi = v[i];
        const robot_real wi = w[i];
        for (int j = first; j <= i; ++j) {
            const robot_real entry = A[i][j] - vi*w[j] - wi*v[j];
            A[i][j] = entry;
            A[j][i] = entry;
        }
    }
}

/*
 * Reflects A to three diagonals d and e, and writes the rows of Q' of A = Q tridiag(e, d, e) Q'. Of each
 * reflection, v stays in A's own row.
 */
static void reflect(int size, robot_matrix A, robot_real *d, robot_real *e, robot_matrix Q)
{
    robot_real scale[ROBOT_SYSTEM]; /* 2/v'v */
    for (int k = 0; k + 1 < size; ++k) {
        robot_real *const v = A[k];
        const robot_real first = v[k + 1];
        robot_real square = ROBOT_R(0.0);
        for (int i = k + 2; i < size; ++i) {
            square += v[i]*v[i];
        }
        d[k] = v[k];
        e[k] = first;
        scale[k] = ROBOT_R(0.0);
        if (square > ROBOT_R(0.0)) {
            const robot_real length = ROBOT_SQRT(square + first*first);
            e[k] = first > ROBOT_R(0.0) ? -length : length;
            v[k + 1] = first - e[k];
            scale[k] = ROBOT_R(1.0)/(length*(length + ROBOT_FABS(first)));
            turn(k + 1, size, v, scale[k], A);
        }
    }
    d[size - 1] = A[size - 1][size - 1];
    Q[size - 1][size - 1] = ROBOT_R(1.0);
    for (int k = size - 3; k >= 0; --k) { /* rows of Q' are reflected as they are columns of Q */
        const robot_real *const v = A[k];
        const int next = k + 1; /* row and column that were none but for a 1 where they meet */
        const robot_real lead = scale[k]*v[next];
        Q[next][next] = ROBOT_R(1.0) - lead*v[next];
        for (int j = next + 1; j < size; ++j) {
            Q[next][j] = -lead*v[j];
        }
        for (int i = next + 1; i < size; ++i) {
            robot_real along = ROBOT_R(0.0);
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
    Q[0][0] = ROBOT_R(1.0);
    for (int i = 1; i < size; ++i) {
        Q[0][i] = ROBOT_R(0.0);
        Q[i][0] = ROBOT_R(0.0);
    }
}

/* One QR step on rows first to last; turns the rows of Q, too. */
static void chase(int first, int last, int size, robot_real *d, robot_real *e, robot_matrix Q)
{
    const robot_real end = e[last - 1];
    const robot_real half = ROBOT_R(0.5)*(d[last - 1] - d[last]);
    const robot_real length = ROBOT_SQRT(half*half + end*end);
    robot_real x = d[first] - d[last] + end*end/(half < ROBOT_R(0.0) ? half - length : half + length);
    robot_real z = e[first];
    for (int k = first; k < last; ++k) {
        const robot_real r = ROBOT_SQRT(x*x + z*z);
        const robot_real inverse = ROBOT_R(1.0)/r;
        const bool turns = r > ROBOT_R(0.0);
        const robot_real c = turns ? x*inverse : ROBOT_R(1.0);
        const robot_real s = turns ? z*inverse : ROBOT_R(0.0);
        if (k > first) {
            e[k - 1] = r;
        }
        const robot_real u = s*(d[k + 1] - d[k]) + ROBOT_R(2.0)*c*e[k];
        d[k] += s*u;
        d[k + 1] -= s*u;
        e[k] = c*u - e[k];
        if (k + 1 < last) {
            x = e[k];
            z = s*e[k + 1];
            e[k + 1] *= c;
        }
        robot_turn(size, c, s, Q[k], Q[k + 1]);
    }
}

/* Whether an entry beside the diagonal is more than none. */
static bool counts(int row, const robot_real *d, const robot_real *e, robot_real small, robot_real noise)
{
    return e[row]*e[row] > noise + small*ROBOT_FABS(d[row]*d[row + 1]);
}

bool robot_spectrum(int size, robot_real small, robot_matrix A, robot_real *values, robot_matrix vectors)
{
    robot_real e[ROBOT_SYSTEM];
    robot_real all = ROBOT_R(0.0);
    reflect(size, A, values, e, vectors);
    for (int i = 0; i < size; ++i) {
        all += ROBOT_FABS(values[i]);
    }
    const robot_real noise = ROBOT_EPSILON*ROBOT_EPSILON*all*all;
    int last = size - 1;
    const int most = small > ROBOT_EPSILON ? MOST_STEPS(size) : MOST_STEPS_TO_ALL_DIGITS(size);
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
