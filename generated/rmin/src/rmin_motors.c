/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of rmin_ by what its motors do: drive on, servo, or turn freely.
 *
 * With z the deviation from the motion before the impact, M z'' + K z = -J'n f - (P rates) v t, where
 * P is the curvature of gravity and of springs of the model file; z is over links whose motors drive,
 * and over links and motors where a servo leads these.
 */
#include "rmin_impact.h"

/* Share of the largest entry that rounding leaves of one that should be none. */
#define NOISE (RMIN_R(8.0)*RMIN_EPSILON)

/* X = L^-T of a mass matrix M = L L': its columns are motions of unit mass. */
static bool unit_motions(int size, rmin_matrix mass, rmin_matrix X)
{
    if (!rmin_cholesky(size, mass)) {
        return false;
    }
    for (int j = 0; j < size; ++j) {
        rmin_real column[RMIN_SYSTEM];
        for (int i = 0; i < size; ++i) {
            column[i] = i == j ? RMIN_R(1.0) : RMIN_R(0.0);
        }
        rmin_backward(size, mass, column);
        for (int i = 0; i < size; ++i) {
            X[i][j] = column[i];
        }
    }
    return true;
}

#if RMIN_STRUCTURED
/* A = X' diag(k) X. */
static void stretch(const rmin_real *k, rmin_matrix X, rmin_matrix A)
{
    for (int i = 0; i < RMIN_N; ++i) {
        rmin_real pulled[RMIN_N];
        for (int l = 0; l < RMIN_N; ++l) {
            pulled[l] = k[l]*X[l][i];
        }
        for (int j = 0; j <= i; ++j) {
            rmin_real sum = RMIN_R(0.0);
            for (int l = 0; l < RMIN_N; ++l) {
                sum += pulled[l]*X[l][j];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
    }
}
#endif

/* A = X'KX; returns the noise in its entries. */
static rmin_real congruent(int size, rmin_matrix K, rmin_matrix X, rmin_matrix A)
{
    rmin_real largest = RMIN_R(0.0);
    for (int i = 0; i < size; ++i) {
        rmin_real pulled[RMIN_SYSTEM];
        for (int l = 0; l < size; ++l) {
            pulled[l] = RMIN_R(0.0);
            for (int m = 0; m < size; ++m) {
                pulled[l] += K[l][m]*X[m][i];
            }
        }
        for (int j = 0; j <= i; ++j) {
            rmin_real sum = RMIN_R(0.0);
            for (int l = 0; l < size; ++l) {
                sum += pulled[l]*X[l][j];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
        largest = RMIN_FMAX(largest, RMIN_FABS(A[i][i]));
    }
    return NOISE*largest;
}

/* Appends the eigenvectors X, over the coordinates `places`, to modes. */
static void append(int size, const int *places, rmin_matrix A, rmin_matrix X, const rmin_real *row,
    rmin_modes *modes)
{
    const int first = modes->count;
    for (int i = 0; i < size; ++i) {
        const int at = first + i;
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            modes->shape[j][at] = RMIN_R(0.0);
        }
        rmin_real sum = RMIN_R(0.0);
        for (int j = 0; j < size; ++j) {
            modes->shape[places[j]][at] = X[j][i];
            sum += row[j]*X[j][i];
        }
        modes->squared[at] = A[i][i];
        modes->row[at] = sum;
        modes->start[at] = RMIN_R(0.0);
    }
    modes->count = first + size;
}

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
            along += modes->shape[j][i]*pull[j];
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
#if !RMIN_STRUCTURED
            K[i][j] = K[places[i]][places[j]];
#endif
        }
    }
    *drift = RMIN_R(1.0);
    modes->count = 0;
    if (!unit_motions(size, mass, X)) {
        return RMIN_SINGULAR;
    }
#if RMIN_STRUCTURED
    rmin_real k[RMIN_N];
    for (int i = 0; i < RMIN_N; ++i) {
        k[i] = RMIN_SPRING(p, i);
    }
    stretch(k, X, A);
    const rmin_real noise = RMIN_R(0.0);
#else
    const rmin_real noise = congruent(size, K, X, A);
#endif
    if (!rmin_diagonalise(size, A, X, noise)) {
        return RMIN_SINGULAR;
    }
    append(size, places, A, X, row, modes);
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

int rmin_servo_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real *drift)
{
    rmin_matrix mass;
    rmin_matrix K;
    rmin_matrix X;
    rmin_matrix A;
    int places[RMIN_SYSTEM];
    rmin_real row[RMIN_SYSTEM];
    whole(arrival, p, mass, K);
    for (int i = 0; i < RMIN_SYSTEM; ++i) {
        places[i] = i;
        row[i] = i < RMIN_N ? arrival->row[i] : RMIN_R(0.0);
    }
    for (int i = 0; i < RMIN_N; ++i) {
        const int motor = RMIN_SYSTEM - RMIN_N + i;
        K[motor][motor] += RMIN_GAIN(p, i);
    }
    modes->count = 0;
    if (!unit_motions(RMIN_SYSTEM, mass, X)) {
        return RMIN_SINGULAR;
    }
    const rmin_real noise = congruent(RMIN_SYSTEM, K, X, A);
    if (!rmin_diagonalise(RMIN_SYSTEM, A, X, noise)) {
        return RMIN_SINGULAR;
    }
    append(RMIN_SYSTEM, places, A, X, row, modes);
    modes->noise = noise;
    *drift = RMIN_R(1.0);
    rmin_real pull[RMIN_SYSTEM];
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

#if RMIN_STRUCTURED
/*
 * Deflections d of the springs, by d'' + (1/M + 1/B) k d = -(1/M) J'n f, and the motion r of links
 * and rotors together: x = J r + g'd with g = B (M + B)^-1 J'n.
 */
int rmin_free_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real carried[RMIN_N])
{
    rmin_matrix mass;
    rmin_matrix X;
    rmin_matrix A;
    rmin_matrix mobility;
    int places[RMIN_SYSTEM];
    rmin_real k[RMIN_N];
    (void)p;
    rmin_real moved[RMIN_N]; /* (M + B)^-1 J'n */
    for (int i = 0; i < RMIN_N; ++i) {
        places[i] = i;
        k[i] = RMIN_SPRING(p, i);
        moved[i] = arrival->row[i];
        for (int j = 0; j < RMIN_N; ++j) {
            mass[i][j] = arrival->links.M[i][j];
            A[i][j] = mass[i][j];
        }
        A[i][i] += RMIN_ROTOR(p, i);
    }
    if (!unit_motions(RMIN_N, mass, X) || !rmin_cholesky(RMIN_N, A)) {
        return RMIN_SINGULAR;
    }
    rmin_forward(RMIN_N, A, moved);
    rmin_backward(RMIN_N, A, moved);
    rmin_real together = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        together += arrival->row[i]*moved[i];
        carried[i] = RMIN_ROTOR(p, i)*moved[i];
        for (int j = 0; j <= i; ++j) {
            rmin_real sum = RMIN_R(0.0);
            for (int l = i; l < RMIN_N; ++l) {
                sum += X[i][l]*X[j][l];
            }
            mobility[i][j] = sum;
            mobility[j][i] = sum;
        }
        mobility[i][i] += RMIN_R(1.0)/RMIN_ROTOR(p, i);
    }
    if (!(together > RMIN_R(0.0)) || !rmin_cholesky(RMIN_N, mobility)) {
        return RMIN_SINGULAR;
    }
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j < RMIN_N; ++j) {
            X[i][j] = j <= i ? mobility[i][j] : RMIN_R(0.0);
        }
    }
    stretch(k, X, A);
    if (!rmin_diagonalise(RMIN_N, A, X, RMIN_R(0.0))) {
        return RMIN_SINGULAR;
    }
    modes->count = 1; /* the first: r */
    modes->squared[0] = RMIN_R(0.0);
    modes->row[0] = RMIN_SQRT(together);
    modes->start[0] = RMIN_R(1.0)/modes->row[0];
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        modes->shape[j][0] = RMIN_R(0.0);
    }
    append(RMIN_N, places, A, X, carried, modes);
    return RMIN_OK;
}
#else
int rmin_free_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real carried[RMIN_N])
{
    rmin_matrix mass;
    rmin_matrix kept;
    rmin_matrix K;
    rmin_matrix X;
    rmin_matrix A;
    int places[RMIN_SYSTEM];
    rmin_real row[RMIN_SYSTEM];
    rmin_real momentum[RMIN_SYSTEM]; /* before, at 1 m/s */
    (void)carried;
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
    const rmin_real noise = congruent(RMIN_SYSTEM, K, X, A);
    if (!rmin_diagonalise(RMIN_SYSTEM, A, X, noise)) {
        return RMIN_SINGULAR;
    }
    append(RMIN_SYSTEM, places, A, X, row, modes);
    for (int i = 0; i < modes->count; ++i) {
        for (int j = 0; j < RMIN_SYSTEM; ++j) {
            modes->start[i] += modes->shape[j][i]*momentum[j];
        }
    }
    return RMIN_OK;
}
#endif
