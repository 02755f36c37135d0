/* A law for several units: readings from telegrams and their ages, commands and notes into telegrams. */
#ifndef RAILHIL_LAW_H
#define RAILHIL_LAW_H

#include "@LAW@.h"
#include "@LAW@_node.h"
#include "railhil_clock.h"

/* Counters after those of the clock. */
enum {
    RAILHIL_READING_DUPLICATE = RAILHIL_CLOCK_OUTCOMES, /* telegram of readings: life sign repeated */
    RAILHIL_READING_OUT_OF_ORDER,                     /* older than the last telegram */
    RAILHIL_READING_GAP,                              /* new, but telegrams before it are missing */
    RAILHIL_READING_CHECK,                            /* a check variable is not correct */
    RAILHIL_STALE,                                    /* safe commands sent because a reading was too old */
    RAILHIL_COUNTS
};

typedef struct {
    int signs[RAILHIL_SOURCE_COUNT];     /* life sign of the last telegram with readings, -1 before the first */
    int32_t raws[RAILHIL_READING_COUNT]; /* of the last accepted telegrams */
    int64_t taken_ns[RAILHIL_READING_COUNT];
    int known[RAILHIL_READING_COUNT];
    @LAW@_in_t in;
    @LAW@_state_t state;
    @LAW@_out_t out;
    iq_events_t events;
    int64_t period; /* number of the last control period, -1 before the first */
    uint32_t steps;
    unsigned lives[RAILHIL_ANSWER_COUNT];
} railhil_law_t;

void railhil_law_init(railhil_law_t *law);

/* Takes the process data of a telegram received on a port. Its readings are accepted if its life sign is new and all
 * its check variables are correct, as far as it has them. counts: by outcome. */
void railhil_law_take(railhil_law_t *law, const railhil_clock_t *clock, int port, const unsigned char *process,
                      uint32_t *counts);

/* Writes the process data that answer a poll of a port; the caller passes zeros. */
void railhil_law_answer(railhil_law_t *law, const railhil_clock_t *clock, int port, unsigned char *process,
                        uint32_t *counts);

/* Time has passed without a telegram. */
void railhil_law_look(railhil_law_t *law, const railhil_clock_t *clock);

/* Name of an outcome; index >= RAILHIL_CLOCK_OUTCOMES. */
const char *railhil_law_outcome(unsigned index);

#endif
