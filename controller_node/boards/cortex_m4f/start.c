/* Vectors, start and faults of a Cortex-M; its stack, painted for board_free_stack. */
#include "railhil_board.h"

#define PAINT UINT32_C(0xA5A5A5A5)
/* Coprocessor access: the floating-point unit. */
#define CPACR (*(volatile uint32_t *)0xE000ED88u)

/* Memory protection unit (Armv7-M architecture, B3.5). Without it, QEMU reads 0 where there is no memory. */
typedef struct {
    volatile uint32_t type;
    volatile uint32_t control;
    volatile uint32_t number;
    volatile uint32_t base;
    volatile uint32_t attributes;
} mpu_t;

#define MPU ((mpu_t *)0xE000ED90u)
/* Region of 2^bits octets: read only, read and write without execution, and the same for devices. */
#define MPU_ROM(bits) (UINT32_C(0x06020001) | ((bits) - 1u) << 1)
#define MPU_RAM(bits) (UINT32_C(0x13020001) | ((bits) - 1u) << 1)
#define MPU_DEVICE(bits) (UINT32_C(0x13010001) | ((bits) - 1u) << 1)

enum { FAULT_WORDS = 256 };

extern uint32_t stack_bottom[], stack_top[], data_start[], data_end[], data_image[], bss_start[], bss_end[];

/* Those of C++. */
extern void (*const constructors_start[])(void), (*const constructors_end[])(void);

int main(void);

/* Stack of the fault handlers: that of the program may be the cause. */
static uint64_t fault_stack[FAULT_WORDS / 2];

static void protect(uint32_t number, uint32_t base, uint32_t attributes)
{
    MPU->number = number;
    MPU->base = base;
    MPU->attributes = attributes;
}

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
    /* The regions of board.ld, and the timers; all else, what is below the stack too, is a fault. */
    protect(0, 0x00000000u, MPU_ROM(20));
    protect(1, 0x20000000u, MPU_RAM(19));
    protect(2, 0x40000000u, MPU_DEVICE(16));
    MPU->control = 1;
    __asm volatile("dsb\n isb" ::: "memory");
#ifdef __ARM_FP
    CPACR |= UINT32_C(0xF) << 20;
#endif
    for (constructor = constructors_start; constructor < constructors_end; constructor++) {
        (*constructor)();
    }
    main();
    board_stop();
}

/* Paints the whole stack before anything is on it; then it is that of the program, the process stack. */
__attribute__((naked, noreturn)) void reset(void)
{
    __asm volatile("ldr r0, =stack_bottom\n"
                   "ldr r1, =stack_top\n"
                   "ldr r2, =%c0\n"
                   "1: str r2, [r0], #4\n"
                   "cmp r0, r1\n"
                   "blo 1b\n"
                   "msr psp, r1\n"
                   "movs r0, #2\n"
                   "msr control, r0\n"
                   "isb\n"
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
    if (at == stack_bottom) {
        board_fault("stack overflow", (uint32_t)(uintptr_t)at);
    }
    return (uint32_t)((uintptr_t)at - (uintptr_t)stack_bottom);
}

/* frame: registers that the processor has saved: r0 to r3, r12, lr, pc, xPSR. It has not where the stack is used up. */
__attribute__((noreturn, used)) static void tell_fault(const uint32_t *frame)
{
    if (frame < stack_bottom || frame >= stack_top) {
        board_fault("stack overflow", (uint32_t)(uintptr_t)frame);
    }
    board_fault("hard fault", frame[6]);
}

__attribute__((naked)) static void fault(void)
{
    __asm volatile("mrs r0, psp\n"
                   "b tell_fault\n");
}

/* Memory, bus and usage faults are not enabled: they escalate to the hard fault. */
__attribute__((section(".vectors"), used)) static void (*const vectors[])(void) = {
    (void (*)(void))(fault_stack + FAULT_WORDS / 2), reset, fault, fault, fault, fault, fault,
};
