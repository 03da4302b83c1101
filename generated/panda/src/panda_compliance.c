/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of panda_ where nothing but springs in the joints pulls.
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
#include "panda_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (PANDA_R(8.0)*PANDA_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL PANDA_R(1e-8)

#if PANDA_STRUCTURED
/*
 * Appends the modes of a compliance to those there are: of C over sqrt(k k'), of which C's part below its diagonal is
 * given and lost, and of `moved` over sqrt(k).
 */
static int spring_modes(const panda_params *p, panda_matrix C, const panda_real moved[PANDA_N], panda_modes *modes)
{
    panda_real soft[PANDA_N];
    panda_real squares[PANDA_N];
    panda_real row[1][PANDA_SYSTEM];
    panda_real all = PANDA_R(0.0);
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < PANDA_N; ++i) {
        soft[i] = PANDA_SQRT(PANDA_R(1.0)/PANDA_SPRING(p, i));
        row[0][i] = moved[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            C[i][j] *= soft[i]*soft[j];
            C[j][i] = C[i][j];
        }
        all += C[i][i];
    }
    if (!panda_spectrum(PANDA_N, SMALL, C, squares, 1, row, &modes->turns)) {
        return PANDA_SINGULAR;
    }
    const panda_real least = NOISE*all;
    modes->fastest = PANDA_R(1.0)/least;
    for (int i = 0; i < PANDA_N; ++i) {
        const int at = modes->rigid + i;
        const panda_real squared = PANDA_R(1.0)/PANDA_FMAX(squares[i], least);
        modes->squared[at] = squared;
        modes->noise[at] = PANDA_R(0.0);
        modes->row[at] = row[0][i]*PANDA_SQRT(squared);
        modes->from[at] = i;
        modes->start[at] = PANDA_R(0.0);
    }
    modes->count = modes->rigid + PANDA_N;
    return PANDA_OK;
}

/* Copies a symmetric matrix's part below its diagonal. */
static void copy_below(const panda_real (*from)[PANDA_N], panda_matrix to)
{
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            to[i][j] = from[i][j];
        }
    }
}

int panda_driven_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift)
{
    copy_below(arrival->links.M, modes->shape);
    *drift = PANDA_R(1.0);
    modes->rigid = 0;
    return spring_modes(p, modes->shape, arrival->row, modes);
}

int panda_free_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes)
{
    const int end = PANDA_N - 1;
    panda_real (*const L)[PANDA_SYSTEM] = modes->shape; /* of panda_mobilities, and then U^-1 L' */
    panda_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    panda_real light[PANDA_N]; /* 1/rotors */
    panda_real z[PANDA_N];
    panda_real per[PANDA_N]; /* 1/the diagonal of U */
    panda_real carried[PANDA_N]; /* g sqrt(k) */
    panda_real pulled[PANDA_N];
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < PANDA_N; ++i) {
        light[i] = PANDA_R(1.0)/PANDA_ROTOR(p, i);
        z[i] = arrival->row[i];
        pulled[i] = PANDA_R(0.0);
    }
    for (int i = 0; i < PANDA_N; ++i) {
        for (int l = i; l < PANDA_N; ++l) {
            pulled[l] = L[l][i]*light[l];
        }
        for (int j = 0; j <= i; ++j) {
            panda_real sum = i == j ? PANDA_R(1.0) : PANDA_R(0.0);
            for (int l = i; l < PANDA_N; ++l) {
                sum += pulled[l]*L[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!panda_cholesky(PANDA_N, G)) {
        return PANDA_SINGULAR;
    }
    panda_forward(PANDA_N, L, z);
    for (int i = end; i >= 0; --i) {
        const panda_real *const U = G[end - i];
        panda_real rest = z[i];
        for (int m = i + 1; m < PANDA_N; ++m) {
            rest -= U[end - m]*z[m];
        }
        per[i] = PANDA_R(1.0)/U[end - i];
        z[i] = rest*per[i];
    }
    panda_real together = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        panda_real *const y = L[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        panda_real sum = PANDA_R(0.0);
        for (int l = i; l >= 0; --l) {
            const panda_real *const U = G[end - l];
            panda_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest*per[l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += arrival->row[i]*sum*light[i];
    }
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            panda_real entry = PANDA_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += L[i][l]*L[j][l];
            }
            G[i][j] = entry;
        }
    }
    if (!(together > PANDA_R(0.0) && together <= PANDA_REAL_MAX)) {
        return PANDA_SINGULAR;
    }
    modes->rigid = 1; /* r */
    modes->squared[0] = PANDA_R(0.0);
    modes->noise[0] = PANDA_R(0.0);
    modes->row[0] = PANDA_SQRT(together);
    modes->start[0] = PANDA_R(1.0)/modes->row[0];
    modes->from[0] = PANDA_N; /* none of them */
    return spring_modes(p, G, carried, modes);
}

/* Mobility of the contact point with links, whose mass becomes its L L', and rotors as one, if they count. */
static panda_real mobility_of(const panda_arrival *arrival, const panda_params *p, panda_real rotors, panda_matrix L)
{
    panda_real z[PANDA_N];
    panda_real sum = PANDA_R(0.0);
    (void)p;
    copy_below(arrival->links.M, L);
    for (int i = 0; i < PANDA_N; ++i) {
        z[i] = arrival->row[i];
        L[i][i] += rotors*PANDA_ROTOR(p, i);
    }
    if (panda_cholesky(PANDA_N, L)) {
        panda_forward(PANDA_N, L, z);
        for (int i = 0; i < PANDA_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int panda_mobilities(const panda_arrival *arrival, const panda_params *p, panda_matrix L, panda_real *links,
    panda_real *rotors)
{
    *rotors = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        *rotors += arrival->row[i]*arrival->row[i]/PANDA_ROTOR(p, i);
    }
    *links = mobility_of(arrival, p, PANDA_R(0.0), L);
    return *links > PANDA_LEAST_MOBILITY ? PANDA_OK : PANDA_SINGULAR;
}

panda_real panda_together(const panda_arrival *arrival, const panda_params *p)
{
    panda_matrix mass;
    return mobility_of(arrival, p, PANDA_R(1.0), mass);
}
#endif
