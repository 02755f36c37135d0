/* Vectors, start and faults of a Cortex-A53 at EL1, where QEMU starts it; its stack, painted for board_free_stack; its
 * cycle counter. The MMU stays off, so memory is accessed in order and only at aligned addresses (-mstrict-align).
 */
#include "cortex_a53.h"
#include "railhil_board.h"

#define PAINT 0xA5A5A5A5
#define TEXT_OF(value) #value
#define TEXT(value) TEXT_OF(value)

extern uint32_t stack_bottom[], stack_top[];

int main(void);

/* errno of the C library's math functions. */
static uint64_t thread_storage[8] __attribute__((used));

/* In assembler because nothing may be on the stack yet, and before the data are copied. */
__asm__(".section .start, \"ax\"\n"
        ".global _start\n"
        "_start:\n"
        "    ldr x0, =vectors\n"
        "    msr vbar_el1, x0\n"
        "    mov x0, #(3 << 20)\n" /* CPACR: floating point does not trap */
        "    msr cpacr_el1, x0\n"
        "    isb\n"
        "    ldr x0, =stack_bottom\n"
        "    ldr x1, =stack_top\n"
        "    mov sp, x1\n"
        "    ldr w2, =" TEXT(PAINT) "\n"
        "1:  str w2, [x0], #4\n"
        "    cmp x0, x1\n"
        "    b.lo 1b\n"
        "    ldr x0, =data_start\n"
        "    ldr x1, =data_end\n"
        "    ldr x2, =data_image\n"
        "2:  cmp x0, x1\n"
        "    b.hs 3f\n"
        "    ldr w3, [x2], #4\n"
        "    str w3, [x0], #4\n"
        "    b 2b\n"
        "3:  ldr x0, =bss_start\n"
        "    ldr x1, =bss_end\n"
        "4:  cmp x0, x1\n"
        "    b.hs 5f\n"
        "    str wzr, [x0], #4\n"
        "    b 4b\n"
        "5:  ldr x0, =thread_storage\n"
        "    msr tpidr_el0, x0\n"
        "    bl main\n"
        "    bl board_stop\n"
        "    .balign 2048\n"
        "vectors:\n"
        "    .rept 16\n"
        "    mrs x0, esr_el1\n"
        "    mrs x1, elr_el1\n"
        "    ldr x2, =stack_top\n" /* the stack may be the cause */
        "    mov sp, x2\n"
        "    b tell_fault\n"
        "    .balign 128\n"
        "    .endr\n"
        "    .text\n");

__attribute__((noreturn, used)) static void tell_fault(uint64_t syndrome, uint64_t address)
{
    enum { UNDEFINED = 0x00, DATA_ABORT = 0x25 };
    const unsigned cause = (unsigned)(syndrome >> 26) & 0x3Fu;
    const char *what = cause == DATA_ABORT ? "data abort" : cause == UNDEFINED ? "undefined instruction" : "exception";
    board_fault(what, (uint32_t)address);
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

uint32_t board_ticks(void)
{
    uint64_t cycles;
    __asm__ volatile("isb\n mrs %0, pmccntr_el0" : "=r"(cycles)::"memory");
    return (uint32_t)cycles;
}

void gic_enable(uintptr_t distributor, uintptr_t cpu_interface, unsigned from, unsigned to)
{
    enum { ENABLE = 0x100, PRIORITY = 0x400, TARGET = 0x800, PRIORITY_MASK = 4, LOWEST = 0xFF };
    unsigned line;
    for (line = from; line <= to; line++) {
        REGISTER(distributor + ENABLE + line / 32 * 4) = UINT32_C(1) << line % 32;
        *(volatile unsigned char *)(distributor + PRIORITY + line) = 0;
        *(volatile unsigned char *)(distributor + TARGET + line) = 1;
    }
    REGISTER(distributor) = 1;
    REGISTER(cpu_interface + PRIORITY_MASK) = LOWEST;
    REGISTER(cpu_interface) = 1;
    /* The cycle counter, without division. */
    __asm__ volatile("msr pmcntenset_el0, %0\n msr pmcr_el0, %1" ::"r"(UINT64_C(1) << 31), "r"(UINT64_C(1)));
}

/* Interrupts are masked in the processor, where a pending one ends wfi all the same. */
void sleep_until_interrupt(void)
{
    __asm__ volatile("dsb sy\n wfi" ::: "memory");
}

void board_stop(void)
{
    for (;;) {
        __asm__ volatile("msr daifset, #15\n wfi");
    }
}

/* Those of the C library for this processor access unaligned addresses. */
void *memcpy(void *restrict to, const void *restrict from, size_t count)
{
    unsigned char *at = to;
    const unsigned char *next = from;
    while (count-- != 0) {
        *at++ = *next++;
    }
    return to;
}

void *memset(void *to, int value, size_t count)
{
    unsigned char *at = to;
    while (count-- != 0) {
        *at++ = (unsigned char)value;
    }
    return to;
}

int memcmp(const void *one, const void *other, size_t count)
{
    const unsigned char *a = one;
    const unsigned char *b = other;
    for (; count != 0; count--, a++, b++) {
        if (*a != *b) {
            return *a - *b;
        }
    }
    return 0;
}
