/* SPDX-License-Identifier: 0BSD */
/*
 * Feeds one function of rr, which the input chooses, numbers about those of a usual robot, or any bits. Whatever
 * is RR_OK or a bound must be finite, and within what the header promises; whatever is not must have written
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

#include "rr.h"

#define FUNCTIONS 9u /* without impacts */
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
static rr_real q[4];
static rr_real n[3];
static rr_params p;
static rr_real speed;
static rr_real restitution;
static rr_real other_mobility;
static rr_real dq[4];
static rr_real number; /* a speed or a limit */
static rr_region region;
static rr_law_point *law; /* NULL, or exactly its points */
static int point;
static int frame;
static rr_real place[3];

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
    return status == RR_OK || status == RR_BOUNDED;
}

/* Numbers are finite, or as they were. */
static void check(int status, const void *memory, size_t length)
{
    const unsigned char *const m = memory;
    told = mix(mix(told, &status, sizeof status), memory, length);
    for (size_t i = 0; i < length; i += sizeof(rr_real)) {
        rr_real x;
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
static rr_real strange(bool bits)
{
    static const rr_real numbers[16] = {0, -1, (rr_real)NAN, (rr_real)INFINITY, -(rr_real)INFINITY, (rr_real)FLT_MAX, -(rr_real)FLT_MAX, (rr_real)FLT_MIN,
        (rr_real)1e-45, (rr_real)FLT_EPSILON, 1, (rr_real)1e30, (rr_real)1e-30, (rr_real)1e15, (rr_real)1e-15, (rr_real)-1e-9};
    const unsigned int which = bits ? 0u : next(0);
    is_odd = true;
    rr_real x = numbers[which % 16u];
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
static rr_real part(bool *is_strange)
{
    const unsigned int high = any_bits ? 128u : next(128);
    const unsigned int low = any_bits ? 255u : next(0);
    *is_strange = low == 255u;
    return (rr_real)((int)(256u*high + low) - 32768)/32768;
}

/* About a number, up to 65,536 times more or less. */
static rr_real around(rr_real usual)
{
    bool is_strange;
    const rr_real x = part(&is_strange);
    return is_strange ? strange(any_bits) : usual*(rr_real)exp2(16*(double)x);
}

/* About a number, up to `most` more or less. */
static rr_real beside(rr_real usual, rr_real most)
{
    bool is_strange;
    const rr_real x = part(&is_strange);
    return is_strange ? strange(any_bits) : usual + most*x;
}

static void draw_params(void)
{
    const unsigned int drawn = next(0); /* fields; the others are the usual ones */
    const bool alike = (drawn & 128u) != 0u; /* all joints */
    rr_default_params(&p);
    const size_t at_rotor_inertia = at;
    for (int i = 0; i < 4; ++i) {
        rr_real *const x = &p.rotor_inertia[i];
        at = alike ? at_rotor_inertia : at;
        if ((drawn >> 0 & 1u) != 0u) {
            *x = around(*x > 0 ? *x : (rr_real)0.5);
        }
    }
    const size_t at_position_gain = at;
    for (int i = 0; i < 4; ++i) {
        rr_real *const x = &p.position_gain[i];
        at = alike ? at_position_gain : at;
        if ((drawn >> 1 & 1u) != 0u) {
            *x = around(*x > 0 ? *x : (rr_real)1000.0);
        }
    }
    const size_t at_damping_gain = at;
    for (int i = 0; i < 4; ++i) {
        rr_real *const x = &p.damping_gain[i];
        at = alike ? at_damping_gain : at;
        if ((drawn >> 2 & 1u) != 0u) {
            *x = around(*x > 0 ? *x : (rr_real)20.0);
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
    if (rr_body_region((int)(part_of_body & 15u), (int)(part_of_body & 16u), &region) != RR_OK) {
        rr_body_region(0, (int)(part_of_body & 16u), &region);
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
        rr_real depth = 0;
        rr_real force = 0;
        law = malloc((size_t)most*sizeof *law);
        holds(law != NULL);
        for (int i = 0; i < most; ++i) {
            law[i].depth = depth;
            law[i].force = force;
            depth += around((rr_real)4e-3);
            force += around(50);
            law[i].knee_depth = (points & 32u) == 0u ? (law[i].depth + depth)/2 : around((rr_real)2e-3);
            law[i].knee_force = (points & 64u) == 0u ? (law[i].force + force)/2 : around(25);
        }
        region.law = law;
        region.law_points = (points & 128u) == 0u ? most : (int)(points & 7u) - 8;
    }
}

static void draw(void)
{
    static const rr_real usual_q[4] = { -2.296875, 2.1826171875, 1.6572265625, -1.5390625 };
    static const rr_real usual_n[3] = { -0.03125, -0.21875, 0.625 };
    const unsigned int flags = next(0);
    const bool far = (flags & 8u) != 0u;
    any_bits = (flags & 7u) == 7u;
    is_odd = false;
    draw_params();
    draw_region();
    point = (flags & 192u) != 0u ? 0 : (int)(next(1) % (RR_POINTS + 2u)) - 1;
    number = around((flags & 32u) != 0u ? region.force_limit : 1);
    for (int i = 0; i < 3; ++i) {
        n[i] = beside(far ? 0 : usual_n[i], 1);
    }
    for (int i = 0; i < 4; ++i) {
        q[i] = beside(far ? 0 : usual_q[i], 4);
    }
    speed = around((rr_real)1.0);
    restitution = around((rr_real)0.25);
    other_mobility = around((rr_real)0.25);
    for (int i = 0; i < 4; ++i) {
        dq[i] = beside((rr_real)0.25, 4);
    }
    frame = (int)(next(1) % 8u) - 1;
    for (int i = 0; i < 3; ++i) {
        place[i] = beside(0, 1);
    }
}

static void call_function(unsigned int which)
{
    switch (which) {
    case 0u: {
        rr_real M[4][4];
        memset(&M, UNWRITTEN, sizeof M);
        const int status = rr_mass_matrix(q, M);
        check(status, &M, sizeof M);
        break;
    }
    case 1u: {
        rr_real J[3][4];
        memset(&J, UNWRITTEN, sizeof J);
        const int status = rr_jacobian(q, J);
        check(status, &J, sizeof J);
        break;
    }
    case 2u: {
        rr_real M0[4][4];
        memset(&M0, UNWRITTEN, sizeof M0);
        const int status = rr_generalised_mass_matrix(q, &p, M0);
        check(status, &M0, sizeof M0);
        break;
    }
    case 3u: {
        rr_real K0[4][4];
        memset(&K0, UNWRITTEN, sizeof K0);
        const int status = rr_stiffness_matrix(q, &p, K0);
        check(status, &K0, sizeof K0);
        break;
    }
    case 4u: {
        rr_real J_c[4];
        memset(&J_c, UNWRITTEN, sizeof J_c);
        const int status = rr_contact_jacobian(q, n, J_c);
        check(status, &J_c, sizeof J_c);
        break;
    }
    case 5u: {
        rr_real m_c;
        memset(&m_c, UNWRITTEN, sizeof m_c);
        const int status = rr_reflected_mass(q, n, &p, &m_c);
        check(status, &m_c, sizeof m_c);
        break;
    }
    case 6u: {
        rr_reduced_model_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = rr_reduced_model(q, n, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    case 7u: {
        rr_chain_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = rr_chain(q, n, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    default: {
        rr_joint_impulse_t out;
        memset(&out, UNWRITTEN, sizeof out);
        const int status = rr_joint_impulse(q, n, speed, restitution, other_mobility, &p, &out);
        check(status, &out, sizeof out);
        break;
    }
    }
}

static void call_peak_force(bool on)
{
    rr_peak_force_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = on ? rr_peak_force_on(q, frame, place, n, number, &region, &p, &out)
                          : rr_peak_force_at(q, point, n, number, &region, &p, &out);
    check(status, &out, sizeof out);
    holds(!is_written(status) || (out.force > 0 && out.time >= 0));
}

static void call_safe_speed(bool on)
{
    rr_safe_speed_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = on ? rr_safe_speed_on(q, frame, place, n, number, &region, &p, &out)
                          : rr_safe_speed_at(q, point, n, number, &region, &p, &out);
    check(status, &out, sizeof out);
    holds(!is_written(status) || (out.speed > 0 && out.force > 0 && out.force <= number));
    /* steps are fitted to another force than the limit: where that is far off, so may be what they find */
    const bool is_usual = law == NULL && !is_odd && out.speed < 20 && p.horizon > (rr_real)1e-3;
    if (status == RR_OK && is_usual && !on && rare(4)) {
        rr_peak_force_t peak;
        const int known = rr_peak_force_at(q, point, n, out.speed, &region, &p, &peak);
        holds(known != RR_OK || peak.force <= (rr_real)1.1*number);
    }
}

static void call_speed_factor(void)
{
    rr_speed_factor_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = rr_speed_factor(q, dq, number, &region, &p, &out);
    check(status, &out.factor, sizeof out.factor);
    check(status, &out.speed, sizeof out.speed);
    check(status, &out.force, sizeof out.force);
    check_int(status, out.point, -1, RR_POINTS - 1);
    holds(!is_written(status) || (out.factor >= 0 && out.factor <= 1 && out.force <= number));
}

static void call_speed_factor_over(void)
{
    const int entries = 1 + (int)(hash >> 8 & 1u);
    int *const points = malloc((size_t)entries*sizeof *points);
    rr_region *const regions = malloc((size_t)entries*sizeof *regions);
    rr_real *const limits = malloc((size_t)entries*sizeof *limits);
    holds(points != NULL && regions != NULL && limits != NULL);
    for (int i = 0; i < entries; ++i) {
        points[i] = i == 0 ? point : RR_POINTS - 1;
        regions[i] = region;
        limits[i] = i == 0 ? number : region.force_limit;
    }
    rr_speed_factor_over_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = rr_speed_factor_over(q, dq, points, regions, limits, entries, &p, &out);
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
    rr_real force;
    memset(&force, UNWRITTEN, sizeof force);
    const int status = rr_pressing_force_at(q, point, n, number, &region, &p, &force);
    check(status, &force, sizeof force);
    holds(!is_written(status) || force >= 0);
}

static void call_may_press(void)
{
    int may;
    memset(&may, UNWRITTEN, sizeof may);
    const int status = rr_may_press(q, dq, number, &region, &p, &may);
    told = mix(told, &status, sizeof status);
    check_int(status, may, 0, 1);
}

/* Up to 15 times as many steps. */
static void call_allowed_speed(void)
{
    rr_allowed_speed_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = rr_allowed_speed_at(q, point, n, &region, &p, &out);
    check(status, &out.speed, sizeof out.speed);
    check(status, &out.force, sizeof out.force);
    check_int(status, out.pressed, 0, 1);
    holds(!is_written(status) || (out.speed > 0 && out.force <= region.force_limit));
}

static void call_allowed_factor(void)
{
    rr_allowed_factor_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = rr_allowed_factor(q, dq, &region, &p, &out);
    check(status, &out.factor, sizeof out.factor);
    check(status, &out.speed, sizeof out.speed);
    check(status, &out.force, sizeof out.force);
    check_int(status, out.point, -1, RR_POINTS - 1);
    check_int(status, out.pressed, 0, 1);
    holds(!is_written(status) || (out.factor >= 0 && out.factor <= 1));
}

/* Some 300 impacts. */
static void call_worst_direction(bool on)
{
    rr_worst_direction_t out;
    memset(&out, UNWRITTEN, sizeof out);
    const int status = on ? rr_worst_direction_on(q, frame, place, number, &region, &p, &out)
                          : rr_worst_direction_at(q, point, number, &region, &p, &out);
    check(status, &out, sizeof out);
    holds(!is_written(status) || (out.force > 0 && out.error >= 0));
}

static void call_select_configuration(void)
{
    rr_real poses[2][4];
    const unsigned char allowed[2] = {(unsigned char)(hash >> 8 & 1u), (unsigned char)(hash >> 9 & 1u)};
    rr_selection_t out;
    for (int i = 0; i < 4; ++i) {
        poses[0][i] = q[i];
        poses[1][i] = -q[i];
    }
    memset(&out, UNWRITTEN, sizeof out);
    const int status = rr_select_configuration((const rr_real (*)[4])poses, 2, rare(4) ? allowed : NULL, n, number, &region, &p, &out);
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
