/* CAN0, the GIC-400 and UART0 of a Zynq UltraScale+ (AMD UG1085, UG1087), as QEMU has them. QEMU's CAN registers hold a
 * frame as Linux does: the identifier in bits 10:0, the flags of extended and remote frames in bits 31 and 30, the first
 * octet in the lowest bits. On the chip the identifier is in bits 31:21 and the first octet in the highest: there
 * ID_SHIFT and FIRST_SHIFT are 21 and 24, and the acceptance filters are the words of railhil_filters.h as they are.
 */
#include "cortex_a53.h"
#include "railhil_board.h"
#include "railhil_filters.h"

typedef struct {
    volatile uint32_t id, length, data[2];
} message_t;

typedef struct {
    volatile uint32_t reset, mode, prescaler, bit_timing, error_counter, error_status, status;
    volatile uint32_t interrupt_status, interrupt_enable, interrupt_clear, timestamp, watermark;
    message_t transmit, transmit_urgent, receive;
    volatile uint32_t filter_enable;
    struct {
        volatile uint32_t mask, id;
    } filter[RAILHIL_ZYNQMP_FILTER_COUNT];
} can_t;

#define CAN0 ((can_t *)0xFF060000u)
#define UART_CONTROL REGISTER(0xFF000000u)
#define UART_FIFO REGISTER(0xFF000030u)
#define UART_STATUS REGISTER(0xFF00002Cu)
#define GIC_DISTRIBUTOR 0xF9010000u
#define GIC_CPU 0xF9020000u

enum { SOFTWARE_RESET = 1, CAN_ENABLE = 2 };
enum { TRANSMIT_FULL = 1 << 10 };
enum { RECEIVE_OVERFLOW = 1 << 6, RECEIVE_NOT_EMPTY = 1 << 7 };
enum { UART_ENABLE = 0x14, UART_FULL = 1 << 4 };
enum { CAN0_LINE = 55 };
/* 500 kbit/s from a reference clock of 100 MHz: 20 quanta of 0.1 us, of which 15 + 4 about the sample point. */
enum { PRESCALER = 10 - 1, BIT_TIMING = (4 - 1) << 4 | (15 - 1) };
enum { ID_SHIFT = 0, FIRST_SHIFT = 0, LENGTH_SHIFT = 28, ID_MAX = 0x7FF, CHIP_ID_SHIFT = 21 };
/* Both flags are compared: only standard data frames pass. */
#define FLAGS UINT32_C(0xC0000000)

static uint32_t lost;

static void set_filters(void)
{
    unsigned i;
    CAN0->filter_enable = 0;
    for (i = 0; i < RAILHIL_ZYNQMP_FILTER_COUNT; i++) {
        CAN0->filter[i].mask = railhil_zynqmp_filters[i][0] >> CHIP_ID_SHIFT << ID_SHIFT | FLAGS;
        CAN0->filter[i].id = railhil_zynqmp_filters[i][1] >> CHIP_ID_SHIFT << ID_SHIFT;
    }
    CAN0->filter_enable = (1u << RAILHIL_ZYNQMP_FILTER_COUNT) - 1;
}

void board_start(void)
{
    UART_CONTROL = UART_ENABLE;
    CAN0->reset = SOFTWARE_RESET;
    CAN0->mode = 0;
    CAN0->prescaler = PRESCALER;
    CAN0->bit_timing = BIT_TIMING;
    set_filters();
    CAN0->interrupt_enable = RECEIVE_NOT_EMPTY;
    CAN0->reset = CAN_ENABLE;
    gic_enable(GIC_DISTRIBUTOR, GIC_CPU, CAN0_LINE, CAN0_LINE);
}

void board_console(const char *line)
{
    do {
        while (UART_STATUS & UART_FULL) {
        }
        UART_FIFO = *line == '\0' ? '\n' : (uint32_t)*line;
    } while (*line++ != '\0');
}

int board_can_receive(railhil_frame_t *frame)
{
    const uint32_t events = CAN0->interrupt_status;
    uint32_t words[2];
    unsigned i;
    if (events & RECEIVE_OVERFLOW) {
        lost++;
        CAN0->interrupt_clear = RECEIVE_OVERFLOW;
    }
    if (!(events & RECEIVE_NOT_EMPTY)) {
        sleep_until_interrupt();
        return 0;
    }
    /* The four registers of a message are read in this order: the next one follows. */
    frame->can_id = CAN0->receive.id >> ID_SHIFT;
    frame->length = CAN0->receive.length >> LENGTH_SHIFT;
    words[0] = CAN0->receive.data[0];
    words[1] = CAN0->receive.data[1];
    CAN0->interrupt_clear = RECEIVE_NOT_EMPTY;
    for (i = 0; i < RAILHIL_BLOCK; i++) {
        frame->data[i] = (unsigned char)(words[i / 4] >> (FIRST_SHIFT ^ 8 * (i % 4)));
    }
    return frame->can_id <= ID_MAX && frame->length <= RAILHIL_BLOCK;
}

void board_can_send(const railhil_frame_t *frame)
{
    uint32_t words[2] = {0, 0};
    unsigned i;
    for (i = 0; i < frame->length; i++) {
        words[i / 4] |= (uint32_t)frame->data[i] << (FIRST_SHIFT ^ 8 * (i % 4));
    }
    while (CAN0->status & TRANSMIT_FULL) {
    }
    CAN0->transmit.id = frame->can_id << ID_SHIFT;
    CAN0->transmit.length = (uint32_t)frame->length << LENGTH_SHIFT;
    CAN0->transmit.data[0] = words[0];
    CAN0->transmit.data[1] = words[1];
}

uint32_t board_can_lost(void)
{
    return lost;
}
