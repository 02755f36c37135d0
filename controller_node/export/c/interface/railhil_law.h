/* A law over several units between the telegrams: readings in, commands and notes out, and how old a reading may be. */
#ifndef RAILHIL_LAW_H
#define RAILHIL_LAW_H

#include "@LAW@.h"
#include "@LAW@_node.h"
#include "railhil_clock.h"

/* What is counted after the outcomes of railhil_outcome_t. */
enum {
    RAILHIL_READING_DUPLICATE = RAILHIL_MVB_OUTCOMES, /* telegram of readings: life sign repeated */
    RAILHIL_READING_OUT_OF_ORDER,                     /* from the past */
    RAILHIL_READING_GAP,                              /* new, but telegrams are missing before it */
    RAILHIL_READING_CHECK,                            /* a check variable is not correct */
    RAILHIL_STALE,                                    /* commands that were the safe ones: a reading was too old */
    RAILHIL_COUNTS
};

typedef struct {
    int signs[RAILHIL_SOURCE_COUNT];     /* life sign of the last telegram with readings, -1 before the first */
    int32_t raws[RAILHIL_READING_COUNT]; /* of the last telegrams that counted */
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

/* Takes the process data of a telegram that was accepted on a port. One with readings counts if its life sign is new
 * and all its check variables are correct, as far as it has them. counts: by outcome. */
void railhil_law_take(railhil_law_t *law, const railhil_clock_t *clock, int port, const unsigned char *process,
                      uint32_t *counts);

/* Process data of the answer to a poll of a port, written over zeros. */
void railhil_law_answer(railhil_law_t *law, const railhil_clock_t *clock, int port, unsigned char *process,
                        uint32_t *counts);

/* Name of an outcome from RAILHIL_MVB_OUTCOMES on. */
const char *railhil_law_outcome(unsigned index);

#endif
