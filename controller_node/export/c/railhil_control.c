/* Telegrams in, control law, answers out: see railhil_control.h. */
#include "railhil_control.h"

/* All blocks of a telegram come within this time. */
#define ASSEMBLY_NS INT64_C(5000000)

enum { F_DEVICE_STATUS = 15, POLL_LENGTH = 3, FLAG_FALSE = 1, FLAG_TRUE = 2, MODE_INITIALISING = 0, MODE_RUNNING = 1 };
/* CTL_STAT shows no quantity of the law; CTL_STAT, OverflowFlags. */
enum { NO_QUANTITY = 127, HEADROOM_UNUSED = 31, SATURATED = 2, DIVIDED_BY_ZERO = 4 };

static const char *const count_names[RAILHIL_COUNTS] = {
    "part",
    "complete",
    "wrong_length",
    "wrong_check_sequence",
    "wrong_master_word",
    "wrong_block_count",
    "missing_block",
    "assembly_timeout",
    "duplicate",
    "out_of_order",
    "gap",
    "check_variable",
    "out_of_range",
    "position_duplicate",
    "position_out_of_order",
    "position_check",
    "position_jump",
    "balise_check",
    "balise_number",
    "balise_late",
};

const char *railhil_count_name(unsigned index)
{
    return count_names[index];
}

void railhil_init(railhil_control_t *control)
{
    memset(control, 0, sizeof *control);
    railhil_guard_init(&control->guard);
    control->period = -1;
}

/* Runs the law when a control period has begun since its last step. */
static void step(railhil_control_t *control)
{
    const int64_t period = railhil_now_ns(&control->guard) / @PREFIX@_PERIOD_NS;
    const int32_t k = period < INT32_MAX ? (int32_t)period : INT32_MAX;
    const int32_t speed_01mmps = control->guard.watch.speed_01mmps;
    const int32_t *balise = control->guard.balise.last;
    int32_t position_01mm;
    (void)balise; /* not every law is given it */
    if (!control->guard.clock.running || period == control->period || !control->guard.watch.speed_known) {
        return;
    }
    if (control->period >= 0 && period > control->period + 1) {
        control->overruns++;
    }
    position_01mm = railhil_position_01mm(&control->guard);
    @LAW@_inputs(k, speed_01mmps, position_01mm@BALISE@, &control->in, &control->events);
    if (control->steps == 0) {
        @LAW@_start(&control->in, &control->state);
    }
    @LAW@_step(&control->state, &control->in, &control->out, &control->events);
    control->told_code = control->out.notch;
    control->period = period;
    control->steps++;
}

static unsigned answer_notch(railhil_control_t *control, railhil_frame_t *answer)
{
    unsigned char process[4] = {0, 0, MODE_INITIALISING, 0};
    unsigned emergency = FLAG_FALSE;
    step(control);
    control->notch_life = (control->notch_life + 1u) & 0xFu;
    if (control->steps != 0) {
        const int32_t code = railhil_watched_notch(&control->guard, control->out.notch);
        if (code != control->told_code) {
            control->told_code = code;
            @LAW@_sent(&control->state, code);
        }
        railhil_put16(process, (uint32_t)code);
        process[2] = (unsigned char)(MODE_RUNNING + control->guard.watch.level);
        emergency = control->guard.watch.level == RAILHIL_EMERGENCY ? FLAG_TRUE : FLAG_FALSE;
    }
    process[3] = (unsigned char)((RAILHIL_CHECK_CORRECT << 6) | (emergency << 4) | control->notch_life);
    return railhil_frames(&railhil_ports[RAILHIL_NOTCH_CMD], process, NULL, answer);
}

static unsigned answer_status(railhil_control_t *control, railhil_frame_t *answer)
{
    unsigned char process[16] = {0};
    const uint32_t overruns = control->overruns < 255u ? control->overruns : 255u;
    control->status_life = (control->status_life + 1u) & 0xFu;
    process[12] = NO_QUANTITY << 1;
    process[13] = HEADROOM_UNUSED << 3;
    process[15] = (unsigned char)((RAILHIL_CHECK_CORRECT << 6) | (FLAG_FALSE << 4) | control->status_life);
    if (control->steps != 0) {
        const uint32_t note1 = (uint32_t)@PREFIX@_NOTE1(control->out) & 0xFu;
        process[0] = (unsigned char)(note1 << 4 | (unsigned)control->guard.watch.level);
        process[1] = (unsigned char)((control->events.saturations != 0 ? SATURATED : 0) |
                                     (control->events.zero_divisions != 0 ? DIVIDED_BY_ZERO : 0));
        railhil_put16(process + 2, (uint32_t)@PREFIX@_NOTE2(control->out));
        railhil_put16(process + 4, (uint32_t)@PREFIX@_NOTE3(control->out));
        railhil_put16(process + 6, control->steps);
        railhil_put16(process + 8, RAILHIL_STEP_CYCLES);
        process[14] = (unsigned char)overruns;
        process[15] = (unsigned char)((RAILHIL_CHECK_CORRECT << 6) | (FLAG_TRUE << 4) | control->status_life);
    }
    return railhil_frames(&railhil_ports[RAILHIL_CTL_STAT], process, &control->status_sequence, answer);
}

/* The handshake of another run, with what is left of one that ended, or was never heard to end. In a run the bus
 * administrator looks for nobody, and between its looking and this poll nothing of a run is on the bus: no single frame
 * makes a law begin afresh in motion. */
static unsigned answer_ident(railhil_control_t *control, railhil_frame_t *answer)
{
    if (control->phase == RAILHIL_LOOKED_FOR) {
        railhil_init(control);
    }
    control->phase = RAILHIL_IN_RUN;
    return railhil_frames(&railhil_ports[RAILHIL_CTL_IDENT], railhil_ident, &control->ident_sequence, answer);
}

/* Device status: no port of its own, two octets in the form of a single frame on a common identifier. */
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
    uint32_t word;
    if (length != POLL_LENGTH || railhil_check_sequence(data, 2) != data[2]) {
        control->guard.counts[RAILHIL_WRONG_MASTER_WORD]++;
        return 0;
    }
    word = railhil_get16(data);
    if (RAILHIL_PACE_TICKS != 0 && word == RAILHIL_PACE_WORD) {
        railhil_clock_poll(&control->guard, RAILHIL_PACE_TICKS);
    }
    if (word == railhil_ports[RAILHIL_NOTCH_CMD].word) {
        control->phase = RAILHIL_IN_RUN;
        return answer_notch(control, answer);
    }
    if (word == railhil_ports[RAILHIL_CTL_STAT].word) {
        control->phase = RAILHIL_IN_RUN;
        return answer_status(control, answer);
    }
    if (word == railhil_ports[RAILHIL_CTL_IDENT].word) {
        return answer_ident(control, answer);
    }
    if (word == ((uint32_t)F_DEVICE_STATUS << 12 | RAILHIL_DEVICE)) {
        return answer_device_status(control, word, answer);
    }
    return 0;
}

static void take_telegram(railhil_control_t *control, int port, const unsigned char *process)
{
    switch (port) {
    case RAILHIL_TRN_SPEED:
        railhil_speed(&control->guard, process);
        break;
    case RAILHIL_TRN_POS:
        railhil_position(&control->guard, process);
        break;
    case RAILHIL_BALISE:
        railhil_balise(&control->guard, process);
        break;
    case RAILHIL_TIME_SYNC:
        railhil_time_sync(&control->guard, process);
        control->rate_10th = process[6];
        break;
    case RAILHIL_TRK_INFO:
        railhil_track(&control->guard, process);
        break;
    case RAILHIL_RUN_EVENT:
        if (process[0] >= RAILHIL_ENDED && process[0] <= RAILHIL_EVENT_MAX) {
            control->ended = process[0];
        }
        break;
    default: /* PLT_STAT: checked and counted like the others, of no use to a law */
        break;
    }
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
        if (i == RAILHIL_TRN_SPEED) {
            railhil_clock_frame(&control->guard, length, data);
        }
        outcome = railhil_take(port, &control->sinks[i], part, length, data, railhil_now_ns(&control->guard),
                               ASSEMBLY_NS);
        control->guard.counts[outcome]++;
        if (outcome == RAILHIL_COMPLETE) {
            take_telegram(control, i, control->sinks[i].data);
        }
        break;
    }
    return 0;
}
