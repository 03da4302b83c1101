/* SPDX-License-Identifier: BSD-3-Clause */
/*
 * The self-motion of robot_: postures that hold the end where it is. The step is what the last one
 * leaves when everything that moves the end is taken out of it; Newton's steps then put the end back.
 */
#include "robot_impact.h"

#define STEP ROBOT_R(0.02) /* rad */
#define MOST_STEPS 1000
#define CORRECTIONS 4
#define HELD ROBOT_R(1e-9) /* pose error, m and rad */
#define LEAST ROBOT_R(1e-6) /* share of a guess that must be motion of its own */
#define OWN ROBOT_R(1e-3) /* length of a unit guess that is motion of its own at all */
#define SOFT ROBOT_R(1e-12) /* added to J J', so that singular postures are passed */

/* x = x - J+ (J x - wanted) */
static void hold(const robot_end_t *end, const robot_real wanted[6], robot_real x[ROBOT_JOINTS])
{
    robot_real square[6][6];
    robot_real miss[6];
    for (int k = 0; k < 6; ++k) {
        miss[k] = -wanted[k];
        for (int i = 0; i < ROBOT_JOINTS; ++i) {
            miss[k] += end->J[k][i]*x[i];
        }
        for (int l = 0; l < 6; ++l) {
            square[k][l] = k == l ? SOFT : ROBOT_R(0.0);
            for (int i = 0; i < ROBOT_JOINTS; ++i) {
                square[k][l] += end->J[k][i]*end->J[l][i];
            }
        }
    }
    for (int k = 0; k < 6; ++k) { /* Gauss; the matrix is positive definite */
        for (int l = k + 1; l < 6; ++l) {
            const robot_real share = square[l][k]/square[k][k];
            for (int m = k; m < 6; ++m) {
                square[l][m] -= share*square[k][m];
            }
            miss[l] -= share*miss[k];
        }
    }
    for (int k = 5; k >= 0; --k) {
        for (int l = k + 1; l < 6; ++l) {
            miss[k] -= square[k][l]*miss[l];
        }
        miss[k] /= square[k][k];
    }
    for (int i = 0; i < ROBOT_JOINTS; ++i) {
        for (int k = 0; k < 6; ++k) {
            x[i] -= end->J[k][i]*miss[k];
        }
    }
}

/* Way and turn from one pose to another, small. */
static void way(const robot_end_t *from, const robot_end_t *to, robot_real error[6])
{
    for (int k = 0; k < 3; ++k) {
        error[k] = to->position[k] - from->position[k];
        error[3 + k] = ROBOT_R(0.0);
    }
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3;
            const int b = (k + 2) % 3;
            error[3 + k] += ROBOT_R(0.5)
                *(from->rotation[a][c]*to->rotation[b][c] - from->rotation[b][c]*to->rotation[a][c]);
        }
    }
}

static robot_real length(int count, const robot_real *x)
{
    robot_real sum = ROBOT_R(0.0);
    for (int i = 0; i < count; ++i) {
        sum += x[i]*x[i];
    }
    return ROBOT_SQRT(sum);
}

/* Puts the end back; false if that fails. */
static bool put_back(const robot_end_t *aim, robot_real q[ROBOT_JOINTS])
{
    for (int k = 0; k < CORRECTIONS; ++k) {
        robot_end_t now;
        robot_real error[6];
        robot_real move[ROBOT_JOINTS] = {0};
        if (robot_end(q, &now) != ROBOT_OK) {
            return false;
        }
        way(&now, aim, error);
        if (length(6, error) < HELD) {
            return true;
        }
        hold(&now, error, move);
        for (int i = 0; i < ROBOT_JOINTS; ++i) {
            q[i] += move[i];
        }
    }
    return false;
}

/* A first way along the self-motion: the joint's that has most of its own. */
static robot_real begin(const robot_end_t *end, robot_real along[ROBOT_JOINTS])
{
    const robot_real still[6] = {0};
    robot_real best = ROBOT_R(0.0);
    for (int j = 0; j < ROBOT_JOINTS; ++j) {
        robot_real trial[ROBOT_JOINTS] = {0};
        trial[j] = ROBOT_R(1.0);
        hold(end, still, trial);
        const robot_real own = length(ROBOT_JOINTS, trial);
        if (own > best*ROBOT_R(1.001)) { /* the first of equals, whatever rounding says */
            best = own;
            for (int i = 0; i < ROBOT_JOINTS; ++i) {
                along[i] = trial[i];
            }
        }
    }
    return best;
}

static bool is_within(const robot_real *q, const robot_real *lower, const robot_real *upper)
{
    for (int i = 0; i < ROBOT_JOINTS; ++i) {
        if (q[i] < lower[i] || q[i] > upper[i]) {
            return false;
        }
    }
    return true;
}

/* One step of a length; false where there is none. `along` is the way of the last. */
static bool step(const robot_end_t *aim, robot_real by, robot_real along[ROBOT_JOINTS],
    robot_real q[ROBOT_JOINTS])
{
    const robot_real still[6] = {0};
    robot_end_t now;
    if (robot_end(q, &now) != ROBOT_OK) {
        return false;
    }
    hold(&now, still, along);
    const robot_real own = length(ROBOT_JOINTS, along);
    if (own < LEAST) {
        return false;
    }
    for (int i = 0; i < ROBOT_JOINTS; ++i) {
        along[i] /= own;
        q[i] += by*along[i];
    }
    return put_back(aim, q);
}

int robot_slide(const robot_real q[ROBOT_JOINTS], robot_real by, const robot_real lower[ROBOT_JOINTS],
    const robot_real upper[ROBOT_JOINTS], robot_slide_t *out)
{
    robot_end_t aim;
    robot_real along[ROBOT_JOINTS] = {0};
    robot_real next[ROBOT_JOINTS];
    const int status = robot_end(q, &aim);
    if (status != ROBOT_OK) {
        return status;
    }
    const robot_real sign = by < ROBOT_R(0.0) ? ROBOT_R(-1.0) : ROBOT_R(1.0);
    const robot_real wanted = ROBOT_FABS(by);
    const bool any = begin(&aim, along) > OWN;
    robot_real done = ROBOT_R(0.0);
    for (int i = 0; i < ROBOT_JOINTS; ++i) {
        out->posture[i] = q[i];
        next[i] = q[i];
        along[i] *= sign;
    }
    for (int k = 0; any && k < MOST_STEPS && done < wanted; ++k) {
        const robot_real length_of_step = ROBOT_FMIN(STEP, wanted - done);
        if (!step(&aim, length_of_step, along, next) || !is_within(next, lower, upper)) {
            break;
        }
        done += length_of_step;
        for (int i = 0; i < ROBOT_JOINTS; ++i) {
            out->posture[i] = next[i];
        }
    }
    out->done = sign*done;
    return ROBOT_OK;
}
