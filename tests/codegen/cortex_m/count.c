/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the instructions of one call of CALL, on average over the golden inputs: with
 * "-icount shift=0" QEMU's 25 MHz SysTick advances once in 40 instructions. */
#include <stdint.h>
#include <stdio.h>

#include "golden.h"

#define CONTROL (*(volatile uint32_t *)0xE000E010u)
#define RELOAD (*(volatile uint32_t *)0xE000E014u)
#define CURRENT (*(volatile uint32_t *)0xE000E018u)
#define PER_TICK 40u
#define ROUNDS 200u

static int failed = 0;

/* Ticks of ROUNDS passes over all inputs, with or without the call itself. */
static uint32_t ticks(int calls)
{
    RELOAD = 0xFFFFFFu;
    CURRENT = 0u;
    CONTROL = 5u;
    const uint32_t start = CURRENT;
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        for (uint32_t k = 0; k < PANDA_GOLDEN_CASES; ++k) {
            const panda_golden_input *volatile chosen = &panda_golden_inputs[k];
            const panda_golden_input *const in = chosen;
            if (calls) {
                failed |= CALL;
            }
        }
    }
    return (start - CURRENT) & 0xFFFFFFu;
}

int main(void)
{
    const uint32_t loop = ticks(0);
    const uint32_t all = ticks(1);
    const uint32_t count = ROUNDS*PANDA_GOLDEN_CASES;
    printf("instructions: %lu\n", (unsigned long)((all - loop)*PER_TICK/count));
    return failed;
}
