/* Telegrams in, answers out: see railhil_control.h. */
#include "railhil_control.h"

enum { POLL_LENGTH = 3 };

static const char *const count_names[RAILHIL_CLOCK_OUTCOMES] = {
    "part",
    "complete",
    "wrong_length",
    "wrong_check_sequence",
    "wrong_master_word",
    "wrong_block_count",
    "missing_block",
    "assembly_timeout",
    "time_check",
    "time_duplicate",
    "time_out_of_order",
    "time_backward",
    "time_ahead",
};

const char *railhil_count_name(unsigned index)
{
    return index < RAILHIL_CLOCK_OUTCOMES ? count_names[index] : railhil_law_outcome(index);
}

void railhil_init(railhil_control_t *control)
{
    memset(control, 0, sizeof *control);
    railhil_clock_init(&control->clock);
    railhil_law_init(&control->law);
}

/* Answers the poll of the handshake. If it opens a new run, the state of the previous one is cleared, even if its end
 * was not received. During a run the bus administrator does not poll device status, and between that poll and this one
 * there are no frames of a run on the bus; so a single frame cannot restart the law while the train moves. */
static unsigned answer_ident(railhil_control_t *control, railhil_frame_t *answer)
{
    if (control->phase == RAILHIL_LOOKED_FOR) {
        railhil_init(control);
    }
    control->phase = RAILHIL_IN_RUN;
    return railhil_frames(&railhil_ports[RAILHIL_CTL_IDENT], railhil_ident, &control->sequences[RAILHIL_CTL_IDENT],
                          answer);
}

/* Device status has no port of its own: two octets, sent like a telegram of one frame on a common identifier. */
static unsigned answer_device_status(railhil_control_t *control, uint32_t word, railhil_frame_t *answer)
{
    static const unsigned char ready[RAILHIL_BLOCK] = {0x10, 0x00};
    railhil_port_t port;
    port.address = RAILHIL_DEVICE_STATUS_ID;
    port.word = word;
    port.bytes = 2;
    if (control->phase == RAILHIL_IN_RUN) {
        control->phase = RAILHIL_LOOKED_FOR;
    }
    return railhil_frames(&port, ready, NULL, answer);
}

static unsigned answer_poll(railhil_control_t *control, unsigned length, const unsigned char *data,
                            railhil_frame_t *answer)
{
    unsigned char process[RAILHIL_BLOCKS_MAX * RAILHIL_BLOCK] = {0};
    uint32_t word;
    int port;
    if (length != POLL_LENGTH || railhil_check_sequence(data, 2) != data[2]) {
        control->counts[RAILHIL_WRONG_MASTER_WORD]++;
        return 0;
    }
    word = railhil_get16(data);
    if (RAILHIL_PACE_TICKS != 0 && word == RAILHIL_PACE_WORD) {
        railhil_clock_poll(&control->clock, RAILHIL_PACE_TICKS);
    }
    if (word == railhil_ports[RAILHIL_CTL_IDENT].word) {
        return answer_ident(control, answer);
    }
    if (word == RAILHIL_DEVICE_STATUS_WORD) {
        return answer_device_status(control, word, answer);
    }
    for (port = RAILHIL_SINK_COUNT; port < RAILHIL_PORT_COUNT; port++) {
        if (word == railhil_ports[port].word) {
            control->phase = RAILHIL_IN_RUN;
            railhil_law_answer(&control->law, &control->clock, port, process, control->counts);
            return railhil_frames(&railhil_ports[port], process, &control->sequences[port], answer);
        }
    }
    return 0;
}

static void take_telegram(railhil_control_t *control, int port, const unsigned char *process)
{
    if (port == RAILHIL_TIME_SYNC) {
        if (railhil_time_sync(&control->clock, process, control->counts)) {
            control->rate_10th = (unsigned)railhil_unpack_time_sync(process).rate_10th;
        }
    } else if (port == RAILHIL_RUN_EVENT) {
        const int event = (int)railhil_unpack_run_event(process).event;
        if (event >= RAILHIL_ENDED && event <= RAILHIL_EVENT_MAX) {
            control->ended = event;
        }
    }
    if (port == RAILHIL_SLOW_PORT) {
        railhil_clock_slow(&control->clock, railhil_slow_life(process));
    }
    railhil_law_take(&control->law, &control->clock, port, process, control->counts);
}

void railhil_elapsed(railhil_control_t *control, int64_t elapsed_ns)
{
    railhil_clock_elapsed(&control->clock, elapsed_ns);
    railhil_law_look(&control->law, &control->clock);
}

unsigned railhil_receive(railhil_control_t *control, uint32_t can_id, unsigned length, const unsigned char *data,
                         railhil_frame_t *answer)
{
    int i;
    if (can_id == RAILHIL_POLL_ID) {
        return answer_poll(control, length, data, answer);
    }
    for (i = 0; i < RAILHIL_SINK_COUNT; i++) {
        const railhil_port_t *port = &railhil_ports[i];
        const int part = railhil_part(port, can_id);
        railhil_outcome_t outcome;
        if (part < 0) {
            continue;
        }
        control->phase = RAILHIL_IN_RUN;
        if (i == RAILHIL_CLOCK_PORT) {
            railhil_clock_frame(&control->clock, length, data);
        }
        outcome = railhil_take(port, &control->sinks[i], part, length, data, railhil_own_ns(&control->clock),
                               RAILHIL_ASSEMBLY_NS);
        control->counts[outcome]++;
        if (outcome == RAILHIL_COMPLETE) {
            take_telegram(control, i, control->sinks[i].data);
        }
        break;
    }
    return 0;
}
