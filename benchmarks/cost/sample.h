/* SPDX-License-Identifier: BSD-3-Clause */
/* What every contender is given. */
#ifndef SAMPLE_H
#define SAMPLE_H

#include "panda.h"

typedef struct {
    double q[PANDA_JOINTS], n[3];
    panda_params p;
    panda_region region;
    double speed; /* m/s; 0 for samples that hit nothing */
    double force; /* N; peak force by SUNDIALS */
} sample;

#endif
