/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * A 1 kHz control loop that never moves faster than a collision with a chest allows.
 *
 * The arm follows a joint trajectory. In every cycle panda_speed_factor tells by how much the planned
 * motion has to be slowed down for the contact point to stay below the limit in the direction in which
 * it moves, whether motors turn freely in an impact or drive on, and the trajectory's clock slows down. Uses nothing but the generated package, so that the loop's body
 * runs on a microcontroller as it is.
 */
#include <math.h>
#include <stdio.h>

#include "panda.h"

#define JOINTS PANDA_JOINTS
#define CYCLE ((panda_real)0.001) /* s */
#define PI ((panda_real)3.14159265358979)

/* What the controller knows: its drives, and whom it may hit. */
typedef struct {
    panda_params drives;
    panda_region body;
    panda_real limit; /* N */
} guard;

/* The planned trajectory: there and back between two poses, at rest at both ends. */
static void plan(panda_real time, panda_real q[JOINTS], panda_real rate[JOINTS])
{
    static const panda_real from[JOINTS] = {-0.9f, -0.4f, 0, -2.3f, 0, 1.9f, 0.8f};
    static const panda_real to[JOINTS] = {0.9f, 0.3f, 0, -1.7f, 0, 2.2f, 0.8f};
    const panda_real period = 2;
    const panda_real angle = 2*PI*time/period;
    const panda_real share = (1 - (panda_real)cos((double)angle))/2;
    const panda_real share_rate = PI/period*(panda_real)sin((double)angle);
    for (int i = 0; i < JOINTS; ++i) {
        q[i] = from[i] + share*(to[i] - from[i]);
        rate[i] = share_rate*(to[i] - from[i]);
    }
}

/*
 * Share of the planned velocity that is allowed now; *force is what it leads to at most [N]. Whatever
 * gives no answer stops the arm: a state that makes no sense, or an impact that cannot be bounded.
 */
static panda_real allowed_share(const guard *g, const panda_real q[JOINTS], const panda_real rate[JOINTS],
    panda_real *force)
{
    panda_speed_factor_t found;
    const int status = panda_speed_factor(q, rate, g->limit, &g->body, &g->drives, &found);
    if (status != PANDA_OK && status != PANDA_BOUNDED) {
        *force = 0;
        return 0;
    }
    *force = found.force;
    return found.factor;
}

static int prepare(guard *g)
{
    if (panda_default_params(&g->drives) != PANDA_OK
        || panda_body_region(PANDA_CHEST, 0, &g->body) != PANDA_OK) {
        return 0;
    }
    for (int i = 0; i < JOINTS; ++i) {
        g->drives.joint_stiffness[i] = 3000; /* N m/rad; yours */
        g->drives.rotor_inertia[i] = (panda_real)0.3; /* kg m^2; yours */
    }
    g->drives.horizon = (panda_real)0.1; /* s; what comes later is for the quasi-static limit */
    g->limit = g->body.force_limit;
    return 1;
}

int main(void)
{
    guard g;
    if (!prepare(&g)) {
        return 2;
    }
    int cycles = 0;
    int slowed = 0;
    panda_real clock = 0;
    panda_real highest = 0;
    panda_real q[JOINTS];
    panda_real rate[JOINTS];
    puts("time [s]  plan [s]  share  peak force [N]");
    while (clock < 2 && cycles < 60000) {
        panda_real force;
        plan(clock, q, rate);
        const panda_real share = allowed_share(&g, q, rate, &force);
        /* here q + share*rate*CYCLE would go to the drives */
        highest = force > highest ? force : highest;
        slowed += share < 1;
        if (cycles % 250 == 0) {
            printf("%8.3f  %8.3f  %5.2f  %6.1f\n", cycles*(double)CYCLE, (double)clock,
                   (double)share, (double)force);
        }
        clock += share*CYCLE;
        ++cycles;
    }
    printf("%d cycles, %d slowed down, highest force %.2f N, limit %.2f N\n", cycles, slowed,
           (double)highest, (double)g.body.force_limit);
    return highest <= g.body.force_limit ? 0 : 1;
}
