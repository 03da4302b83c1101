/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of rr_ by what its motors do: drive on, servo, or turn freely.
 *
 * With z the deviation from the motion before the impact, M z'' + K z = -J'n f - (P rates) v t, where
 * P is the curvature of gravity and of springs of the model file; z is over links whose motors drive,
 * and over links and motors where a servo leads these.
 */
#include "rr_impact.h"

/* X = L^-1 of a mass matrix M = L L': its rows are motions of unit mass, with nothing behind its diagonal. */
static bool unit_motions(int size, rr_matrix mass, rr_matrix X)
{
    if (!rr_cholesky(size, mass)) {
        return false;
    }
    for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
            X[j][i] = i == j ? RR_R(1.0) : RR_R(0.0);
        }
        rr_backward(j + 1, mass, X[j]);
    }
    return true;
}

/* A = XKX' of such an X. */
static void congruent(int size, rr_matrix K, rr_matrix X, rr_matrix A)
{
    for (int i = 0; i < size; ++i) {
        rr_real pulled[RR_SYSTEM];
        for (int l = 0; l <= i; ++l) {
            pulled[l] = RR_R(0.0);
            for (int m = 0; m <= i; ++m) {
                pulled[l] += K[l][m]*X[i][m];
            }
        }
        for (int j = 0; j <= i; ++j) {
            rr_real sum = RR_R(0.0);
            for (int l = 0; l <= j; ++l) {
                sum += pulled[l]*X[j][l];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
    }
}

#if !RR_STRUCTURED
/*
 * Modes: the eigenvectors of A = XKX' in X, over the coordinates `places`, of the mass L L'. An entry of A errs by
 * rounding times the root of its diagonal entries' product, so a mode's squared frequency by as much of the
 * squared sum of these roots' shares in it. False if eigenvectors are not found.
 */
static bool find_modes(int size, const int *places, rr_matrix L, rr_matrix A, rr_matrix X,
    const rr_real *row, rr_modes *modes)
{
    rr_real roots[RR_SYSTEM];
    for (int i = 0; i < size; ++i) {
        roots[i] = RR_SQRT(RR_FABS(A[i][i]));
    }
    const bool found = rr_diagonalise(size, A, X);
    for (int i = 0; i < size; ++i) {
        rr_real held = RR_R(0.0);
        for (int l = 0; l < size; ++l) { /* what X was, times a share, is what it is: share = L'x */
            rr_real share = RR_R(0.0);
            for (int m = l; m < size; ++m) {
                share += L[m][l]*X[i][m];
            }
            held += roots[l]*RR_FABS(share);
        }
        for (int j = 0; j < RR_SYSTEM; ++j) {
            modes->shape[i][j] = RR_R(0.0);
        }
        rr_real sum = RR_R(0.0);
        for (int j = 0; j < size; ++j) {
            modes->shape[i][places[j]] = X[i][j];
            sum += row[j]*X[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = RR_EPSILON*held*held;
        modes->squared[i] = A[i][i];
        modes->row[i] = sum;
        modes->start[i] = RR_R(0.0);
    }
    modes->count = size;
    modes->rigid = 0;
    modes->fastest = RR_REAL_MAX;
    return found;
}
#endif

/* P rates: what gravity and the model's own springs pull on as the motion before goes on, over v t. */
static void pulled_on(const rr_arrival *arrival, rr_real pull[RR_SYSTEM])
{
    for (int i = 0; i < RR_SYSTEM; ++i) {
        pull[i] = RR_R(0.0);
    }
#if RR_POTENTIAL
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j < RR_N; ++j) {
            pull[i] += arrival->links.K[i][j]*arrival->rates[j];
        }
    }
#else
    (void)arrival;
#endif
}

/* Turns a pull that grows with time into a drift and rates of modes. */
static int lead(const rr_real pull[RR_SYSTEM], rr_modes *modes, rr_real *drift)
{
    for (int i = 0; i < modes->count; ++i) {
        rr_real along = RR_R(0.0);
        for (int j = 0; j < RR_SYSTEM; ++j) {
            along += modes->shape[i][j]*pull[j];
        }
        if (RR_FABS(along) > RR_R(0.0)) {
            if (!(RR_FABS(modes->squared[i]) > RR_R(0.0))) {
                return RR_UNRESOLVED;
            }
            modes->start[i] = along/modes->squared[i];
            *drift -= modes->row[i]*modes->start[i];
        }
    }
    return RR_OK;
}

/* Mass and stiffness over links, and over motors where there are springs between. */
static void whole(const rr_arrival *arrival, const rr_params *p, rr_matrix mass, rr_matrix K)
{
    (void)p;
    for (int i = 0; i < RR_SYSTEM; ++i) {
        for (int j = 0; j < RR_SYSTEM; ++j) {
            mass[i][j] = RR_R(0.0);
            K[i][j] = RR_R(0.0);
        }
    }
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j < RR_N; ++j) {
            mass[i][j] = arrival->links.M[i][j];
#if RR_POTENTIAL
            K[i][j] = arrival->links.K[i][j];
#endif
        }
    }
#if RR_ELASTIC
    for (int i = 0; i < RR_N; ++i) {
        const int motor = RR_N + i;
        mass[motor][motor] = RR_ROTOR(p, i);
        K[i][i] += RR_SPRING(p, i);
        K[motor][motor] = RR_SPRING(p, i);
        K[i][motor] = -RR_SPRING(p, i);
        K[motor][i] = -RR_SPRING(p, i);
    }
#endif
}

#if !RR_STRUCTURED
int rr_driven_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes,
    rr_real *drift)
{
    rr_matrix mass;
    rr_matrix K;
    rr_matrix X;
    rr_matrix A;
    int places[RR_SYSTEM] = {0}; /* stays so where motors hold all */
    rr_real row[RR_SYSTEM];
    rr_real pull[RR_SYSTEM];
    int size = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < RR_N; ++i) { /* coordinates that no motor holds to its motion */
        if (RR_ELASTIC || !rr_has_motor[i]) {
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
    *drift = RR_R(1.0);
    modes->count = 0;
    if (!unit_motions(size, mass, X)) {
        return RR_SINGULAR;
    }
    congruent(size, K, X, A);
    if (!find_modes(size, places, mass, A, X, row, modes)) {
        return RR_SINGULAR;
    }
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}
#endif

#if !RR_POTENTIAL
/*
 * Most sweeps that make what modes bend orthogonal: one or two, as it nearly is, but where springs or rotors are a
 * thousand times others.
 */
#define SWEEPS_OF_SERVO 8

static rr_real product_of(const rr_real a[RR_SYSTEM], const rr_real b[RR_SYSTEM])
{
    rr_real sum = RR_R(0.0);
    for (int k = 0; k < RR_SYSTEM; ++k) {
        sum += a[k]*b[k];
    }
    return sum;
}

/*
 * QR errs by rounding of the largest squared frequency, whatever the mode. What each mode bends of springs and
 * gains, times their roots, is known better: its square is the mode's squared frequency, and two modes' are
 * orthogonal (Jacobi's rotations from one side).
 */
static void sharpen(const rr_params *p, rr_matrix bent, rr_modes *modes)
{
    rr_real known[RR_SYSTEM]; /* error of the root of a squared frequency */
    (void)p;
    for (int i = 0; i < RR_SYSTEM; ++i) {
        rr_real off = RR_R(0.0);
        for (int j = 0; j < RR_N; ++j) {
            const int motor = RR_SYSTEM - RR_N + j;
            const rr_real turned = modes->shape[i][motor];
            const rr_real gain = RR_SQRT(RR_GAIN(p, j));
            bent[i][motor] = gain*turned;
            off += gain*RR_FABS(turned);
#if RR_ELASTIC
            const rr_real root = RR_SQRT(RR_SPRING(p, j));
            bent[i][j] = root*(modes->shape[i][j] - turned);
            off += root*(RR_FABS(modes->shape[i][j]) + RR_FABS(turned));
#endif
        }
        modes->squared[i] = product_of(bent[i], bent[i]);
        known[i] = RR_EPSILON*off;
    }
    bool turned = true;
    for (int sweep = 0; sweep < SWEEPS_OF_SERVO && turned; ++sweep) {
        turned = false;
        for (int i = 0; i < RR_SYSTEM; ++i) {
            for (int j = 0; j < i; ++j) {
                const rr_real off = product_of(bent[i], bent[j]);
                if (off*off > RR_EPSILON*modes->squared[i]*modes->squared[j]) {
                    turned = true;
                    const rr_real t = rr_tangent(modes->squared[j] - modes->squared[i], off);
                    rr_turn_by(RR_SYSTEM, t, bent[j], bent[i]);
                    rr_turn_by(RR_SYSTEM, t, modes->shape[j], modes->shape[i]);
                    modes->squared[i] = product_of(bent[i], bent[i]);
                    modes->squared[j] = product_of(bent[j], bent[j]);
                }
            }
        }
    }
    for (int i = 0; i < RR_SYSTEM && !turned; ++i) { /* else they err as QR does */
        modes->noise[i] = known[i]*(known[i] + RR_R(2.0)*RR_SQRT(modes->squared[i]));
    }
}
#endif

int rr_servo_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes,
    rr_real *drift)
{
    rr_matrix mass; /* and then XKX', and what modes move */
    rr_matrix X;
    rr_real (*const K)[RR_SYSTEM] = modes->shape; /* and then unit vectors in eigenvectors of XKX' */
    modes->count = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < RR_N; ++i) {
        const int motor = RR_SYSTEM - RR_N + i;
        K[motor][motor] += RR_GAIN(p, i);
    }
    if (!unit_motions(RR_SYSTEM, mass, X)) {
        return RR_SINGULAR;
    }
    congruent(RR_SYSTEM, K, X, mass);
    rr_real all = RR_R(0.0);
    for (int i = 0; i < RR_SYSTEM; ++i) {
        all += RR_FABS(mass[i][i]);
        for (int j = 0; j < RR_SYSTEM; ++j) {
            K[i][j] = i == j ? RR_R(1.0) : RR_R(0.0);
        }
    }
    const rr_real none = RR_EPSILON*RR_EPSILON;
    if (!rr_spectrum(RR_SYSTEM, none, mass, modes->squared, RR_SYSTEM, K, NULL)) {
        return RR_SINGULAR;
    }
    for (int i = 0; i < RR_SYSTEM; ++i) {
        for (int j = 0; j < RR_SYSTEM; ++j) {
            rr_real shape = RR_R(0.0);
            for (int k = j; k < RR_SYSTEM; ++k) { /* X has nothing behind its diagonal */
                shape += X[k][j]*K[k][i];
            }
            mass[i][j] = shape;
        }
    }
    for (int i = 0; i < RR_SYSTEM; ++i) {
        for (int j = 0; j < RR_SYSTEM; ++j) {
            modes->shape[i][j] = mass[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = RR_EPSILON*all;
    }
#if !RR_POTENTIAL
    sharpen(p, mass, modes);
#endif
    for (int i = 0; i < RR_SYSTEM; ++i) {
        modes->row[i] = RR_R(0.0);
        modes->start[i] = RR_R(0.0);
        for (int j = 0; j < RR_N; ++j) {
            modes->row[i] += arrival->row[j]*modes->shape[i][j];
        }
    }
    modes->count = RR_SYSTEM;
    modes->rigid = 0;
    modes->fastest = RR_REAL_MAX;
    *drift = RR_R(1.0);
    rr_real pull[RR_SYSTEM];
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

#if !RR_STRUCTURED
int rr_free_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes)
{
    rr_matrix mass;
    rr_matrix kept;
    rr_matrix K;
    rr_matrix X;
    rr_matrix A;
    int places[RR_SYSTEM];
    rr_real row[RR_SYSTEM];
    rr_real momentum[RR_SYSTEM]; /* before, at 1 m/s */
    whole(arrival, p, mass, K);
    whole(arrival, p, kept, K);
    for (int i = 0; i < RR_SYSTEM; ++i) {
        places[i] = i;
        row[i] = i < RR_N ? arrival->row[i] : RR_R(0.0);
        momentum[i] = RR_R(0.0);
        for (int j = 0; j < RR_SYSTEM; ++j) {
            momentum[i] += kept[i][j]*arrival->rates[j % RR_N];
        }
    }
    modes->count = 0;
    if (!unit_motions(RR_SYSTEM, mass, X)) {
        return RR_SINGULAR;
    }
    congruent(RR_SYSTEM, K, X, A);
    if (!find_modes(RR_SYSTEM, places, mass, A, X, row, modes)) {
        return RR_SINGULAR;
    }
    for (int i = 0; i < modes->count; ++i) {
        for (int j = 0; j < RR_SYSTEM; ++j) {
            modes->start[i] += modes->shape[i][j]*momentum[j];
        }
    }
    return RR_OK;
}
#endif
