/* What the FMU calls of the law @LAW@, which computes in single precision. */
#ifndef RAILHIL_FMU_LAW_H
#define RAILHIL_FMU_LAW_H

#include "@LAW@.h"

/* First of the inputs that are commands sent; the readings are before them. */
enum { SENT = @SENT@ };
/* Commands, then notes. */
enum { COMMANDS = @COMMANDS@, LAW_WORDS = @WORDS@ };

typedef struct {
    int32_t words[LAW_WORDS];
    @LAW@_state_t state;
} fmu_law_t;

static inline void law_sent(fmu_law_t *law, const int32_t *input) { @LAW@_sent(&law->state, input + SENT); }

/* k: number of the control period; a law in single precision counts for itself. */
static inline void law_step(fmu_law_t *law, const int32_t *input, int32_t k, int first)
{
    (void)k;
    if (first) {
        @LAW@_start(input, &law->state);
    }
    @LAW@_step(&law->state, input, law->words, law->words + COMMANDS);
}

#endif
