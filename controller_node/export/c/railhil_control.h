/* The controller on the bus, for any CAN driver: frames in, answers to the bus administrator's polls out.
 *
 * A board's program: railhil_init once, then railhil_receive with every data frame in the order of its arrival, and the
 * frames that it returns are to be sent in their order. There is no timer: time is what the frames say. When the bus
 * falls silent nothing is asked and nothing is answered; a board that does more than answer needs a timer of its own.
 *
 * One run after another: the handshake of the next one begins afresh, however the last one ended.
 */
#ifndef RAILHIL_CONTROL_H
#define RAILHIL_CONTROL_H

#include "railhil_law.h"

/* RUN_EVENT: from RAILHIL_ENDED on the run is over; RAILHIL_REFUSED: the nodes do not agree on what to run. */
enum { RAILHIL_ENDED = 4, RAILHIL_REFUSED = 8, RAILHIL_EVENT_MAX = 10 };

enum { RAILHIL_PORT_COUNT = sizeof railhil_ports / sizeof railhil_ports[0] };

/* No run has begun; one has, from its handshake on; and then the bus administrator has looked for this device again. */
typedef enum { RAILHIL_AFRESH, RAILHIL_IN_RUN, RAILHIL_LOOKED_FOR } railhil_phase_t;

typedef struct {
    railhil_clock_t clock;
    railhil_law_t law;
    unsigned sequences[RAILHIL_PORT_COUNT]; /* counters of the telegrams that were answered */
    unsigned rate_10th; /* of simulation time, TIME_SYNC; 0: lockstep, an answer is waited for */
    int ended;          /* event that ended the run, 0 before */
    railhil_phase_t phase;
    uint32_t counts[RAILHIL_COUNTS]; /* by outcome */
    railhil_sink_t sinks[RAILHIL_SINK_COUNT];
} railhil_control_t;

void railhil_init(railhil_control_t *control);

/* Takes one frame: identifier, length and octets of a CAN data frame. Frames of a 29-bit identifier, remote and error
 * frames must not come here, or with an identifier above 0x7FF. Returns the number of frames to send, at most
 * RAILHIL_FRAMES_MAX. */
unsigned railhil_receive(railhil_control_t *control, uint32_t can_id, unsigned length, const unsigned char *data,
                         railhil_frame_t *answer);

/* Name of an entry of control->counts. */
const char *railhil_count_name(unsigned index);

#endif
