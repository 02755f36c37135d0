/* Readings, commands and status of the law: see railhil_law.h. */
#include "railhil_law.h"

/* Overflow flags of the status. */
enum { SATURATED = 2, DIVIDED_BY_ZERO = 4 };

static const char *const outcome_names[RAILHIL_COUNTS - RAILHIL_CLOCK_OUTCOMES] = {
    "duplicate",
    "out_of_order",
    "gap",
    "check_variable",
    "stale",
};

const char *railhil_law_outcome(unsigned index)
{
    return outcome_names[index - RAILHIL_CLOCK_OUTCOMES];
}

void railhil_law_init(railhil_law_t *law)
{
    int i;
    memset(law, 0, sizeof *law);
    for (i = 0; i < RAILHIL_SOURCE_COUNT; i++) {
        law->signs[i] = -1;
    }
    law->period = -1;
}

/* Extracts the raw integer of a signal. */
static int32_t taken(const unsigned char *process, const railhil_signal_t *signal)
{
    uint32_t raw = 0;
    unsigned i;
    for (i = signal->first_bit; i < signal->first_bit + signal->bits; i++) {
        raw = (raw << 1) | (((uint32_t)process[i / 8u] >> (7u - i % 8u)) & 1u);
    }
    if (signal->is_signed) {
        const uint32_t sign = UINT32_C(1) << (signal->bits - 1u);
        raw = (raw ^ sign) - sign;
    }
    return (int32_t)raw;
}

/* Writes the low bits of a number into a signal; a signal of more than 32 bits is sign-extended. */
static void put(unsigned char *process, const railhil_signal_t *signal, int32_t value)
{
    const uint64_t raw = (uint64_t)(int64_t)value;
    unsigned i;
    for (i = 0; i < signal->bits; i++) {
        const unsigned at = signal->first_bit + signal->bits - 1u - i;
        const unsigned mask = 1u << (7u - at % 8u);
        process[at / 8u] = (unsigned char)((raw >> i & 1u) != 0 ? process[at / 8u] | mask : process[at / 8u] & ~mask);
    }
}

/* 1 if the readings of a telegram are accepted. */
static int counted(railhil_law_t *law, int port, const unsigned char *process, uint32_t *counts)
{
    int i;
    for (i = 0; i < RAILHIL_SOURCE_COUNT; i++) {
        const railhil_signal_t *sign = &railhil_signs[i];
        if (sign->port == port && sign->bits != 0) {
            const int life = (int)taken(process, sign);
            const railhil_life_t judged = railhil_life(law->signs[i], life);
            if (judged == RAILHIL_REPEATED || judged == RAILHIL_OLD) {
                /* Nothing new: the age of the readings keeps growing. */
                counts[judged == RAILHIL_OLD ? RAILHIL_READING_OUT_OF_ORDER : RAILHIL_READING_DUPLICATE]++;
                return 0;
            }
            if (judged == RAILHIL_GAP) {
                counts[RAILHIL_READING_GAP]++;
            }
            law->signs[i] = life;
        }
    }
    for (i = 0; i < RAILHIL_CHECK_COUNT; i++) {
        if (railhil_checks[i].port == port && taken(process, &railhil_checks[i]) != RAILHIL_CHECK_CORRECT) {
            counts[RAILHIL_READING_CHECK]++;
            return 0;
        }
    }
    return 1;
}

void railhil_law_take(railhil_law_t *law, const railhil_clock_t *clock, int port, const unsigned char *process,
                      uint32_t *counts)
{
    int i;
    if (!counted(law, port, process, counts)) {
        return;
    }
    for (i = 0; i < RAILHIL_READING_COUNT; i++) {
        if (railhil_readings[i].port == port) {
            law->raws[i] = taken(process, &railhil_readings[i]);
            law->taken_ns[i] = railhil_own_ns(clock);
            law->known[i] = 1;
        }
    }
}

/* Runs the law if a control period has begun since its last step; returns 1 if its commands may be sent. */
static int step(railhil_law_t *law, const railhil_clock_t *clock)
{
    const int64_t now_ns = railhil_own_ns(clock);
    const int64_t period = railhil_now_ns(clock) / @PREFIX@_PERIOD_NS;
    int i;
    for (i = 0; i < RAILHIL_READING_COUNT; i++) {
        if (!law->known[i] || now_ns - law->taken_ns[i] > railhil_ages_ns[i]) {
            return 0;
        }
    }
    if (clock->running && period != law->period) {
        @LAW@_inputs(@GIVEN@, &law->in, &law->events);
        if (law->steps == 0) {
            @LAW@_start(&law->in, &law->state);
        }
        @LAW@_step(&law->state, &law->in, &law->out, &law->events);
        law->period = period;
        law->steps++;
    }
    return law->steps != 0;
}

static void answer_commands(railhil_law_t *law, const railhil_clock_t *clock, int port, unsigned char *process,
                            uint32_t *counts)
{
    const int may_be_sent = step(law, clock);
    const int32_t commands[RAILHIL_COMMAND_COUNT] = {@COMMANDS@};
    int i;
    if (!may_be_sent && law->steps != 0) {
        counts[RAILHIL_STALE]++;
        @LAW@_sent(&law->state, @SAFE@);
    }
    for (i = 0; i < RAILHIL_COMMAND_COUNT; i++) {
        if (railhil_commands[i].port == port) {
            put(process, &railhil_commands[i], may_be_sent ? commands[i] : railhil_safe[i]);
        }
    }
}

/* Notes and flags, from the law's first step on; the number of steps always. */
static void answer_status(const railhil_law_t *law, int port, unsigned char *process)
{
    const int32_t flags =
        (law->events.saturations != 0 ? SATURATED : 0) | (law->events.zero_divisions != 0 ? DIVIDED_BY_ZERO : 0);
    const int32_t told[RAILHIL_TOLD_COUNT] = {@TOLD@};
    int i;
    for (i = 0; i < RAILHIL_TOLD_COUNT; i++) {
        /* After the notes, each status has its flags and then its number of steps. */
        const int is_count = i >= RAILHIL_NOTE_COUNT && (i - RAILHIL_NOTE_COUNT) % 2 == 1;
        if (railhil_told[i].port == port && (law->steps != 0 || is_count)) {
            put(process, &railhil_told[i], told[i]);
        }
    }
}

/* The ages of the readings are looked at when commands are sent. */
void railhil_law_look(railhil_law_t *law, const railhil_clock_t *clock)
{
    (void)law;
    (void)clock;
}

void railhil_law_answer(railhil_law_t *law, const railhil_clock_t *clock, int port, unsigned char *process,
                        uint32_t *counts)
{
    const int answer = port - RAILHIL_SINK_COUNT;
    int i, has_commands = 0;
    memcpy(process, railhil_blanks[answer], railhil_ports[port].bytes);
    for (i = 0; i < RAILHIL_COMMAND_COUNT; i++) {
        has_commands |= railhil_commands[i].port == port;
    }
    if (has_commands) {
        answer_commands(law, clock, port, process, counts);
    } else {
        answer_status(law, port, process);
    }
    put(process, &railhil_lives[answer], (int32_t)law->lives[answer]);
    law->lives[answer] = (law->lives[answer] + 1u) & 0xFu;
}
