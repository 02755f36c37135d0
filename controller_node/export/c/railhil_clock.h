/* Simulation time on the bus, and 64-bit arithmetic. Integers only; periods and identifiers are in @LAW@_node.h. */
#ifndef RAILHIL_CLOCK_H
#define RAILHIL_CLOCK_H

#include "railhil_mvb.h"

/* The clock port is the first of the received ports. */
enum { RAILHIL_CLOCK_PORT = 0 };

/* Simulation time in base ticks, counted from the life sign of the clock port. */
typedef struct {
    int64_t tick;
    int64_t frame_tick; /* tick of the last clock frame */
    int64_t poll_tick;  /* tick of the first poll since then */
    int64_t polls;      /* polls since then */
    int life;     /* of the last clock frame, -1: not known */
    int expected; /* life sign that would confirm that an apparently old frame is a new one; -1: none */
    int running;
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

/* Take a frame of the clock port, before it is handled as a telegram; a poll that comes every period_ticks; a
 * TIME_SYNC. */
void railhil_clock_frame(railhil_clock_t *clock, unsigned length, const unsigned char *data);
void railhil_clock_poll(railhil_clock_t *clock, int64_t period_ticks);
void railhil_time_sync(railhil_clock_t *clock, const unsigned char *process);

#endif
