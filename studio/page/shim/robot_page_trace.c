/* SPDX-License-Identifier: BSD-3-Clause */
/* The force of an impact of robot_ over time: the runtime's own steps, each of them written down. */
#define robot_impact_run robot_impact_run_seen /* nobody calls it */
#define robot_phase_begin robot_phase_begin_seen /* the same as the runtime's */
#include "robot_run.c" /* the runtime's, whose steps are its own */
#undef robot_impact_run
#undef robot_phase_begin

#include "robot_page_steps.h"

/* When the quasi-static limit takes over from the transient one, s; a little less for rounding. */
#define PRESSED_FROM ROBOT_R(0.499999)

/* Share of the runtime's bend at which steps are halved here: lines between them are drawn straight. */
#define DRAWN ROBOT_R(0.2)

/* Writes down every so many moments, twice as many once there is no more room. */
typedef struct {
    int every, passed;
} pace;

static void write_down(const robot_state *s, pace *p, robot_follow_t *out)
{
    if (p->passed++ % p->every != 0) {
        return;
    }
    if (out->count == ROBOT_SEEN) {
        for (int i = 0; i < ROBOT_SEEN/2; ++i) {
            out->time[i] = out->time[2*i];
            out->over_time[i] = out->over_time[2*i];
        }
        out->count = ROBOT_SEEN/2;
        p->every *= 2;
    }
    out->time[out->count] = s->time;
    out->over_time[out->count] = s->f;
    ++out->count;
}

/* One step that is taken; false if the steps do not do. */
static bool step_on(robot_state *s, int *left, robot_peak *peak)
{
    robot_trial t;
    outcome was = TO_BE_SHORTER;
    while (was == TO_BE_SHORTER) { /* steps on trial count, too */
        if (--*left < 0 || peak->contacts > MOST_CONTACTS) {
            return false;
        }
        robot_glide(s, &t);
        was = s->touching ? step_pressed(s, &t, s->impact->smooth*DRAWN*BENDS, SHORTEST, peak)
                          : step_apart(s, &t, SHORTEST_APART, peak);
    }
    tick(s, was == TAKEN_AND_STRAIGHT);
    return true;
}

robot_real robot_run_seen(robot_impact *impact, robot_real speed, int steps, robot_peak *peak,
    robot_follow_t *out)
{
    static const robot_peak none = {ROBOT_R(0.0), ROBOT_R(0.0), ROBOT_R(0.0), 1, 1, false, false};
    robot_state s;
    pace p = {1, 0};
    int left = steps;
    robot_real pressing = ROBOT_R(0.0);
    *peak = none;
    start(impact, speed, false, &s);
    for (int k = impact->first; k <= impact->last; ++k) {
        if (k > impact->first) {
            robot_impact_let_go(impact);
            if (impact->status != ROBOT_OK) {
                return ROBOT_REAL_MAX;
            }
            robot_release(&s);
        }
        if (impact->phase[k].blurred) {
            return ROBOT_REAL_MAX;
        }
        while (s.ticks > 0) {
            if (out != NULL) {
                write_down(&s, &p, out);
            }
            pressing = s.time >= PRESSED_FROM ? ROBOT_FMAX(pressing, s.f) : pressing;
            if (!step_on(&s, &left, peak)) {
                return ROBOT_REAL_MAX;
            }
        }
    }
    if (out != NULL) {
        p.passed = 0;
        write_down(&s, &p, out);
    }
    peak->ended = true;
    return ROBOT_FMAX(pressing, s.f);
}
