/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of panda_ by what its motors do: drive on, servo, or turn freely.
 *
 * With z the deviation from the motion before the impact, M z'' + K z = -J'n f - (P rates) v t, where
 * P is the curvature of gravity and of springs of the model file; z is over links whose motors drive,
 * and over links and motors where a servo leads these.
 */
#include "panda_impact.h"

/* X = L^-1 of a mass matrix M = L L': its rows are motions of unit mass, with nothing behind its diagonal. */
static bool unit_motions(int size, panda_matrix mass, panda_matrix X)
{
    if (!panda_cholesky(size, mass)) {
        return false;
    }
    for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
            X[j][i] = i == j ? PANDA_R(1.0) : PANDA_R(0.0);
        }
        panda_backward(j + 1, mass, X[j]);
    }
    return true;
}

/* A = XKX' of such an X. */
static void congruent(int size, panda_matrix K, panda_matrix X, panda_matrix A)
{
    for (int i = 0; i < size; ++i) {
        panda_real pulled[PANDA_SYSTEM];
        for (int l = 0; l <= i; ++l) {
            pulled[l] = PANDA_R(0.0);
            for (int m = 0; m <= i; ++m) {
                pulled[l] += K[l][m]*X[i][m];
            }
        }
        for (int j = 0; j <= i; ++j) {
            panda_real sum = PANDA_R(0.0);
            for (int l = 0; l <= j; ++l) {
                sum += pulled[l]*X[j][l];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
    }
}

#if !PANDA_STRUCTURED
/*
 * Modes: the eigenvectors of A = XKX' in X, over the coordinates `places`, of the mass L L'. An entry of A errs by
 * rounding times the root of its diagonal entries' product, so a mode's squared frequency by as much of the
 * squared sum of these roots' shares in it. False if eigenvectors are not found.
 */
static bool find_modes(int size, const int *places, panda_matrix L, panda_matrix A, panda_matrix X,
    const panda_real *row, panda_modes *modes)
{
    panda_real roots[PANDA_SYSTEM];
    for (int i = 0; i < size; ++i) {
        roots[i] = PANDA_SQRT(PANDA_FABS(A[i][i]));
    }
    const bool found = panda_diagonalise(size, A, X);
    for (int i = 0; i < size; ++i) {
        panda_real held = PANDA_R(0.0);
        for (int l = 0; l < size; ++l) { /* what X was, times a share, is what it is: share = L'x */
            panda_real share = PANDA_R(0.0);
            for (int m = l; m < size; ++m) {
                share += L[m][l]*X[i][m];
            }
            held += roots[l]*PANDA_FABS(share);
        }
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            modes->shape[i][j] = PANDA_R(0.0);
        }
        panda_real sum = PANDA_R(0.0);
        for (int j = 0; j < size; ++j) {
            modes->shape[i][places[j]] = X[i][j];
            sum += row[j]*X[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = PANDA_EPSILON*held*held;
        modes->squared[i] = A[i][i];
        modes->row[i] = sum;
        modes->start[i] = PANDA_R(0.0);
    }
    modes->count = size;
    modes->rigid = 0;
    modes->fastest = PANDA_REAL_MAX;
    return found;
}
#endif

/* P rates: what gravity and the model's own springs pull on as the motion before goes on, over v t. */
static void pulled_on(const panda_arrival *arrival, panda_real pull[PANDA_SYSTEM])
{
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        pull[i] = PANDA_R(0.0);
    }
#if PANDA_POTENTIAL
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j < PANDA_N; ++j) {
            pull[i] += arrival->links.K[i][j]*arrival->rates[j];
        }
    }
#else
    (void)arrival;
#endif
}

/* Turns a pull that grows with time into a drift and rates of modes. */
static int lead(const panda_real pull[PANDA_SYSTEM], panda_modes *modes, panda_real *drift)
{
    for (int i = 0; i < modes->count; ++i) {
        panda_real along = PANDA_R(0.0);
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            along += modes->shape[i][j]*pull[j];
        }
        if (PANDA_FABS(along) > PANDA_R(0.0)) {
            if (!(PANDA_FABS(modes->squared[i]) > PANDA_R(0.0))) {
                return PANDA_UNRESOLVED;
            }
            modes->start[i] = along/modes->squared[i];
            *drift -= modes->row[i]*modes->start[i];
        }
    }
    return PANDA_OK;
}

/* Mass and stiffness over links, and over motors where there are springs between. */
static void whole(const panda_arrival *arrival, const panda_params *p, panda_matrix mass, panda_matrix K)
{
    (void)p;
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            mass[i][j] = PANDA_R(0.0);
            K[i][j] = PANDA_R(0.0);
        }
    }
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j < PANDA_N; ++j) {
            mass[i][j] = arrival->links.M[i][j];
#if PANDA_POTENTIAL
            K[i][j] = arrival->links.K[i][j];
#endif
        }
    }
#if PANDA_ELASTIC
    for (int i = 0; i < PANDA_N; ++i) {
        const int motor = PANDA_N + i;
        mass[motor][motor] = PANDA_ROTOR(p, i);
        K[i][i] += PANDA_SPRING(p, i);
        K[motor][motor] = PANDA_SPRING(p, i);
        K[i][motor] = -PANDA_SPRING(p, i);
        K[motor][i] = -PANDA_SPRING(p, i);
    }
#endif
}

#if !PANDA_STRUCTURED
int panda_driven_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift)
{
    panda_matrix mass;
    panda_matrix K;
    panda_matrix X;
    panda_matrix A;
    int places[PANDA_SYSTEM] = {0}; /* stays so where motors hold all */
    panda_real row[PANDA_SYSTEM];
    panda_real pull[PANDA_SYSTEM];
    int size = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < PANDA_N; ++i) { /* coordinates that no motor holds to its motion */
        if (PANDA_ELASTIC || !panda_has_motor[i]) {
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
    *drift = PANDA_R(1.0);
    modes->count = 0;
    if (!unit_motions(size, mass, X)) {
        return PANDA_SINGULAR;
    }
    congruent(size, K, X, A);
    if (!find_modes(size, places, mass, A, X, row, modes)) {
        return PANDA_SINGULAR;
    }
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}
#endif

#if !PANDA_POTENTIAL
/*
 * Most sweeps that make what modes bend orthogonal: one or two, as it nearly is, but where springs or rotors are a
 * thousand times others.
 */
#define SWEEPS_OF_SERVO 8

static panda_real product_of(const panda_real a[PANDA_SYSTEM], const panda_real b[PANDA_SYSTEM])
{
    panda_real sum = PANDA_R(0.0);
    for (int k = 0; k < PANDA_SYSTEM; ++k) {
        sum += a[k]*b[k];
    }
    return sum;
}

/*
 * QR errs by rounding of the largest squared frequency, whatever the mode. What each mode bends of springs and
 * gains, times their roots, is known better: its square is the mode's squared frequency, and two modes' are
 * orthogonal (Jacobi's rotations from one side).
 */
static void sharpen(const panda_params *p, panda_matrix bent, panda_modes *modes)
{
    panda_real known[PANDA_SYSTEM]; /* error of the root of a squared frequency */
    (void)p;
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        panda_real off = PANDA_R(0.0);
        for (int j = 0; j < PANDA_N; ++j) {
            const int motor = PANDA_SYSTEM - PANDA_N + j;
            const panda_real turned = modes->shape[i][motor];
            const panda_real gain = PANDA_SQRT(PANDA_GAIN(p, j));
            bent[i][motor] = gain*turned;
            off += gain*PANDA_FABS(turned);
#if PANDA_ELASTIC
            const panda_real root = PANDA_SQRT(PANDA_SPRING(p, j));
            bent[i][j] = root*(modes->shape[i][j] - turned);
            off += root*(PANDA_FABS(modes->shape[i][j]) + PANDA_FABS(turned));
#endif
        }
        modes->squared[i] = product_of(bent[i], bent[i]);
        known[i] = PANDA_EPSILON*off;
    }
    bool turned = true;
    for (int sweep = 0; sweep < SWEEPS_OF_SERVO && turned; ++sweep) {
        turned = false;
        for (int i = 0; i < PANDA_SYSTEM; ++i) {
            for (int j = 0; j < i; ++j) {
                const panda_real off = product_of(bent[i], bent[j]);
                if (off*off > PANDA_EPSILON*modes->squared[i]*modes->squared[j]) {
                    turned = true;
                    const panda_real t = panda_tangent(modes->squared[j] - modes->squared[i], off);
                    panda_turn_by(PANDA_SYSTEM, t, bent[j], bent[i]);
                    panda_turn_by(PANDA_SYSTEM, t, modes->shape[j], modes->shape[i]);
                    modes->squared[i] = product_of(bent[i], bent[i]);
                    modes->squared[j] = product_of(bent[j], bent[j]);
                }
            }
        }
    }
    for (int i = 0; i < PANDA_SYSTEM && !turned; ++i) { /* else they err as QR does */
        modes->noise[i] = known[i]*(known[i] + PANDA_R(2.0)*PANDA_SQRT(modes->squared[i]));
    }
}
#endif

int panda_servo_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift)
{
    panda_matrix mass; /* and then XKX', and what modes move */
    panda_matrix X;
    panda_real (*const K)[PANDA_SYSTEM] = modes->shape; /* and then unit vectors in eigenvectors of XKX' */
    modes->count = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < PANDA_N; ++i) {
        const int motor = PANDA_SYSTEM - PANDA_N + i;
        K[motor][motor] += PANDA_GAIN(p, i);
    }
    if (!unit_motions(PANDA_SYSTEM, mass, X)) {
        return PANDA_SINGULAR;
    }
    congruent(PANDA_SYSTEM, K, X, mass);
    panda_real all = PANDA_R(0.0);
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        all += PANDA_FABS(mass[i][i]);
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            K[i][j] = i == j ? PANDA_R(1.0) : PANDA_R(0.0);
        }
    }
    const panda_real none = PANDA_EPSILON*PANDA_EPSILON;
    if (!panda_spectrum(PANDA_SYSTEM, none, mass, modes->squared, PANDA_SYSTEM, K, NULL)) {
        return PANDA_SINGULAR;
    }
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            panda_real shape = PANDA_R(0.0);
            for (int k = j; k < PANDA_SYSTEM; ++k) { /* X has nothing behind its diagonal */
                shape += X[k][j]*K[k][i];
            }
            mass[i][j] = shape;
        }
    }
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            modes->shape[i][j] = mass[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = PANDA_EPSILON*all;
    }
#if !PANDA_POTENTIAL
    sharpen(p, mass, modes);
#endif
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        modes->row[i] = PANDA_R(0.0);
        modes->start[i] = PANDA_R(0.0);
        for (int j = 0; j < PANDA_N; ++j) {
            modes->row[i] += arrival->row[j]*modes->shape[i][j];
        }
    }
    modes->count = PANDA_SYSTEM;
    modes->rigid = 0;
    modes->fastest = PANDA_REAL_MAX;
    *drift = PANDA_R(1.0);
    panda_real pull[PANDA_SYSTEM];
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

#if !PANDA_STRUCTURED
int panda_free_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes)
{
    panda_matrix mass;
    panda_matrix kept;
    panda_matrix K;
    panda_matrix X;
    panda_matrix A;
    int places[PANDA_SYSTEM];
    panda_real row[PANDA_SYSTEM];
    panda_real momentum[PANDA_SYSTEM]; /* before, at 1 m/s */
    whole(arrival, p, mass, K);
    whole(arrival, p, kept, K);
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        places[i] = i;
        row[i] = i < PANDA_N ? arrival->row[i] : PANDA_R(0.0);
        momentum[i] = PANDA_R(0.0);
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            momentum[i] += kept[i][j]*arrival->rates[j % PANDA_N];
        }
    }
    modes->count = 0;
    if (!unit_motions(PANDA_SYSTEM, mass, X)) {
        return PANDA_SINGULAR;
    }
    congruent(PANDA_SYSTEM, K, X, A);
    if (!find_modes(PANDA_SYSTEM, places, mass, A, X, row, modes)) {
        return PANDA_SINGULAR;
    }
    for (int i = 0; i < modes->count; ++i) {
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            modes->start[i] += modes->shape[i][j]*momentum[j];
        }
    }
    return PANDA_OK;
}
#endif
