/* SPDX-License-Identifier: BSD-3-Clause */
/* The force of an impact of robot_ over time: the runtime's own steps, each of them written down. */
#include "robot_contact_steps.h" /* the runtime's robot_contact.c, whose steps are its own */

#include "robot_page_steps.h"

/* When the quasi-static limit takes over from the transient one, s; a little less for rounding. */
#define PRESSED_FROM ROBOT_R(0.499999)

/* Writes down every so many moments, twice as many once there is no more room. */
typedef struct {
    int every, passed;
} pace;

static void write_down(const state *s, pace *p, robot_follow_t *out)
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

robot_real robot_run_seen(const robot_impact *impact, robot_real speed, int steps, robot_peak *peak,
    robot_follow_t *out)
{
    static const robot_peak none = {ROBOT_R(0.0), ROBOT_R(0.0), 1, 1, false};
    state s;
    trial t;
    pace p = {1, 0};
    int left = steps;
    robot_real pressing = ROBOT_R(0.0);
    *peak = none;
    start(impact, speed, &s);
    for (int k = 0; k < impact->phases; ++k) {
        if (k > 0) {
            release(&s);
        }
        while (s.ticks > 0) {
            if (out != NULL) {
                write_down(&s, &p, out);
            }
            pressing = s.time >= PRESSED_FROM ? ROBOT_FMAX(pressing, s.f) : pressing;
            bool taken = false;
            while (!taken) { /* steps on trial count, too */
                if (left-- <= 0) {
                    return ROBOT_FMAX(peak->force, s.f);
                }
                glide(&s, &t);
                taken = s.touching ? step_pressed(&s, &t, impact->smooth*BENDS, peak)
                                   : step_apart(&s, &t, peak);
            }
            if (s.phase->damped) {
                damp(s.phase, speed, ROBOT_R(0.5)*s.h, s.rate);
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
