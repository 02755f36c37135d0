/* A train's law between the telegrams: what it is given, what is answered, and the watch that stands over it. */
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
    int32_t told_code; /* the notch that the law believes to have been sent, 1/256 */
    uint32_t steps;
    uint32_t overruns; /* times that control periods were left out */
    unsigned notch_life;
    unsigned status_life;
} railhil_law_t;

void railhil_law_init(railhil_law_t *law);

/* Takes the process data of a telegram that was accepted on a port. counts: of refusals, by outcome. */
void railhil_law_take(railhil_law_t *law, const railhil_clock_t *clock, int port, const unsigned char *process,
                      uint32_t *counts);

/* Process data of the answer to a poll of a port, written over zeros. */
void railhil_law_answer(railhil_law_t *law, const railhil_clock_t *clock, int port, unsigned char *process,
                        uint32_t *counts);

/* Name of an outcome from RAILHIL_MVB_OUTCOMES on. */
const char *railhil_law_outcome(unsigned index);

#endif
