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
 * stand. With S = L L' and G = I + L'(1/R) L, C = L G^-1 L' and g = L G^-1 L^-1 b: no difference of
 * what may be nearly the same, whether rotors are much lighter or heavier than links.
 */
#include "rr_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (RR_R(8.0)*RR_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL RR_R(1e-8)

#if RR_STRUCTURED
/* S, R and b. */
typedef struct {
    rr_matrix S;
    rr_real R[RR_N];
    rr_real b[RR_N];
} spring_scaled;

static void scale_by_springs(const rr_arrival *arrival, const rr_params *p, spring_scaled *out)
{
    (void)p; /* whatever of it counts may be built in */
    rr_real soft[RR_N];
    for (int i = 0; i < RR_N; ++i) {
        const rr_real compliance = RR_R(1.0)/RR_SPRING(p, i);
        soft[i] = RR_SQRT(compliance);
        out->R[i] = RR_ROTOR(p, i)*compliance;
        out->b[i] = arrival->row[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            out->S[i][j] = arrival->links.M[i][j]*soft[i]*soft[j];
            out->S[j][i] = out->S[i][j];
        }
    }
}

/* Appends the modes of a compliance, which is lost, to those there are. */
static int spring_modes(rr_matrix C, const rr_real b[RR_N], rr_modes *modes)
{
    rr_real squares[RR_N];
    rr_real (*const vectors)[RR_SYSTEM] = &modes->shape[modes->rigid];
    rr_real all = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        all += C[i][i];
    }
    if (!rr_spectrum(RR_N, SMALL, C, squares, vectors)) {
        return RR_SINGULAR;
    }
    const rr_real least = NOISE*all;
    modes->fastest = RR_R(1.0)/least;
    for (int i = 0; i < RR_N; ++i) {
        const int at = modes->rigid + i;
        const rr_real squared = RR_R(1.0)/RR_FMAX(squares[i], least);
        const rr_real rate = RR_SQRT(squared);
        rr_real row = RR_R(0.0);
        for (int j = 0; j < RR_N; ++j) {
            row += vectors[i][j]*b[j];
            vectors[i][j] *= rate;
        }
        modes->squared[at] = squared;
        modes->noise[at] = RR_R(0.0);
        modes->row[at] = row*rate;
        modes->start[at] = RR_R(0.0);
    }
    modes->count = modes->rigid + RR_N;
    return RR_OK;
}

int rr_driven_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes,
    rr_real *drift)
{
    spring_scaled s;
    scale_by_springs(arrival, p, &s);
    *drift = RR_R(1.0);
    modes->rigid = 0;
    return spring_modes(s.S, s.b, modes);
}

int rr_free_modes(const rr_arrival *arrival, const rr_params *p, rr_modes *modes,
    rr_real carried[RR_N])
{
    const int end = RR_N - 1;
    spring_scaled s;
    rr_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    rr_real z[RR_N];
    scale_by_springs(arrival, p, &s);
    if (!rr_cholesky(RR_N, s.S)) {
        return RR_SINGULAR;
    }
    for (int i = 0; i < RR_N; ++i) {
        z[i] = s.b[i];
        rr_real stiff[RR_N];
        for (int l = 0; l < RR_N; ++l) {
            stiff[l] = l < i ? RR_R(0.0) : s.S[l][i]/s.R[l];
        }
        for (int j = 0; j <= i; ++j) {
            rr_real sum = i == j ? RR_R(1.0) : RR_R(0.0);
            for (int l = i; l < RR_N; ++l) {
                sum += stiff[l]*s.S[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!rr_cholesky(RR_N, G)) {
        return RR_SINGULAR;
    }
    rr_forward(RR_N, s.S, z);
    for (int i = end; i >= 0; --i) {
        for (int m = i + 1; m < RR_N; ++m) {
            z[i] -= G[end - i][end - m]*z[m];
        }
        z[i] /= G[end - i][end - i];
    }
    rr_real together = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        rr_real *const y = s.S[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        rr_real sum = RR_R(0.0);
        for (int l = i; l >= 0; --l) {
            const rr_real *const U = G[end - l];
            rr_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest/U[end - l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += s.b[i]*sum/s.R[i];
    }
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            rr_real entry = RR_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += s.S[i][l]*s.S[j][l];
            }
            G[i][j] = entry;
            G[j][i] = entry;
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
    for (int j = 0; j < RR_SYSTEM; ++j) {
        modes->shape[0][j] = RR_R(0.0);
    }
    return spring_modes(G, carried, modes);
}

/* Row (mass)^-1 row of a symmetric matrix; 0 unless it is positive definite. */
static rr_real mobility_through(rr_matrix mass, const rr_real row[RR_N])
{
    rr_real z[RR_N];
    rr_real sum = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        z[i] = row[i];
    }
    if (rr_cholesky(RR_N, mass)) {
        rr_forward(RR_N, mass, z);
        for (int i = 0; i < RR_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int rr_mobilities(const rr_arrival *arrival, const rr_params *p, rr_real *links,
    rr_real *rotors)
{
    rr_matrix mass;
    *rotors = RR_R(0.0);
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        *rotors += arrival->row[i]*arrival->row[i]/RR_ROTOR(p, i);
    }
    (void)p;
    *links = mobility_through(mass, arrival->row);
    return *links > RR_LEAST_MOBILITY ? RR_OK : RR_SINGULAR;
}

rr_real rr_together(const rr_arrival *arrival, const rr_params *p)
{
    rr_matrix mass;
    for (int i = 0; i < RR_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        mass[i][i] += RR_ROTOR(p, i);
    }
    (void)p;
    return mobility_through(mass, arrival->row);
}
#endif
