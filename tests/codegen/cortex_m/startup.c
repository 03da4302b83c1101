/* SPDX-License-Identifier: BSD-3-Clause */
/* Brings a Cortex-M with an FPU under QEMU to main and back, with semihosting for its output. */
#include <stdint.h>
#include <stdio.h>

extern uint32_t _stack_top, _data_start, _data_end, _data_load, _bss_start, _bss_end;

extern void initialise_monitor_handles(void);
int main(void);
void reset(void);

static void leave(uint32_t code)
{
    const uint32_t block[2] = {0x20026u, code}; /* ADP_Stopped_ApplicationExit */
    register uint32_t operation __asm__("r0") = 0x20u; /* SYS_EXIT_EXTENDED */
    register const uint32_t *argument __asm__("r1") = block;
    __asm__ volatile("bkpt 0xAB" : : "r"(operation), "r"(argument) : "memory");
    for (;;) {
    }
}

static void fault(void)
{
    leave(99u);
}

static void run(void)
{
    const uint32_t *from = &_data_load;
    for (uint32_t *to = &_data_start; to < &_data_end; ++to) {
        *to = *from++;
    }
    for (uint32_t *to = &_bss_start; to < &_bss_end; ++to) {
        *to = 0u;
    }
    initialise_monitor_handles();
    const int code = main();
    fflush(stdout);
    leave((uint32_t)code);
}

/* No instruction of the FPU may come before it is switched on. */
void reset(void)
{
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
    __asm__ volatile("dsb\n isb");
    run();
}

__attribute__((section(".vectors"), used)) static void *const vectors[16] = {
    &_stack_top, (void *)reset, (void *)fault, (void *)fault, (void *)fault, (void *)fault,
    (void *)fault,
};
