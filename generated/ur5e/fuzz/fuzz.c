/* SPDX-License-Identifier: 0BSD */
/*
 * Feeds one function of ur5e, which the input chooses, numbers about those of a usual robot, or any bits. Whatever
 * is UR5E_OK or a bound must be finite, and within what the header promises; whatever is not must have written
 * nothing; a second call must say the same. For libFuzzer, to which comparisons tell nothing here:
 * clang -fsanitize=fuzzer,address,undefined -fno-sanitize-coverage=trace-cmp -Iinclude fuzz/fuzz.c src/<all>.c -lm
 */
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "ur5e.h"

#define FUNCTIONS 19u /* without impacts */
#define UNWRITTEN 0xA5 /* each byte of outputs before a call */
#define STALE 0xFF /* each byte of the stack before a second call: no number */
#define DEEP 65536u /* bytes of it */
#define LAW_POINTS 4 /* at most, of a law by table */

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

/* The input, and its hash: what takes long is left to some inputs that no mutation can make more frequent. */
static const uint8_t *data;
static size_t size;
static size_t at;
static uint32_t hash;

static bool any_bits; /* numbers are the input's own bits */
static bool is_odd; /* some number is one that is seldom thought of */

/* Everything that functions read; each by itself, so that what is read beside it is noticed. */
static ur5e_real q[6];
static ur5e_real n[3];
static ur5e_params p;
static ur5e_real speed;
static ur5e_real restitution;
static ur5e_real other_mobility;
static ur5e_real duration;
static ur5e_real dq[6];
static ur5e_real number; /* a speed or a limit */
static ur5e_region region;
static ur5e_law_point *law; /* NULL, or exactly its points */
static int point;
static int frame;
static ur5e_real place[3];

static uint32_t told; /* hash of all that was answered */

static bool rare(uint32_t one_in)
{
    return hash % one_in == 0u;
}

static uint32_t mix(uint32_t h, const void *memory, size_t length)
{
    const unsigned char *const m = memory;
    for (size_t i = 0; i < length; ++i) {
        h = (h ^ m[i])*16777619u;
    }
    return h;
}

static void holds(bool promise)
{
    if (!promise) {
        abort();
    }
}

static bool is_written(int status)
{
    return status == UR5E_OK || status == UR5E_BOUNDED;
}

/* Numbers are finite, or as they were. */
static void check(int status, const void *memory, size_t length)
{
    const unsigned char *const m = memory;
    told = mix(mix(told, &status, sizeof status), memory, length);
    for (size_t i = 0; i < length; i += sizeof(ur5e_real)) {
        ur5e_real x;
        unsigned char untouched[sizeof x];
        memset(untouched, UNWRITTEN, sizeof untouched);
        memcpy(&x, m + i, sizeof x);
        holds(is_written(status) ? isfinite(x) : memcmp(&x, untouched, sizeof x) == 0);
    }
}

/* A whole number is from low to high, or as it was. */
static void check_int(int status, int x, int low, int high)
{
    int untouched;
    memset(&untouched, UNWRITTEN, sizeof untouched);
    told = mix(told, &x, sizeof x);
    holds(is_written(status) ? x >= low && x <= high : x == untouched);
}

/* The next byte, or what stands for one after the last. */
static unsigned int next(unsigned int otherwise)
{
    const unsigned int byte = at < size ? data[at] : otherwise;
    ++at;
    return byte;
}

/* Any bits, or a number that is seldom thought of. */
static ur5e_real strange(bool bits)
{
    static const ur5e_real numbers[16] = {0, -1, (ur5e_real)NAN, (ur5e_real)INFINITY, -(ur5e_real)INFINITY, (ur5e_real)FLT_MAX, -(ur5e_real)FLT_MAX, (ur5e_real)FLT_MIN,
        (ur5e_real)1e-45, (ur5e_real)FLT_EPSILON, 1, (ur5e_real)1e30, (ur5e_real)1e-30, (ur5e_real)1e15, (ur5e_real)1e-15, (ur5e_real)-1e-9};
    const unsigned int which = bits ? 0u : next(0);
    is_odd = true;
    ur5e_real x = numbers[which % 16u];
    if (bits || which >= 128u) {
        unsigned char raw[sizeof x] = {0};
        for (size_t i = 0; i < sizeof raw; ++i) {
            raw[i] = (unsigned char)next(0);
        }
        memcpy(&x, raw, sizeof x);
    }
    return x;
}

/* From -1 to 1, which is 0 after the input's end. */
static ur5e_real part(bool *is_strange)
{
    const unsigned int high = any_bits ? 128u : next(128);
    const unsigned int low = any_bits ? 255u : next(0);
    *is_strange = low == 255u;
    return (ur5e_real)((int)(256u*high + low) - 32768)/32768;
}

/* About a number, up to 65,536 times more or less. */
static ur5e_real around(ur5e_real usual)
{
    bool is_strange;
    const ur5e_real x = part(&is_strange);
    return is_strange ? strange(any_bits) : usual*(ur5e_real)exp2(16*(double)x);
}

/* About a number, up to `most` more or less. */
static ur5e_real beside(ur5e_real usual, ur5e_real most)
{
    bool is_strange;
    const ur5e_real x = part(&is_strange);
    return is_strange ? strange(any_bits) : usual + most*x;
}

static void draw_params(void)
{
    const unsigned int drawn = next(0); /* fields; the others are the usual ones */
    const bool alike = (drawn & 128u) != 0u; /* all joints */
    ur5e_default_params(&p);
    for (int i = 0; i < 6; ++i) {
        ur5e_real *const x = &p.joint_stiffness[i];
        *x = *x > 0 ? *x : (ur5e_real)10000.0; /* else functions would refuse it */
    }
    for (int i = 0; i < 6; ++i) {
        ur5e_real *const x = &p.rotor_inertia[i];
        *x = *x > 0 ? *x : (ur5e_real)0.5; /* else functions would refuse it */
    }
    const size_t at_joint_stiffness = at;
    for (int i = 0; i < 6; ++i) {
        ur5e_real *const x = &p.joint_stiffness[i];
        at = alike ? at_joint_stiffness : at;
        if ((drawn >> 0 & 1u) != 0u) {
            *x = around(*x > 0 ? *x : (ur5e_real)10000.0);
        }
    }
    const size_t at_rotor_inertia = at;
    for (int i = 0; i < 6; ++i) {
        ur5e_real *const x = &p.rotor_inertia[i];
        at = alike ? at_rotor_inertia : at;
        if ((drawn >> 1 & 1u) != 0u) {
            *x = around(*x > 0 ? *x : (ur5e_real)0.5);
        }
    }
    const size_t at_position_gain = at;
    for (int i = 0; i < 6; ++i) {
        ur5e_real *const x = &p.position_gain[i];
        at = alike ? at_position_gain : at;
        if ((drawn >> 2 & 1u) != 0u) {
            *x = around(*x > 0 ? *x : (ur5e_real)1000.0);
        }
    }
    const size_t at_damping_gain = at;
    for (int i = 0; i < 6; ++i) {
        ur5e_real *const x = &p.damping_gain[i];
        at = alike ? at_damping_gain : at;
        if ((drawn >> 3 & 1u) != 0u) {
            *x = around(*x > 0 ? *x : (ur5e_real)20.0);
        }
    }
    const unsigned int motors = next(0);
    const unsigned int steps = next(0);
    p.motors = motors < 224u ? (int)(motors % 4u) : (int)motors - 228;
    if (steps > 0u) {
        p.steps = (int)steps; /* hardly any input needs the usual 800, which take long */
    }
    if (steps > 192u) {
        static const int numbers[8] = {0, -1, INT_MIN, INT_MAX, 1000001, 2000, 1200, 400};
        p.steps = rare(16) ? numbers[steps % 8u] : 1 + (int)(steps % 16u);
    }
    if ((drawn & 64u) != 0u) {
        p.reaction_time = around(p.reaction_time);
        p.horizon = around(p.horizon);
    }
    if (next(0) == 255u) {
        p.layout ^= 1u + next(0);
    }
}

static void draw_region(void)
{
    const unsigned int part_of_body = next(4);
    const unsigned int drawn = next(0);
    const unsigned int points = next(0);
    if (ur5e_body_region((int)(part_of_body & 15u), (int)(part_of_body & 16u), &region) != UR5E_OK) {
        ur5e_body_region(0, (int)(part_of_body & 16u), &region);
    }
    if ((drawn & 1u) != 0u) {
        region.stiffness = around(region.stiffness);
        region.damping = around(region.damping);
        region.effective_mass = around(region.effective_mass);
        region.hertz_stiffness = around(region.hertz_stiffness);
    }
    if ((drawn & 2u) != 0u) {
        region.quasi_static_limit = around(region.quasi_static_limit);
        region.force_limit = around(region.force_limit);
    }
    if ((drawn & 12u) == 4u) {
        const int most = 1 + (int)(points % LAW_POINTS);
        ur5e_real depth = 0;
        ur5e_real force = 0;
        law = malloc((size_t)most*sizeof *law);
        holds(law != NULL);
        for (int i = 0; i < most; ++i) {
            law[i].depth = depth;
            law[i].force = force;
            depth += around((ur5e_real)4e-3);
            force += around(50);
            law[i].knee_depth = (points & 32u) == 0u ? (law[i].depth + depth)/2 : around((ur5e_real)2e-3);
            law[i].knee_force = (points & 64u) == 0u ? (law[i].force + force)/2 : around(25);
        }
        region.law = law;
        region.law_points = (points & 128u) == 0u ? most : (int)(points & 7u) - 8;
    }
}

static void draw(void)
{
    static const ur5e_real usual_q[6] = { -4.5947265625, 4.365234375, 1.6572265625, -3.078125, -0.0576171875, -0.634765625 };
    static const ur5e_real usual_n[3] = { 0.625, 1.15625, -1.625 };
    const unsigned int flags = next(0);
    const bool far = (flags & 8u) != 0u;
    any_bits = (flags & 7u) == 7u;
    is_odd = false;
    draw_params();
    draw_region();
    point = (flags & 192u) != 0u ? 0 : (int)(next(1) % (UR5E_POINTS + 2u)) - 1;
    number = around((flags & 32u) != 0u ? region.force_limit : 1);
    for (int i = 0; i < 3; ++i) {
        n[i] = beside(far ? 0 : usual_n[i], 1);
    }
    for (int i = 0; i < 6; ++i) {
        q[i] = beside(far ? 0 : usual_q[i], 4);
    }
    speed = around((ur5e_real)1.0);
    restitution = around((ur5e_real)0.25);
    other_mobility = around((ur5e_real)0.25);
    duration = around((ur5e_real)0.02);
    for (int i = 0; i < 6; ++i) {
        dq[i] = beside((ur5e_real)0.25, 4);
    }
    frame = (int)(next(1) % 9u) - 1;
    for (int i = 0; i < 3; ++i) {
        place[i] = beside(0, 1);
    }
}

static void call_function(unsigned int which)
{
    switch (which) {
    case 0u: {
        ur5e_real M[6][6];
        memset(&M, UNWRITTEN, sizeof M);
        const int status = ur5e_mass_matrix(q, M);
        check(status, &M, sizeof M);
        break;
    }
    case 1u: {
        ur5e_real J[3][6];
        memset(&J, UNWRITTEN, sizeof J);
        const int status = ur5e_jacobian(q, J);
        check(status, &J, sizeof J);
        break;
    }
    case 2u: {
        ur5e_real M0[12][12];
        memset(&M0, UNWRITTEN, sizeof M0);
        const int status = ur5e_generalised_mass_matrix(q, &p, M0);
        check(status, &M0, sizeof M0);
        break;
    }
    case 3u: {
        ur5e_real K0[12][12];
        memset(&K0, UNWRITTEN, sizeof K0);
        const int status = ur5e_stiffness_matrix(q, &p, K0);
        check(status, &K0, sizeof K0);
        break;
    }
    case 4u: {
        ur5e_real J_c[12];
        memset(&J_c, UNWRITTEN, sizeof J_c);
        const int status = ur5e_contact_jacobian(q, n, J_c);
        check(status, &J_c, sizeof J_c);
        break;
    }
    case 5u: {
        ur5e_real m_c;
        memset(&m_c, UNWRITTEN, sizeof m_c);
        const int status = ur5e_reflected_mass(q, n, &m_c);
        check(status, &m_c, sizeof m_c);
        break;
    }
    case 6u: {
        ur5e_reduced_model_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_reduced_model(q, n, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 7u: {
        ur5e_chain_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_chain(q, n, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 8u: {
        ur5e_osim_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_osim(q, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 9u: {
        ur5e_giaf_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_giaf(q, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 10u: {
        ur5e_real giaf;
        memset(&giaf, UNWRITTEN, sizeof giaf);
        const int status = ur5e_directional_giaf(q, n, &p, &giaf);
        check(status, &giaf, sizeof giaf);
        break;
    }
    case 11u: {
        ur5e_absorption_extremes_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_absorption_extremes(q, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 12u: {
        ur5e_manipulability_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_manipulability(q, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 13u: {
        ur5e_real omega_f;
        memset(&omega_f, UNWRITTEN, sizeof omega_f);
        const int status = ur5e_force_measure(q, &omega_f);
        check(status, &omega_f, sizeof omega_f);
        break;
    }
    case 14u: {
        ur5e_impact_measure_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_impact_measure(q, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 15u: {
        ur5e_rotor_influence_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_rotor_influence(q, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 16u: {
        ur5e_real giaf[6];
        memset(&giaf, UNWRITTEN, sizeof giaf);
        const int status = ur5e_single_joint_giaf(q, &p, giaf);
        check(status, &giaf, sizeof giaf);
        break;
    }
    case 17u: {
        ur5e_joint_impulse_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = ur5e_joint_impulse(q, n, speed, restitution, other_mobility, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    default: {
        ur5e_real error;
        memset(&error, UNWRITTEN, sizeof error);
        const int status = ur5e_linear_error(q, n, speed, duration, &error);
        check(status, &error, sizeof error);
        break;
    }
    }
}

static void call_peak_force(bool on)
{
    ur5e_peak_force_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = on ? ur5e_peak_force_on(q, frame, place, n, number, &region, &p, &out)
                          : ur5e_peak_force_at(q, point, n, number, &region, &p, &out);
    check(status, &out, sizeof out);
    holds(!is_written(status) || (out.force > 0 && out.time >= 0));
}

static void call_safe_speed(bool on)
{
    ur5e_safe_speed_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = on ? ur5e_safe_speed_on(q, frame, place, n, number, &region, &p, &out)
                          : ur5e_safe_speed_at(q, point, n, number, &region, &p, &out);
    check(status, &out, sizeof out);
    holds(!is_written(status) || (out.speed > 0 && out.force > 0 && out.force <= number));
    /* steps are fitted to another force than the limit: where that is far off, so may be what they find */
    const bool is_usual = law == NULL && !is_odd && out.speed < 20 && p.horizon > (ur5e_real)1e-3;
    if (status == UR5E_OK && is_usual && !on && rare(4)) {
        ur5e_peak_force_t peak;
        const int known = ur5e_peak_force_at(q, point, n, out.speed, &region, &p, &peak);
        holds(known != UR5E_OK || peak.force <= (ur5e_real)1.1*number);
    }
}

static void call_speed_factor(void)
{
    ur5e_speed_factor_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = ur5e_speed_factor(q, dq, number, &region, &p, &out);
    check(status, &out.factor, sizeof out.factor);
    check(status, &out.speed, sizeof out.speed);
    check(status, &out.force, sizeof out.force);
    check_int(status, out.point, -1, UR5E_POINTS - 1);
    holds(!is_written(status) || (out.factor >= 0 && out.factor <= 1 && out.force <= number));
}

static void call_speed_factor_over(void)
{
    const int entries = 1 + (int)(hash >> 8 & 1u);
    int *const points = malloc((size_t)entries*sizeof *points);
    ur5e_region *const regions = malloc((size_t)entries*sizeof *regions);
    ur5e_real *const limits = malloc((size_t)entries*sizeof *limits);
    holds(points != NULL && regions != NULL && limits != NULL);
    for (int i = 0; i < entries; ++i) {
        points[i] = i == 0 ? point : UR5E_POINTS - 1;
        regions[i] = region;
        limits[i] = i == 0 ? number : region.force_limit;
    }
    ur5e_speed_factor_over_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = ur5e_speed_factor_over(q, dq, points, regions, limits, entries, &p, &out);
    check(status, &out.factor, sizeof out.factor);
    check(status, &out.speed, sizeof out.speed);
    check(status, &out.force, sizeof out.force);
    check_int(status, out.entry, -1, entries - 1);
    holds(!is_written(status) || (out.factor >= 0 && out.factor <= 1));
    free(points);
    free(regions);
    free(limits);
}

/* What presses is followed to 0.62 s. */
static void call_pressing_force(void)
{
    ur5e_real force;
    memset(&force, UNWRITTEN, sizeof force);
    const int status = ur5e_pressing_force_at(q, point, n, number, &region, &p, &force);
    check(status, &force, sizeof force);
    holds(!is_written(status) || force >= 0);
}

static void call_may_press(void)
{
    int may;
    memset(&may, UNWRITTEN, sizeof may);
    const int status = ur5e_may_press(q, dq, number, &region, &p, &may);
    told = mix(told, &status, sizeof status);
    check_int(status, may, 0, 1);
}

/* Up to 15 times as many steps. */
static void call_allowed_speed(void)
{
    ur5e_allowed_speed_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = ur5e_allowed_speed_at(q, point, n, &region, &p, &out);
    check(status, &out.speed, sizeof out.speed);
    check(status, &out.force, sizeof out.force);
    check_int(status, out.pressed, 0, 1);
    holds(!is_written(status) || (out.speed > 0 && out.force <= region.force_limit));
}

static void call_allowed_factor(void)
{
    ur5e_allowed_factor_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = ur5e_allowed_factor(q, dq, &region, &p, &out);
    check(status, &out.factor, sizeof out.factor);
    check(status, &out.speed, sizeof out.speed);
    check(status, &out.force, sizeof out.force);
    check_int(status, out.point, -1, UR5E_POINTS - 1);
    check_int(status, out.pressed, 0, 1);
    holds(!is_written(status) || (out.factor >= 0 && out.factor <= 1));
}

/* Some 300 impacts. */
static void call_worst_direction(bool on)
{
    ur5e_worst_direction_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = on ? ur5e_worst_direction_on(q, frame, place, number, &region, &p, &out)
                          : ur5e_worst_direction_at(q, point, number, &region, &p, &out);
    check(status, &out, sizeof out);
    holds(!is_written(status) || (out.force > 0 && out.error >= 0));
}

static void call_select_configuration(void)
{
    ur5e_real poses[2][6];
    const unsigned char allowed[2] = {(unsigned char)(hash >> 8 & 1u), (unsigned char)(hash >> 9 & 1u)};
    ur5e_selection_t out;
    for (int i = 0; i < 6; ++i) {
        poses[0][i] = q[i];
        poses[1][i] = -q[i];
    }
    memset(&out, UNWRITTEN, sizeof out);
    const int status = ur5e_select_configuration((const ur5e_real (*)[6])poses, 2, rare(4) ? allowed : NULL, n, number, &region, &p, &out);
    check(status, &out.force, sizeof out.force);
    check(status, &out.margin, sizeof out.margin);
    check_int(status, out.best, 0, 1);
    check_int(status, out.second, -1, 1);
    check_int(status, out.usable, 1, 2);
    holds(!is_written(status) || (out.force > 0 && out.margin >= 0));
}

/* What takes long is asked of few inputs, the others in its place what it is made of. */
static void call_impact(unsigned int which)
{
    const bool on = which % 2u != 0u;
    switch (which/2u % 12u) {
    case 0:
        call_select_configuration();
        break;
    case 1:
        call_speed_factor_over();
        break;
    case 2:
        call_pressing_force();
        break;
    case 3:
        call_may_press();
        break;
    case 4:
    case 5:
        call_speed_factor();
        break;
    case 6:
        if (rare(64)) {
            call_worst_direction(on);
            break;
        }
        call_peak_force(on);
        break;
    case 7:
        if (rare(8)) {
            if (on) {
                call_allowed_speed();
            } else {
                call_allowed_factor();
            }
            break;
        }
        call_safe_speed(on);
        break;
    case 8:
    case 9:
        call_peak_force(on);
        break;
    default:
        call_safe_speed(on);
        break;
    }
}

static void call(unsigned int which)
{
    told = 2166136261u;
    if (which >= 64u) {
        call_impact(which - 64u);
        return;
    }
    call_function(which % FUNCTIONS);
}

/* Leaves no numbers where the next call's variables will be. */
static void soil(void)
{
    volatile unsigned char below[DEEP];
    for (size_t i = 0; i < sizeof below; ++i) {
        below[i] = STALE;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    data = bytes;
    size = count;
    at = 0;
    hash = mix(2166136261u, bytes, count);
    hash ^= hash >> 15;
    const unsigned int which = next(0);
    draw();
    call(which);
    if ((hash >> 16) % 8u == 0u) {
        const uint32_t first = told;
        soil();
        call(which);
        holds(told == first);
    }
    free(law);
    law = NULL;
    return 0;
}
