/* What the FMU calls of the law @LAW@. */
#ifndef RAILHIL_FMU_LAW_H
#define RAILHIL_FMU_LAW_H

#include "railhil_result.h"

typedef union {
    result_t result;
    int32_t words[RESULT_WORDS];
} fmu_law_t;

static inline void law_sent(fmu_law_t *law, const int32_t *input)
{
    @LAW@_sent(&law->result.state, @TOLD@);
}

/* k: number of the control period, which not every kind of law needs. */
static inline void law_step(fmu_law_t *law, const int32_t *input, int32_t k, int first)
{
    result_t *result = &law->result;
    (void)k;
    @LAW@_inputs(@GIVEN@, &result->in, &result->events);
    if (first) {
        @LAW@_start(&result->in, &result->state);
    }
    @LAW@_step(&result->state, &result->in, &result->out, &result->events);
}

#endif
