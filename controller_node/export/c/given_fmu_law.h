/* What the FMU calls of the controller @LAW@. */
#ifndef RAILHIL_FMU_LAW_H
#define RAILHIL_FMU_LAW_H

#include <math.h>

#include "@LAW@.h"

enum { RESULT_WORDS = @COMMANDS@ };

typedef struct {
    double words[RESULT_WORDS];
} fmu_law_t;

/* A controller of the user is given the commands really sent as readings. */
static inline void law_sent(fmu_law_t *law, const double *input)
{
    (void)law;
    (void)input;
}

__attribute__((weak)) void @LAW@_reset(void)
{
}

static inline void law_step(fmu_law_t *law, const double *input, int32_t k, int first)
{
    const @LAW@_readings_t in = {@READINGS@};
    @LAW@_commands_t out = {@NANS@};
    (void)k;
    if (first) {
        @LAW@_reset();
    }
    @LAW@_step(&in, &out);
@ANSWERS@
}

#endif
