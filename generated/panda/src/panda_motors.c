/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of panda_ by what its motors do: drive on, servo, or turn freely.
 *
 * With z the deviation from the motion before the impact, M z'' + K z = -J'n f - (P rates) v t, where
 * P is the curvature of gravity and of springs of the model file; z is over links whose motors drive,
 * and over links and motors where a servo leads these.
 */
#include "panda_impact.h"

/* Share of the largest entry that rounding leaves of one that should be none. */
#define NOISE (PANDA_R(8.0)*PANDA_EPSILON)

/* X = L^-T of a mass matrix M = L L': its columns are motions of unit mass. */
static bool unit_motions(int size, panda_matrix mass, panda_matrix X)
{
    if (!panda_cholesky(size, mass)) {
        return false;
    }
    for (int j = 0; j < size; ++j) {
        panda_real column[PANDA_SYSTEM];
        for (int i = 0; i < size; ++i) {
            column[i] = i == j ? PANDA_R(1.0) : PANDA_R(0.0);
        }
        panda_backward(size, mass, column);
        for (int i = 0; i < size; ++i) {
            X[i][j] = column[i];
        }
    }
    return true;
}

#if PANDA_STRUCTURED
/* A = X' diag(k) X. */
static void stretch(const panda_real *k, panda_matrix X, panda_matrix A)
{
    for (int i = 0; i < PANDA_N; ++i) {
        panda_real pulled[PANDA_N];
        for (int l = 0; l < PANDA_N; ++l) {
            pulled[l] = k[l]*X[l][i];
        }
        for (int j = 0; j <= i; ++j) {
            panda_real sum = PANDA_R(0.0);
            for (int l = 0; l < PANDA_N; ++l) {
                sum += pulled[l]*X[l][j];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
    }
}
#endif

/* A = X'KX; returns the noise in its entries. */
static panda_real congruent(int size, panda_matrix K, panda_matrix X, panda_matrix A)
{
    panda_real largest = PANDA_R(0.0);
    for (int i = 0; i < size; ++i) {
        panda_real pulled[PANDA_SYSTEM];
        for (int l = 0; l < size; ++l) {
            pulled[l] = PANDA_R(0.0);
            for (int m = 0; m < size; ++m) {
                pulled[l] += K[l][m]*X[m][i];
            }
        }
        for (int j = 0; j <= i; ++j) {
            panda_real sum = PANDA_R(0.0);
            for (int l = 0; l < size; ++l) {
                sum += pulled[l]*X[l][j];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
        largest = PANDA_FMAX(largest, PANDA_FABS(A[i][i]));
    }
    return NOISE*largest;
}

/* Appends the eigenvectors X, over the coordinates `places`, to modes. */
static void append(int size, const int *places, panda_matrix A, panda_matrix X, const panda_real *row,
    panda_modes *modes)
{
    const int first = modes->count;
    for (int i = 0; i < size; ++i) {
        const int at = first + i;
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            modes->shape[j][at] = PANDA_R(0.0);
        }
        panda_real sum = PANDA_R(0.0);
        for (int j = 0; j < size; ++j) {
            modes->shape[places[j]][at] = X[j][i];
            sum += row[j]*X[j][i];
        }
        modes->squared[at] = A[i][i];
        modes->row[at] = sum;
        modes->start[at] = PANDA_R(0.0);
    }
    modes->count = first + size;
}

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
            along += modes->shape[j][i]*pull[j];
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
#if !PANDA_STRUCTURED
            K[i][j] = K[places[i]][places[j]];
#endif
        }
    }
    *drift = PANDA_R(1.0);
    modes->count = 0;
    if (!unit_motions(size, mass, X)) {
        return PANDA_SINGULAR;
    }
#if PANDA_STRUCTURED
    panda_real k[PANDA_N];
    for (int i = 0; i < PANDA_N; ++i) {
        k[i] = PANDA_SPRING(p, i);
    }
    stretch(k, X, A);
    const panda_real noise = PANDA_R(0.0);
#else
    const panda_real noise = congruent(size, K, X, A);
#endif
    if (!panda_diagonalise(size, A, X, noise)) {
        return PANDA_SINGULAR;
    }
    append(size, places, A, X, row, modes);
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

int panda_servo_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift)
{
    panda_matrix mass;
    panda_matrix K;
    panda_matrix X;
    panda_matrix A;
    int places[PANDA_SYSTEM];
    panda_real row[PANDA_SYSTEM];
    whole(arrival, p, mass, K);
    for (int i = 0; i < PANDA_SYSTEM; ++i) {
        places[i] = i;
        row[i] = i < PANDA_N ? arrival->row[i] : PANDA_R(0.0);
    }
    for (int i = 0; i < PANDA_N; ++i) {
        const int motor = PANDA_SYSTEM - PANDA_N + i;
        K[motor][motor] += PANDA_GAIN(p, i);
    }
    modes->count = 0;
    if (!unit_motions(PANDA_SYSTEM, mass, X)) {
        return PANDA_SINGULAR;
    }
    const panda_real noise = congruent(PANDA_SYSTEM, K, X, A);
    if (!panda_diagonalise(PANDA_SYSTEM, A, X, noise)) {
        return PANDA_SINGULAR;
    }
    append(PANDA_SYSTEM, places, A, X, row, modes);
    modes->noise = noise;
    *drift = PANDA_R(1.0);
    panda_real pull[PANDA_SYSTEM];
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

#if PANDA_STRUCTURED
/*
 * Deflections d of the springs, by d'' + (1/M + 1/B) k d = -(1/M) J'n f, and the motion r of links
 * and rotors together: x = J r + g'd with g = B (M + B)^-1 J'n.
 */
int panda_free_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real carried[PANDA_N])
{
    panda_matrix mass;
    panda_matrix X;
    panda_matrix A;
    panda_matrix mobility;
    int places[PANDA_SYSTEM];
    panda_real k[PANDA_N];
    (void)p;
    panda_real moved[PANDA_N]; /* (M + B)^-1 J'n */
    for (int i = 0; i < PANDA_N; ++i) {
        places[i] = i;
        k[i] = PANDA_SPRING(p, i);
        moved[i] = arrival->row[i];
        for (int j = 0; j < PANDA_N; ++j) {
            mass[i][j] = arrival->links.M[i][j];
            A[i][j] = mass[i][j];
        }
        A[i][i] += PANDA_ROTOR(p, i);
    }
    if (!unit_motions(PANDA_N, mass, X) || !panda_cholesky(PANDA_N, A)) {
        return PANDA_SINGULAR;
    }
    panda_forward(PANDA_N, A, moved);
    panda_backward(PANDA_N, A, moved);
    panda_real together = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        together += arrival->row[i]*moved[i];
        carried[i] = PANDA_ROTOR(p, i)*moved[i];
        for (int j = 0; j <= i; ++j) {
            panda_real sum = PANDA_R(0.0);
            for (int l = i; l < PANDA_N; ++l) {
                sum += X[i][l]*X[j][l];
            }
            mobility[i][j] = sum;
            mobility[j][i] = sum;
        }
        mobility[i][i] += PANDA_R(1.0)/PANDA_ROTOR(p, i);
    }
    if (!(together > PANDA_R(0.0)) || !panda_cholesky(PANDA_N, mobility)) {
        return PANDA_SINGULAR;
    }
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j < PANDA_N; ++j) {
            X[i][j] = j <= i ? mobility[i][j] : PANDA_R(0.0);
        }
    }
    stretch(k, X, A);
    if (!panda_diagonalise(PANDA_N, A, X, PANDA_R(0.0))) {
        return PANDA_SINGULAR;
    }
    modes->count = 1; /* the first: r */
    modes->squared[0] = PANDA_R(0.0);
    modes->row[0] = PANDA_SQRT(together);
    modes->start[0] = PANDA_R(1.0)/modes->row[0];
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        modes->shape[j][0] = PANDA_R(0.0);
    }
    append(PANDA_N, places, A, X, carried, modes);
    return PANDA_OK;
}
#else
int panda_free_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real carried[PANDA_N])
{
    panda_matrix mass;
    panda_matrix kept;
    panda_matrix K;
    panda_matrix X;
    panda_matrix A;
    int places[PANDA_SYSTEM];
    panda_real row[PANDA_SYSTEM];
    panda_real momentum[PANDA_SYSTEM]; /* before, at 1 m/s */
    (void)carried;
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
    const panda_real noise = congruent(PANDA_SYSTEM, K, X, A);
    if (!panda_diagonalise(PANDA_SYSTEM, A, X, noise)) {
        return PANDA_SINGULAR;
    }
    append(PANDA_SYSTEM, places, A, X, row, modes);
    for (int i = 0; i < modes->count; ++i) {
        for (int j = 0; j < PANDA_SYSTEM; ++j) {
            modes->start[i] += modes->shape[j][i]*momentum[j];
        }
    }
    return PANDA_OK;
}
#endif
