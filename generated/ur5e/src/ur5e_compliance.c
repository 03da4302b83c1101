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
 * stand. With S = L L' and G = I + L'(1/R) L, C = L G^-1 L' and g = L G^-1 L^-1 b: no difference of
 * what may be nearly the same, whether rotors are much lighter or heavier than links.
 */
#include "ur5e_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (UR5E_R(8.0)*UR5E_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL UR5E_R(1e-8)

#if UR5E_STRUCTURED
/* S, R and b. */
typedef struct {
    ur5e_matrix S;
    ur5e_real R[UR5E_N];
    ur5e_real b[UR5E_N];
} spring_scaled;

static void scale_by_springs(const ur5e_arrival *arrival, const ur5e_params *p, spring_scaled *out)
{
    (void)p; /* whatever of it counts may be built in */
    ur5e_real soft[UR5E_N];
    for (int i = 0; i < UR5E_N; ++i) {
        const ur5e_real compliance = UR5E_R(1.0)/UR5E_SPRING(p, i);
        soft[i] = UR5E_SQRT(compliance);
        out->R[i] = UR5E_ROTOR(p, i)*compliance;
        out->b[i] = arrival->row[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            out->S[i][j] = arrival->links.M[i][j]*soft[i]*soft[j];
            out->S[j][i] = out->S[i][j];
        }
    }
}

/* Appends the modes of a compliance, which is lost, to those there are. */
static int spring_modes(ur5e_matrix C, const ur5e_real b[UR5E_N], ur5e_modes *modes)
{
    ur5e_real squares[UR5E_N];
    ur5e_real (*const vectors)[UR5E_SYSTEM] = &modes->shape[modes->rigid];
    ur5e_real all = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        all += C[i][i];
    }
    if (!ur5e_spectrum(UR5E_N, SMALL, C, squares, vectors)) {
        return UR5E_SINGULAR;
    }
    const ur5e_real least = NOISE*all;
    modes->fastest = UR5E_R(1.0)/least;
    for (int i = 0; i < UR5E_N; ++i) {
        const int at = modes->rigid + i;
        const ur5e_real squared = UR5E_R(1.0)/UR5E_FMAX(squares[i], least);
        const ur5e_real rate = UR5E_SQRT(squared);
        ur5e_real row = UR5E_R(0.0);
        for (int j = 0; j < UR5E_N; ++j) {
            row += vectors[i][j]*b[j];
            vectors[i][j] *= rate;
        }
        modes->squared[at] = squared;
        modes->noise[at] = UR5E_R(0.0);
        modes->row[at] = row*rate;
        modes->start[at] = UR5E_R(0.0);
    }
    modes->count = modes->rigid + UR5E_N;
    return UR5E_OK;
}

int ur5e_driven_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real *drift)
{
    spring_scaled s;
    scale_by_springs(arrival, p, &s);
    *drift = UR5E_R(1.0);
    modes->rigid = 0;
    return spring_modes(s.S, s.b, modes);
}

int ur5e_free_modes(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_modes *modes,
    ur5e_real carried[UR5E_N])
{
    const int end = UR5E_N - 1;
    spring_scaled s;
    ur5e_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    ur5e_real z[UR5E_N];
    scale_by_springs(arrival, p, &s);
    if (!ur5e_cholesky(UR5E_N, s.S)) {
        return UR5E_SINGULAR;
    }
    for (int i = 0; i < UR5E_N; ++i) {
        z[i] = s.b[i];
        ur5e_real stiff[UR5E_N];
        for (int l = 0; l < UR5E_N; ++l) {
            stiff[l] = l < i ? UR5E_R(0.0) : s.S[l][i]/s.R[l];
        }
        for (int j = 0; j <= i; ++j) {
            ur5e_real sum = i == j ? UR5E_R(1.0) : UR5E_R(0.0);
            for (int l = i; l < UR5E_N; ++l) {
                sum += stiff[l]*s.S[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!ur5e_cholesky(UR5E_N, G)) {
        return UR5E_SINGULAR;
    }
    ur5e_forward(UR5E_N, s.S, z);
    for (int i = end; i >= 0; --i) {
        for (int m = i + 1; m < UR5E_N; ++m) {
            z[i] -= G[end - i][end - m]*z[m];
        }
        z[i] /= G[end - i][end - i];
    }
    ur5e_real together = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        ur5e_real *const y = s.S[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        ur5e_real sum = UR5E_R(0.0);
        for (int l = i; l >= 0; --l) {
            const ur5e_real *const U = G[end - l];
            ur5e_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest/U[end - l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += s.b[i]*sum/s.R[i];
    }
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            ur5e_real entry = UR5E_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += s.S[i][l]*s.S[j][l];
            }
            G[i][j] = entry;
            G[j][i] = entry;
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
    for (int j = 0; j < UR5E_SYSTEM; ++j) {
        modes->shape[0][j] = UR5E_R(0.0);
    }
    return spring_modes(G, carried, modes);
}

/* Row (mass)^-1 row of a symmetric matrix; 0 unless it is positive definite. */
static ur5e_real mobility_through(ur5e_matrix mass, const ur5e_real row[UR5E_N])
{
    ur5e_real z[UR5E_N];
    ur5e_real sum = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        z[i] = row[i];
    }
    if (ur5e_cholesky(UR5E_N, mass)) {
        ur5e_forward(UR5E_N, mass, z);
        for (int i = 0; i < UR5E_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int ur5e_mobilities(const ur5e_arrival *arrival, const ur5e_params *p, ur5e_real *links,
    ur5e_real *rotors)
{
    ur5e_matrix mass;
    *rotors = UR5E_R(0.0);
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        *rotors += arrival->row[i]*arrival->row[i]/UR5E_ROTOR(p, i);
    }
    (void)p;
    *links = mobility_through(mass, arrival->row);
    return *links > UR5E_LEAST_MOBILITY ? UR5E_OK : UR5E_SINGULAR;
}

ur5e_real ur5e_together(const ur5e_arrival *arrival, const ur5e_params *p)
{
    ur5e_matrix mass;
    for (int i = 0; i < UR5E_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        mass[i][i] += UR5E_ROTOR(p, i);
    }
    (void)p;
    return mobility_through(mass, arrival->row);
}
#endif
