/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the instructions of one call of CALL, on average over the golden inputs and at most: with
 * "-icount shift=0" QEMU's 25 MHz SysTick advances once in 40 instructions. CALL names an input
 * `in` of INPUT and, for impacts, its body region `region`. */
#include <stdint.h>
#include <stdio.h>

#include "golden.h"

#define CONTROL (*(volatile uint32_t *)0xE000E010u)
#define RELOAD (*(volatile uint32_t *)0xE000E014u)
#define CURRENT (*(volatile uint32_t *)0xE000E018u)
#define PER_TICK 40u
#define ROUNDS 200u
#define CASES (sizeof(INPUTS)/sizeof(INPUTS[0]))

static int failed = 0;

/* Ticks of ROUNDS calls with one input, or of as many rounds without the call. */
static uint32_t ticks(const INPUT *input, const panda_region *region, int calls)
{
    const INPUT *volatile chosen = input;
    (void)region;
    RELOAD = 0xFFFFFFu;
    CURRENT = 0u;
    CONTROL = 5u;
    const uint32_t start = CURRENT;
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        const INPUT *const in = chosen;
        (void)in;
        if (calls) {
            failed |= CALL;
        }
    }
    return (start - CURRENT) & 0xFFFFFFu;
}

int main(void)
{
    uint32_t total = 0u;
    uint32_t most = 0u;
    for (uint32_t k = 0; k < CASES; ++k) {
        panda_region region;
        failed |= panda_body_region(PART(INPUTS[k]), CLAMPED(INPUTS[k]), &region);
        const uint32_t loop = ticks(&INPUTS[k], &region, 0);
        const uint32_t all = ticks(&INPUTS[k], &region, 1);
        total += all - loop;
        most = all - loop > most ? all - loop : most;
    }
    printf("instructions: %lu, at most %lu\n", (unsigned long)(total/CASES*PER_TICK/ROUNDS),
           (unsigned long)(most*PER_TICK/ROUNDS));
    return failed;
}
