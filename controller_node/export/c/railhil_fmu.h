/* The @TITLE@ @LAW@ as an FMU, without the functions of a version of FMI: @VALUES@.
 *
 * In the first step of each control period the law runs with the inputs of that instant; a step is at most a period.
 * Before it, the commands really sent (if the input OTHER_SENT is not 0) are passed to the law.
 */
#ifndef RAILHIL_FMU_H
#define RAILHIL_FMU_H

#include <stddef.h>
#include <stdint.h>

#include "railhil_fmu_law.h"

/* GUID of FMI 2.0, instantiation token of FMI 3.0. */
#define FMU_TOKEN "@TOKEN@"

/* Value references: inputs from 0, the time, words of the result from RESULT on. */
enum { INPUTS = @INPUTS@, OTHER_SENT = @OTHER_SENT@, TIME = 999, RESULT = 1000 };

typedef struct {
    @NUMBER@ input[INPUTS];
    fmu_law_t law;
    double period; /* the last one in which the law ran; -1: it has not */
    double time_s; /* at the end of the last step */
} fmu_t;

/* A new instance, at the beginning of a run; NULL: the token is that of another FMU, or there is no memory. */
fmu_t *fmu_new(const char *token);

/* Begin a run. */
void fmu_begin(fmu_t *one);

/* Words by their value references; 0: there is no such word. */
int fmu_get(const fmu_t *one, const uint32_t *references, size_t count, @NUMBER@ *values);
int fmu_set(fmu_t *one, const uint32_t *references, size_t count, const @NUMBER@ *values);

/* Keep all of an instance in *state (NULL: a new one), and go back to it; 0: no memory, or no state. */
int fmu_keep(const fmu_t *one, void **state);
int fmu_go_back(fmu_t *one, const void *state);

/* A state as bytes: the token, then the state as this binary keeps it. 0: too few bytes, or the bytes of another FMU. */
enum { STATE_BYTES = sizeof FMU_TOKEN + sizeof(fmu_t) };
int fmu_to_bytes(const void *state, void *bytes, size_t count);
int fmu_from_bytes(const void *bytes, size_t count, void **state);

/* A step; 0: it is longer than a period, or begins before the last one. */
int fmu_step(fmu_t *one, double now_s, double step_s);

#endif
