/* A law over several units between the telegrams: readings in, commands and notes out, and how old a reading may be. */
#ifndef RAILHIL_LAW_H
#define RAILHIL_LAW_H

#include "@LAW@.h"
#include "@LAW@_node.h"
#include "railhil_clock.h"

/* What is counted after the outcomes of railhil_outcome_t. */
enum {
    RAILHIL_STALE = RAILHIL_MVB_OUTCOMES, /* commands that were the safe ones, because a reading was too old */
    RAILHIL_COUNTS
};

typedef struct {
    int32_t raws[RAILHIL_READING_COUNT]; /* newest readings */
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

/* Takes the process data of a telegram that was accepted on a port. counts: by outcome. */
void railhil_law_take(railhil_law_t *law, const railhil_clock_t *clock, int port, const unsigned char *process,
                      uint32_t *counts);

/* Process data of the answer to a poll of a port, written over zeros. */
void railhil_law_answer(railhil_law_t *law, const railhil_clock_t *clock, int port, unsigned char *process,
                        uint32_t *counts);

/* Name of an outcome from RAILHIL_MVB_OUTCOMES on. */
const char *railhil_law_outcome(unsigned index);

#endif
