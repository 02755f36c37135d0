/* See railhil_fmu.h. */
#include "railhil_fmu.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PERIOD_S (@PERIOD_NS@ * 1e-9)
/* Part of a period within which an instant is the beginning of the next. */
#define NEARLY 1e-6

fmu_t *fmu_new(const char *token)
{
    fmu_t *one = NULL;
    if (token != NULL && strcmp(token, FMU_TOKEN) == 0) {
        one = malloc(sizeof *one);
    }
    if (one != NULL) {
        fmu_begin(one);
    }
    return one;
}

void fmu_begin(fmu_t *one)
{
    memset(one, 0, sizeof *one);
    one->period = -1;
}

int fmu_get(const fmu_t *one, const uint32_t *references, size_t count, @NUMBER@ *values)
{
    size_t i;
    for (i = 0; i < count; i++) {
        const uint32_t at = references[i];
        if (at < INPUTS) {
            values[i] = one->input[at];
        } else if (at >= RESULT && at < RESULT + RESULT_WORDS) {
            values[i] = one->law.words[at - RESULT];
        } else {
            return 0;
        }
    }
    return 1;
}

int fmu_set(fmu_t *one, const uint32_t *references, size_t count, const @NUMBER@ *values)
{
    size_t i;
    for (i = 0; i < count; i++) {
        if (references[i] >= INPUTS) {
            return 0;
        }
        one->input[references[i]] = values[i];
    }
    return 1;
}

int fmu_keep(const fmu_t *one, void **state)
{
    if (*state == NULL) {
        *state = malloc(sizeof *one);
    }
    if (*state == NULL) {
        return 0;
    }
    memcpy(*state, one, sizeof *one);
    return 1;
}

int fmu_go_back(fmu_t *one, const void *state)
{
    if (state == NULL) {
        return 0;
    }
    memcpy(one, state, sizeof *one);
    return 1;
}

int fmu_to_bytes(const void *state, void *bytes, size_t count)
{
    if (state == NULL || count < STATE_BYTES) {
        return 0;
    }
    memcpy(bytes, FMU_TOKEN, sizeof FMU_TOKEN);
    memcpy((char *)bytes + sizeof FMU_TOKEN, state, sizeof(fmu_t));
    return 1;
}

int fmu_from_bytes(const void *bytes, size_t count, void **state)
{
    fmu_t one;
    if (count != STATE_BYTES || memcmp(bytes, FMU_TOKEN, sizeof FMU_TOKEN) != 0) {
        return 0;
    }
    memcpy(&one, (const char *)bytes + sizeof FMU_TOKEN, sizeof one);
    return fmu_keep(&one, state);
}

int fmu_step(fmu_t *one, double now_s, double step_s)
{
    const double period = floor(now_s / PERIOD_S + NEARLY);
    if (!(step_s > 0) || step_s > PERIOD_S * (1 + NEARLY) || period < one->period || period > INT32_MAX) {
        return 0;
    }
    if (period > one->period) {
        if (one->period >= 0 && one->input[OTHER_SENT] != 0) {
            law_sent(&one->law, one->input);
        }
        law_step(&one->law, one->input, (int32_t)period, one->period < 0);
        one->period = period;
    }
    one->time_s = now_s + step_s;
    return 1;
}
