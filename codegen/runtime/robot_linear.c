/* SPDX-License-Identifier: 0BSD */
/* Linear algebra of robot_: Cholesky's factors, and eigenvectors by Jacobi's rotations. */
#include "robot_impact.h"

bool robot_cholesky(int size, robot_matrix A)
{
    for (int j = 0; j < size; ++j) {
        robot_real pivot = A[j][j];
        for (int k = 0; k < j; ++k) {
            pivot -= A[j][k]*A[j][k];
        }
        if (!(pivot > ROBOT_R(0.0) && pivot <= ROBOT_REAL_MAX)) {
            return false;
        }
        const robot_real root = ROBOT_SQRT(pivot);
        const robot_real inverse = ROBOT_R(1.0)/root;
        A[j][j] = root;
        for (int i = j + 1; i < size; ++i) {
            robot_real rest = A[i][j];
            for (int k = 0; k < j; ++k) {
                rest -= A[i][k]*A[j][k];
            }
            A[i][j] = rest*inverse;
        }
    }
    return true;
}

void robot_forward(int size, robot_matrix L, robot_real *x)
{
    for (int i = 0; i < size; ++i) {
        robot_real rest = x[i];
        for (int k = 0; k < i; ++k) {
            rest -= L[i][k]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void robot_backward(int size, robot_matrix L, robot_real *x)
{
    for (int i = size - 1; i >= 0; --i) {
        robot_real rest = x[i];
        for (int k = i + 1; k < size; ++k) {
            rest -= L[k][i]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void robot_turn(int size, robot_real c, robot_real s, robot_real *a, robot_real *b)
{
    for (int k = 0; k < size; ++k) {
        const robot_real x = a[k];
        const robot_real y = b[k];
        a[k] = c*x + s*y;
        b[k] = c*y - s*x;
    }
}

void robot_turn_by(int size, robot_real t, robot_real *a, robot_real *b)
{
    const robot_real c = ROBOT_R(1.0)/ROBOT_SQRT(t*t + ROBOT_R(1.0));
    robot_turn(size, c, t*c, a, b);
}

robot_real robot_tangent(robot_real apart, robot_real off)
{
    const robot_real half = apart/(off + off);
    const robot_real length = ROBOT_FABS(half) + ROBOT_SQRT(half*half + ROBOT_R(1.0));
    return (half < ROBOT_R(0.0) ? ROBOT_R(-1.0) : ROBOT_R(1.0))/length;
}

#if !ROBOT_STRUCTURED
/*
 * Square of an entry, over the product of its diagonal entries, from which on it is rotated away: against
 * the largest entry it may be as small as rounding and still turn slow modes that carry most of a motion.
 * What is left turns eigenvectors by less than 1e-4; the next rotation would leave its square.
 */
#define TURNED ROBOT_R(1e-8)
/* Jacobi's method converges in 5 to 8 sweeps; from there on it is not going to. */
#define SWEEPS 16

/* Rotates away A[i][j]; A is kept whole, so that rows and columns turn alike. */
static void rotate(int size, robot_matrix A, robot_matrix X, int i, int j)
{
    const robot_real off = A[i][j];
    const robot_real first = A[i][i];
    const robot_real second = A[j][j];
    const robot_real t = robot_tangent(second - first, off);
    robot_turn_by(size, t, A[j], A[i]);
    for (int k = 0; k < size; ++k) {
        A[k][i] = A[i][k];
        A[k][j] = A[j][k];
    }
    A[i][i] = first - t*off;
    A[j][j] = second + t*off;
    A[i][j] = ROBOT_R(0.0);
    A[j][i] = ROBOT_R(0.0);
    robot_turn_by(size, t, X[j], X[i]);
}

bool robot_diagonalise(int size, robot_matrix A, robot_matrix X)
{
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        bool turned = false;
        for (int i = 0; i < size; ++i) {
            for (int j = i + 1; j < size; ++j) {
                if (A[i][j]*A[i][j] > TURNED*ROBOT_FABS(A[i][i]*A[j][j])) {
                    rotate(size, A, X, i, j);
                    turned = true;
                }
            }
        }
        if (!turned) {
            return true;
        }
    }
    return false;
}
#endif
