/* SPDX-License-Identifier: 0BSD */
/* What still presses when the quasi-static limit of ur5e_'s impacts takes over from the transient one. */
#include "ur5e_state.h"

/* When it does, s. */
#define LATE UR5E_R(0.5)
/* Steps after which it is looked whether the rest matters. */
#define LOOKS_LATE 2

bool ur5e_pass(const ur5e_state *s, ur5e_watch *watch)
{
    if (s->time >= LATE) {
        const ur5e_real share = UR5E_FMIN((s->time - LATE)/s->h, UR5E_R(1.0));
        const ur5e_real then = share*watch->last + (UR5E_R(1.0) - share)*s->f;
        const ur5e_real up = watch->last - watch->before;
        const ur5e_real down = watch->last - s->f;
        watch->late = UR5E_FMAX(watch->late, UR5E_FMAX(then, s->f) + s->swings);
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
    return s->f < matters && s->past % LOOKS_LATE == 0
        && ur5e_is_settled(s, matters, watch->depth, UR5E_R(1.0));
}
