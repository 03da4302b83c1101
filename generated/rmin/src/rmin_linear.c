/* SPDX-License-Identifier: 0BSD */
/* Linear algebra of rmin_: Cholesky's factors, and eigenvectors by Jacobi's rotations. */
#include "rmin_impact.h"

bool rmin_cholesky(int size, rmin_matrix A)
{
    for (int j = 0; j < size; ++j) {
        rmin_real pivot = A[j][j];
        for (int k = 0; k < j; ++k) {
            pivot -= A[j][k]*A[j][k];
        }
        if (!(pivot > RMIN_R(0.0) && pivot <= RMIN_REAL_MAX)) {
            return false;
        }
        const rmin_real root = RMIN_SQRT(pivot);
        const rmin_real inverse = RMIN_R(1.0)/root;
        A[j][j] = root;
        for (int i = j + 1; i < size; ++i) {
            rmin_real rest = A[i][j];
            for (int k = 0; k < j; ++k) {
                rest -= A[i][k]*A[j][k];
            }
            A[i][j] = rest*inverse;
        }
    }
    return true;
}

void rmin_forward(int size, rmin_matrix L, rmin_real *x)
{
    for (int i = 0; i < size; ++i) {
        rmin_real rest = x[i];
        for (int k = 0; k < i; ++k) {
            rest -= L[i][k]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void rmin_backward(int size, rmin_matrix L, rmin_real *x)
{
    for (int i = size - 1; i >= 0; --i) {
        rmin_real rest = x[i];
        for (int k = i + 1; k < size; ++k) {
            rest -= L[k][i]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void rmin_turn(int size, rmin_real c, rmin_real s, rmin_real *a, rmin_real *b)
{
    for (int k = 0; k < size; ++k) {
        const rmin_real x = a[k];
        const rmin_real y = b[k];
        a[k] = c*x + s*y;
        b[k] = c*y - s*x;
    }
}

void rmin_turn_by(int size, rmin_real t, rmin_real *a, rmin_real *b)
{
    const rmin_real c = RMIN_R(1.0)/RMIN_SQRT(t*t + RMIN_R(1.0));
    rmin_turn(size, c, t*c, a, b);
}

rmin_real rmin_tangent(rmin_real apart, rmin_real off)
{
    const rmin_real half = apart/(off + off);
    const rmin_real length = RMIN_FABS(half) + RMIN_SQRT(half*half + RMIN_R(1.0));
    return (half < RMIN_R(0.0) ? RMIN_R(-1.0) : RMIN_R(1.0))/length;
}

#if !RMIN_STRUCTURED
/*
 * Square of an entry, over the product of its diagonal entries, from which on it is rotated away: against
 * the largest entry it may be as small as rounding and still turn slow modes that carry most of a motion.
 * What is left turns eigenvectors by less than 1e-4; the next rotation would leave its square.
 */
#define TURNED RMIN_R(1e-8)
/* Jacobi's method converges in 5 to 8 sweeps; from there on it is not going to. */
#define SWEEPS 16

/* Rotates away A[i][j]; A is kept whole, so that rows and columns turn alike. */
static void rotate(int size, rmin_matrix A, rmin_matrix X, int i, int j)
{
    const rmin_real off = A[i][j];
    const rmin_real first = A[i][i];
    const rmin_real second = A[j][j];
    const rmin_real t = rmin_tangent(second - first, off);
    rmin_turn_by(size, t, A[j], A[i]);
    for (int k = 0; k < size; ++k) {
        A[k][i] = A[i][k];
        A[k][j] = A[j][k];
    }
    A[i][i] = first - t*off;
    A[j][j] = second + t*off;
    A[i][j] = RMIN_R(0.0);
    A[j][i] = RMIN_R(0.0);
    rmin_turn_by(size, t, X[j], X[i]);
}

bool rmin_diagonalise(int size, rmin_matrix A, rmin_matrix X)
{
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        bool turned = false;
        for (int i = 0; i < size; ++i) {
            for (int j = i + 1; j < size; ++j) {
                if (A[i][j]*A[i][j] > TURNED*RMIN_FABS(A[i][i]*A[j][j])) {
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
