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
 * stand. With S = L L' and G = I + L'(1/R) L, C = L G^-1 L' and g = L G^-1 L^-1 b: no difference of
 * what may be nearly the same, whether rotors are much lighter or heavier than links.
 */
#include "robot_impact.h"

/* A mode of less than this share of all squared periods has no digits left. */
#define NOISE (ROBOT_R(8.0)*ROBOT_EPSILON)

/* Square of what may be left beside the diagonal of a compliance: energies change by less than its root. */
#define SMALL ROBOT_R(1e-8)

#if ROBOT_STRUCTURED
/* S, R and b. */
typedef struct {
    robot_matrix S;
    robot_real R[ROBOT_N];
    robot_real b[ROBOT_N];
} spring_scaled;

static void scale_by_springs(const robot_arrival *arrival, const robot_params *p, spring_scaled *out)
{
    (void)p; /* whatever of it counts may be built in */
    robot_real soft[ROBOT_N];
    for (int i = 0; i < ROBOT_N; ++i) {
        const robot_real compliance = ROBOT_R(1.0)/ROBOT_SPRING(p, i);
        soft[i] = ROBOT_SQRT(compliance);
        out->R[i] = ROBOT_ROTOR(p, i)*compliance;
        out->b[i] = arrival->row[i]*soft[i];
        for (int j = 0; j <= i; ++j) {
            out->S[i][j] = arrival->links.M[i][j]*soft[i]*soft[j];
            out->S[j][i] = out->S[i][j];
        }
    }
}

/* Appends the modes of a compliance, which is lost, to those there are. */
static int spring_modes(robot_matrix C, const robot_real b[ROBOT_N], robot_modes *modes)
{
    robot_real squares[ROBOT_N];
    robot_real (*const vectors)[ROBOT_SYSTEM] = &modes->shape[modes->rigid];
    robot_real all = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        all += C[i][i];
    }
    if (!robot_spectrum(ROBOT_N, SMALL, C, squares, vectors)) {
        return ROBOT_SINGULAR;
    }
    const robot_real least = NOISE*all;
    modes->fastest = ROBOT_R(1.0)/least;
    for (int i = 0; i < ROBOT_N; ++i) {
        const int at = modes->rigid + i;
        const robot_real squared = ROBOT_R(1.0)/ROBOT_FMAX(squares[i], least);
        const robot_real rate = ROBOT_SQRT(squared);
        robot_real row = ROBOT_R(0.0);
        for (int j = 0; j < ROBOT_N; ++j) {
            row += vectors[i][j]*b[j];
            vectors[i][j] *= rate;
        }
        modes->squared[at] = squared;
        modes->noise[at] = ROBOT_R(0.0);
        modes->row[at] = row*rate;
        modes->start[at] = ROBOT_R(0.0);
    }
    modes->count = modes->rigid + ROBOT_N;
    return ROBOT_OK;
}

int robot_driven_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes,
    robot_real *drift)
{
    spring_scaled s;
    scale_by_springs(arrival, p, &s);
    *drift = ROBOT_R(1.0);
    modes->rigid = 0;
    return spring_modes(s.S, s.b, modes);
}

int robot_free_modes(const robot_arrival *arrival, const robot_params *p, robot_modes *modes,
    robot_real carried[ROBOT_N])
{
    const int end = ROBOT_N - 1;
    spring_scaled s;
    robot_matrix G; /* and then C; from its end to its start: so Cholesky's factors are upper ones, G = U U' */
    robot_real z[ROBOT_N];
    scale_by_springs(arrival, p, &s);
    if (!robot_cholesky(ROBOT_N, s.S)) {
        return ROBOT_SINGULAR;
    }
    for (int i = 0; i < ROBOT_N; ++i) {
        z[i] = s.b[i];
        robot_real stiff[ROBOT_N];
        for (int l = 0; l < ROBOT_N; ++l) {
            stiff[l] = l < i ? ROBOT_R(0.0) : s.S[l][i]/s.R[l];
        }
        for (int j = 0; j <= i; ++j) {
            robot_real sum = i == j ? ROBOT_R(1.0) : ROBOT_R(0.0);
            for (int l = i; l < ROBOT_N; ++l) {
                sum += stiff[l]*s.S[l][j];
            }
            G[end - j][end - i] = sum;
        }
    }
    if (!robot_cholesky(ROBOT_N, G)) {
        return ROBOT_SINGULAR;
    }
    robot_forward(ROBOT_N, s.S, z);
    for (int i = end; i >= 0; --i) {
        for (int m = i + 1; m < ROBOT_N; ++m) {
            z[i] -= G[end - i][end - m]*z[m];
        }
        z[i] /= G[end - i][end - i];
    }
    robot_real together = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        robot_real *const y = s.S[i]; /* column i of L' and then of U^-1 L', upper triangular as both are */
        robot_real sum = ROBOT_R(0.0);
        for (int l = i; l >= 0; --l) {
            const robot_real *const U = G[end - l];
            robot_real rest = y[l];
            for (int m = l + 1; m <= i; ++m) {
                rest -= U[end - m]*y[m];
            }
            y[l] = rest/U[end - l];
            sum += y[l]*z[l];
        }
        carried[i] = sum;
        together += s.b[i]*sum/s.R[i];
    }
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            robot_real entry = ROBOT_R(0.0);
            for (int l = 0; l <= j; ++l) {
                entry += s.S[i][l]*s.S[j][l];
            }
            G[i][j] = entry;
            G[j][i] = entry;
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
    for (int j = 0; j < ROBOT_SYSTEM; ++j) {
        modes->shape[0][j] = ROBOT_R(0.0);
    }
    return spring_modes(G, carried, modes);
}

/* Row (mass)^-1 row of a symmetric matrix; 0 unless it is positive definite. */
static robot_real mobility_through(robot_matrix mass, const robot_real row[ROBOT_N])
{
    robot_real z[ROBOT_N];
    robot_real sum = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        z[i] = row[i];
    }
    if (robot_cholesky(ROBOT_N, mass)) {
        robot_forward(ROBOT_N, mass, z);
        for (int i = 0; i < ROBOT_N; ++i) {
            sum += z[i]*z[i];
        }
    }
    return sum;
}

int robot_mobilities(const robot_arrival *arrival, const robot_params *p, robot_real *links,
    robot_real *rotors)
{
    robot_matrix mass;
    *rotors = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        *rotors += arrival->row[i]*arrival->row[i]/ROBOT_ROTOR(p, i);
    }
    (void)p;
    *links = mobility_through(mass, arrival->row);
    return *links > ROBOT_LEAST_MOBILITY ? ROBOT_OK : ROBOT_SINGULAR;
}

robot_real robot_together(const robot_arrival *arrival, const robot_params *p)
{
    robot_matrix mass;
    for (int i = 0; i < ROBOT_N; ++i) {
        for (int j = 0; j <= i; ++j) {
            mass[i][j] = arrival->links.M[i][j];
        }
        mass[i][i] += ROBOT_ROTOR(p, i);
    }
    (void)p;
    return mobility_through(mass, arrival->row);
}
#endif
