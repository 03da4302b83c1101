/* SPDX-License-Identifier: 0BSD */
/* Linear algebra of rr_: Cholesky's factors, and eigenvectors by Jacobi's rotations. */
#include "rr_impact.h"

bool rr_cholesky(int size, rr_matrix A)
{
    for (int j = 0; j < size; ++j) {
        rr_real pivot = A[j][j];
        for (int k = 0; k < j; ++k) {
            pivot -= A[j][k]*A[j][k];
        }
        if (!(pivot > RR_R(0.0) && pivot <= RR_REAL_MAX)) {
            return false;
        }
        const rr_real root = RR_SQRT(pivot);
        const rr_real inverse = RR_R(1.0)/root;
        A[j][j] = root;
        for (int i = j + 1; i < size; ++i) {
            rr_real rest = A[i][j];
            for (int k = 0; k < j; ++k) {
                rest -= A[i][k]*A[j][k];
            }
            A[i][j] = rest*inverse;
        }
    }
    return true;
}

void rr_forward(int size, rr_matrix L, rr_real *x)
{
    for (int i = 0; i < size; ++i) {
        rr_real rest = x[i];
        for (int k = 0; k < i; ++k) {
            rest -= L[i][k]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void rr_backward(int size, rr_matrix L, rr_real *x)
{
    for (int i = size - 1; i >= 0; --i) {
        rr_real rest = x[i];
        for (int k = i + 1; k < size; ++k) {
            rest -= L[k][i]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void rr_turn(int size, rr_real c, rr_real s, rr_real *a, rr_real *b)
{
    for (int k = 0; k < size; ++k) {
        const rr_real x = a[k];
        const rr_real y = b[k];
        a[k] = c*x + s*y;
        b[k] = c*y - s*x;
    }
}

void rr_turn_by(int size, rr_real t, rr_real *a, rr_real *b)
{
    const rr_real c = RR_R(1.0)/RR_SQRT(t*t + RR_R(1.0));
    rr_turn(size, c, t*c, a, b);
}

rr_real rr_tangent(rr_real apart, rr_real off)
{
    const rr_real half = apart/(off + off);
    const rr_real length = RR_FABS(half) + RR_SQRT(half*half + RR_R(1.0));
    return (half < RR_R(0.0) ? RR_R(-1.0) : RR_R(1.0))/length;
}

#if !RR_STRUCTURED
/*
 * Square of an entry, over the product of its diagonal entries, from which on it is rotated away: against
 * the largest entry it may be as small as rounding and still turn slow modes that carry most of a motion.
 * What is left turns eigenvectors by less than 1e-4; the next rotation would leave its square.
 */
#define TURNED RR_R(1e-8)
/* Jacobi's method converges in 5 to 8 sweeps; from there on it is not going to. */
#define SWEEPS 16

/* Rotates away A[i][j]; A is kept whole, so that rows and columns turn alike. */
static void rotate(int size, rr_matrix A, rr_matrix X, int i, int j)
{
    const rr_real off = A[i][j];
    const rr_real first = A[i][i];
    const rr_real second = A[j][j];
    const rr_real t = rr_tangent(second - first, off);
    rr_turn_by(size, t, A[j], A[i]);
    for (int k = 0; k < size; ++k) {
        A[k][i] = A[i][k];
        A[k][j] = A[j][k];
    }
    A[i][i] = first - t*off;
    A[j][j] = second + t*off;
    A[i][j] = RR_R(0.0);
    A[j][i] = RR_R(0.0);
    rr_turn_by(size, t, X[j], X[i]);
}

bool rr_diagonalise(int size, rr_matrix A, rr_matrix X)
{
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        bool turned = false;
        for (int i = 0; i < size; ++i) {
            for (int j = i + 1; j < size; ++j) {
                if (A[i][j]*A[i][j] > TURNED*RR_FABS(A[i][i]*A[j][j])) {
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
