/* SPDX-License-Identifier: 0BSD */
/* What still presses when the quasi-static limit of robot_'s impacts takes over from the transient one. */
#include "robot_state.h"

/* When it does, s. */
#define LATE ROBOT_R(0.5)
/*
 * From when on contacts after the first count where slower speeds matter, too: those of slower speeds come later, by
 * 1.8 times at a twentieth of the speed (Hertz's contact lasts as v^-1/5), and oscillate with other phases.
 */
#define AGAIN ROBOT_R(0.25)
/* Steps after which it is looked whether the rest matters. */
#define LOOKS_LATE 2

bool robot_pass(const robot_state *s, robot_watch *watch)
{
    watch->apart = s->touching ? watch->apart : s->time;
    const robot_real from = watch->slower && watch->apart > ROBOT_R(0.0) ? AGAIN : LATE;
    const robot_real until = watch->apart > LATE ? s->time : ROBOT_FMIN(ROBOT_COUNTS_UNTIL, s->time);
    if (s->time >= from && until > s->time - s->h) {
        const robot_real share = ROBOT_FMIN((s->time - from)/s->h, ROBOT_R(1.0));
        const robot_real then = share*watch->last + (ROBOT_R(1.0) - share)*s->f;
        const robot_real now = s->f - (s->time - until)/s->h*(s->f - watch->last);
        const robot_real up = watch->last - watch->before;
        const robot_real down = watch->last - s->f;
        watch->late = ROBOT_FMAX(watch->late, ROBOT_FMAX(then, now) + s->swings);
        if (s->past > 1 && up >= ROBOT_R(0.0) && down > ROBOT_R(0.0)) { /* a top between nodes */
            const robot_real bend = (up/s->h_before + down/s->h)/(s->h + s->h_before);
            const robot_real slope = up/s->h_before - bend*s->h_before;
            const robot_real top = watch->last + ROBOT_R(0.25)*slope*slope/bend;
            watch->late = ROBOT_FMAX(watch->late, top + s->swings);
        }
    }
    watch->before = watch->last;
    watch->last = s->f;
    const robot_real matters = watch->matters - s->swings;
    watch->settled = s->f < matters && s->past % LOOKS_LATE == 0
        && robot_is_settled(s, matters, watch->depth, ROBOT_R(1.0));
    return watch->settled;
}
