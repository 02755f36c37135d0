/* The bus of the controller on a host (Linux): a raw CAN socket, or a socket of the bench's hub. On a board the CAN
 * driver takes its place.
 */
#ifndef RAILHIL_SOCKET_H
#define RAILHIL_SOCKET_H

#include <linux/can.h>

#include "@LAW@_mailboxes.h"
#include "railhil_mvb.h"

/* Frames that come at once, at most. */
enum { RAILHIL_PACKET_FRAMES = 256 };

typedef struct {
    int socket;
    int is_hub;
    const char *channel;
    int64_t lockstep_ms;   /* so long an answer waits for the interface in lockstep */
    unsigned long dropped; /* answers that the interface did not take */
    int down;
    unsigned index; /* of the interface that the socket is bound to */
    struct can_filter filters[RAILHIL_MAILBOX_COUNT];
    unsigned filter_count;
} railhil_bus_t;

/* Monotonic wall time. */
int64_t railhil_now_ms(void);

/* Opens an interface (vcan0, can0), or the hub of that path, for which it waits 5 s. What cannot be done is said in one
 * line on stderr, here and below. Returns 0, or -1. */
int railhil_bus_open(railhil_bus_t *bus, int is_hub, const char *channel);

/* Frames that have come, at most RAILHIL_PACKET_FRAMES; 0 after half a second without one, -1 when the bus is gone. */
int railhil_bus_receive(railhil_bus_t *bus, struct can_frame *frames);

/* Whether a receive mailbox of the chip would take the frame: the hub gives every frame of the bus, and what the
 * kernel's filters do has to be done here. */
int railhil_is_let_in(const railhil_bus_t *bus, const struct can_frame *frame);

/* Sends the frames of one answer; -1 when the bus is gone. lockstep: the bench waits for this very answer. */
int railhil_bus_send(railhil_bus_t *bus, const railhil_frame_t *answer, unsigned count, int lockstep);

#endif
