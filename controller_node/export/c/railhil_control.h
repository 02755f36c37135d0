/* The controller on the bus, for any CAN driver: frames in, answers to the bus administrator's polls out.
 *
 * A board's program calls railhil_init once, then railhil_receive with every data frame in the order of arrival, and
 * sends the frames that it returns in their order. Time comes from the frames. While the bus is silent there is no poll
 * and no answer; what has passed is seen afterwards, from a slow port or TIME_SYNC. A board that has a timer of its own
 * passes the time to railhil_elapsed: the age of the speed is then seen at once, and a board that does more than answer
 * can act on it.
 *
 * Runs may follow one another: the handshake of the next one resets everything, however the last one ended.
 */
#ifndef RAILHIL_CONTROL_H
#define RAILHIL_CONTROL_H

#include "railhil_law.h"

/* RUN_EVENT: values from RAILHIL_ENDED on end the run; RAILHIL_REFUSED: the nodes do not agree on what to run. */
enum {
    RAILHIL_ENDED = RAILHIL_EVENT_ENDED_COMPLETE,
    RAILHIL_REFUSED = RAILHIL_EVENT_ENDED_REFUSED,
    RAILHIL_EVENT_MAX = RAILHIL_EVENT_ENDED_SUPERVISOR_LOST
};

enum { RAILHIL_PORT_COUNT = sizeof railhil_ports / sizeof railhil_ports[0] };

/* No run has begun; a run has begun with its handshake; in a run, the device status has been polled again. */
typedef enum { RAILHIL_AFRESH, RAILHIL_IN_RUN, RAILHIL_LOOKED_FOR } railhil_phase_t;

typedef struct {
    railhil_clock_t clock;
    railhil_law_t law;
    unsigned sequences[RAILHIL_PORT_COUNT]; /* sequence counters of the telegrams sent */
    unsigned rate_10th; /* simulation rate from TIME_SYNC, 1/10; 0: lockstep, the bench waits for each answer */
    int ended;          /* event that ended the run; 0: not ended */
    railhil_phase_t phase;
    uint32_t counts[RAILHIL_COUNTS]; /* by outcome */
    railhil_sink_t sinks[RAILHIL_SINK_COUNT];
} railhil_control_t;

void railhil_init(railhil_control_t *control);

/* Takes one frame: identifier, length and octets of a CAN data frame. Remote and error frames, and
 * frames with a 29-bit identifier, must not be passed, or only with an identifier above 0x7FF. Returns the number of
 * frames to send, at most RAILHIL_FRAMES_MAX. */
unsigned railhil_receive(railhil_control_t *control, uint32_t can_id, unsigned length, const unsigned char *data,
                         railhil_frame_t *answer);

/* Nothing was received for so much simulation time since the last frame or call, by a timer of the board. Not in
 * lockstep (rate_10th 0), where time waits for the answers. */
void railhil_elapsed(railhil_control_t *control, int64_t elapsed_ns);

/* Name of an entry of control->counts. */
const char *railhil_count_name(unsigned index);

#endif
