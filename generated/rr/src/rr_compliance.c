/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of rr_ where nothing but springs in the joints pulls.
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
#include "rr_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (RR_R(8.0)*RR_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL RR_R(1e-8)

#if RR_STRUCTURED
/*
 * Appends the modes of a compliance to those there are: of C over sqrt(k k'), of which C's part below its diagonal is
 * given and lost, and of `moved` over sqrt(k).
 */
static int spring_modes(const rr_params *p, rr_matrix C, const rr_real moved[RR_N], rr_modes *modes)
{
    rr_real soft[RR_N];
    rr_real squares[RR_N];
    rr_real row[1][RR_SYSTEM];
    rr_real all = RR_R(0.0);
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < RR_N; ++i) {
        soft[i] = RR_SQRT(RR_R(1.0)/RR_SPRING(p, i));
        row[0][i] = moved[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            C[i][j] *= soft[i]*soft[j];
            C[j][i] = C[i][j];
        }
        all += C[i][i];
    }
    if (!rr_spectrum(RR_N, SMALL, C, squares, 1, row, &modes->turns)) {
        return RR_SINGULAR;
    }
    const rr_real least = NOISE*all;
    modes->fastest = RR_R(1.0)/least;
    for (int i = 0; i < RR_N; ++i) {
        const int at = modes->rigid + i;
        const rr_real squared = RR_R(1.0)/RR_FMAX(squares[i], least);
        modes->squared[at] = squared;
        modes->noise[at] = RR_R(0.0);
        modes->row[at] = row[0][i]*RR_SQRT(squared);
        modes->from[at] = i;
        modes->start[at] = RR_R(0.0);
    }
    modes->count = modes->rigid + RR_N;
    return RR_OK;
}

/* Copies a symmetric matrix's part below its diagonal. */
static void copy_below(const rr_real (*from)[RR_N], rr_matrix to)
{
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            to[i][j] = from[i][j];
        }
    }
}

int rr_driven_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes,
    rr_real *drift)
{
    copy_below(arrival->links.M, modes->shape);
    *drift = RR_R(1.0);
    modes->rigid = 0;
    return spring_modes(p, modes->shape, arrival->row, modes);
}

int rr_free_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes)
{
    const int end = RR_N - 1;
    rr_real (*const L)[RR_SYSTEM] = modes->shape; /* of rr_mobilities, and then U^-1 L' */
    rr_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    rr_real light[RR_N]; /* 1/rotors */
    rr_real z[RR_N];
    rr_real per[RR_N]; /* 1/the diagonal of U */
    rr_real carried[RR_N]; /* g sqrt(k) */
    rr_real pulled[RR_N];
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < RR_N; ++i) {
        light[i] = RR_R(1.0)/RR_ROTOR(p, i);
        z[i] = arrival->row[i];
        pulled[i] = RR_R(0.0);
    }
    for (int i = 0; i < RR_N; ++i) {
        for (int l = i; l < RR_N; ++l) {
            pulled[l] = L[l][i]*light[l];
        }
        for (int j = 0; j <= i; ++j) {
            rr_real sum = i == j ? RR_R(1.0) : RR_R(0.0);
            for (int l = i; l < RR_N; ++l) {
                sum += pulled[l]*L[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!rr_cholesky(RR_N, G)) {
        return RR_SINGULAR;
    }
    rr_forward(RR_N, L, z);
    for (int i = end; i >= 0; --i) {
        const rr_real *const U = G[end - i];
        rr_real rest = z[i];
        for (int m = i + 1; m < RR_N; ++m) {
            rest -= U[end - m]*z[m];
        }
        per[i] = RR_R(1.0)/U[end - i];
        z[i] = rest*per[i];
    }
    rr_real together = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        rr_real *const y = L[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        rr_real sum = RR_R(0.0);
        for (int l = i; l >= 0; --l) {
            const rr_real *const U = G[end - l];
            rr_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest*per[l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += arrival->row[i]*sum*light[i];
    }
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            rr_real entry = RR_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += L[i][l]*L[j][l];
            }
            G[i][j] = entry;
        }
    }
    if (!(together > RR_R(0.0) && together <= RR_REAL_MAX)) {
        return RR_SINGULAR;
    }
    modes->rigid = 1; /* r */
    modes->squared[0] = RR_R(0.0);
    modes->noise[0] = RR_R(0.0);
    modes->row[0] = RR_SQRT(together);
    modes->start[0] = RR_R(1.0)/modes->row[0];
    modes->from[0] = RR_N; /* none of them */
    return spring_modes(p, G, carried, modes);
}

/* Mobility of the contact point with links, whose mass becomes its L L', and rotors as one, if they count. */
static rr_real mobility_of(const rr_arrival *arrival, const rr_params *p, rr_real rotors, rr_matrix L)
{
    rr_real z[RR_N];
    rr_real sum = RR_R(0.0);
    (void)p;
    copy_below(arrival->links.M, L);
    for (int i = 0; i < RR_N; ++i) {
        z[i] = arrival->row[i];
        L[i][i] += rotors*RR_ROTOR(p, i);
    }
    if (rr_cholesky(RR_N, L)) {
        rr_forward(RR_N, L, z);
        for (int i = 0; i < RR_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int rr_mobilities(const rr_arrival *arrival, const rr_params *p, rr_matrix L, rr_real *links,
    rr_real *rotors)
{
    *rotors = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        *rotors += arrival->row[i]*arrival->row[i]/RR_ROTOR(p, i);
    }
    *links = mobility_of(arrival, p, RR_R(0.0), L);
    return *links > RR_LEAST_MOBILITY ? RR_OK : RR_SINGULAR;
}

rr_real rr_together(const rr_arrival *arrival, const rr_params *p)
{
    rr_matrix mass;
    return mobility_of(arrival, p, RR_R(1.0), mass);
}
#endif
