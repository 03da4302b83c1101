/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the instructions of one call of CALL, on average over the golden inputs and at most: with
 * "-icount shift=0" QEMU's 25 MHz SysTick advances once in 40 instructions. CALL names an input
 * `in` of INPUTS, each of which is repeated ROUNDS times, and, for impacts, the body region `region`
 * that goes with it. With EACH it prints the instructions of every input first. */
#include <stdint.h>
#include <stdio.h>

#include "golden.h"

#define CONTROL (*(volatile uint32_t *)0xE000E010u)
#define RELOAD (*(volatile uint32_t *)0xE000E014u)
#define CURRENT (*(volatile uint32_t *)0xE000E018u)
#define WRAPPED (1u << 16)
#define PER_TICK 40u
#define CASES (sizeof(INPUTS)/sizeof(INPUTS[0]))

typedef __typeof__(INPUTS[0]) input_type;

static int failed = 0;

#if defined(REGION)
static REGION region;

static void choose_region(const input_type *in)
{
    failed |= BODY_REGION(in->part, in->clamped, &region);
}
#else
static void choose_region(const input_type *in)
{
    (void)in;
}
#endif

/* Ticks of ROUNDS calls with one input, or of as many rounds without the call. */
static uint32_t ticks(const input_type *input, int calls)
{
    const input_type *volatile chosen = input;
    RELOAD = 0xFFFFFFu;
    CURRENT = 0u;
    CONTROL = 5u;
    const uint32_t start = CURRENT;
    for (uint32_t round = 0; round < ROUNDS; ++round) {
        const input_type *const in = chosen;
        (void)in;
        if (calls) {
            failed |= CALL;
        }
    }
    const uint32_t end = CURRENT;
    failed |= (CONTROL & WRAPPED) != 0u;
    return (start - end) & 0xFFFFFFu;
}

int main(void)
{
    uint32_t total = 0u;
    uint32_t most = 0u;
    for (uint32_t k = 0; k < CASES; ++k) {
        choose_region(&INPUTS[k]);
        const uint32_t loop = ticks(&INPUTS[k], 0);
        const uint32_t all = ticks(&INPUTS[k], 1);
        total += all - loop;
        most = all - loop > most ? all - loop : most;
#if defined(EACH)
        printf("%lu\n", (unsigned long)((all - loop)*PER_TICK/ROUNDS));
#endif
    }
    printf("instructions: %lu, at most %lu\n", (unsigned long)(total/CASES*PER_TICK/ROUNDS),
           (unsigned long)(most*PER_TICK/ROUNDS));
    return failed;
}
