/* SPDX-License-Identifier: 0BSD */
/* Linear algebra of ur5e_: Cholesky's factors, and eigenvectors by Jacobi's rotations. */
#include "ur5e_impact.h"

bool ur5e_cholesky(int size, ur5e_matrix A)
{
    for (int j = 0; j < size; ++j) {
        ur5e_real pivot = A[j][j];
        for (int k = 0; k < j; ++k) {
            pivot -= A[j][k]*A[j][k];
        }
        if (!(pivot > UR5E_R(0.0) && pivot <= UR5E_REAL_MAX)) {
            return false;
        }
        const ur5e_real root = UR5E_SQRT(pivot);
        const ur5e_real inverse = UR5E_R(1.0)/root;
        A[j][j] = root;
        for (int i = j + 1; i < size; ++i) {
            ur5e_real rest = A[i][j];
            for (int k = 0; k < j; ++k) {
                rest -= A[i][k]*A[j][k];
            }
            A[i][j] = rest*inverse;
        }
    }
    return true;
}

void ur5e_forward(int size, ur5e_matrix L, ur5e_real *x)
{
    for (int i = 0; i < size; ++i) {
        ur5e_real rest = x[i];
        for (int k = 0; k < i; ++k) {
            rest -= L[i][k]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void ur5e_backward(int size, ur5e_matrix L, ur5e_real *x)
{
    for (int i = size - 1; i >= 0; --i) {
        ur5e_real rest = x[i];
        for (int k = i + 1; k < size; ++k) {
            rest -= L[k][i]*x[k];
        }
        x[i] = rest/L[i][i];
    }
}

void ur5e_turn(int size, ur5e_real c, ur5e_real s, ur5e_real *a, ur5e_real *b)
{
    for (int k = 0; k < size; ++k) {
        const ur5e_real x = a[k];
        const ur5e_real y = b[k];
        a[k] = c*x + s*y;
        b[k] = c*y - s*x;
    }
}

void ur5e_turn_by(int size, ur5e_real t, ur5e_real *a, ur5e_real *b)
{
    const ur5e_real c = UR5E_R(1.0)/UR5E_SQRT(t*t + UR5E_R(1.0));
    ur5e_turn(size, c, t*c, a, b);
}

ur5e_real ur5e_tangent(ur5e_real apart, ur5e_real off)
{
    const ur5e_real half = apart/(off + off);
    const ur5e_real length = UR5E_FABS(half) + UR5E_SQRT(half*half + UR5E_R(1.0));
    return (half < UR5E_R(0.0) ? UR5E_R(-1.0) : UR5E_R(1.0))/length;
}

#if !UR5E_STRUCTURED
/*
 * Square of an entry, over the product of its diagonal entries, from which on it is rotated away: against
 * the largest entry it may be as small as rounding and still turn slow modes that carry most of a motion.
 * What is left turns eigenvectors by less than 1e-4; the next rotation would leave its square.
 */
#define TURNED UR5E_R(1e-8)
/* Jacobi's method converges in 5 to 8 sweeps; from there on it is not going to. */
#define SWEEPS 16

/* Rotates away A[i][j]; A is kept whole, so that rows and columns turn alike. */
static void rotate(int size, ur5e_matrix A, ur5e_matrix X, int i, int j)
{
    const ur5e_real off = A[i][j];
    const ur5e_real first = A[i][i];
    const ur5e_real second = A[j][j];
    const ur5e_real t = ur5e_tangent(second - first, off);
    ur5e_turn_by(size, t, A[j], A[i]);
    for (int k = 0; k < size; ++k) {
        A[k][i] = A[i][k];
        A[k][j] = A[j][k];
    }
    A[i][i] = first - t*off;
    A[j][j] = second + t*off;
    A[i][j] = UR5E_R(0.0);
    A[j][i] = UR5E_R(0.0);
    ur5e_turn_by(size, t, X[j], X[i]);
}

bool ur5e_diagonalise(int size, ur5e_matrix A, ur5e_matrix X)
{
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        bool turned = false;
        for (int i = 0; i < size; ++i) {
            for (int j = i + 1; j < size; ++j) {
                if (A[i][j]*A[i][j] > TURNED*UR5E_FABS(A[i][i]*A[j][j])) {
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
