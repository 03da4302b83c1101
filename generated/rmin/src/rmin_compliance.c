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
 * stand. With S = L L' and G = I + L'(1/R) L, C = L G^-1 L' and g = L G^-1 L^-1 b: no difference of
 * what may be nearly the same, whether rotors are much lighter or heavier than links.
 */
#include "rmin_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (RMIN_R(8.0)*RMIN_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL RMIN_R(1e-8)

#if RMIN_STRUCTURED
/* S, R and b. */
typedef struct {
    rmin_matrix S;
    rmin_real R[RMIN_N];
    rmin_real b[RMIN_N];
} spring_scaled;

static void scale_by_springs(const rmin_arrival *arrival, const rmin_params *p, spring_scaled *out)
{
    (void)p; /* whatever of it counts may be built in */
    rmin_real soft[RMIN_N];
    for (int i = 0; i < RMIN_N; ++i) {
        const rmin_real compliance = RMIN_R(1.0)/RMIN_SPRING(p, i);
        soft[i] = RMIN_SQRT(compliance);
        out->R[i] = RMIN_ROTOR(p, i)*compliance;
        out->b[i] = arrival->row[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            out->S[i][j] = arrival->links.M[i][j]*soft[i]*soft[j];
            out->S[j][i] = out->S[i][j];
        }
    }
}

/* Appends the modes of a compliance, which is lost, to those there are. */
static int spring_modes(rmin_matrix C, const rmin_real b[RMIN_N], rmin_modes *modes)
{
    rmin_real squares[RMIN_N];
    rmin_real (*const vectors)[RMIN_SYSTEM] = &modes->shape[modes->rigid];
    rmin_real all = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        all += C[i][i];
    }
    if (!rmin_spectrum(RMIN_N, SMALL, C, squares, vectors)) {
        return RMIN_SINGULAR;
    }
    const rmin_real least = NOISE*all;
    modes->fastest = RMIN_R(1.0)/least;
    for (int i = 0; i < RMIN_N; ++i) {
        const int at = modes->rigid + i;
        const rmin_real squared = RMIN_R(1.0)/RMIN_FMAX(squares[i], least);
        const rmin_real rate = RMIN_SQRT(squared);
        rmin_real row = RMIN_R(0.0);
        for (int j = 0; j < RMIN_N; ++j) {
            row += vectors[i][j]*b[j];
            vectors[i][j] *= rate;
        }
        modes->squared[at] = squared;
        modes->noise[at] = RMIN_R(0.0);
        modes->row[at] = row*rate;
        modes->start[at] = RMIN_R(0.0);
    }
    modes->count = modes->rigid + RMIN_N;
    return RMIN_OK;
}

int rmin_driven_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real *drift)
{
    spring_scaled s;
    scale_by_springs(arrival, p, &s);
    *drift = RMIN_R(1.0);
    modes->rigid = 0;
    return spring_modes(s.S, s.b, modes);
}

int rmin_free_modes(const rmin_arrival *arrival, const rmin_params *p, rmin_modes *modes,
    rmin_real carried[RMIN_N])
{
    const int end = RMIN_N - 1;
    spring_scaled s;
    rmin_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    rmin_real z[RMIN_N];
    scale_by_springs(arrival, p, &s);
    if (!rmin_cholesky(RMIN_N, s.S)) {
        return RMIN_SINGULAR;
    }
    for (int i = 0; i < RMIN_N; ++i) {
        z[i] = s.b[i];
        rmin_real stiff[RMIN_N];
        for (int l = 0; l < RMIN_N; ++l) {
            stiff[l] = l < i ? RMIN_R(0.0) : s.S[l][i]/s.R[l];
        }
        for (int j = 0; j <= i; ++j) {
            rmin_real sum = i == j ? RMIN_R(1.0) : RMIN_R(0.0);
            for (int l = i; l < RMIN_N; ++l) {
                sum += stiff[l]*s.S[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!rmin_cholesky(RMIN_N, G)) {
        return RMIN_SINGULAR;
    }
    rmin_forward(RMIN_N, s.S, z);
    for (int i = end; i >= 0; --i) {
        for (int m = i + 1; m < RMIN_N; ++m) {
            z[i] -= G[end - i][end - m]*z[m];
        }
        z[i] /= G[end - i][end - i];
    }
    rmin_real together = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        rmin_real *const y = s.S[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        rmin_real sum = RMIN_R(0.0);
        for (int l = i; l >= 0; --l) {
            const rmin_real *const U = G[end - l];
            rmin_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest/U[end - l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += s.b[i]*sum/s.R[i];
    }
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            rmin_real entry = RMIN_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += s.S[i][l]*s.S[j][l];
            }
            G[i][j] = entry;
            G[j][i] = entry;
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
    for (int j = 0; j < RMIN_SYSTEM; ++j) {
        modes->shape[0][j] = RMIN_R(0.0);
    }
    return spring_modes(G, carried, modes);
}

/* Row (mass)^-1 row of a symmetric matrix; 0 unless it is positive definite. */
static rmin_real mobility_through(rmin_matrix mass, const rmin_real row[RMIN_N])
{
    rmin_real z[RMIN_N];
    rmin_real sum = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        z[i] = row[i];
    }
    if (rmin_cholesky(RMIN_N, mass)) {
        rmin_forward(RMIN_N, mass, z);
        for (int i = 0; i < RMIN_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int rmin_mobilities(const rmin_arrival *arrival, const rmin_params *p, rmin_real *links,
    rmin_real *rotors)
{
    rmin_matrix mass;
    *rotors = RMIN_R(0.0);
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        *rotors += arrival->row[i]*arrival->row[i]/RMIN_ROTOR(p, i);
    }
    (void)p;
    *links = mobility_through(mass, arrival->row);
    return *links > RMIN_LEAST_MOBILITY ? RMIN_OK : RMIN_SINGULAR;
}

rmin_real rmin_together(const rmin_arrival *arrival, const rmin_params *p)
{
    rmin_matrix mass;
    for (int i = 0; i < RMIN_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        mass[i][i] += RMIN_ROTOR(p, i);
    }
    (void)p;
    return mobility_through(mass, arrival->row);
}
#endif
