/* SPDX-License-Identifier: 0BSD */
/* What still presses when the quasi-static limit of ur5e_'s impacts takes over from the transient one. */
#include "ur5e_state.h"

/* When it does, s. */
#define LATE UR5E_R(0.5)
/*
 * From when on contacts after the first count where slower speeds matter, too: those of slower speeds come later, by
 * 1.8 times at a twentieth of the speed (Hertz's contact lasts as v^-1/5), and oscillate with other phases.
 */
#define AGAIN UR5E_R(0.25)
/* Steps after which it is looked whether the rest matters. */
#define LOOKS_LATE 2

bool ur5e_pass(const ur5e_state *s, ur5e_watch *watch)
{
    watch->apart = s->touching ? watch->apart : s->time;
    const ur5e_real from = watch->slower && watch->apart > UR5E_R(0.0) ? AGAIN : LATE;
    const ur5e_real until = watch->apart > LATE ? s->time : UR5E_FMIN(UR5E_COUNTS_UNTIL, s->time);
    if (s->time >= from && until > s->time - s->h) {
        const ur5e_real share = UR5E_FMIN((s->time - from)/s->h, UR5E_R(1.0));
        const ur5e_real then = share*watch->last + (UR5E_R(1.0) - share)*s->f;
        const ur5e_real now = s->f - (s->time - until)/s->h*(s->f - watch->last);
        const ur5e_real up = watch->last - watch->before;
        const ur5e_real down = watch->last - s->f;
        watch->late = UR5E_FMAX(watch->late, UR5E_FMAX(then, now) + s->swings);
        if (s->past > 1 && up >= UR5E_R(0.0) && down > UR5E_R(0.0)) { /* a top between nodes */
            const ur5e_real bend = (up/s->h_before + down/s->h)/(s->h + s->h_before);
            const ur5e_real slope = up/s->h_before - bend*s->h_before;
            const ur5e_real top = watch->last + UR5E_R(0.25)*slope*slope/bend;
            watch->late = UR5E_FMAX(watch->late, top + s->swings);
        }
    }
    watch->before = watch->last;
    watch->last = s->f;
    const ur5e_real matters = watch->matters - s->swings;
    watch->settled = s->f < matters && s->past % LOOKS_LATE == 0
        && ur5e_is_settled(s, matters, watch->depth, UR5E_R(1.0));
    return watch->settled;
}
