/* SPDX-License-Identifier: 0BSD */
/*
 * Modes of robot_ where nothing but springs in the joints pulls.
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
#include "robot_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (ROBOT_R(8.0)*ROBOT_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL ROBOT_R(1e-8)

#if ROBOT_STRUCTURED
/*
 * Appends the modes of a compliance to those there are: of C over sqrt(k k'), of which C's part below its diagonal is
 * given and lost, and of `moved` over sqrt(k).
 */
static int spring_modes(const robot_params *p, robot_matrix C, const robot_real moved[ROBOT_N], robot_modes *modes)
{
    robot_real soft[ROBOT_N];
    robot_real squares[ROBOT_N];
    robot_real row[1][ROBOT_SYSTEM];
    robot_real all = ROBOT_R(0.0);
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < ROBOT_N; ++i) {
        soft[i] = ROBOT_SQRT(ROBOT_R(1.0)/ROBOT_SPRING(p, i));
        row[0][i] = moved[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            C[i][j] *= soft[i]*soft[j];
            C[j][i] = C[i][j];
        }
        all += C[i][i];
    }
    if (!robot_spectrum(ROBOT_N, SMALL, C, squares, 1, row, &modes->turns)) {
        return ROBOT_SINGULAR;
    }
    const robot_real least = NOISE*all;
    modes->fastest = ROBOT_R(1.0)/least;
    for (int i = 0; i < ROBOT_N; ++i) {
        const int at = modes->rigid + i;
        const robot_real squared = ROBOT_R(1.0)/ROBOT_FMAX(squares[i], least);
        modes->squared[at] = squared;
        modes->noise[at] = ROBOT_R(0.0);
        modes->row[at] = row[0][i]*ROBOT_SQRT(squared);
        modes->from[at] = i;
        modes->start[at] = ROBOT_R(0.0);
    }
    modes->count = modes->rigid + ROBOT_N;
    return ROBOT_OK;
}

/* Copies a symmetric matrix's part below its diagonal. */
static void copy_below(const robot_real (*from)[ROBOT_N], robot_matrix to)
{
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            to[i][j] = from[i][j];
        }
    }
}

int robot_driven_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes,
    robot_real *drift)
{
    copy_below(arrival->links.M, modes->shape);
    *drift = ROBOT_R(1.0);
    modes->rigid = 0;
    return spring_modes(p, modes->shape, arrival->row, modes);
}

int robot_free_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes)
{
    const int end = ROBOT_N - 1;
    robot_real (*const L)[ROBOT_SYSTEM] = modes->shape; /* of robot_mobilities, and then U^-1 L' */
    robot_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    robot_real light[ROBOT_N]; /* 1/rotors */
    robot_real z[ROBOT_N];
    robot_real per[ROBOT_N]; /* 1/the diagonal of U */
    robot_real carried[ROBOT_N]; /* g sqrt(k) */
    robot_real pulled[ROBOT_N];
    (void)p; /* whatever of it counts may be built in */
    for (int i = 0; i < ROBOT_N; ++i) {
        light[i] = ROBOT_R(1.0)/ROBOT_ROTOR(p, i);
        z[i] = arrival->row[i];
        pulled[i] = ROBOT_R(0.0);
    }
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int l = i; l < ROBOT_N; ++l) {
            pulled[l] = L[l][i]*light[l];
        }
        for (int j = 0; j <= i; ++j) {
            robot_real sum = i == j ? ROBOT_R(1.0) : ROBOT_R(0.0);
            for (int l = i; l < ROBOT_N; ++l) {
                sum += pulled[l]*L[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!robot_cholesky(ROBOT_N, G)) {
        return ROBOT_SINGULAR;
    }
    robot_forward(ROBOT_N, L, z);
    for (int i = end; i >= 0; --i) {
        const robot_real *const U = G[end - i];
        robot_real rest = z[i];
        for (int m = i + 1; m < ROBOT_N; ++m) {
            rest -= U[end - m]*z[m];
        }
        per[i] = ROBOT_R(1.0)/U[end - i];
        z[i] = rest*per[i];
    }
    robot_real together = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        robot_real *const y = L[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        robot_real sum = ROBOT_R(0.0);
        for (int l = i; l >= 0; --l) {
            const robot_real *const U = G[end - l];
            robot_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest*per[l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += arrival->row[i]*sum*light[i];
    }
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            robot_real entry = ROBOT_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += L[i][l]*L[j][l];
            }
            G[i][j] = entry;
        }
    }
    if (!(together > ROBOT_R(0.0) && together <= ROBOT_REAL_MAX)) {
        return ROBOT_SINGULAR;
    }
    modes->rigid = 1; /* r */
    modes->squared[0] = ROBOT_R(0.0);
    modes->noise[0] = ROBOT_R(0.0);
    modes->row[0] = ROBOT_SQRT(together);
    modes->start[0] = ROBOT_R(1.0)/modes->row[0];
    modes->from[0] = ROBOT_N; /* none of them */
    return spring_modes(p, G, carried, modes);
}

/* Mobility of the contact point with links, whose mass becomes its L L', and rotors as one, if they count. */
static robot_real mobility_of(const robot_arrival *arrival, const robot_params *p, robot_real rotors, robot_matrix L)
{
    robot_real z[ROBOT_N];
    robot_real sum = ROBOT_R(0.0);
    (void)p;
    copy_below(arrival->links.M, L);
    for (int i = 0; i < ROBOT_N; ++i) {
        z[i] = arrival->row[i];
        L[i][i] += rotors*ROBOT_ROTOR(p, i);
    }
    if (robot_cholesky(ROBOT_N, L)) {
        robot_forward(ROBOT_N, L, z);
        for (int i = 0; i < ROBOT_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int robot_mobilities(const robot_arrival *arrival, const robot_params *p, robot_matrix L, robot_real *links,
    robot_real *rotors)
{
    *rotors = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        *rotors += arrival->row[i]*arrival->row[i]/ROBOT_ROTOR(p, i);
    }
    *links = mobility_of(arrival, p, ROBOT_R(0.0), L);
    return *links > ROBOT_LEAST_MOBILITY ? ROBOT_OK : ROBOT_SINGULAR;
}

robot_real robot_together(const robot_arrival *arrival, const robot_params *p)
{
    robot_matrix mass;
    return mobility_of(arrival, p, ROBOT_R(1.0), mass);
}
#endif
