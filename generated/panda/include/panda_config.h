/* SPDX-License-Identifier: 0BSD */
/* Number type of panda; define PANDA_USE_FLOAT or PANDA_USE_DOUBLE in the whole build. */
#ifndef PANDA_CONFIG_H
#define PANDA_CONFIG_H

#if !defined(PANDA_USE_FLOAT) && !defined(PANDA_USE_DOUBLE)
#define PANDA_USE_DOUBLE 1
#endif

#if defined(PANDA_USE_FLOAT) && defined(PANDA_USE_DOUBLE)
#error "define PANDA_USE_FLOAT or PANDA_USE_DOUBLE, not both"
#endif

#if defined(PANDA_USE_FLOAT)
typedef float panda_real;
#else
typedef double panda_real;
#endif

#endif
