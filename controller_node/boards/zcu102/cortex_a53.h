/* What a board with a Cortex-A53 uses of its processor and of the interrupt controller beside it. */
#ifndef CORTEX_A53_H
#define CORTEX_A53_H

#include <stdint.h>

/* A register of 32 bits. */
#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))

/* The lines from..to of a GIC-400 wake the processor; handlers are not called. */
void gic_enable(uintptr_t distributor, uintptr_t cpu_interface, unsigned from, unsigned to);

/* Sleeps until an enabled interrupt is pending, also one that came before the call. */
void sleep_until_interrupt(void);

#endif
