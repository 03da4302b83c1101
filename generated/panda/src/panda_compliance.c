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
 * stand. With S = L L' and G = I + L'(1/R) L, C = L G^-1 L' and g = L G^-1 L^-1 b: no difference of
 * what may be nearly the same, whether rotors are much lighter or heavier than links.
 */
#include "panda_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (PANDA_R(8.0)*PANDA_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL PANDA_R(1e-8)

#if PANDA_STRUCTURED
/* S, R and b. */
typedef struct {
    panda_matrix S;
    panda_real R[PANDA_N];
    panda_real b[PANDA_N];
} spring_scaled;

static void scale_by_springs(const panda_arrival *arrival, const panda_params *p, spring_scaled *out)
{
    (void)p; /* whatever of it counts may be built in */
    panda_real soft[PANDA_N];
    for (int i = 0; i < PANDA_N; ++i) {
        const panda_real compliance = PANDA_R(1.0)/PANDA_SPRING(p, i);
        soft[i] = PANDA_SQRT(compliance);
        out->R[i] = PANDA_ROTOR(p, i)*compliance;
        out->b[i] = arrival->row[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            out->S[i][j] = arrival->links.M[i][j]*soft[i]*soft[j];
            out->S[j][i] = out->S[i][j];
        }
    }
}

/* Appends the modes of a compliance, which is lost, to those there are. */
static int spring_modes(panda_matrix C, const panda_real b[PANDA_N], panda_modes *modes)
{
    panda_real squares[PANDA_N];
    panda_real (*const vectors)[PANDA_SYSTEM] = &modes->shape[modes->rigid];
    panda_real all = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        all += C[i][i];
    }
    if (!panda_spectrum(PANDA_N, SMALL, C, squares, vectors)) {
        return PANDA_SINGULAR;
    }
    const panda_real least = NOISE*all;
    modes->fastest = PANDA_R(1.0)/least;
    for (int i = 0; i < PANDA_N; ++i) {
        const int at = modes->rigid + i;
        const panda_real squared = PANDA_R(1.0)/PANDA_FMAX(squares[i], least);
        const panda_real rate = PANDA_SQRT(squared);
        panda_real row = PANDA_R(0.0);
        for (int j = 0; j < PANDA_N; ++j) {
            row += vectors[i][j]*b[j];
            vectors[i][j] *= rate;
        }
        modes->squared[at] = squared;
        modes->noise[at] = PANDA_R(0.0);
        modes->row[at] = row*rate;
        modes->start[at] = PANDA_R(0.0);
    }
    modes->count = modes->rigid + PANDA_N;
    return PANDA_OK;
}

int panda_driven_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real *drift)
{
    spring_scaled s;
    scale_by_springs(arrival, p, &s);
    *drift = PANDA_R(1.0);
    modes->rigid = 0;
    return spring_modes(s.S, s.b, modes);
}

int panda_free_modes(const panda_arrival *arrival, const panda_params *p, panda_modes *modes,
    panda_real carried[PANDA_N])
{
    const int end = PANDA_N - 1;
    spring_scaled s;
    panda_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    panda_real z[PANDA_N];
    scale_by_springs(arrival, p, &s);
    if (!panda_cholesky(PANDA_N, s.S)) {
        return PANDA_SINGULAR;
    }
    for (int i = 0; i < PANDA_N; ++i) {
        z[i] = s.b[i];
        panda_real stiff[PANDA_N];
        for (int l = 0; l < PANDA_N; ++l) {
            stiff[l] = l < i ? PANDA_R(0.0) : s.S[l][i]/s.R[l];
        }
        for (int j = 0; j <= i; ++j) {
            panda_real sum = i == j ? PANDA_R(1.0) : PANDA_R(0.0);
            for (int l = i; l < PANDA_N; ++l) {
                sum += stiff[l]*s.S[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!panda_cholesky(PANDA_N, G)) {
        return PANDA_SINGULAR;
    }
    panda_forward(PANDA_N, s.S, z);
    for (int i = end; i >= 0; --i) {
        for (int m = i + 1; m < PANDA_N; ++m) {
            z[i] -= G[end - i][end - m]*z[m];
        }
        z[i] /= G[end - i][end - i];
    }
    panda_real together = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        panda_real *const y = s.S[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        panda_real sum = PANDA_R(0.0);
        for (int l = i; l >= 0; --l) {
            const panda_real *const U = G[end - l];
            panda_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest/U[end - l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += s.b[i]*sum/s.R[i];
    }
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            panda_real entry = PANDA_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += s.S[i][l]*s.S[j][l];
            }
            G[i][j] = entry;
            G[j][i] = entry;
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
    for (int j = 0; j < PANDA_SYSTEM; ++j) {
        modes->shape[0][j] = PANDA_R(0.0);
    }
    return spring_modes(G, carried, modes);
}

/* Row (mass)^-1 row of a symmetric matrix; 0 unless it is positive definite. */
static panda_real mobility_through(panda_matrix mass, const panda_real row[PANDA_N])
{
    panda_real z[PANDA_N];
    panda_real sum = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        z[i] = row[i];
    }
    if (panda_cholesky(PANDA_N, mass)) {
        panda_forward(PANDA_N, mass, z);
        for (int i = 0; i < PANDA_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int panda_mobilities(const panda_arrival *arrival, const panda_params *p, panda_real *links,
    panda_real *rotors)
{
    panda_matrix mass;
    *rotors = PANDA_R(0.0);
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        *rotors += arrival->row[i]*arrival->row[i]/PANDA_ROTOR(p, i);
    }
    (void)p;
    *links = mobility_through(mass, arrival->row);
    return *links > PANDA_LEAST_MOBILITY ? PANDA_OK : PANDA_SINGULAR;
}

panda_real panda_together(const panda_arrival *arrival, const panda_params *p)
{
    panda_matrix mass;
    for (int i = 0; i < PANDA_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        mass[i][i] += PANDA_ROTOR(p, i);
    }
    (void)p;
    return mobility_through(mass, arrival->row);
}
#endif
