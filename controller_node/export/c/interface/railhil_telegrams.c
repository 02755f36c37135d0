/* Readings, commands and status of the law, and the ages of the readings: see railhil_law.h. */
#include "railhil_law.h"

/* The telegram has no life sign. */
enum { NO_LIFE = -1 };

static const char *const outcome_names[RAILHIL_COUNTS - RAILHIL_CLOCK_OUTCOMES] = {
    "duplicate",
    "out_of_order",
    "gap",
    "check_variable",
    "stale",
};

const char *railhil_law_outcome(unsigned index)
{
    return outcome_names[index - RAILHIL_CLOCK_OUTCOMES];
}

void railhil_guard_init(railhil_guard_t *guard)
{
    int i;
    for (i = 0; i < RAILHIL_SOURCE_COUNT; i++) {
        guard->lives[i] = -1;
    }
}

/* Accepts the telegram of a port with readings if its life sign is new and all its check variables are correct, as far
 * as it has them; returns 1 if so. */
static int accept(railhil_guard_t *guard, int source, int64_t now_ns, int life, int is_correct, uint32_t *counts)
{
    if (life != NO_LIFE) {
        const railhil_life_t judged = railhil_life(guard->lives[source], life);
        if (judged == RAILHIL_REPEATED || judged == RAILHIL_OLD) {
            /* Nothing new: the age of the readings keeps growing. */
            counts[judged == RAILHIL_OLD ? RAILHIL_READING_OUT_OF_ORDER : RAILHIL_READING_DUPLICATE]++;
            return 0;
        }
        if (judged == RAILHIL_GAP) {
            counts[RAILHIL_READING_GAP]++;
        }
        guard->lives[source] = life;
    }
    if (!is_correct) {
        counts[RAILHIL_READING_CHECK]++;
        return 0;
    }
    guard->taken_ns[source] = now_ns;
    guard->known[source] = 1;
    return 1;
}

void railhil_law_take(railhil_law_t *law, const railhil_clock_t *clock, int port, const unsigned char *process,
                      uint32_t *counts)
{
    railhil_guard_t *guard = &law->guard;
    const int64_t now_ns = railhil_own_ns(clock);
    switch (port) {
@TAKEN@
    default: /* no readings */
        break;
    }
}

static int is_fresh(const railhil_guard_t *guard, const railhil_clock_t *clock)
{
    const int64_t now_ns = railhil_own_ns(clock);
    int i;
    for (i = 0; i < RAILHIL_SOURCE_COUNT; i++) {
        if (!guard->known[i] || now_ns - guard->taken_ns[i] > railhil_ages_ns[i]) {
            return 0;
        }
    }
    return 1;
}

int railhil_guard_inputs(railhil_guard_t *guard, const railhil_clock_t *clock, int64_t period, int64_t last,
                         int32_t *given)
{
    (void)period;
    (void)last;
    memcpy(given, guard->raws, sizeof guard->raws);
    return clock->running && is_fresh(guard, clock);
}

/* The safe commands while a reading is missing or too old. */
int railhil_guard_commands(railhil_guard_t *guard, const railhil_clock_t *clock, uint32_t steps, int32_t *commands,
                           uint32_t *counts)
{
    if (steps != 0 && is_fresh(guard, clock)) {
        return 0;
    }
    memcpy(commands, railhil_safe, sizeof railhil_safe);
    counts[RAILHIL_STALE] += steps != 0 ? 1u : 0u;
    return 1;
}

/* The ages of the readings are looked at when commands are sent. */
void railhil_law_look(railhil_law_t *law, const railhil_clock_t *clock)
{
    (void)law;
    (void)clock;
}

/* Notes and flags count from the law's first step on. */
void railhil_law_answer(railhil_law_t *law, const railhil_clock_t *clock, int port, unsigned char *process,
                        uint32_t *counts)
{
    int32_t commands[RAILHIL_COMMAND_COUNT];
    switch (port) {
@ANSWERS@
    default: /* nothing else is polled */
        break;
    }
}
