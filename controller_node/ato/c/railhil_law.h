/* A train's law: its inputs from the telegrams, its notch and status into telegrams, and the watch that limits it. */
#ifndef RAILHIL_LAW_H
#define RAILHIL_LAW_H

#include "@LAW@.h"
#include "@LAW@_node.h"
#include "railhil_guard.h"

typedef struct {
    railhil_guard_t guard;
    @LAW@_in_t in;
    @LAW@_state_t state;
    @LAW@_out_t out;
    iq_events_t events;
    int64_t period;    /* number of the last control period, -1 before the first */
    int32_t told_code; /* the last notch sent, as known to the law, 1/256 */
    uint32_t steps;
    uint32_t overruns; /* how often control periods were skipped */
    unsigned notch_life;
    unsigned safe_ssc;       /* sequence counter of NOTCH_SDT */
    unsigned safe_emergency; /* and the command that it repeats */
    int32_t safe_code;
    unsigned status_life;
} railhil_law_t;

void railhil_law_init(railhil_law_t *law);

/* Takes the process data of a telegram received on a port. counts: counters of refusals, by outcome. */
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
