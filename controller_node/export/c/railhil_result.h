/* All words of a control period of the law @LAW@: inputs, state, outputs, events. */
#ifndef RAILHIL_RESULT_H
#define RAILHIL_RESULT_H

#include "@LAW@.h"

/* All members have 32 bits, so the words of a result are contiguous. */
typedef struct {
    @LAW@_in_t in;
    @LAW@_state_t state;
    @LAW@_out_t out;
    iq_events_t events;
} result_t;

enum { RESULT_WORDS = sizeof(result_t) / sizeof(int32_t) };

#endif
