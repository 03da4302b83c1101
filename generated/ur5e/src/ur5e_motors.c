/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of ur5e_ by what its motors do: drive on, servo, or turn freely.
 *
 * With z the deviation from the motion before the impact, M z'' + K z = -J'n f - (P rates) v t, where
 * P is the curvature of gravity and of springs of the model file; z is over links whose motors drive,
 * and over links and motors where a servo leads these.
 */
#include "ur5e_impact.h"

/* Share of the largest entry that rounding leaves of one that should be none. */
#define NOISE (UR5E_R(8.0)*UR5E_EPSILON)

/* X = L^-T of a mass matrix M = L L': its columns are motions of unit mass. */
static bool unit_motions(int size, ur5e_matrix mass, ur5e_matrix X)
{
    if (!ur5e_cholesky(size, mass)) {
        return false;
    }
    for (int j = 0; j < size; ++j) {
        ur5e_real column[UR5E_SYSTEM];
        for (int i = 0; i < size; ++i) {
            column[i] = i == j ? UR5E_R(1.0) : UR5E_R(0.0);
        }
        ur5e_backward(size, mass, column);
        for (int i = 0; i < size; ++i) {
            X[i][j] = column[i];
        }
    }
    return true;
}

#if UR5E_STRUCTURED
/* A = X' diag(k) X. */
static void stretch(const ur5e_real *k, ur5e_matrix X, ur5e_matrix A)
{
    for (int i = 0; i < UR5E_N; ++i) {
        ur5e_real pulled[UR5E_N];
        for (int l = 0; l < UR5E_N; ++l) {
            pulled[l] = k[l]*X[l][i];
        }
        for (int j = 0; j <= i; ++j) {
            ur5e_real sum = UR5E_R(0.0);
            for (int l = 0; l < UR5E_N; ++l) {
                sum += pulled[l]*X[l][j];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
    }
}
#endif

/* A = X'KX; returns the noise in its entries. */
static ur5e_real congruent(int size, ur5e_matrix K, ur5e_matrix X, ur5e_matrix A)
{
    ur5e_real largest = UR5E_R(0.0);
    for (int i = 0; i < size; ++i) {
        ur5e_real pulled[UR5E_SYSTEM];
        for (int l = 0; l < size; ++l) {
            pulled[l] = UR5E_R(0.0);
            for (int m = 0; m < size; ++m) {
                pulled[l] += K[l][m]*X[m][i];
            }
        }
        for (int j = 0; j <= i; ++j) {
            ur5e_real sum = UR5E_R(0.0);
            for (int l = 0; l < size; ++l) {
                sum += pulled[l]*X[l][j];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
        largest = UR5E_FMAX(largest, UR5E_FABS(A[i][i]));
    }
    return NOISE*largest;
}

/* Appends the eigenvectors X, over the coordinates `places`, to modes. */
static void append(int size, const int *places, ur5e_matrix A, ur5e_matrix X, const ur5e_real *row,
    ur5e_modes *modes)
{
    const int first = modes->count;
    for (int i = 0; i < size; ++i) {
        const int at = first + i;
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            modes->shape[j][at] = UR5E_R(0.0);
        }
        ur5e_real sum = UR5E_R(0.0);
        for (int j = 0; j < size; ++j) {
            modes->shape[places[j]][at] = X[j][i];
            sum += row[j]*X[j][i];
        }
        modes->squared[at] = A[i][i];
        modes->row[at] = sum;
        modes->start[at] = UR5E_R(0.0);
    }
    modes->count = first + size;
}

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
            along += modes->shape[j][i]*pull[j];
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
#if !UR5E_STRUCTURED
            K[i][j] = K[places[i]][places[j]];
#endif
        }
    }
    *drift = UR5E_R(1.0);
    modes->count = 0;
    if (!unit_motions(size, mass, X)) {
        return UR5E_SINGULAR;
    }
#if UR5E_STRUCTURED
    ur5e_real k[UR5E_N];
    for (int i = 0; i < UR5E_N; ++i) {
        k[i] = UR5E_SPRING(p, i);
    }
    stretch(k, X, A);
    const ur5e_real noise = UR5E_R(0.0);
#else
    const ur5e_real noise = congruent(size, K, X, A);
#endif
    if (!ur5e_diagonalise(size, A, X, noise)) {
        return UR5E_SINGULAR;
    }
    append(size, places, A, X, row, modes);
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

int ur5e_servo_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real *drift)
{
    ur5e_matrix mass;
    ur5e_matrix K;
    ur5e_matrix X;
    ur5e_matrix A;
    int places[UR5E_SYSTEM];
    ur5e_real row[UR5E_SYSTEM];
    whole(arrival, p, mass, K);
    for (int i = 0; i < UR5E_SYSTEM; ++i) {
        places[i] = i;
        row[i] = i < UR5E_N ? arrival->row[i] : UR5E_R(0.0);
    }
    for (int i = 0; i < UR5E_N; ++i) {
        const int motor = UR5E_SYSTEM - UR5E_N + i;
        K[motor][motor] += UR5E_GAIN(p, i);
    }
    modes->count = 0;
    if (!unit_motions(UR5E_SYSTEM, mass, X)) {
        return UR5E_SINGULAR;
    }
    const ur5e_real noise = congruent(UR5E_SYSTEM, K, X, A);
    if (!ur5e_diagonalise(UR5E_SYSTEM, A, X, noise)) {
        return UR5E_SINGULAR;
    }
    append(UR5E_SYSTEM, places, A, X, row, modes);
    modes->noise = noise;
    *drift = UR5E_R(1.0);
    ur5e_real pull[UR5E_SYSTEM];
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

#if UR5E_STRUCTURED
/*
 * Deflections d of the springs, by d'' + (1/M + 1/B) k d = -(1/M) J'n f, and the motion r of links
 * and rotors together: x = J r + g'd with g = B (M + B)^-1 J'n.
 */
int ur5e_free_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real carried[UR5E_N])
{
    ur5e_matrix mass;
    ur5e_matrix X;
    ur5e_matrix A;
    ur5e_matrix mobility;
    int places[UR5E_SYSTEM];
    ur5e_real k[UR5E_N];
    (void)p;
    ur5e_real moved[UR5E_N]; /* (M + B)^-1 J'n */
    for (int i = 0; i < UR5E_N; ++i) {
        places[i] = i;
        k[i] = UR5E_SPRING(p, i);
        moved[i] = arrival->row[i];
        for (int j = 0; j < UR5E_N; ++j) {
            mass[i][j] = arrival->links.M[i][j];
            A[i][j] = mass[i][j];
        }
        A[i][i] += UR5E_ROTOR(p, i);
    }
    if (!unit_motions(UR5E_N, mass, X) || !ur5e_cholesky(UR5E_N, A)) {
        return UR5E_SINGULAR;
    }
    ur5e_forward(UR5E_N, A, moved);
    ur5e_backward(UR5E_N, A, moved);
    ur5e_real together = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        together += arrival->row[i]*moved[i];
        carried[i] = UR5E_ROTOR(p, i)*moved[i];
        for (int j = 0; j <= i; ++j) {
            ur5e_real sum = UR5E_R(0.0);
            for (int l = i; l < UR5E_N; ++l) {
                sum += X[i][l]*X[j][l];
            }
            mobility[i][j] = sum;
            mobility[j][i] = sum;
        }
        mobility[i][i] += UR5E_R(1.0)/UR5E_ROTOR(p, i);
    }
    if (!(together > UR5E_R(0.0)) || !ur5e_cholesky(UR5E_N, mobility)) {
        return UR5E_SINGULAR;
    }
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j < UR5E_N; ++j) {
            X[i][j] = j <= i ? mobility[i][j] : UR5E_R(0.0);
        }
    }
    stretch(k, X, A);
    if (!ur5e_diagonalise(UR5E_N, A, X, UR5E_R(0.0))) {
        return UR5E_SINGULAR;
    }
    modes->count = 1; /* the first: r */
    modes->squared[0] = UR5E_R(0.0);
    modes->row[0] = UR5E_SQRT(together);
    modes->start[0] = UR5E_R(1.0)/modes->row[0];
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        modes->shape[j][0] = UR5E_R(0.0);
    }
    append(UR5E_N, places, A, X, carried, modes);
    return UR5E_OK;
}
#else
int ur5e_free_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real carried[UR5E_N])
{
    ur5e_matrix mass;
    ur5e_matrix kept;
    ur5e_matrix K;
    ur5e_matrix X;
    ur5e_matrix A;
    int places[UR5E_SYSTEM];
    ur5e_real row[UR5E_SYSTEM];
    ur5e_real momentum[UR5E_SYSTEM]; /* before, at 1 m/s */
    (void)carried;
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
    const ur5e_real noise = congruent(UR5E_SYSTEM, K, X, A);
    if (!ur5e_diagonalise(UR5E_SYSTEM, A, X, noise)) {
        return UR5E_SINGULAR;
    }
    append(UR5E_SYSTEM, places, A, X, row, modes);
    for (int i = 0; i < modes->count; ++i) {
        for (int j = 0; j < UR5E_SYSTEM; ++j) {
            modes->start[i] += modes->shape[j][i]*momentum[j];
        }
    }
    return UR5E_OK;
}
#endif
