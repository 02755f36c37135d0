/* Simulation time on the bus, and 64-bit arithmetic. Integers only; periods and identifiers are in @LAW@_node.h. */
#ifndef RAILHIL_CLOCK_H
#define RAILHIL_CLOCK_H

#include "railhil_mvb.h"

/* The clock port is the first of the received ports. */
enum { RAILHIL_CLOCK_PORT = 0 };

/* Counters of refused TIME_SYNC, after those of railhil_outcome_t. */
enum {
    RAILHIL_TIME_CHECK = RAILHIL_MVB_OUTCOMES, /* check variable not correct */
    RAILHIL_TIME_DUPLICATE,                    /* life sign repeated */
    RAILHIL_TIME_OUT_OF_ORDER,                 /* older than the last telegram */
    RAILHIL_TIME_BACKWARD,                     /* a time that has passed already */
    RAILHIL_TIME_AHEAD,                        /* further ahead than the clock's own count, and not confirmed */
    RAILHIL_CLOCK_OUTCOMES
};

/* Simulation time in base ticks, counted from the life sign of the clock port. */
typedef struct {
    int64_t tick;
    int64_t frame_tick; /* tick of the last clock frame */
    int64_t poll_tick;  /* tick of the first poll since then */
    int64_t polls;      /* polls since then */
    int life;     /* of the last clock frame, -1: not known */
    int expected; /* life sign that would confirm that an apparently old frame is a new one; -1: none */
    int sync_life;  /* of the last TIME_SYNC taken, -1 before the first */
    int ahead_life; /* of a TIME_SYNC refused as too far ahead, -1: none; the next one may confirm it */
    int64_t ahead_ticks;
    int64_t known_tick; /* since a silence the time is an estimate: the last tick before it, -1: it is none */
    int64_t spare_ns;   /* what of the silence is less than a tick */
    int64_t slow_tick;  /* own tick at which the life sign of the slow port was right */
    int64_t slow_ahead; /* by so many ticks it was ahead in the last telegram */
    int slow_life;       /* that life sign, -1 before the first */
    int slow_ahead_life; /* the one that was ahead, -1: none */
    int64_t began; /* tick at which a node that came late began to count */
    int running;
    int is_set; /* a TIME_SYNC has been taken: the time is that of the run */
} railhil_clock_t;

static inline int64_t railhil_lesser(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static inline int64_t railhil_greater(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static inline int64_t railhil_within(int64_t a, int64_t limit)
{
    return railhil_lesser(railhil_greater(a, -limit), limit);
}

static inline int64_t railhil_floored(int64_t a, int64_t divisor)
{
    return a / divisor - (a % divisor < 0 ? 1 : 0);
}

void railhil_clock_init(railhil_clock_t *clock);

/* Simulation time of the current tick. */
int64_t railhil_now_ns(const railhil_clock_t *clock);

/* The same from the beginning of this node's count, for ages: the leap of a node that comes late to the time of the run
 * is no time that has passed. */
int64_t railhil_own_ns(const railhil_clock_t *clock);

/* Take a frame of the clock port, before it is handled as a telegram; a poll that comes every period_ticks (with
 * RAILHIL_PACE_BEGINS tick 0 is that of the first one, if nothing else has begun the time by the second one); a
 * TIME_SYNC: returns 1 if it is taken. A repeated or forged TIME_SYNC must not stop the ageing of the last speed: it is
 * refused, and counted in counts, when its check variable is wrong, its life sign is not new, its time lies in the
 * past, or further ahead than life signs can bridge and the next TIME_SYNC has not confirmed it. */
void railhil_clock_frame(railhil_clock_t *clock, unsigned length, const unsigned char *data);
void railhil_clock_poll(railhil_clock_t *clock, int64_t period_ticks);
int railhil_time_sync(railhil_clock_t *clock, const unsigned char *process, uint32_t *counts);

/* Take the life sign of the slow port. A silence of the whole bus shifts the clock by whole turns of its life sign;
 * where two telegrams of the slow port in a row are ahead by the same number of turns, the clock follows. */
void railhil_clock_slow(railhil_clock_t *clock, int life);

/* Nothing was received for a time. The time after it is an estimate, which TIME_SYNC may take back. */
void railhil_clock_elapsed(railhil_clock_t *clock, int64_t elapsed_ns);

#endif
