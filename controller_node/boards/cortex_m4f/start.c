/* Vectors, start and faults of a Cortex-M; its stack, painted for board_free_stack. */
#include "railhil_board.h"

#define PAINT UINT32_C(0xA5A5A5A5)
/* Coprocessor access: the floating-point unit. */
#define CPACR (*(volatile uint32_t *)0xE000ED88u)

extern uint32_t stack_bottom[], stack_top[], data_start[], data_end[], data_image[], bss_start[], bss_end[];

/* Those of C++. */
extern void (*const constructors_start[])(void), (*const constructors_end[])(void);

int main(void);

__attribute__((noreturn, used)) static void start(void)
{
    uint32_t *to;
    const uint32_t *from = data_image;
    void (*const *constructor)(void);
    for (to = data_start; to < data_end; to++) {
        *to = *from++;
    }
    for (to = bss_start; to < bss_end; to++) {
        *to = 0;
    }
#ifdef __ARM_FP
    CPACR |= UINT32_C(0xF) << 20;
#endif
    for (constructor = constructors_start; constructor < constructors_end; constructor++) {
        (*constructor)();
    }
    main();
    board_stop();
}

/* Paints the whole stack before anything is on it. */
__attribute__((naked, noreturn)) void reset(void)
{
    __asm volatile("ldr r0, =stack_bottom\n"
                   "ldr r1, =stack_top\n"
                   "ldr r2, =%c0\n"
                   "1: str r2, [r0], #4\n"
                   "cmp r0, r1\n"
                   "blo 1b\n"
                   "b start\n"
                   :
                   : "i"(PAINT));
}

uint32_t board_free_stack(void)
{
    const uint32_t *at = stack_bottom;
    while (at < stack_top && *at == PAINT) {
        at++;
    }
    return (uint32_t)((uintptr_t)at - (uintptr_t)stack_bottom);
}

/* frame: registers that the processor has saved: r0 to r3, r12, lr, pc, xPSR. */
__attribute__((noreturn, used)) static void tell_fault(const uint32_t *frame)
{
    board_fault("hard fault", frame[6]);
}

__attribute__((naked)) static void fault(void)
{
    __asm volatile("mrs r0, msp\n"
                   "b tell_fault\n");
}

/* Memory, bus and usage faults are not enabled: they escalate to the hard fault. */
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))stack_top, reset, fault, fault, fault, fault, fault,
};
