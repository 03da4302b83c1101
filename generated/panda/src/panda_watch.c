/* SPDX-License-Identifier: 0BSD */
/* What still presses when the quasi-static limit of panda_'s impacts takes over from the transient one. */
#include "panda_state.h"

/* When it does, s. */
#define LATE PANDA_R(0.5)
/*
 * From when on contacts after the first count where slower speeds matter, too: those of slower speeds come later, by
 * 1.8 times at a twentieth of the speed (Hertz's contact lasts as v^-1/5), and oscillate with other phases.
 */
#define AGAIN PANDA_R(0.25)
/* Steps after which it is looked whether the rest matters. */
#define LOOKS_LATE 2

bool panda_pass(const panda_state *s, panda_watch *watch)
{
    watch->apart = s->touching ? watch->apart : s->time;
    const panda_real from = watch->slower && watch->apart > PANDA_R(0.0) ? AGAIN : LATE;
    const panda_real until = watch->apart > LATE ? s->time : PANDA_FMIN(PANDA_COUNTS_UNTIL, s->time);
    if (s->time >= from && until > s->time - s->h) {
        const panda_real share = PANDA_FMIN((s->time - from)/s->h, PANDA_R(1.0));
        const panda_real then = share*watch->last + (PANDA_R(1.0) - share)*s->f;
        const panda_real now = s->f - (s->time - until)/s->h*(s->f - watch->last);
        const panda_real up = watch->last - watch->before;
        const panda_real down = watch->last - s->f;
        watch->late = PANDA_FMAX(watch->late, PANDA_FMAX(then, now) + s->swings);
        if (s->past > 1 && up >= PANDA_R(0.0) && down > PANDA_R(0.0)) { /* a top between nodes */
            const panda_real bend = (up/s->h_before + down/s->h)/(s->h + s->h_before);
            const panda_real slope = up/s->h_before - bend*s->h_before;
            const panda_real top = watch->last + PANDA_R(0.25)*slope*slope/bend;
            watch->late = PANDA_FMAX(watch->late, top + s->swings);
        }
    }
    watch->before = watch->last;
    watch->last = s->f;
    const panda_real matters = watch->matters - s->swings;
    watch->settled = s->f < matters && s->past % LOOKS_LATE == 0
        && panda_is_settled(s, matters, watch->depth, PANDA_R(1.0));
    return watch->settled;
}
