/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of robot_ by what its motors do: drive on, servo, or turn freely.
 *
 * With z the deviation from the motion before the impact, M z'' + K z = -J'n f - (P rates) v t, where
 * P is the curvature of gravity and of springs of the model file; z is over links whose motors drive,
 * and over links and motors where a servo leads these.
 */
#include "robot_impact.h"

/* X = L^-1 of a mass matrix M = L L': its rows are motions of unit mass, with nothing behind its diagonal. */
static bool unit_motions(int size, robot_matrix mass, robot_matrix X)
{
    if (!robot_cholesky(size, mass)) {
        return false;
    }
    for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) {
            X[j][i] = i == j ? ROBOT_R(1.0) : ROBOT_R(0.0);
        }
        robot_backward(j + 1, mass, X[j]);
    }
    return true;
}

/* A = XKX' of such an X. */
static void congruent(int size, robot_matrix K, robot_matrix X, robot_matrix A)
{
    for (int i = 0; i < size; ++i) {
        robot_real pulled[ROBOT_SYSTEM];
        for (int l = 0; l <= i; ++l) {
            pulled[l] = ROBOT_R(0.0);
            for (int m = 0; m <= i; ++m) {
                pulled[l] += K[l][m]*X[i][m];
            }
        }
        for (int j = 0; j <= i; ++j) {
            robot_real sum = ROBOT_R(0.0);
            for (int l = 0; l <= j; ++l) {
                sum += pulled[l]*X[j][l];
            }
            A[i][j] = sum;
            A[j][i] = sum;
        }
    }
}

#if !ROBOT_STRUCTURED
/*
 * Modes: the eigenvectors of A = XKX' in X, over the coordinates `places`, of the mass L L'. An entry of A errs by
 * rounding times the root of its diagonal entries' product, so a mode's squared frequency by as much of the
 * squared sum of these roots' shares in it. False if eigenvectors are not found.
 */
static bool find_modes(int size, const int *places, robot_matrix L, robot_matrix A, robot_matrix X,
    const robot_real *row, robot_modes *modes)
{
    robot_real roots[ROBOT_SYSTEM];
    for (int i = 0; i < size; ++i) {
        roots[i] = ROBOT_SQRT(ROBOT_FABS(A[i][i]));
    }
    const bool found = robot_diagonalise(size, A, X);
    for (int i = 0; i < size; ++i) {
        robot_real held = ROBOT_R(0.0);
        for (int l = 0; l < size; ++l) { /* what X was, times a share, is what it is: share = L'x */
            robot_real share = ROBOT_R(0.0);
            for (int m = l; m < size; ++m) {
                share += L[m][l]*X[i][m];
            }
            held += roots[l]*ROBOT_FABS(share);
        }
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
            modes->shape[i][j] = ROBOT_R(0.0);
        }
        robot_real sum = ROBOT_R(0.0);
        for (int j = 0; j < size; ++j) {
            modes->shape[i][places[j]] = X[i][j];
            sum += row[j]*X[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = ROBOT_EPSILON*held*held;
        modes->squared[i] = A[i][i];
        modes->row[i] = sum;
        modes->start[i] = ROBOT_R(0.0);
    }
    modes->count = size;
    modes->rigid = 0;
    modes->fastest = ROBOT_REAL_MAX;
    return found;
}
#endif

/* P rates: what gravity and the model's own springs pull on as the motion before goes on, over v t. */
static void pulled_on(const robot_arrival *arrival, robot_real pull[ROBOT_SYSTEM])
{
    for (int i = 0; i < ROBOT_SYSTEM; ++i) {
        pull[i] = ROBOT_R(0.0);
    }
#if ROBOT_POTENTIAL
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j < ROBOT_N; ++j) {
            pull[i] += arrival->links.K[i][j]*arrival->rates[j];
        }
    }
#else
    (void)arrival;
#endif
}

/* Turns a pull that grows with time into a drift and rates of modes. */
static int lead(const robot_real pull[ROBOT_SYSTEM], robot_modes *modes, robot_real *drift)
{
    for (int i = 0; i < modes->count; ++i) {
        robot_real along = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
            along += modes->shape[i][j]*pull[j];
        }
        if (ROBOT_FABS(along) > ROBOT_R(0.0)) {
            if (!(ROBOT_FABS(modes->squared[i]) > ROBOT_R(0.0))) {
                return ROBOT_UNRESOLVED;
            }
            modes->start[i] = along/modes->squared[i];
            *drift -= modes->row[i]*modes->start[i];
        }
    }
    return ROBOT_OK;
}

/* Mass and stiffness over links, and over motors where there are springs between. */
static void whole(const robot_arrival *arrival, const robot_params *p, robot_matrix mass, robot_matrix K)
{
    (void)p;
    for (int i = 0; i < ROBOT_SYSTEM; ++i) {
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
            mass[i][j] = ROBOT_R(0.0);
            K[i][j] = ROBOT_R(0.0);
        }
    }
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j < ROBOT_N; ++j) {
            mass[i][j] = arrival->links.M[i][j];
#if ROBOT_POTENTIAL
            K[i][j] = arrival->links.K[i][j];
#endif
        }
    }
#if ROBOT_ELASTIC
    for (int i = 0; i < ROBOT_N; ++i) {
        const int motor = ROBOT_N + i;
        mass[motor][motor] = ROBOT_ROTOR(p, i);
        K[i][i] += ROBOT_SPRING(p, i);
        K[motor][motor] = ROBOT_SPRING(p, i);
        K[i][motor] = -ROBOT_SPRING(p, i);
        K[motor][i] = -ROBOT_SPRING(p, i);
    }
#endif
}

#if !ROBOT_STRUCTURED
int robot_driven_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes,
    robot_real *drift)
{
    robot_matrix mass;
    robot_matrix K;
    robot_matrix X;
    robot_matrix A;
    int places[ROBOT_SYSTEM] = {0}; /* stays so where motors hold all */
    robot_real row[ROBOT_SYSTEM];
    robot_real pull[ROBOT_SYSTEM];
    int size = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < ROBOT_N; ++i) { /* coordinates that no motor holds to its motion */
        if (ROBOT_ELASTIC || !robot_has_motor[i]) {
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
    *drift = ROBOT_R(1.0);
    modes->count = 0;
    if (!unit_motions(size, mass, X)) {
        return ROBOT_SINGULAR;
    }
    congruent(size, K, X, A);
    if (!find_modes(size, places, mass, A, X, row, modes)) {
        return ROBOT_SINGULAR;
    }
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}
#endif

#if !ROBOT_POTENTIAL
/*
 * Most sweeps that make what modes bend orthogonal: one or two, as it nearly is, but where springs or rotors are a
 * thousand times others.
 */
#define SWEEPS_OF_SERVO 8

static robot_real product_of(const robot_real a[ROBOT_SYSTEM], const robot_real b[ROBOT_SYSTEM])
{
    robot_real sum = ROBOT_R(0.0);
    for (int k = 0; k < ROBOT_SYSTEM; ++k) {
        sum += a[k]*b[k];
    }
    return sum;
}

/*
 * QR errs by rounding of the largest squared frequency, whatever the mode. What each mode bends of springs and
 * gains, times their roots, is known better: its square is the mode's squared frequency, and two modes' are
 * orthogonal (Jacobi's rotations from one side).
 */
static void sharpen(const robot_params *p, robot_matrix bent, robot_modes *modes)
{
    robot_real known[ROBOT_SYSTEM]; /* error of the root of a squared frequency */
    (void)p;
    for (int i = 0; i < ROBOT_SYSTEM; ++i) {
        robot_real off = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_N; ++j) {
            const int motor = ROBOT_SYSTEM - ROBOT_N + j;
            const robot_real turned = modes->shape[i][motor];
            const robot_real gain = ROBOT_SQRT(ROBOT_GAIN(p, j));
            bent[i][motor] = gain*turned;
            off += gain*ROBOT_FABS(turned);
#if ROBOT_ELASTIC
            const robot_real root = ROBOT_SQRT(ROBOT_SPRING(p, j));
            bent[i][j] = root*(modes->shape[i][j] - turned);
            off += root*(ROBOT_FABS(modes->shape[i][j]) + ROBOT_FABS(turned));
#endif
        }
        modes->squared[i] = product_of(bent[i], bent[i]);
        known[i] = ROBOT_EPSILON*off;
    }
    bool turned = true;
    for (int sweep = 0; sweep < SWEEPS_OF_SERVO && turned; ++sweep) {
        turned = false;
        for (int i = 0; i < ROBOT_SYSTEM; ++i) {
            for (int j = 0; j < i; ++j) {
                const robot_real off = product_of(bent[i], bent[j]);
                if (off*off > ROBOT_EPSILON*modes->squared[i]*modes->squared[j]) {
                    turned = true;
                    const robot_real t = robot_tangent(modes->squared[j] - modes->squared[i], off);
                    robot_turn_by(ROBOT_SYSTEM, t, bent[j], bent[i]);
                    robot_turn_by(ROBOT_SYSTEM, t, modes->shape[j], modes->shape[i]);
                    modes->squared[i] = product_of(bent[i], bent[i]);
                    modes->squared[j] = product_of(bent[j], bent[j]);
                }
            }
        }
    }
    for (int i = 0; i < ROBOT_SYSTEM && !turned; ++i) { /* else they err as QR does */
        modes->noise[i] = known[i]*(known[i] + ROBOT_R(2.0)*ROBOT_SQRT(modes->squared[i]));
    }
}
#endif

int robot_servo_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes,
    robot_real *drift)
{
    robot_matrix mass; /* and then XKX', and what modes move */
    robot_matrix X;
    robot_real (*const K)[ROBOT_SYSTEM] = modes->shape; /* and then unit vectors in eigenvectors of XKX' */
    modes->count = 0;
    whole(arrival, p, mass, K);
    for (int i = 0; i < ROBOT_N; ++i) {
        const int motor = ROBOT_SYSTEM - ROBOT_N + i;
        K[motor][motor] += ROBOT_GAIN(p, i);
    }
    if (!unit_motions(ROBOT_SYSTEM, mass, X)) {
        return ROBOT_SINGULAR;
    }
    congruent(ROBOT_SYSTEM, K, X, mass);
    robot_real all = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_SYSTEM; ++i) {
        all += ROBOT_FABS(mass[i][i]);
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
            K[i][j] = i == j ? ROBOT_R(1.0) : ROBOT_R(0.0);
        }
    }
    const robot_real none = ROBOT_EPSILON*ROBOT_EPSILON;
    if (!robot_spectrum(ROBOT_SYSTEM, none, mass, modes->squared, ROBOT_SYSTEM, K, NULL)) {
        return ROBOT_SINGULAR;
    }
    for (int i = 0; i < ROBOT_SYSTEM; ++i) {
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
            robot_real shape = ROBOT_R(0.0);
            for (int k = j; k < ROBOT_SYSTEM; ++k) { /* X has nothing behind its diagonal */
                shape += X[k][j]*K[k][i];
            }
            mass[i][j] = shape;
        }
    }
    for (int i = 0; i < ROBOT_SYSTEM; ++i) {
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
            modes->shape[i][j] = mass[i][j];
        }
        modes->from[i] = i;
        modes->noise[i] = ROBOT_EPSILON*all;
    }
#if !ROBOT_POTENTIAL
    sharpen(p, mass, modes);
#endif
    for (int i = 0; i < ROBOT_SYSTEM; ++i) {
        modes->row[i] = ROBOT_R(0.0);
        modes->start[i] = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_N; ++j) {
            modes->row[i] += arrival->row[j]*modes->shape[i][j];
        }
    }
    modes->count = ROBOT_SYSTEM;
    modes->rigid = 0;
    modes->fastest = ROBOT_REAL_MAX;
    *drift = ROBOT_R(1.0);
    robot_real pull[ROBOT_SYSTEM];
    pulled_on(arrival, pull);
    return lead(pull, modes, drift);
}

#if !ROBOT_STRUCTURED
int robot_free_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes)
{
    robot_matrix mass;
    robot_matrix kept;
    robot_matrix K;
    robot_matrix X;
    robot_matrix A;
    int places[ROBOT_SYSTEM];
    robot_real row[ROBOT_SYSTEM];
    robot_real momentum[ROBOT_SYSTEM]; /* before, at 1 m/s */
    whole(arrival, p, mass, K);
    whole(arrival, p, kept, K);
    for (int i = 0; i < ROBOT_SYSTEM; ++i) {
        places[i] = i;
        row[i] = i < ROBOT_N ? arrival->row[i] : ROBOT_R(0.0);
        momentum[i] = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
            momentum[i] += kept[i][j]*arrival->rates[j % ROBOT_N];
        }
    }
    modes->count = 0;
    if (!unit_motions(ROBOT_SYSTEM, mass, X)) {
        return ROBOT_SINGULAR;
    }
    congruent(ROBOT_SYSTEM, K, X, A);
    if (!find_modes(ROBOT_SYSTEM, places, mass, A, X, row, modes)) {
        return ROBOT_SINGULAR;
    }
    for (int i = 0; i < modes->count; ++i) {
        for (int j = 0; j < ROBOT_SYSTEM; ++j) {
            modes->start[i] += modes->shape[i][j]*momentum[j];
        }
    }
    return ROBOT_OK;
}
#endif
