/* SPDX-License-Identifier: 0BSD */
/*
 * Feeds rmin any bits, or any numbers of a plausible size: whatever is RMIN_OK or a bound must be
 * finite, whatever is not must have written nothing. For libFuzzer:
 * clang -fsanitize=fuzzer,address,undefined -Iinclude fuzz/fuzz.c src/<all>.c -lm
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "rmin.h"

#define LAW_POINTS 4 /* at most, of a law by table */

/* Everything that functions read, as plain numbers. */
typedef struct {
    rmin_real q[6];
    rmin_real n[3];
    rmin_params p;
    rmin_real region[4];
    rmin_real number;
    rmin_real dq[6];
    rmin_law_point law[LAW_POINTS];
} inputs;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Stops the fuzzer unless memory holds finite numbers, or is as it was. */
static void check(int status, const void *memory, size_t size)
{
    const int written = status == RMIN_OK || status == RMIN_BOUNDED;
    for (size_t at = 0; at < size; at += sizeof(rmin_real)) {
        rmin_real x;
        unsigned char untouched[sizeof x];
        memset(untouched, 0xA5, sizeof untouched);
        memcpy(&x, (const unsigned char *)memory + at, sizeof x);
        if (written ? !isfinite(x) : memcmp(&x, untouched, sizeof x) != 0) {
            abort();
        }
    }
}

/* Bits as they are, or two bytes a number: -8 to 8, or its square for what should be positive. */
static void decode(const uint8_t *data, size_t size, inputs *in)
{
    memset(in, 0, sizeof *in);
    if (size > 0 && (data[0] & 1u) != 0u) {
        memcpy(in, data + 1, size - 1 < sizeof *in ? size - 1 : sizeof *in);
        return;
    }
    for (size_t i = 0; i < sizeof *in/sizeof(rmin_real); ++i) {
        const size_t at = 1 + 2*i;
        const int low = at < size ? data[at] : 1;
        const int high = at + 1 < size ? data[at + 1] : 144;
        const rmin_real x = (rmin_real)(256*high + low - 32768)/(rmin_real)4096;
        const rmin_real positive = x*x*x*x;
        memcpy((unsigned char *)in + i*sizeof x, i < 9 ? &x : &positive, sizeof x);
    }
}

/* Makes points a law: each number is what it rises by. */
static void rise(rmin_law_point law[LAW_POINTS])
{
    rmin_real depth = 0;
    rmin_real force = 0;
    for (int i = 0; i < LAW_POINTS; ++i) {
        const rmin_law_point by = law[i];
        law[i].depth = depth;
        law[i].force = force;
        depth += (by.depth + by.knee_depth)/1024;
        force += by.force + by.knee_force;
        law[i].knee_depth = (law[i].depth + depth)/2;
        law[i].knee_force = (law[i].force + force)/2;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    inputs in;
    decode(data, size, &in);
    if (size % 16u != 15u) {
        in.p.layout = RMIN_LAYOUT; /* else all that read p refuse */
    }
    if (size % 64u != 62u && in.p.steps > 256) {
        in.p.steps = 1 + in.p.steps % 256; /* long ones take most of the time */
    }
    {
        const rmin_real *const start = size > 0 && (data[0] & 8u) != 0u ? in.q : NULL;
        rmin_real q[6];
        memset(q, 0xA5, sizeof q);
        const int status = rmin_configuration(&in.q[4], start, q);
        check(status, q, sizeof q);
        if (status == RMIN_OK) {
            memcpy(in.q, q, sizeof q); /* else the loops are open, and all the others refuse */
        }
    }
    {
        rmin_real M[4][4];
        memset(&M, 0xA5, sizeof M);
        const int status = rmin_mass_matrix(in.q, M);
        check(status, &M, sizeof M);
    }
    {
        rmin_real J[3][4];
        memset(&J, 0xA5, sizeof J);
        const int status = rmin_jacobian(in.q, J);
        check(status, &J, sizeof J);
    }
    {
        rmin_real M0[4][4];
        memset(&M0, 0xA5, sizeof M0);
        const int status = rmin_generalised_mass_matrix(in.q, &in.p, M0);
        check(status, &M0, sizeof M0);
    }
    {
        rmin_real K0[4][4];
        memset(&K0, 0xA5, sizeof K0);
        const int status = rmin_stiffness_matrix(in.q, &in.p, K0);
        check(status, &K0, sizeof K0);
    }
    {
        rmin_real J_c[4];
        memset(&J_c, 0xA5, sizeof J_c);
        const int status = rmin_contact_jacobian(in.q, in.n, J_c);
        check(status, &J_c, sizeof J_c);
    }
    {
        rmin_real m_c;
        memset(&m_c, 0xA5, sizeof m_c);
        const int status = rmin_reflected_mass(in.q, in.n, &in.p, &m_c);
        check(status, &m_c, sizeof m_c);
    }
    {
        rmin_reduced_model_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = rmin_reduced_model(in.q, in.n, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        rmin_chain_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = rmin_chain(in.q, in.n, &in.p, &out);
        check(status, &out, sizeof out);
    }
    rmin_region region;
    if (rmin_body_region(size > 0 ? data[0] >> 4 : 0, size > 0 ? data[0] & 2 : 0, &region) != RMIN_OK) {
        return 0;
    }
    if (size > 0 && (data[0] & 4u) != 0u) {
        region.stiffness = in.region[0];
        region.damping = in.region[1];
        region.effective_mass = in.region[2];
        region.hertz_stiffness = in.region[3];
    }
    if (size > 1 && data[1] % 4u == 1u) {
        region.law_points = data[1] >> 4 & 7u; /* more than there are: refused, as points are no law */
        region.law = in.law;
        if ((data[1] & 128u) != 0u) {
            rise(in.law);
            region.law_points = 1 + region.law_points % LAW_POINTS;
        }
        region.law_points = region.law_points < LAW_POINTS ? region.law_points : LAW_POINTS;
    }
    {
        rmin_peak_force_t out;
        memset(&out, 0xA5, sizeof out);
        check(rmin_peak_force(in.q, in.n, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        rmin_safe_speed_t out;
        memset(&out, 0xA5, sizeof out);
        check(rmin_safe_speed(in.q, in.n, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        rmin_speed_factor_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = rmin_speed_factor(in.q, in.dq, in.number, &region, &in.p, &out);
        check(status, &out.factor, sizeof out.factor);
        check(status, &out.speed, sizeof out.speed);
        check(status, &out.force, sizeof out.force);
        if (status == RMIN_OK && !(out.factor >= 0 && out.factor <= 1 && out.point >= -1 && out.point < RMIN_POINTS)) {
            abort();
        }
    }
    if (size % 4u == 2u) { /* until 0.6 s */
        rmin_real force;
        memset(&force, 0xA5, sizeof force);
        check(rmin_pressing_force_at(in.q, 0, in.n, in.number, &region, &in.p, &force), &force, sizeof force);
    }
    if (size % 16u == 5u) { /* up to 15 times as long */
        rmin_allowed_speed_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = rmin_allowed_speed_at(in.q, 0, in.n, &region, &in.p, &out);
        check(status, &out.speed, sizeof out.speed);
        check(status, &out.force, sizeof out.force);
    }
    if (size % 64u == 7u) { /* a hundred impacts */
        rmin_worst_direction_t out;
        memset(&out, 0xA5, sizeof out);
        check(rmin_worst_direction_at(in.q, 0, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        rmin_real poses[2][6];
        rmin_selection_t out;
        for (int i = 0; i < 6; ++i) {
            poses[0][i] = in.q[i];
            poses[1][i] = in.q[i]; /* any other would open the loops */
        }
        memset(&out, 0xA5, sizeof out);
        const int status = rmin_select_configuration((const rmin_real (*)[6])poses, 2, NULL, in.n, in.number, &region, &in.p, &out);
        check(status, &out.force, sizeof out.force);
        check(status, &out.margin, sizeof out.margin);
        if (status == RMIN_OK && !(out.best >= 0 && out.best < 2 && out.usable > 0 && out.margin >= 0)) {
            abort();
        }
    }
    return 0;
}
