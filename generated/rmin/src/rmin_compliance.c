/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of rmin_ where nothing but springs in the joints pulls.
 *
 * With u = sqrt(k) (links - motors), S = M over sqrt(k k'), R = B over k and b = J'n over sqrt(k), links
 * whose motors drive obey S u'' + u = -b f, x = v t + b'u. Those with loose motors obey C u'' + u = -g f,
 * x = r + g'u, where C = S (S + R)^-1 R is both compliances in series, g = R (S + R)^-1 b, and r is the
 * motion of links and rotors together, whose mobility is b'(S + R)^-1 b.
 *
 * So the eigenvalues are 1/frequency^2, and what rounding costs it costs the fastest modes, which
 * stand. With M = L L' and G = I + L'(1/B) L, C = L G^-1 L' over sqrt(k k'), g = L G^-1 L^-1 J'n over sqrt(k): no
 * difference of what may be nearly the same, whether rotors are much lighter or heavier than links.
 */
#include "rmin_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (RMIN_R(8.0)*RMIN_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL RMIN_R(1e-8)

#if RMIN_STRUCTURED
/*
 * Appends the modes of a compliance to those there are: of C over sqrt(k k'), of which C's part below its diagonal is
 * given and lost, and of `moved` over sqrt(k).
 */
static int spring_modes(const rmin_params *p, rmin_matrix C, const rmin_real moved[RMIN_N], rmin_modes *modes)
{
    rmin_real soft[RMIN_N];
    rmin_real squares[RMIN_N];
    rmin_real row[1][RMIN_SYSTEM];
    rmin_real all = RMIN_R(0.0);
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < RMIN_N; ++i) {
        soft[i] = RMIN_SQRT(RMIN_R(1.0)/RMIN_SPRING(p, i));
        row[0][i] = moved[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            C[i][j] *= soft[i]*soft[j];
            C[j][i] = C[i][j];
        }
        all += C[i][i];
    }
    if (!rmin_spectrum(RMIN_N, SMALL, C, squares, 1, row, &modes->turns)) {
        return RMIN_SINGULAR;
    }
    const rmin_real least = NOISE*all;
    modes->fastest = RMIN_R(1.0)/least;
    for (int i = 0; i < RMIN_N; ++i) {
        const int at = modes->rigid + i;
        const rmin_real squared = RMIN_R(1.0)/RMIN_FMAX(squares[i], least);
        modes->squared[at] = squared;
        modes->noise[at] = RMIN_R(0.0);
        modes->row[at] = row[0][i]*RMIN_SQRT(squared);
        modes->from[at] = i;
        modes->start[at] = RMIN_R(0.0);
    }
    modes->count = modes->rigid + RMIN_N;
    return RMIN_OK;
}

/* Copies a symmetric matrix's part below its diagonal. */
static void copy_below(const rmin_real (*from)[RMIN_N], rmin_matrix to)
{
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            to[i][j] = from[i][j];
        }
    }
}

int rmin_driven_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real *drift)
{
    copy_below(arrival->links.M, modes->shape);
    *drift = RMIN_R(1.0);
    modes->rigid = 0;
    return spring_modes(p, modes->shape, arrival->row, modes);
}

int rmin_free_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes)
{
    const int end = RMIN_N - 1;
    rmin_real (*const L)[RMIN_SYSTEM] = modes->shape; /* of rmin_mobilities, and then U^-1 L' */
    rmin_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    rmin_real light[RMIN_N]; /* 1/rotors */
    rmin_real z[RMIN_N];
    rmin_real per[RMIN_N]; /* 1/the diagonal of U */
    rmin_real carried[RMIN_N]; /* g sqrt(k) */
    rmin_real pulled[RMIN_N];
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < RMIN_N; ++i) {
        light[i] = RMIN_R(1.0)/RMIN_ROTOR(p, i);
        z[i] = arrival->row[i];
        pulled[i] = RMIN_R(0.0);
    }
    for (int i = 0; i < RMIN_N; ++i) {
        for (int l = i; l < RMIN_N; ++l) {
            pulled[l] = L[l][i]*light[l];
        }
        for (int j = 0; j <= i; ++j) {
            rmin_real sum = i == j ? RMIN_R(1.0) : RMIN_R(0.0);
            for (int l = i; l < RMIN_N; ++l) {
                sum += pulled[l]*L[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!rmin_cholesky(RMIN_N, G)) {
        return RMIN_SINGULAR;
    }
    rmin_forward(RMIN_N, L, z);
    for (int i = end; i >= 0; --i) {
        const rmin_real *const U = G[end - i];
        rmin_real rest = z[i];
        for (int m = i + 1; m < RMIN_N; ++m) {
            rest -= U[end - m]*z[m];
        }
        per[i] = RMIN_R(1.0)/U[end - i];
        z[i] = rest*per[i];
    }
    rmin_real together = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        rmin_real *const y = L[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        rmin_real sum = RMIN_R(0.0);
        for (int l = i; l >= 0; --l) {
            const rmin_real *const U = G[end - l];
            rmin_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest*per[l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += arrival->row[i]*sum*light[i];
    }
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            rmin_real entry = RMIN_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += L[i][l]*L[j][l];
            }
            G[i][j] = entry;
        }
    }
    if (!(together > RMIN_R(0.0) && together <= RMIN_REAL_MAX)) {
        return RMIN_SINGULAR;
    }
    modes->rigid = 1; /* r */
    modes->squared[0] = RMIN_R(0.0);
    modes->noise[0] = RMIN_R(0.0);
    modes->row[0] = RMIN_SQRT(together);
    modes->start[0] = RMIN_R(1.0)/modes->row[0];
    modes->from[0] = RMIN_N; /* none of them */
    return spring_modes(p, G, carried, modes);
}

/* Mobility of the contact point with links, whose mass becomes its L L', and rotors as one, if they count. */
static rmin_real mobility_of(const rmin_arrival *arrival, const rmin_params *p, rmin_real rotors, rmin_matrix L)
{
    rmin_real z[RMIN_N];
    rmin_real sum = RMIN_R(0.0);
    (void)p;
    copy_below(arrival->links.M, L);
    for (int i = 0; i < RMIN_N; ++i) {
        z[i] = arrival->row[i];
        L[i][i] += rotors*RMIN_ROTOR(p, i);
    }
    if (rmin_cholesky(RMIN_N, L)) {
        rmin_forward(RMIN_N, L, z);
        for (int i = 0; i < RMIN_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int rmin_mobilities(const rmin_arrival *arrival, const rmin_params *p, rmin_matrix L, rmin_real *links,
    rmin_real *rotors)
{
    *rotors = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        *rotors += arrival->row[i]*arrival->row[i]/RMIN_ROTOR(p, i);
    }
    *links = mobility_of(arrival, p, RMIN_R(0.0), L);
    return *links > RMIN_LEAST_MOBILITY ? RMIN_OK : RMIN_SINGULAR;
}

rmin_real rmin_together(const rmin_arrival *arrival, const rmin_params *p)
{
    rmin_matrix mass;
    return mobility_of(arrival, p, RMIN_R(1.0), mass);
}
#endif
