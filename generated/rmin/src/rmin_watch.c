/* SPDX-License-Identifier: 0BSD */
/* What still presses when the quasi-static limit of rmin_'s impacts takes over from the transient one. */
#include "rmin_state.h"

/* When it does, s. */
#define LATE RMIN_R(0.5)
/*
 * From when on contacts after the first count where slower speeds matter, too: those of slower speeds come later, by
 * 1.8 times at a twentieth of the speed (Hertz's contact lasts as v^-1/5), and oscillate with other phases.
 */
#define AGAIN RMIN_R(0.25)
/* Steps after which it is looked whether the rest matters. */
#define LOOKS_LATE 2

bool rmin_pass(const rmin_state *s, rmin_watch *watch)
{
    watch->apart = s->touching ? watch->apart : s->time;
    const rmin_real from = watch->slower && watch->apart > RMIN_R(0.0) ? AGAIN : LATE;
    const rmin_real until = watch->apart > LATE ? s->time : RMIN_FMIN(RMIN_COUNTS_UNTIL, s->time);
    if (s->time >= from && until > s->time - s->h) {
        const rmin_real share = RMIN_FMIN((s->time - from)/s->h, RMIN_R(1.0));
        const rmin_real then = share*watch->last + (RMIN_R(1.0) - share)*s->f;
        const rmin_real now = s->f - (s->time - until)/s->h*(s->f - watch->last);
        const rmin_real up = watch->last - watch->before;
        const rmin_real down = watch->last - s->f;
        watch->late = RMIN_FMAX(watch->late, RMIN_FMAX(then, now) + s->swings);
        if (s->past > 1 && up >= RMIN_R(0.0) && down > RMIN_R(0.0)) { /* a top between nodes */
            const rmin_real bend = (up/s->h_before + down/s->h)/(s->h + s->h_before);
            const rmin_real slope = up/s->h_before - bend*s->h_before;
            const rmin_real top = watch->last + RMIN_R(0.25)*slope*slope/bend;
            watch->late = RMIN_FMAX(watch->late, top + s->swings);
        }
    }
    watch->before = watch->last;
    watch->last = s->f;
    const rmin_real matters = watch->matters - s->swings;
    watch->settled = s->f < matters && s->past % LOOKS_LATE == 0
        && rmin_is_settled(s, matters, watch->depth, RMIN_R(1.0));
    return watch->settled;
}
