/* MPS2 on QEMU: the streams are files of the host (Arm's semihosting), which it reads and writes in one piece. A real
 * board has a UART here, with DMA or with a receive interrupt into a ring. The counter is a timer of the CMSDK. */
#include "railhil_board.h"

enum { SYS_OPEN = 0x01, SYS_WRITE = 0x05, SYS_READ = 0x06, SYS_EXIT = 0x18 };
enum { MODE_READ = 1, MODE_WRITE = 5, APPLICATION_EXIT = 0x20026 };

typedef struct {
    volatile uint32_t control;
    volatile uint32_t value;
    volatile uint32_t reload;
} timer_t;

#define TIMER0 ((timer_t *)0x40000000u)

static int32_t input;
static int32_t output;

static int32_t call_host(int32_t operation, uintptr_t argument)
{
    register int32_t r0 __asm("r0") = operation;
    register uintptr_t r1 __asm("r1") = argument;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static int32_t open_file(const char *path, uint32_t mode)
{
    const uintptr_t block[3] = {(uintptr_t)path, mode, strlen(path)};
    return call_host(SYS_OPEN, (uintptr_t)block);
}

void board_start(void)
{
    TIMER0->reload = UINT32_MAX;
    TIMER0->value = UINT32_MAX;
    TIMER0->control = 1;
    input = open_file("/dev/stdin", MODE_READ);
    output = open_file("/dev/stdout", MODE_WRITE);
}

/* The timer counts down. */
uint32_t board_ticks(void)
{
    return ~TIMER0->value;
}

/* The host returns the number of octets that were not read. */
size_t board_read(unsigned char *octets, size_t most)
{
    const uintptr_t block[3] = {(uintptr_t)input, (uintptr_t)octets, most};
    const size_t missing = (size_t)call_host(SYS_READ, (uintptr_t)block);
    return missing > most ? 0 : most - missing;
}

void board_write(const unsigned char *octets, size_t count)
{
    while (count != 0) {
        const uintptr_t block[3] = {(uintptr_t)output, (uintptr_t)octets, count};
        const size_t missing = (size_t)call_host(SYS_WRITE, (uintptr_t)block);
        if (missing >= count) {
            board_stop();
        }
        octets += count - missing;
        count = missing;
    }
}

void board_stop(void)
{
    call_host(SYS_EXIT, APPLICATION_EXIT);
    for (;;) {
    }
}
