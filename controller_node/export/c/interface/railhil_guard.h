/* Readings of the law: which telegrams are accepted, and their ages. */
#ifndef RAILHIL_GUARD_H
#define RAILHIL_GUARD_H

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

/* Of each port with readings: life sign of its last telegram, -1 before the first; time of the last accepted one. */
typedef struct {
    int lives[RAILHIL_SOURCE_COUNT];
    int known[RAILHIL_SOURCE_COUNT];
    int64_t taken_ns[RAILHIL_SOURCE_COUNT];
    int32_t raws[RAILHIL_GIVEN_COUNT]; /* readings of the last accepted telegrams */
} railhil_guard_t;

#endif
