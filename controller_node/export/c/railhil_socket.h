/* The bus of the controller on a host (Linux): a raw CAN socket, a socket of the bench's hub, or the serial line of an
 * adapter. On a board it is replaced by the CAN driver.
 */
#ifndef RAILHIL_SOCKET_H
#define RAILHIL_SOCKET_H

#include <linux/can.h>

#include "@LAW@_mailboxes.h"
#include "railhil_mvb.h"

/* Largest number of frames received at once. */
enum { RAILHIL_PACKET_FRAMES = 256 };

typedef enum { RAILHIL_BUS_CAN, RAILHIL_BUS_HUB, RAILHIL_BUS_SLCAN } railhil_bus_kind_t;

typedef struct {
    int socket;
    railhil_bus_kind_t kind;
    const char *channel;
    int64_t lockstep_ms;   /* how long an answer waits for the interface in lockstep */
    unsigned long dropped; /* answers that the interface did not accept */
    int down;
    unsigned index; /* index of the interface that the socket is bound to */
    struct can_filter filters[RAILHIL_MAILBOX_COUNT];
    unsigned filter_count;
    char line[32]; /* of an adapter, as far as it has come */
    unsigned line_size;
} railhil_bus_t;

/* Monotonic wall time. */
int64_t railhil_now_ms(void);

/* Opens an interface (vcan0, can0), the hub at that path, for which it waits up to 5 s, or an adapter (/dev/ttyACM0).
 * Here and below, errors are reported in one line on stderr. Returns 0, or -1. */
int railhil_bus_open(railhil_bus_t *bus, railhil_bus_kind_t kind, const char *channel);

/* Receives at most RAILHIL_PACKET_FRAMES frames; returns their number, 0 after half a second without one, -1 when the
 * bus is gone. */
int railhil_bus_receive(railhil_bus_t *bus, struct can_frame *frames);

/* 1 if a receive mailbox of the chip would accept the frame. Hub and adapter deliver every frame of the bus, so the
 * filtering that the kernel does for a CAN socket is done here. */
int railhil_is_let_in(const railhil_bus_t *bus, const struct can_frame *frame);

/* Sends the frames of one answer; returns 0, or -1 when the bus is gone. lockstep: the bench waits for this answer. */
int railhil_bus_send(railhil_bus_t *bus, const railhil_frame_t *answer, unsigned count, int lockstep);

/* The same for the serial line of an adapter (railhil_slcan.c); they leave the reason in errno. */
int railhil_slcan_open(const char *path);
int railhil_slcan_receive(railhil_bus_t *bus, struct can_frame *frames);
int railhil_slcan_send(const railhil_bus_t *bus, const railhil_frame_t *answer, unsigned count);

#endif
