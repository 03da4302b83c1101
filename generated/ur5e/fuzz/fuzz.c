/* SPDX-License-Identifier: 0BSD */
/*
 * Feeds ur5e any bits, or any numbers of a plausible size: whatever is UR5E_OK or a bound must be
 * finite, whatever is not must have written nothing. For libFuzzer:
 * clang -fsanitize=fuzzer,address,undefined -Iinclude fuzz/fuzz.c src/<all>.c -lm
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "ur5e.h"

#define LAW_POINTS 4 /* at most, of a law by table */

/* Everything that functions read, as plain numbers. */
typedef struct {
    ur5e_real q[6];
    ur5e_real n[3];
    ur5e_params p;
    ur5e_real speed;
    ur5e_real restitution;
    ur5e_real other_mobility;
    ur5e_real duration;
    ur5e_real region[4];
    ur5e_real number;
    ur5e_real dq[6];
    ur5e_real place[3];
    ur5e_law_point law[LAW_POINTS];
} inputs;

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Stops the fuzzer unless memory holds finite numbers, or is as it was. */
static void check(int status, const void *memory, size_t size)
{
    const int written = status == UR5E_OK || status == UR5E_BOUNDED;
    for (size_t at = 0; at < size; at += sizeof(ur5e_real)) {
        ur5e_real x;
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
    for (size_t i = 0; i < sizeof *in/sizeof(ur5e_real); ++i) {
        const size_t at = 1 + 2*i;
        const int low = at < size ? data[at] : 1;
        const int high = at + 1 < size ? data[at + 1] : 144;
        const ur5e_real x = (ur5e_real)(256*high + low - 32768)/(ur5e_real)4096;
        const ur5e_real positive = x*x*x*x;
        memcpy((unsigned char *)in + i*sizeof x, i < 9 ? &x : &positive, sizeof x);
    }
}

/* Makes points a law: each number is what it rises by. */
static void rise(ur5e_law_point law[LAW_POINTS])
{
    ur5e_real depth = 0;
    ur5e_real force = 0;
    for (int i = 0; i < LAW_POINTS; ++i) {
        const ur5e_law_point by = law[i];
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
        in.p.layout = UR5E_LAYOUT; /* else all that read p refuse */
    }
    if (size % 64u != 62u && in.p.steps > 256) {
        in.p.steps = 1 + in.p.steps % 256; /* long ones take most of the time */
    }
    {
        ur5e_real M[6][6];
        memset(&M, 0xA5, sizeof M);
        const int status = ur5e_mass_matrix(in.q, M);
        check(status, &M, sizeof M);
    }
    {
        ur5e_real J[3][6];
        memset(&J, 0xA5, sizeof J);
        const int status = ur5e_jacobian(in.q, J);
        check(status, &J, sizeof J);
    }
    {
        ur5e_real M0[12][12];
        memset(&M0, 0xA5, sizeof M0);
        const int status = ur5e_generalised_mass_matrix(in.q, &in.p, M0);
        check(status, &M0, sizeof M0);
    }
    {
        ur5e_real K0[12][12];
        memset(&K0, 0xA5, sizeof K0);
        const int status = ur5e_stiffness_matrix(in.q, &in.p, K0);
        check(status, &K0, sizeof K0);
    }
    {
        ur5e_real J_c[12];
        memset(&J_c, 0xA5, sizeof J_c);
        const int status = ur5e_contact_jacobian(in.q, in.n, J_c);
        check(status, &J_c, sizeof J_c);
    }
    {
        ur5e_real m_c;
        memset(&m_c, 0xA5, sizeof m_c);
        const int status = ur5e_reflected_mass(in.q, in.n, &m_c);
        check(status, &m_c, sizeof m_c);
    }
    {
        ur5e_reduced_model_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_reduced_model(in.q, in.n, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_chain_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_chain(in.q, in.n, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_osim_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_osim(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_giaf_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_giaf(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_real giaf;
        memset(&giaf, 0xA5, sizeof giaf);
        const int status = ur5e_directional_giaf(in.q, in.n, &in.p, &giaf);
        check(status, &giaf, sizeof giaf);
    }
    {
        ur5e_absorption_extremes_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_absorption_extremes(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_manipulability_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_manipulability(in.q, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_real omega_f;
        memset(&omega_f, 0xA5, sizeof omega_f);
        const int status = ur5e_force_measure(in.q, &omega_f);
        check(status, &omega_f, sizeof omega_f);
    }
    {
        ur5e_impact_measure_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_impact_measure(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_rotor_influence_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_rotor_influence(in.q, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_real giaf[6];
        memset(&giaf, 0xA5, sizeof giaf);
        const int status = ur5e_single_joint_giaf(in.q, &in.p, giaf);
        check(status, &giaf, sizeof giaf);
    }
    {
        ur5e_joint_impulse_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_joint_impulse(in.q, in.n, in.speed, in.restitution, in.other_mobility, &in.p, &out);
        check(status, &out, sizeof out);
    }
    {
        ur5e_real error;
        memset(&error, 0xA5, sizeof error);
        const int status = ur5e_linear_error(in.q, in.n, in.speed, in.duration, &error);
        check(status, &error, sizeof error);
    }
    ur5e_region region;
    if (ur5e_body_region(size > 0 ? data[0] >> 4 : 0, size > 0 ? data[0] & 2 : 0, &region) != UR5E_OK) {
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
        ur5e_peak_force_t out;
        memset(&out, 0xA5, sizeof out);
        check(ur5e_peak_force(in.q, in.n, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        ur5e_safe_speed_t out;
        memset(&out, 0xA5, sizeof out);
        check(ur5e_safe_speed(in.q, in.n, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        ur5e_speed_factor_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_speed_factor(in.q, in.dq, in.number, &region, &in.p, &out);
        check(status, &out.factor, sizeof out.factor);
        check(status, &out.speed, sizeof out.speed);
        check(status, &out.force, sizeof out.force);
        if (status == UR5E_OK && !(out.factor >= 0 && out.factor <= 1 && out.point >= -1 && out.point < UR5E_POINTS)) {
            abort();
        }
    }
    if (size % 4u == 2u) { /* until 0.6 s */
        ur5e_real force;
        memset(&force, 0xA5, sizeof force);
        check(ur5e_pressing_force_at(in.q, 0, in.n, in.number, &region, &in.p, &force), &force, sizeof force);
    }
    if (size % 16u == 5u) { /* up to 15 times as long */
        ur5e_allowed_speed_t out;
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_allowed_speed_at(in.q, 0, in.n, &region, &in.p, &out);
        check(status, &out.speed, sizeof out.speed);
        check(status, &out.force, sizeof out.force);
    }
    if (size % 64u == 7u) { /* a hundred impacts */
        ur5e_worst_direction_t out;
        memset(&out, 0xA5, sizeof out);
        check(ur5e_worst_direction_at(in.q, 0, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    if (size % 4u == 1u) {
        ur5e_safe_speed_t out;
        const int frame = size > 2 ? data[2] % 9 - 1 : 0;
        memset(&out, 0xA5, sizeof out);
        check(ur5e_safe_speed_on(in.q, frame, in.place, in.n, in.number, &region, &in.p, &out), &out, sizeof out);
    }
    {
        ur5e_real poses[2][6];
        ur5e_selection_t out;
        for (int i = 0; i < 6; ++i) {
            poses[0][i] = in.q[i];
            poses[1][i] = -in.q[i];
        }
        memset(&out, 0xA5, sizeof out);
        const int status = ur5e_select_configuration((const ur5e_real (*)[6])poses, 2, NULL, in.n, in.number, &region, &in.p, &out);
        check(status, &out.force, sizeof out.force);
        check(status, &out.margin, sizeof out.margin);
        if (status == UR5E_OK && !(out.best >= 0 && out.best < 2 && out.usable > 0 && out.margin >= 0)) {
            abort();
        }
    }
    return 0;
}
