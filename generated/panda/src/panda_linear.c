/* SPDX-License-Identifier: 0BSD */
/* Linear algebra of panda_: Cholesky's factors, and eigenvectors by Jacobi's rotations. */
#include "panda_impact.h"

bool panda_cholesky(int size, panda_matrix A)
{
    for (int j = 0; j < size; ++j) {
        panda_real pivot = A[j][j];
        for (int k = 0; k < j; ++k) {
            pivot -= A[j][k]*A[j][k];
        }
        if (!(pivot > PANDA_R(0.0) && pivot <= PANDA_REAL_MAX)) {
            return false;
        }
        const panda_real root = PANDA_SQRT(pivot);
        const panda_real inverse = PANDA_R(1.0)/root;
        A[j][j] = root;
        for (int i = j + 1; i < size; ++i) {
            panda_real rest = A[i][j];
            for (int k = 0; k < j; ++k) {
                rest -= A[i][k]*A[j][k];
            }
            A[i][j] = rest*inverse;
        }
    }
    return true;
}

void panda_forward(int size, panda_matrix L, panda_real *x)
{
    for (int i = 0; i < size; ++i) {
        panda_real rest = x[i];
        for (int k = 0; k < i; ++k) {
            rest -= L[i][k]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void panda_backward(int size, panda_matrix L, panda_real *x)
{
    for (int i = size - 1; i >= 0; --i) {
        panda_real rest = x[i];
        for (int k = i + 1; k < size; ++k) {
            rest -= L[k][i]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void panda_turn(int size, panda_real c, panda_real s, panda_real *a, panda_real *b)
{
    for (int k = 0; k < size; ++k) {
        const panda_real x = a[k];
        const panda_real y = b[k];
        a[k] = c*x + s*y;
        b[k] = c*y - s*x;
    }
}

void panda_turn_by(int size, panda_real t, panda_real *a, panda_real *b)
{
    const panda_real c = PANDA_R(1.0)/PANDA_SQRT(t*t + PANDA_R(1.0));
    panda_turn(size, c, t*c, a, b);
}

panda_real panda_tangent(panda_real apart, panda_real off)
{
    const panda_real half = apart/(off + off);
    const panda_real length = PANDA_FABS(half) + PANDA_SQRT(half*half + PANDA_R(1.0));
    return (half < PANDA_R(0.0) ? PANDA_R(-1.0) : PANDA_R(1.0))/length;
}

#if !PANDA_STRUCTURED
/*
 * Square of an entry, over the product of its diagonal entries, from which on it is rotated away: against
 * the largest entry it may be as small as rounding and still turn slow modes that carry most of a motion.
 * What is left turns eigenvectors by less than 1e-4; the next rotation would leave its square.
 */
#define TURNED PANDA_R(1e-8)
/* Jacobi's method converges in 5 to 8 sweeps; from there on it is not going to. */
#define SWEEPS 16

/* Rotates away A[i][j]; A is kept whole, so that rows and columns turn alike. */
static void rotate(int size, panda_matrix A, panda_matrix X, int i, int j)
{
    const panda_real off = A[i][j];
    const panda_real first = A[i][i];
    const panda_real second = A[j][j];
    const panda_real t = panda_tangent(second - first, off);
    panda_turn_by(size, t, A[j], A[i]);
    for (int k = 0; k < size; ++k) {
        A[k][i] = A[i][k];
        A[k][j] = A[j][k];
    }
    A[i][i] = first - t*off;
    A[j][j] = second + t*off;
    A[i][j] = PANDA_R(0.0);
    A[j][i] = PANDA_R(0.0);
    panda_turn_by(size, t, X[j], X[i]);
}

bool panda_diagonalise(int size, panda_matrix A, panda_matrix X)
{
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        bool turned = false;
        for (int i = 0; i < size; ++i) {
            for (int j = i + 1; j < size; ++j) {
                if (A[i][j]*A[i][j] > TURNED*PANDA_FABS(A[i][i]*A[j][j])) {
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
