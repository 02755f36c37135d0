/* The law in the controller. The law itself, a function of its state and inputs, is in @LAW@.h.
 * The guard decides what the law is given, and what is sent instead of its commands. railhil_telegrams.c takes and
 * answers telegrams. Guard and telegrams belong to the kind of control; railhil_law.c, which runs the law, is the same
 * for all.
 */
#ifndef RAILHIL_LAW_H
#define RAILHIL_LAW_H

#include "@LAW@.h"
#include "@LAW@_node.h"
#include "railhil_guard.h"

/* A board that measures control periods names its counter of time here (-DRAILHIL_TICKS=board_ticks). */
#ifdef RAILHIL_TICKS
uint32_t RAILHIL_TICKS(void);
#else
#define RAILHIL_TICKS() UINT32_C(0)
#endif

typedef struct {
    railhil_guard_t guard;
    @LAW@_in_t in;
    @LAW@_state_t state;
    @LAW@_out_t out;
    iq_events_t events;
    int64_t period; /* number of the last control period, -1 before the first */
    uint32_t steps;
    uint32_t ticks; /* RAILHIL_TICKS during the last control period */
    unsigned lives[RAILHIL_SENT_COUNT]; /* last life sign of each port that is sent */
} railhil_law_t;

void railhil_law_init(railhil_law_t *law);

/* Code of a user in the place of a law calls it when it cannot go on; the program or board ends here. */
void railhil_fail(const char *line);

/* Runs the law if its next control period has begun. commands: those to send now, the law's or the guard's, which the
 * law is then told. */
void railhil_law_command(railhil_law_t *law, const railhil_clock_t *clock, int32_t *commands, uint32_t *counts);

/* The guard at the start of a run. */
void railhil_guard_init(railhil_guard_t *guard);

/* given: inputs of the law in a control period, in the order of its C function; last: number of the period that was
 * computed before, -1: none. Returns 0 if the law cannot be computed now. */
int railhil_guard_inputs(railhil_guard_t *guard, const railhil_clock_t *clock, int64_t period, int64_t last,
                         int32_t *given);

/* Replaces the law's commands by those to send now; steps: control periods computed so far, 0: the law has no commands
 * yet. Returns 1 if the law is to be told of them. */
int railhil_guard_commands(railhil_guard_t *guard, const railhil_clock_t *clock, uint32_t steps, int32_t *commands,
                           uint32_t *counts);

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

/* Overflow flags of a status: events in the law since its start. */
static inline int32_t railhil_law_flags(const railhil_law_t *law)
{
    return (law->events.saturations != 0 ? RAILHIL_OVERFLOW_SATURATION : 0) |
           (law->events.zero_divisions != 0 ? RAILHIL_OVERFLOW_DIVISION_BY_ZERO : 0);
}

/* The next life sign of a port that is sent. */
static inline int32_t railhil_law_life(railhil_law_t *law, int port)
{
    unsigned *life = &law->lives[port - RAILHIL_SINK_COUNT];
    *life = (*life + 1u) & 0xFu;
    return (int32_t)*life;
}

#endif
