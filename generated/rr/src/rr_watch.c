/* SPDX-License-Identifier: 0BSD */
/* What still presses when the quasi-static limit of rr_'s impacts takes over from the transient one. */
#include "rr_state.h"

/* When it does, s. */
#define LATE RR_R(0.5)
/*
 * From when on contacts after the first count where slower speeds matter, too: those of slower speeds come later, by
 * 1.8 times at a twentieth of the speed (Hertz's contact lasts as v^-1/5), and oscillate with other phases.
 */
#define AGAIN RR_R(0.25)
/* Steps after which it is looked whether the rest matters. */
#define LOOKS_LATE 2

bool rr_pass(const rr_state *s, rr_watch *watch)
{
    watch->apart = s->touching ? watch->apart : s->time;
    const rr_real from = watch->slower && watch->apart > RR_R(0.0) ? AGAIN : LATE;
    const rr_real until = watch->apart > LATE ? s->time : RR_FMIN(RR_COUNTS_UNTIL, s->time);
    if (s->time >= from && until > s->time - s->h) {
        const rr_real share = RR_FMIN((s->time - from)/s->h, RR_R(1.0));
        const rr_real then = share*watch->last + (RR_R(1.0) - share)*s->f;
        const rr_real now = s->f - (s->time - until)/s->h*(s->f - watch->last);
        const rr_real up = watch->last - watch->before;
        const rr_real down = watch->last - s->f;
        watch->late = RR_FMAX(watch->late, RR_FMAX(then, now) + s->swings);
        if (s->past > 1 && up >= RR_R(0.0) && down > RR_R(0.0)) { /* a top between nodes */
            const rr_real bend = (up/s->h_before + down/s->h)/(s->h + s->h_before);
            const rr_real slope = up/s->h_before - bend*s->h_before;
            const rr_real top = watch->last + RR_R(0.25)*slope*slope/bend;
            watch->late = RR_FMAX(watch->late, top + s->swings);
        }
    }
    watch->before = watch->last;
    watch->last = s->f;
    const rr_real matters = watch->matters - s->swings;
    watch->settled = s->f < matters && s->past % LOOKS_LATE == 0
        && rr_is_settled(s, matters, watch->depth, RR_R(1.0));
    return watch->settled;
}
