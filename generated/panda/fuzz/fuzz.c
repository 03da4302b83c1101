/* SPDX-License-Identifier: 0BSD */
/*
 * Feeds panda any bits, or any numbers of a plausible size: whatever is PANDA_OK or a bound must be
 * finite, whatever is not must have written nothing. For libFuzzer:
 * clang -fsanitize=fuzzer,address,undefined -Iinclude fuzz/fuzz.c src/<all>.c -lm
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "panda.h"

#define LAW_POINTS 4 /* at most, of a law by table */

/* Everything that functions read, as plain numbers. */
typedef struct {
    panda_real q[7];
    panda_real n[3];
    panda_params p;
    panda_real speed;
    panda_real restitution;
    panda_real other_mobility;
    panda_real duration;
    panda_real region[4];
    panda_real number;
    panda_real dq[7];
    panda_real place[3];
    panda_law_point law[LAW_POINTS];
} inputs;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Stops the fuzzer unless memory holds finite numbers, or is as it was. */
static void check(int status, const void *memory, size_t size)
{
    const int written = status == PANDA_OK || status == PANDA_BOUNDED;
    for (size_t at = 0; at < size; at += sizeof(panda_real)) {
        panda_real x;
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
    for (size_t i = 0; i < sizeof *in/sizeof(panda_real); ++i) {
        const size_t at = 1 + 2*i;
        const int low = at < size ? data[at] : 1;
        const int high = at + 1 < size ? data[at + 1] : 144;
        const panda_real x = (panda_real)(256*high + low - 32768)/(panda_real)4096;
        const panda_real positive = x*x*x*x;
        memcpy((unsigned char *)in + i*sizeof x, i < 10 ? &x : &positive, sizeof x);
    }
}

/* Makes points a law: each number is what it rises by. */
static void rise(panda_law_point law[LAW_POINTS])
{
    panda_real depth = 0;
    panda_real force = 0;
    for (int i = 0; i < LAW_POINTS; ++i) {
        const panda_law_point by = law[i];
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
        in.p.layout = PANDA_LAYOUT; /* else all that read p refuse */
    }
    if (size % 64u != 62u && in.p.steps > 256) {
        in.p.steps = 1 + in.p.steps % 256; /* long ones take most of the time */
    }
    {
        panda_real M[7][7];
        memset(&M, 0xA5, sizeof M);
        const int status = panda_mass_matrix(in.q, M);
        check(status, &M, sizeof M);
    }
    {
        panda_real J[3][7];
        memset(&J, 0xA5, sizeof J);
        const int status = panda_jacobian(in.q, J);
        check(status, &J, sizeof J);
    }
    {
        panda_real M0[14][14];
        memset(&M0, 0xA5, sizeof M0);
        const int status = panda_generalised_mass_matrix(in.q, &in.p, M0);
        check(status, &M0, sizeof M0);
    }
    {
        panda_real K0[14][14];
        memset(&K0, 0xA5, sizeof K0);
        const int status = panda_stiffness_matrix(in.q, &in.p, K0);
        check(status, &K0, sizeof K0);
    }
    {
        panda_real J_c[14];
        memset(&J_c, 0xA5, sizeof J_c);
        const int status = panda_contact_jacobian(in.q, in.n, J_c);
        check(status, &J_c, sizeof J_c);
    }
    {
        panda_real m_c;
        memset(&m_c, 0xA5, sizeof m_c);
        const int status = panda_reflected_mass(in.q, in.n, &m_c);
        check(status, &m_c, sizeof m_c);
    }
    {
        panda_reduced_model_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_reduced_model(in.q, in.n, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_chain_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_chain(in.q, in.n, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_osim_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_osim(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_giaf_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_giaf(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_real giaf;
        memset(&giaf, 0xA5, sizeof giaf);
        const int status = panda_directional_giaf(in.q, in.n, &in.p, &giaf);
        check(status, &giaf, sizeof giaf);
    }
    {
        panda_absorption_extremes_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_absorption_extremes(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_manipulability_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_manipulability(in.q, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_real omega_f;
        memset(&omega_f, 0xA5, sizeof omega_f);
        const int status = panda_force_measure(in.q, &omega_f);
        check(status, &omega_f, sizeof omega_f);
    }
    {
        panda_impact_measure_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_impact_measure(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_rotor_influence_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_rotor_influence(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_real giaf[7];
        memset(&giaf, 0xA5, sizeof giaf);
        const int status = panda_single_joint_giaf(in.q, &in.p, giaf);
        check(status, &giaf, sizeof giaf);
    }
    {
        panda_joint_impulse_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        panda_real error;
        memset(&error, 0xA5, sizeof error);
        const int status = panda_linear_error(in.q, in.n, in.speed, in.duration, &error);
        check(status, &error, sizeof error);
    }
    panda_region region;
    if (panda_body_region(size > 0 ? data[0] >> 4 : 0, size > 0 ? data[0] & 2 : 0, &region) != PANDA_OK) {
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
        panda_peak_force_t out;
        memset(&out, 0xA5, sizeof out);
        check(panda_peak_force(in.q, in.n, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        panda_safe_speed_t out;
        memset(&out, 0xA5, sizeof out);
        check(panda_safe_speed(in.q, in.n, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        panda_speed_factor_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_speed_factor(in.q, in.dq, in.number, &region, &in.p, &out);
        check(status, &out.factor, sizeof out.factor);
        check(status, &out.speed, sizeof out.speed);
        check(status, &out.force, sizeof out.force);
        if (status == PANDA_OK && !(out.factor >= 0 && out.factor <= 1 && out.point >= -1 && out.point < PANDA_POINTS)) {
            abort();
        }
    }
    if (size % 4u == 2u) { /* until 0.6 s */
        panda_real force;
        memset(&force, 0xA5, sizeof force);
        check(panda_pressing_force_at(in.q, 0, in.n, in.number, &region, &in.p, &force), &force, sizeof force);
    }
    if (size % 16u == 5u) { /* up to 15 times as long */
        panda_allowed_speed_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = panda_allowed_speed_at(in.q, 0, in.n, &region, &in.p, &out);
        check(status, &out.speed, sizeof out.speed);
        check(status, &out.force, sizeof out.force);
    }
    if (size % 64u == 7u) { /* a hundred impacts */
        panda_worst_direction_t out;
        memset(&out, 0xA5, sizeof out);
        check(panda_worst_direction_at(in.q, 0, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    if (size % 4u == 1u) {
        panda_safe_speed_t out;
        const int frame = size > 2 ? data[2] % 14 - 1 : 0;
        memset(&out, 0xA5, sizeof out);
        check(panda_safe_speed_on(in.q, frame, in.place, in.n, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        panda_real poses[2][7];
        panda_selection_t out;
        for (int i = 0; i < 7; ++i) {
            poses[0][i] = in.q[i];
            poses[1][i] = -in.q[i];
        }
        memset(&out, 0xA5, sizeof out);
        const int status = panda_select_configuration((const panda_real (*)[7])poses, 2, NULL, in.n, in.number, &region, &in.p, &out);
        check(status, &out.force, sizeof out.force);
        check(status, &out.margin, sizeof out.margin);
        if (status == PANDA_OK && !(out.best >= 0 && out.best < 2 && out.usable > 0 && out.margin >= 0)) {
            abort();
        }
    }
    return 0;
}
