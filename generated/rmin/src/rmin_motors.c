/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of rmin_ by what its motors do: drive on, servo, or turn freely.
 *
 * With z the deviation from the motion before the impact, M z'' + K z = -J'n f - (P rates) v t, where
 * P is the curvature of gravity and of springs of the model file; z is over links whose motors drive,
 * and over links and motors where a servo leads these.
 */
#include "rmin_impact.h"

/* X = L^-1 of a mass matrix M = L L': its rows are motions of unit mass, with nothing behind its diagonal. */
static bool unit_motions(int size, rmin_matrix mass, rmin_matrix X)
{
    if (!rmin_cholesky(size, mass)) {
        return false;
    }
    for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
            X[j][i] = i == j ? RMIN_R(1.0) : RMIN_R(0.0);
        }
        rmin_backward(j + 1, mass, X[j]);
    }
    return true;
}

/* A = XKX' of such an X. */
static void congruent(int size, rmin_matrix K, rmin_matrix X, rmin_matrix A)
{
    for (int i = 0; i < size; ++i) {
        rmin_real pulled[RMIN_SYSTEM];
        for (int l = 0; l <= i; ++l) {
            pulled[l] = RMIN_R(0.0);
            for (int m = 0; m <= i; ++m) {
                pulled[l] += K[l][m]*X[i][m];
            }
        }
        for (int j = 0; j <= i; ++j) {
            rmin_real sum = RMIN_R(0.0);
            for (int l = 0; l <= j; ++l) {
                sum += pulled[l]*X[j][l];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
    }
}

#if !RMIN_STRUCTURED
/*
 * Modes: the eigenvectors of A = XKX' in X, over the coordinates `places`, of the mass L L'. An entry of A errs by
 * rounding times the root of its diagonal entries' product, so a mode's squared frequency by as much of the
 * squared sum of these roots' shares in it. False if eigenvectors are not found.
 */
static bool find_modes(int size, const int *places, rmin_matrix L, rmin_matrix A, rmin_matrix X,
    const rmin_real *row, rmin_modes *modes)
{
    rmin_real roots[RMIN_SYSTEM];
    for (int i = 0; i < size; ++i) {
        roots[i] = RMIN_SQRT(RMIN_FABS(A[i][i]));
    }
    const bool found = rmin_diagonalise(size, A, X);
    for (int i = 0; i < size; ++i) {
        rmin_real held = RMIN_R(0.0);
        for (int l = 0; l < size; ++l) { /* what X was, times a share, is what it is: share = L'x */
            rmin_real share = RMIN_R(0.0);
            for (int m = l; m < size; ++m) {
                share += L[m][l]*X[i][m];
            }
            held += roots[l]*RMIN_FABS(share);
        }
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            modes->shape[i][j] = RMIN_R(0.0);
        }
        rmin_real sum = RMIN_R(0.0);
        for (int j = 0; j < size; ++j) {
            modes->shape[i][places[j]] = X[i][j];
            sum += row[j]*X[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = RMIN_EPSILON*held*held;
        modes->squared[i] = A[i][i];
        modes->row[i] = sum;
        modes->start[i] = RMIN_R(0.0);
    }
    modes->count = size;
    modes->rigid = 0;
    modes->fastest = RMIN_REAL_MAX;
    return found;
}
#endif

/* P rates: what gravity and the model's own springs pull on as the motion before goes on, over v t. */
static void pulled_on(const rmin_arrival *arrival, rmin_real pull[RMIN_SYSTEM])
{
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        pull[i] = RMIN_R(0.0);
    }
#if RMIN_POTENTIAL
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j < RMIN_N; ++j) {
            pull[i] += arrival->links.K[i][j]*arrival->rates[j];
        }
    }
#else
    (void)arrival;
#endif
}

/* Turns a pull that grows with time into a drift and rates of modes. */
static int lead(const rmin_real pull[RMIN_SYSTEM], rmin_modes *modes, rmin_real *drift)
{
    for (int i = 0; i < modes->count; ++i) {
        rmin_real along = RMIN_R(0.0);
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            along += modes->shape[i][j]*pull[j];
        }
        if (RMIN_FABS(along) > RMIN_R(0.0)) {
            if (!(RMIN_FABS(modes->squared[i]) > RMIN_R(0.0))) {
                return RMIN_UNRESOLVED;
            }
            modes->start[i] = along/modes->squared[i];
            *drift -= modes->row[i]*modes->start[i];
        }
    }
    return RMIN_OK;
}

/* Mass and stiffness over links, and over motors where there are springs between. */
static void whole(const rmin_arrival *arrival, const rmin_params *p, rmin_matrix mass, rmin_matrix K)
{
    (void)p;
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            mass[i][j] = RMIN_R(0.0);
            K[i][j] = RMIN_R(0.0);
        }
    }
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j < RMIN_N; ++j) {
            mass[i][j] = arrival->links.M[i][j];
#if RMIN_POTENTIAL
            K[i][j] = arrival->links.K[i][j];
#endif
        }
    }
#if RMIN_ELASTIC
    for (int i = 0; i < RMIN_N; ++i) {
        const int motor = RMIN_N + i;
        mass[motor][motor] = RMIN_ROTOR(p, i);
        K[i][i] += RMIN_SPRING(p, i);
        K[motor][motor] = RMIN_SPRING(p, i);
        K[i][motor] = -RMIN_SPRING(p, i);
        K[motor][i] = -RMIN_SPRING(p, i);
    }
#endif
}

#if !RMIN_STRUCTURED
int rmin_driven_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real *drift)
{
    rmin_matrix mass;
    rmin_matrix K;
    rmin_matrix X;
    rmin_matrix A;
    int places[RMIN_SYSTEM] = {0}; /* stays so where motors hold all */
    rmin_real row[RMIN_SYSTEM];
    rmin_real pull[RMIN_SYSTEM];
    int size = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < RMIN_N; ++i) { /* coordinates that no motor holds to its motion */
        if (RMIN_ELASTIC || !rmin_has_motor[i]) {
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
    *drift = RMIN_R(1.0);
    modes->count = 0;
    if (!unit_motions(size, mass, X)) {
        return RMIN_SINGULAR;
    }
    congruent(size, K, X, A);
    if (!find_modes(size, places, mass, A, X, row, modes)) {
        return RMIN_SINGULAR;
    }
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}
#endif

#if !RMIN_POTENTIAL
/*
 * Most sweeps that make what modes bend orthogonal: one or two, as it nearly is, but where springs or rotors are a
 * thousand times others.
 */
#define SWEEPS_OF_SERVO 8

static rmin_real product_of(const rmin_real a[RMIN_SYSTEM], const rmin_real b[RMIN_SYSTEM])
{
    rmin_real sum = RMIN_R(0.0);
    for (int k = 0; k < RMIN_SYSTEM; ++k) {
        sum += a[k]*b[k];
    }
    return sum;
}

/*
 * QR errs by rounding of the largest squared frequency, whatever the mode. What each mode bends of springs and
 * gains, times their roots, is known better: its square is the mode's squared frequency, and two modes' are
 * orthogonal (Jacobi's rotations from one side).
 */
static void sharpen(const rmin_params *p, rmin_matrix bent, rmin_modes *modes)
{
    rmin_real known[RMIN_SYSTEM]; /* error of the root of a squared frequency */
    (void)p;
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        rmin_real off = RMIN_R(0.0);
        for (int j = 0; j < RMIN_N; ++j) {
            const int motor = RMIN_SYSTEM - RMIN_N + j;
            const rmin_real turned = modes->shape[i][motor];
            const rmin_real gain = RMIN_SQRT(RMIN_GAIN(p, j));
            bent[i][motor] = gain*turned;
            off += gain*RMIN_FABS(turned);
#if RMIN_ELASTIC
            const rmin_real root = RMIN_SQRT(RMIN_SPRING(p, j));
            bent[i][j] = root*(modes->shape[i][j] - turned);
            off += root*(RMIN_FABS(modes->shape[i][j]) + RMIN_FABS(turned));
#endif
        }
        modes->squared[i] = product_of(bent[i], bent[i]);
        known[i] = RMIN_EPSILON*off;
    }
    bool turned = true;
    for (int sweep = 0; sweep < SWEEPS_OF_SERVO && turned; ++sweep) {
        turned = false;
        for (int i = 0; i < RMIN_SYSTEM; ++i) {
            for (int j = 0; j < i; ++j) {
                const rmin_real off = product_of(bent[i], bent[j]);
                if (off*off > RMIN_EPSILON*modes->squared[i]*modes->squared[j]) {
                    turned = true;
                    const rmin_real t = rmin_tangent(modes->squared[j] - modes->squared[i], off);
                    rmin_turn_by(RMIN_SYSTEM, t, bent[j], bent[i]);
                    rmin_turn_by(RMIN_SYSTEM, t, modes->shape[j], modes->shape[i]);
                    modes->squared[i] = product_of(bent[i], bent[i]);
                    modes->squared[j] = product_of(bent[j], bent[j]);
                }
            }
        }
    }
    for (int i = 0; i < RMIN_SYSTEM && !turned; ++i) { /* else they err as QR does */
        modes->noise[i] = known[i]*(known[i] + RMIN_R(2.0)*RMIN_SQRT(modes->squared[i]));
    }
}
#endif

int rmin_servo_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real *drift)
{
    rmin_matrix mass; /* and then XKX', and what modes move */
    rmin_matrix X;
    rmin_real (*const K)[RMIN_SYSTEM] = modes->shape; /* and then unit vectors in eigenvectors of XKX' */
    modes->count = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < RMIN_N; ++i) {
        const int motor = RMIN_SYSTEM - RMIN_N + i;
        K[motor][motor] += RMIN_GAIN(p, i);
    }
    if (!unit_motions(RMIN_SYSTEM, mass, X)) {
        return RMIN_SINGULAR;
    }
    congruent(RMIN_SYSTEM, K, X, mass);
    rmin_real all = RMIN_R(0.0);
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        all += RMIN_FABS(mass[i][i]);
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            K[i][j] = i == j ? RMIN_R(1.0) : RMIN_R(0.0);
        }
    }
    const rmin_real none = RMIN_EPSILON*RMIN_EPSILON;
    if (!rmin_spectrum(RMIN_SYSTEM, none, mass, modes->squared, RMIN_SYSTEM, K, NULL)) {
        return RMIN_SINGULAR;
    }
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            rmin_real shape = RMIN_R(0.0);
            for (int k = j; k < RMIN_SYSTEM; ++k) { /* X has nothing behind its diagonal */
                shape += X[k][j]*K[k][i];
            }
            mass[i][j] = shape;
        }
    }
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            modes->shape[i][j] = mass[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = RMIN_EPSILON*all;
    }
#if !RMIN_POTENTIAL
    sharpen(p, mass, modes);
#endif
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        modes->row[i] = RMIN_R(0.0);
        modes->start[i] = RMIN_R(0.0);
        for (int j = 0; j < RMIN_N; ++j) {
            modes->row[i] += arrival->row[j]*modes->shape[i][j];
        }
    }
    modes->count = RMIN_SYSTEM;
    modes->rigid = 0;
    modes->fastest = RMIN_REAL_MAX;
    *drift = RMIN_R(1.0);
    rmin_real pull[RMIN_SYSTEM];
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

#if !RMIN_STRUCTURED
int rmin_free_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes)
{
    rmin_matrix mass;
    rmin_matrix kept;
    rmin_matrix K;
    rmin_matrix X;
    rmin_matrix A;
    int places[RMIN_SYSTEM];
    rmin_real row[RMIN_SYSTEM];
    rmin_real momentum[RMIN_SYSTEM]; /* before, at 1 m/s */
    whole(arrival, p, mass, K);
    whole(arrival, p, kept, K);
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        places[i] = i;
        row[i] = i < RMIN_N ? arrival->row[i] : RMIN_R(0.0);
        momentum[i] = RMIN_R(0.0);
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            momentum[i] += kept[i][j]*arrival->rates[j % RMIN_N];
        }
    }
    modes->count = 0;
    if (!unit_motions(RMIN_SYSTEM, mass, X)) {
        return RMIN_SINGULAR;
    }
    congruent(RMIN_SYSTEM, K, X, A);
    if (!find_modes(RMIN_SYSTEM, places, mass, A, X, row, modes)) {
        return RMIN_SINGULAR;
    }
    for (int i = 0; i < modes->count; ++i) {
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            modes->start[i] += modes->shape[i][j]*momentum[j];
        }
    }
    return RMIN_OK;
}
#endif
