/* SPDX-License-Identifier: 0BSD */
/* Number type of rr; define RR_USE_FLOAT or RR_USE_DOUBLE in the whole build. */
#ifndef RR_CONFIG_H
#define RR_CONFIG_H

#if !defined(RR_USE_FLOAT) && !defined(RR_USE_DOUBLE)
#define RR_USE_DOUBLE 1
#endif

#if defined(RR_USE_FLOAT) && defined(RR_USE_DOUBLE)
#error "define RR_USE_FLOAT or RR_USE_DOUBLE, not both"
#endif

#if defined(RR_USE_FLOAT)
typedef float rr_real;
#else
typedef double rr_real;
#endif

#endif
