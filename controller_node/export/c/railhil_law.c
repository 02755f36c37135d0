/* Control periods of the law, and what is sent instead of its commands: see railhil_law.h. */
#include "railhil_law.h"

void railhil_law_init(railhil_law_t *law)
{
    int i;
    memset(law, 0, sizeof *law);
    railhil_guard_init(&law->guard);
    for (i = 0; i < RAILHIL_SENT_COUNT; i++) {
        law->lives[i] = RAILHIL_LIFE_START;
    }
    law->period = -1;
}

/* Runs the law if a control period has begun since its last step and the guard has its inputs. */
static void step(railhil_law_t *law, const railhil_clock_t *clock)
{
    const int64_t period = railhil_now_ns(clock) / @PREFIX@_PERIOD_NS;
    int32_t given[RAILHIL_GIVEN_COUNT];
    uint32_t began;
    if (period == law->period || !railhil_guard_inputs(&law->guard, clock, period, law->period, given)) {
        return;
    }
    began = RAILHIL_TICKS();
    @LAW@_inputs(@GIVEN@, &law->in, &law->events);
    if (law->steps == 0) {
        @LAW@_start(&law->in, &law->state);
    }
    @LAW@_step(&law->state, &law->in, &law->out, &law->events);
    law->ticks = RAILHIL_TICKS() - began;
    law->period = period;
    law->steps++;
}

void railhil_law_command(railhil_law_t *law, const railhil_clock_t *clock, int32_t *commands, uint32_t *counts)
{
    int is_told;
    step(law, clock);
@COMMANDS@
    is_told = railhil_guard_commands(&law->guard, clock, law->steps, commands, counts);
    if (is_told && law->steps != 0) {
        @LAW@_sent(&law->state, @SENT@);
    }
}
