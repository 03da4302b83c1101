/* SPDX-License-Identifier: BSD-3-Clause */
/* What a page asks of robot_'s package beside the package's own functions. */
/* Moments of a force over time that are kept. */
#define ROBOT_SEEN 2048

typedef struct {
    robot_real poses[ROBOT_JOINTS][12]; /* of the joints' frames: rotation row by row, then origin */
    robot_real contact[3]; /* m; base axes */
    robot_real end[3]; /* m; of the arm, base axes */
} robot_scene_t;

/*
 * Where everything is.
 * body: index of the joint that carries the contact point. place: of that point in the joint's frame.
 */
int robot_scene(const robot_real q[ROBOT_JOINTS], int body, const robot_real place[3], robot_scene_t *out);

typedef struct {
    int mass_status; /* of the number that follows, and so below */
    robot_real m_c; /* kg */
    int reduced_status;
    robot_real k_r; /* N/m */
    robot_real m_a; /* kg */
    int giaf_status;
    robot_real giaf;
    int directional_status;
    robot_real directional_giaf;
} robot_masses_t;

/* What stands for the robot along n. */
int robot_masses(const robot_real q[ROBOT_JOINTS], const robot_real n[3], const robot_params *p,
    robot_masses_t *out);

typedef struct {
    robot_real force; /* N; largest */
    robot_real peak_time; /* s */
    int contact; /* in which that is; the first is 1 */
    robot_real pressing; /* N; largest from 0.5 s on, on a clamped body */
    robot_real rates[ROBOT_JOINTS]; /* rad/s; with which joints arrive */
    int count; /* of moments */
    robot_real time[ROBOT_SEEN]; /* s */
    robot_real over_time[ROBOT_SEEN]; /* N */
} robot_follow_t;

/* An impact over time; p->motors is one kind, not the bracket. */
int robot_follow(const robot_real q[ROBOT_JOINTS], const robot_real n[3], robot_real speed,
    const robot_region *region, const robot_params *p, robot_follow_t *out);

/*
 * The same of two masses and a spring that stand for the robot along n (MSM Eq. 36-38): a rung below,
 * which knows nothing of motors. ROBOT_SINGULAR where a robot has none.
 */
int robot_follow_two_masses(const robot_real q[ROBOT_JOINTS], const robot_real n[3], robot_real speed,
    const robot_region *region, const robot_params *p, robot_follow_t *out);

typedef struct {
    robot_real force; /* N; at the speed */
    robot_real speed; /* m/s; at the transient limit */
} robot_two_body_t;

/* The two-body formula of ISO/TS 15066, A.3.4, for all that moves of a robot [kg] and its payload. */
int robot_two_body(robot_real speed, robot_real moving_mass, const robot_region *region,
    const robot_params *p, robot_two_body_t *out);

typedef struct {
    robot_real n[3];
    robot_real speed; /* m/s */
} robot_aim_t;

/* How the contact point moves as joints do. */
int robot_aim(const robot_real q[ROBOT_JOINTS], const robot_real dq[ROBOT_JOINTS], const robot_params *p,
    robot_aim_t *out);

typedef struct {
    robot_real posture[ROBOT_JOINTS];
    robot_real done; /* rad; how far it was possible */
} robot_slide_t;

/* Follows the self-motion, which holds the end where it is, by an arc in joint space. */
int robot_slide(const robot_real q[ROBOT_JOINTS], robot_real by, const robot_real lower[ROBOT_JOINTS],
    const robot_real upper[ROBOT_JOINTS], robot_slide_t *out);
