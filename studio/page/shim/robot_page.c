/* SPDX-License-Identifier: BSD-3-Clause */
/* What a page asks of robot_'s package: where things are, what stands for the robot, what happens. */
#include "robot_page_steps.h"

/* Until when it is followed what still presses on a clamped body, s: as simulate has it. */
#define PRESSED_UNTIL ROBOT_R(0.6)
/* Steps in which an impact is followed to its end: p->steps are for what ends once it is decided. */
#define FOLLOWED 20000
/* Speed of a contact point that counts as rest, m/s. */
#define AT_REST ROBOT_R(1e-6)

int robot_scene(const robot_real q[ROBOT_JOINTS], int body, const robot_real place[3], robot_scene_t *out)
{
    robot_end_t end;
    int status = robot_joint_frames(q, out->poses);
    if (status == ROBOT_OK) {
        status = robot_end(q, &end);
    }
    if (status != ROBOT_OK || body < 0 || body >= ROBOT_JOINTS) {
        return status == ROBOT_OK ? ROBOT_OUT_OF_RANGE : status;
    }
    const robot_real *const pose = out->poses[body];
    for (int k = 0; k < 3; ++k) {
        out->contact[k] = pose[9 + k] + pose[3*k]*place[0] + pose[3*k + 1]*place[1]
            + pose[3*k + 2]*place[2];
        out->end[k] = end.position[k];
    }
    return ROBOT_OK;
}

int robot_masses(const robot_real q[ROBOT_JOINTS], const robot_real n[3], const robot_params *p,
    robot_masses_t *out)
{
    static const robot_masses_t none;
    *out = none;
    out->mass_status = robot_reflected_mass(q, n, p, &out->m_c);
    out->reduced_status = ROBOT_SINGULAR;
    out->giaf_status = ROBOT_SINGULAR;
    out->directional_status = ROBOT_SINGULAR;
#if ROBOT_HAS_REDUCED_MODEL
    robot_reduced_model_t reduced;
    out->reduced_status = robot_reduced_model(q, n, p, &reduced);
    if (out->reduced_status == ROBOT_OK) {
        out->k_r = reduced.k_r;
        out->m_a = reduced.m_a;
    }
#endif
#if ROBOT_HAS_GIAF
    robot_giaf_t giaf;
    out->giaf_status = robot_giaf(q, p, &giaf);
    if (out->giaf_status == ROBOT_OK) {
        out->giaf = giaf.giaf;
    }
    out->directional_status = robot_directional_giaf(q, n, p, &out->directional_giaf);
#endif
    return ROBOT_OK;
}

/* The robot at first touch, with motors of one kind, for forces about as large as at a speed. */
static int prepare(const robot_real *q, const robot_real *n, robot_real speed, const robot_region *region,
    const robot_params *p, int motors, robot_impact *impact)
{
    const int status = robot_approach(q, ROBOT_POINT_TIP, n, region, p, impact);
    return status == ROBOT_OK ? robot_impact_prepare(region, p, motors, -speed, impact) : status;
}

/* The force that presses on a clamped body from half a second on; infinite where nobody knows. */
static robot_real pressing_at(const robot_real *q, const robot_real *n, robot_real speed,
    const robot_region *region, const robot_params *p, int motors)
{
    robot_impact impact;
    robot_peak peak;
    robot_params longer = *p;
    longer.horizon = PRESSED_UNTIL;
    if (region->clamped == 0) {
        return ROBOT_R(0.0);
    }
    return prepare(q, n, speed, region, &longer, motors, &impact) == ROBOT_OK
        ? robot_run_seen(&impact, speed, FOLLOWED, &peak, NULL) : ROBOT_REAL_MAX;
}

int robot_follow(const robot_real q[ROBOT_JOINTS], const robot_real n[3], robot_real speed,
    const robot_region *region, const robot_params *p, robot_follow_t *out)
{
    robot_impact impact;
    robot_peak peak;
    robot_peak_force_t found;
    const int status = robot_peak_force(q, n, speed, region, p, &found);
    if (status != ROBOT_OK && status != ROBOT_BOUNDED) {
        return status;
    }
    const int prepared = prepare(q, n, speed, region, p, p->motors, &impact);
    if (prepared != ROBOT_OK) {
        return prepared;
    }
    out->count = 0;
    (void)robot_run_seen(&impact, speed, FOLLOWED, &peak, out);
    out->force = found.force;
    out->peak_time = found.time;
    out->contact = peak.contact;
    out->pressing = pressing_at(q, n, speed, region, p, p->motors);
    for (int i = 0; i < ROBOT_JOINTS; ++i) {
        out->rates[i] = impact.arrival.rates[i]*speed;
    }
    return status;
}

#if ROBOT_HAS_REDUCED_MODEL
/* Puts two masses and a spring in the place of the robot's own modes. */
static void lump(const robot_reduced_model_t *reduced, robot_impact *impact)
{
    robot_modes *const modes = &impact->phase[ROBOT_LOOSE].modes;
    const robot_real one = ROBOT_R(1.0);
    const robot_real both = reduced->m_c + reduced->m_a;
    modes->count = 2;
    modes->rigid = 1;
    modes->squared[0] = ROBOT_R(0.0);
    modes->squared[1] = reduced->k_r*(one/reduced->m_c + one/reduced->m_a);
    modes->fastest = ROBOT_REAL_MAX; /* all frequencies are known */
    modes->row[0] = one/ROBOT_SQRT(both);
    modes->row[1] = ROBOT_SQRT(reduced->m_a/(reduced->m_c*both));
    modes->start[0] = ROBOT_SQRT(both);
    modes->start[1] = ROBOT_R(0.0);
    modes->noise[0] = ROBOT_R(0.0);
    modes->noise[1] = ROBOT_R(0.0);
    robot_phase_steps(impact, ROBOT_HORIZON(impact->p), &impact->phase[ROBOT_LOOSE]);
}
#endif

int robot_follow_two_masses(const robot_real q[ROBOT_JOINTS], const robot_real n[3], robot_real speed,
    const robot_region *region, const robot_params *p, robot_follow_t *out)
{
#if ROBOT_HAS_REDUCED_MODEL
    robot_impact impact;
    robot_peak peak;
    robot_reduced_model_t reduced;
    int status = robot_reduced_model(q, n, p, &reduced);
    if (status == ROBOT_OK) {
        status = prepare(q, n, speed, region, p, ROBOT_MOTORS_FREE, &impact);
    }
    if (status != ROBOT_OK) {
        return status;
    }
    lump(&reduced, &impact);
    out->count = 0;
    (void)robot_run_seen(&impact, speed, FOLLOWED, &peak, out);
    out->force = peak.force;
    out->peak_time = peak.time;
    out->contact = peak.contact;
    out->pressing = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_JOINTS; ++i) {
        out->rates[i] = impact.arrival.rates[i]*speed;
    }
    return peak.ended ? ROBOT_OK : ROBOT_UNRESOLVED;
#else
    (void)q;
    (void)n;
    (void)speed;
    (void)region;
    (void)p;
    (void)out;
    return ROBOT_SINGULAR;
#endif
}

int robot_two_body(robot_real speed, robot_real moving_mass, const robot_region *region,
    const robot_params *p, robot_two_body_t *out)
{
    const robot_real zero = ROBOT_R(0.0);
    const robot_real one = ROBOT_R(1.0);
    const robot_real robot = ROBOT_R(0.5)*moving_mass + p->payload_mass;
    const robot_real body = region->clamped != 0 ? zero : one/region->effective_mass;
    if (!(robot > zero)) {
        return ROBOT_OUT_OF_RANGE;
    }
    const robot_real slope = ROBOT_SQRT(region->stiffness/(one/robot + body));
    out->force = slope*speed;
    out->speed = region->force_limit/slope;
    return ROBOT_OK;
}

int robot_aim(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS], const robot_params *p,
    robot_aim_t *out)
{
    robot_links_t links;
    robot_real v[3];
    const int status = robot_links(ROBOT_LINKS_OF(q, p), &links);
    if (status != ROBOT_OK) {
        return status;
    }
    for (int k = 0; k < 3; ++k) {
        v[k] = ROBOT_R(0.0);
        for (int i = 0; i < ROBOT_N; ++i) {
            v[k] += links.J[k][i]*dq[i];
        }
    }
    out->speed = ROBOT_SQRT(v[0]*v[0] + v[1]*v[1] + v[2]*v[2]);
    return out->speed > AT_REST ? robot_unit_vector(v, out->n) : ROBOT_ZERO_DIRECTION;
}
