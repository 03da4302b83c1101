/* SPDX-License-Identifier: 0BSD */
/* Number type of rmin; define RMIN_USE_FLOAT or RMIN_USE_DOUBLE in the whole build. */
#ifndef RMIN_CONFIG_H
#define RMIN_CONFIG_H

#if !defined(RMIN_USE_FLOAT) && !defined(RMIN_USE_DOUBLE)
#define RMIN_USE_DOUBLE 1
#endif

#if defined(RMIN_USE_FLOAT) && defined(RMIN_USE_DOUBLE)
#error "define RMIN_USE_FLOAT or RMIN_USE_DOUBLE, not both"
#endif

#if defined(RMIN_USE_FLOAT)
typedef float rmin_real;
#else
typedef double rmin_real;
#endif

#endif
