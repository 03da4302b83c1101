/* SPDX-License-Identifier: 0BSD */
/* Number type of ur5e; define UR5E_USE_FLOAT or UR5E_USE_DOUBLE in the whole build. */
#ifndef UR5E_CONFIG_H
#define UR5E_CONFIG_H

#if !defined(UR5E_USE_FLOAT) && !defined(UR5E_USE_DOUBLE)
#define UR5E_USE_DOUBLE 1
#endif

#if defined(UR5E_USE_FLOAT) && defined(UR5E_USE_DOUBLE)
#error "define UR5E_USE_FLOAT or UR5E_USE_DOUBLE, not both"
#endif

#if defined(UR5E_USE_FLOAT)
typedef float ur5e_real;
#else
typedef double ur5e_real;
#endif

#endif
