/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of ur5e_ by what its motors do: drive on, servo, or turn freely.
 *
 * With z the deviation from the motion before the impact, M z'' + K z = -J'n f - (P rates) v t, where
 * P is the curvature of gravity and of springs of the model file; z is over links whose motors drive,
 * and over links and motors where a servo leads these.
 */
#include "ur5e_impact.h"

/* X = L^-1 of a mass matrix M = L L': its rows are motions of unit mass, with nothing behind its diagonal. */
static bool unit_motions(int size, ur5e_matrix mass, ur5e_matrix X)
{
    if (!ur5e_cholesky(size, mass)) {
        return false;
    }
    for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
            X[j][i] = i == j ? UR5E_R(1.0) : UR5E_R(0.0);
        }
        ur5e_backward(j + 1, mass, X[j]);
    }
    return true;
}

/* A = XKX' of such an X. */
static void congruent(int size, ur5e_matrix K, ur5e_matrix X, ur5e_matrix A)
{
    for (int i = 0; i < size; ++i) {
        ur5e_real pulled[UR5E_SYSTEM];
        for (int l = 0; l <= i; ++l) {
            pulled[l] = UR5E_R(0.0);
            for (int m = 0; m <= i; ++m) {
                pulled[l] += K[l][m]*X[i][m];
            }
        }
        for (int j = 0; j <= i; ++j) {
            ur5e_real sum = UR5E_R(0.0);
            for (int l = 0; l <= j; ++l) {
                sum += pulled[l]*X[j][l];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
    }
}

#if !UR5E_STRUCTURED
/*
 * Modes: the eigenvectors of A = XKX' in X, over the coordinates `places`, of the mass L L'. An entry of A errs by
 * rounding times the root of its diagonal entries' product, so a mode's squared frequency by as much of the
 * squared sum of these roots' shares in it. False if eigenvectors are not found.
 */
static bool find_modes(int size, const int *places, ur5e_matrix L, ur5e_matrix A, ur5e_matrix X,
    const ur5e_real *row, ur5e_modes *modes)
{
    ur5e_real roots[UR5E_SYSTEM];
    for (int i = 0; i < size; ++i) {
        roots[i] = UR5E_SQRT(UR5E_FABS(A[i][i]));
    }
    const bool found = ur5e_diagonalise(size, A, X);
    for (int i = 0; i < size; ++i) {
        ur5e_real held = UR5E_R(0.0);
        for (int l = 0; l < size; ++l) { /* what X was, times a share, is what it is: share = L'x */
            ur5e_real share = UR5E_R(0.0);
            for (int m = l; m < size; ++m) {
                share += L[m][l]*X[i][m];
            }
            held += roots[l]*UR5E_FABS(share);
        }
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            modes->shape[i][j] = UR5E_R(0.0);
        }
        ur5e_real sum = UR5E_R(0.0);
        for (int j = 0; j < size; ++j) {
            modes->shape[i][places[j]] = X[i][j];
            sum += row[j]*X[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = UR5E_EPSILON*held*held;
        modes->squared[i] = A[i][i];
        modes->row[i] = sum;
        modes->start[i] = UR5E_R(0.0);
    }
    modes->count = size;
    modes->rigid = 0;
    modes->fastest = UR5E_REAL_MAX;
    return found;
}
#endif

/* P rates: what gravity and the model's own springs pull on as the motion before goes on, over v t. */
static void pulled_on(const ur5e_arrival *arrival, ur5e_real pull[UR5E_SYSTEM])
{
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        pull[i] = UR5E_R(0.0);
    }
#if UR5E_POTENTIAL
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j < UR5E_N; ++j) {
            pull[i] += arrival->links.K[i][j]*arrival->rates[j];
        }
    }
#else
    (void)arrival;
#endif
}

/* Turns a pull that grows with time into a drift and rates of modes. */
static int lead(const ur5e_real pull[UR5E_SYSTEM], ur5e_modes *modes, ur5e_real *drift)
{
    for (int i = 0; i < modes->count; ++i) {
        ur5e_real along = UR5E_R(0.0);
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            along += modes->shape[i][j]*pull[j];
        }
        if (UR5E_FABS(along) > UR5E_R(0.0)) {
            if (!(UR5E_FABS(modes->squared[i]) > UR5E_R(0.0))) {
                return UR5E_UNRESOLVED;
            }
            modes->start[i] = along/modes->squared[i];
            *drift -= modes->row[i]*modes->start[i];
        }
    }
    return UR5E_OK;
}

/* Mass and stiffness over links, and over motors where there are springs between. */
static void whole(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_matrix mass, ur5e_matrix K)
{
    (void)p;
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            mass[i][j] = UR5E_R(0.0);
            K[i][j] = UR5E_R(0.0);
        }
    }
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j < UR5E_N; ++j) {
            mass[i][j] = arrival->links.M[i][j];
#if UR5E_POTENTIAL
            K[i][j] = arrival->links.K[i][j];
#endif
        }
    }
#if UR5E_ELASTIC
    for (int i = 0; i < UR5E_N; ++i) {
        const int motor = UR5E_N + i;
        mass[motor][motor] = UR5E_ROTOR(p, i);
        K[i][i] += UR5E_SPRING(p, i);
        K[motor][motor] = UR5E_SPRING(p, i);
        K[i][motor] = -UR5E_SPRING(p, i);
        K[motor][i] = -UR5E_SPRING(p, i);
    }
#endif
}

#if !UR5E_STRUCTURED
int ur5e_driven_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real *drift)
{
    ur5e_matrix mass;
    ur5e_matrix K;
    ur5e_matrix X;
    ur5e_matrix A;
    int places[UR5E_SYSTEM] = {0}; /* stays so where motors hold all */
    ur5e_real row[UR5E_SYSTEM];
    ur5e_real pull[UR5E_SYSTEM];
    int size = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < UR5E_N; ++i) { /* coordinates that no motor holds to its motion */
        if (UR5E_ELASTIC || !ur5e_has_motor[i]) {
            places[size] = i;
            row[size] = arrival->row[i];
            ++size;
        }
    }
    for (int i = 0; i < size; ++i) {
        for (int j = 0; j < size; ++j) {
            mass[i][j] = mass[places[i]][places[j]];
            K[i][j] = K[places[i]][places[j]];
        }
    }
    *drift = UR5E_R(1.0);
    modes->count = 0;
    if (!unit_motions(size, mass, X)) {
        return UR5E_SINGULAR;
    }
    congruent(size, K, X, A);
    if (!find_modes(size, places, mass, A, X, row, modes)) {
        return UR5E_SINGULAR;
    }
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}
#endif

#if !UR5E_POTENTIAL
/*
 * Most sweeps that make what modes bend orthogonal: one or two, as it nearly is, but where springs or rotors are a
 * thousand times others.
 */
#define SWEEPS_OF_SERVO 8

static ur5e_real product_of(const ur5e_real a[UR5E_SYSTEM], const ur5e_real b[UR5E_SYSTEM])
{
    ur5e_real sum = UR5E_R(0.0);
    for (int k = 0; k < UR5E_SYSTEM; ++k) {
        sum += a[k]*b[k];
    }
    return sum;
}

/*
 * QR errs by rounding of the largest squared frequency, whatever the mode. What each mode bends of springs and
 * gains, times their roots, is known better: its square is the mode's squared frequency, and two modes' are
 * orthogonal (Jacobi's rotations from one side).
 */
static void sharpen(const ur5e_params *p, ur5e_matrix bent, ur5e_modes *modes)
{
    ur5e_real known[UR5E_SYSTEM]; /* error of the root of a squared frequency */
    (void)p;
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        ur5e_real off = UR5E_R(0.0);
        for (int j = 0; j < UR5E_N; ++j) {
            const int motor = UR5E_SYSTEM - UR5E_N + j;
            const ur5e_real turned = modes->shape[i][motor];
            const ur5e_real gain = UR5E_SQRT(UR5E_GAIN(p, j));
            bent[i][motor] = gain*turned;
            off += gain*UR5E_FABS(turned);
#if UR5E_ELASTIC
            const ur5e_real root = UR5E_SQRT(UR5E_SPRING(p, j));
            bent[i][j] = root*(modes->shape[i][j] - turned);
            off += root*(UR5E_FABS(modes->shape[i][j]) + UR5E_FABS(turned));
#endif
        }
        modes->squared[i] = product_of(bent[i], bent[i]);
        known[i] = UR5E_EPSILON*off;
    }
    bool turned = true;
    for (int sweep = 0; sweep < SWEEPS_OF_SERVO && turned; ++sweep) {
        turned = false;
        for (int i = 0; i < UR5E_SYSTEM; ++i) {
            for (int j = 0; j < i; ++j) {
                const ur5e_real off = product_of(bent[i], bent[j]);
                if (off*off > UR5E_EPSILON*modes->squared[i]*modes->squared[j]) {
                    turned = true;
                    const ur5e_real t = ur5e_tangent(modes->squared[j] - modes->squared[i], off);
                    ur5e_turn_by(UR5E_SYSTEM, t, bent[j], bent[i]);
                    ur5e_turn_by(UR5E_SYSTEM, t, modes->shape[j], modes->shape[i]);
                    modes->squared[i] = product_of(bent[i], bent[i]);
                    modes->squared[j] = product_of(bent[j], bent[j]);
                }
            }
        }
    }
    for (int i = 0; i < UR5E_SYSTEM && !turned; ++i) { /* else they err as QR does */
        modes->noise[i] = known[i]*(known[i] + UR5E_R(2.0)*UR5E_SQRT(modes->squared[i]));
    }
}
#endif

int ur5e_servo_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real *drift)
{
    ur5e_matrix mass; /* and then XKX', and what modes move */
    ur5e_matrix X;
    ur5e_real (*const K)[UR5E_SYSTEM] = modes->shape; /* and then unit vectors in eigenvectors of XKX' */
    modes->count = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < UR5E_N; ++i) {
        const int motor = UR5E_SYSTEM - UR5E_N + i;
        K[motor][motor] += UR5E_GAIN(p, i);
    }
    if (!unit_motions(UR5E_SYSTEM, mass, X)) {
        return UR5E_SINGULAR;
    }
    congruent(UR5E_SYSTEM, K, X, mass);
    ur5e_real all = UR5E_R(0.0);
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        all += UR5E_FABS(mass[i][i]);
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            K[i][j] = i == j ? UR5E_R(1.0) : UR5E_R(0.0);
        }
    }
    const ur5e_real none = UR5E_EPSILON*UR5E_EPSILON;
    if (!ur5e_spectrum(UR5E_SYSTEM, none, mass, modes->squared, UR5E_SYSTEM, K, NULL)) {
        return UR5E_SINGULAR;
    }
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            ur5e_real shape = UR5E_R(0.0);
            for (int k = j; k < UR5E_SYSTEM; ++k) { /* X has nothing behind its diagonal */
                shape += X[k][j]*K[k][i];
            }
            mass[i][j] = shape;
        }
    }
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            modes->shape[i][j] = mass[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = UR5E_EPSILON*all;
    }
#if !UR5E_POTENTIAL
    sharpen(p, mass, modes);
#endif
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        modes->row[i] = UR5E_R(0.0);
        modes->start[i] = UR5E_R(0.0);
        for (int j = 0; j < UR5E_N; ++j) {
            modes->row[i] += arrival->row[j]*modes->shape[i][j];
        }
    }
    modes->count = UR5E_SYSTEM;
    modes->rigid = 0;
    modes->fastest = UR5E_REAL_MAX;
    *drift = UR5E_R(1.0);
    ur5e_real pull[UR5E_SYSTEM];
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

#if !UR5E_STRUCTURED
int ur5e_free_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes)
{
    ur5e_matrix mass;
    ur5e_matrix kept;
    ur5e_matrix K;
    ur5e_matrix X;
    ur5e_matrix A;
    int places[UR5E_SYSTEM];
    ur5e_real row[UR5E_SYSTEM];
    ur5e_real momentum[UR5E_SYSTEM]; /* before, at 1 m/s */
    whole(arrival, p, mass, K);
    whole(arrival, p, kept, K);
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        places[i] = i;
        row[i] = i < UR5E_N ? arrival->row[i] : UR5E_R(0.0);
        momentum[i] = UR5E_R(0.0);
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            momentum[i] += kept[i][j]*arrival->rates[j % UR5E_N];
        }
    }
    modes->count = 0;
    if (!unit_motions(UR5E_SYSTEM, mass, X)) {
        return UR5E_SINGULAR;
    }
    congruent(UR5E_SYSTEM, K, X, A);
    if (!find_modes(UR5E_SYSTEM, places, mass, A, X, row, modes)) {
        return UR5E_SINGULAR;
    }
    for (int i = 0; i < modes->count; ++i) {
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            modes->start[i] += modes->shape[i][j]*momentum[j];
        }
    }
    return UR5E_OK;
}
#endif
