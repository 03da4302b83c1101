/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of ur5e_ where nothing but springs in the joints pulls.
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
#include "ur5e_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (UR5E_R(8.0)*UR5E_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL UR5E_R(1e-8)

#if UR5E_STRUCTURED
/*
 * Appends the modes of a compliance to those there are: of C over sqrt(k k'), of which C's part below its diagonal is
 * given and lost, and of `moved` over sqrt(k).
 */
static int spring_modes(const ur5e_params *p, ur5e_matrix C, const ur5e_real moved[UR5E_N], ur5e_modes *modes)
{
    ur5e_real soft[UR5E_N];
    ur5e_real squares[UR5E_N];
    ur5e_real row[1][UR5E_SYSTEM];
    ur5e_real all = UR5E_R(0.0);
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < UR5E_N; ++i) {
        soft[i] = UR5E_SQRT(UR5E_R(1.0)/UR5E_SPRING(p, i));
        row[0][i] = moved[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            C[i][j] *= soft[i]*soft[j];
            C[j][i] = C[i][j];
        }
        all += C[i][i];
    }
    if (!ur5e_spectrum(UR5E_N, SMALL, C, squares, 1, row, &modes->turns)) {
        return UR5E_SINGULAR;
    }
    const ur5e_real least = NOISE*all;
    modes->fastest = UR5E_R(1.0)/least;
    for (int i = 0; i < UR5E_N; ++i) {
        const int at = modes->rigid + i;
        const ur5e_real squared = UR5E_R(1.0)/UR5E_FMAX(squares[i], least);
        modes->squared[at] = squared;
        modes->noise[at] = UR5E_R(0.0);
        modes->row[at] = row[0][i]*UR5E_SQRT(squared);
        modes->from[at] = i;
        modes->start[at] = UR5E_R(0.0);
    }
    modes->count = modes->rigid + UR5E_N;
    return UR5E_OK;
}

/* Copies a symmetric matrix's part below its diagonal. */
static void copy_below(const ur5e_real (*from)[UR5E_N], ur5e_matrix to)
{
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            to[i][j] = from[i][j];
        }
    }
}

int ur5e_driven_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real *drift)
{
    copy_below(arrival->links.M, modes->shape);
    *drift = UR5E_R(1.0);
    modes->rigid = 0;
    return spring_modes(p, modes->shape, arrival->row, modes);
}

int ur5e_free_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes)
{
    const int end = UR5E_N - 1;
    ur5e_real (*const L)[UR5E_SYSTEM] = modes->shape; /* of ur5e_mobilities, and then U^-1 L' */
    ur5e_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    ur5e_real light[UR5E_N]; /* 1/rotors */
    ur5e_real z[UR5E_N];
    ur5e_real per[UR5E_N]; /* 1/the diagonal of U */
    ur5e_real carried[UR5E_N]; /* g sqrt(k) */
    ur5e_real pulled[UR5E_N];
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < UR5E_N; ++i) {
        light[i] = UR5E_R(1.0)/UR5E_ROTOR(p, i);
        z[i] = arrival->row[i];
        pulled[i] = UR5E_R(0.0);
    }
    for (int i = 0; i < UR5E_N; ++i) {
        for (int l = i; l < UR5E_N; ++l) {
            pulled[l] = L[l][i]*light[l];
        }
        for (int j = 0; j <= i; ++j) {
            ur5e_real sum = i == j ? UR5E_R(1.0) : UR5E_R(0.0);
            for (int l = i; l < UR5E_N; ++l) {
                sum += pulled[l]*L[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!ur5e_cholesky(UR5E_N, G)) {
        return UR5E_SINGULAR;
    }
    ur5e_forward(UR5E_N, L, z);
    for (int i = end; i >= 0; --i) {
        const ur5e_real *const U = G[end - i];
        ur5e_real rest = z[i];
        for (int m = i + 1; m < UR5E_N; ++m) {
            rest -= U[end - m]*z[m];
        }
        per[i] = UR5E_R(1.0)/U[end - i];
        z[i] = rest*per[i];
    }
    ur5e_real together = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        ur5e_real *const y = L[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        ur5e_real sum = UR5E_R(0.0);
        for (int l = i; l >= 0; --l) {
            const ur5e_real *const U = G[end - l];
            ur5e_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest*per[l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += arrival->row[i]*sum*light[i];
    }
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            ur5e_real entry = UR5E_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += L[i][l]*L[j][l];
            }
            G[i][j] = entry;
        }
    }
    if (!(together > UR5E_R(0.0) && together <= UR5E_REAL_MAX)) {
        return UR5E_SINGULAR;
    }
    modes->rigid = 1; /* r */
    modes->squared[0] = UR5E_R(0.0);
    modes->noise[0] = UR5E_R(0.0);
    modes->row[0] = UR5E_SQRT(together);
    modes->start[0] = UR5E_R(1.0)/modes->row[0];
    modes->from[0] = UR5E_N; /* none of them */
    return spring_modes(p, G, carried, modes);
}

/* Mobility of the contact point with links, whose mass becomes its L L', and rotors as one, if they count. */
static ur5e_real mobility_of(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_real rotors, ur5e_matrix L)
{
    ur5e_real z[UR5E_N];
    ur5e_real sum = UR5E_R(0.0);
    (void)p;
    copy_below(arrival->links.M, L);
    for (int i = 0; i < UR5E_N; ++i) {
        z[i] = arrival->row[i];
        L[i][i] += rotors*UR5E_ROTOR(p, i);
    }
    if (ur5e_cholesky(UR5E_N, L)) {
        ur5e_forward(UR5E_N, L, z);
        for (int i = 0; i < UR5E_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int ur5e_mobilities(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_matrix L, ur5e_real *links,
    ur5e_real *rotors)
{
    *rotors = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        *rotors += arrival->row[i]*arrival->row[i]/UR5E_ROTOR(p, i);
    }
    *links = mobility_of(arrival, p, UR5E_R(0.0), L);
    return *links > UR5E_LEAST_MOBILITY ? UR5E_OK : UR5E_SINGULAR;
}

ur5e_real ur5e_together(const ur5e_arrival *arrival, const ur5e_params *p)
{
    ur5e_matrix mass;
    return mobility_of(arrival, p, UR5E_R(1.0), mass);
}
#endif
