/* A CTU CAN FD controller (CTU CAN FD IP core, datasheet 2.2) on PCI, the GICv2 and the PL011 of QEMU's virt machine. The
 * card is looked for in the configuration space of bus 0, and its second region, the controllers' registers, is placed
 * at the beginning of the bridge's window. QEMU's model takes every frame: it has no acceptance filters.
 */
#include "../zcu102/cortex_a53.h"
#include "railhil_board.h"

#define CONFIGURATION 0x3F000000u
#define WINDOW 0x10000000u
#define UART_DATA REGISTER(0x09000000u)
#define GIC_DISTRIBUTOR 0x08000000u
#define GIC_CPU 0x08010000u

/* Configuration space of a PCI device. */
enum { SLOTS = 32, SLOT_SHIFT = 15, PCI_COMMAND = 0x04, PCI_REGION1 = 0x14, MEMORY_ENABLE = 2 };
#define CARD UINT32_C(0xFF001760)
/* The four interrupt lines of the PCI bridge. */
enum { PCI_FIRST_LINE = 35, PCI_LAST_LINE = 38 };

#define CAN(offset) REGISTER(WINDOW + (offset))
enum {
    MODE = 0x04,
    STATUS = 0x08,
    COMMAND = 0x0C,
    EVENTS = 0x10,
    EVENTS_ENABLE = 0x14,
    BIT_TIMING = 0x24,
    RECEIVE_DATA = 0x6C,
    TRANSMIT_STATUS = 0x70,
    TRANSMIT_COMMAND = 0x74,
    TRANSMIT_PRIORITY = 0x78,
    TRANSMIT_BUFFER = 0x100
};
#define MODE_RESET UINT32_C(1)
#define MODE_ENABLE (UINT32_C(1) << 22)
enum { RECEIVED = 1, OVERRUN = 2, CLEAR_OVERRUN = 8, ALL_EVENTS = 0xFFF, RECEIVE_NOT_EMPTY = 1 << 10 };
enum { BUFFER_READY = 1 << 1, BUFFER1 = 1 << 8, BUFFER_STATE = 15, STATE_READY = 1, STATE_ON_BUS = 2 };
/* 500 kbit/s from 100 MHz: a quantum of 0.1 us; 1 + 7 + 7 + 5 quanta, jump width 1. */
#define TIMING (UINT32_C(7) | UINT32_C(7) << 7 | UINT32_C(5) << 13 | UINT32_C(10) << 19 | UINT32_C(1) << 27)
/* The words of a frame before its data: format, identifier, time stamp (2). */
enum { HEAD = 4, LENGTH = 15, REMOTE_OR_EXTENDED = 3 << 5, WORDS_SHIFT = 11, WORDS = 31, ID_SHIFT = 18, ID_MAX = 0x7FF };

static uint32_t lost;

void board_start(void)
{
    unsigned slot = 0;
    uintptr_t card = CONFIGURATION;
    while (REGISTER(card) != CARD) {
        slot++;
        if (slot == SLOTS) {
            board_last_words("there is no CTU CAN FD card");
            board_stop();
        }
        card = CONFIGURATION + ((uintptr_t)slot << SLOT_SHIFT);
    }
    REGISTER(card + PCI_REGION1) = WINDOW;
    REGISTER(card + PCI_COMMAND) = MEMORY_ENABLE;
    CAN(MODE) = MODE_RESET;
    CAN(BIT_TIMING) = TIMING;
    CAN(EVENTS_ENABLE) = RECEIVE_NOT_EMPTY;
    CAN(TRANSMIT_PRIORITY) = 1;
    CAN(MODE) = MODE_ENABLE;
    gic_enable(GIC_DISTRIBUTOR, GIC_CPU, PCI_FIRST_LINE, PCI_LAST_LINE);
}

void board_console(const char *line)
{
    while (*line != '\0') {
        UART_DATA = (uint32_t)*line++;
    }
    UART_DATA = '\n';
}

int board_can_receive(railhil_frame_t *frame)
{
    uint32_t format;
    unsigned words;
    unsigned i;
    if (CAN(STATUS) & OVERRUN) {
        lost++;
        CAN(COMMAND) = CLEAR_OVERRUN;
    }
    if (!(CAN(STATUS) & RECEIVED)) {
        /* It is set again at once if a frame has arrived meanwhile. */
        CAN(EVENTS) = ALL_EVENTS;
        sleep_until_interrupt();
        return 0;
    }
    /* Each read of RECEIVE_DATA returns the next word; the format says how many follow it. */
    format = CAN(RECEIVE_DATA);
    words = format >> WORDS_SHIFT & WORDS;
    frame->can_id = CAN(RECEIVE_DATA) >> ID_SHIFT & ID_MAX;
    frame->length = format & LENGTH;
    for (i = 2; i <= words; i++) {
        const uint32_t word = CAN(RECEIVE_DATA);
        unsigned k;
        for (k = 0; i >= HEAD && k < 4 && 4 * (i - HEAD) + k < RAILHIL_BLOCK; k++) {
            frame->data[4 * (i - HEAD) + k] = (unsigned char)(word >> (8 * k));
        }
    }
    return !(format & REMOTE_OR_EXTENDED) && frame->length <= RAILHIL_BLOCK;
}

void board_can_send(const railhil_frame_t *frame)
{
    uint32_t words[2] = {0, 0};
    uint32_t state;
    unsigned i;
    for (i = 0; i < frame->length; i++) {
        words[i / 4] |= (uint32_t)frame->data[i] << (8 * (i % 4));
    }
    CAN(TRANSMIT_BUFFER) = frame->length;
    CAN(TRANSMIT_BUFFER + 4) = frame->can_id << ID_SHIFT;
    CAN(TRANSMIT_BUFFER + 16) = words[0];
    CAN(TRANSMIT_BUFFER + 20) = words[1];
    CAN(TRANSMIT_COMMAND) = BUFFER_READY | BUFFER1;
    do {
        state = CAN(TRANSMIT_STATUS) & BUFFER_STATE;
    } while (state == STATE_READY || state == STATE_ON_BUS);
}

uint32_t board_can_lost(void)
{
    return lost;
}
