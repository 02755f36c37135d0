/* The exported control law @LAW@ as an FMI 2.0 co-simulation FMU: integers in, integers out, words of the C as they are.
 *
 * In the first step of each control period the law runs with the inputs of that instant; a step is at most a period.
 * Before it, the commands really sent (if RAILHIL_OTHER_SENT is not 0) are passed to the law.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2Functions.h"

#include "@LAW@.h"

/* Value references: inputs from 0, words of the result from RESULT on. */
enum { INPUTS = @INPUTS@, OTHER_SENT = @OTHER_SENT@, RESULT = 1000 };
#define PERIOD_S (@PREFIX@_PERIOD_NS * 1e-9)
/* Part of a period within which an instant is the beginning of the next. */
#define NEARLY 1e-6

/* All members have 32 bits, so the words of a result are contiguous. */
typedef struct {
    @LAW@_in_t in;
    @LAW@_state_t state;
    @LAW@_out_t out;
    iq_events_t events;
} result_t;

enum { RESULT_WORDS = sizeof(result_t) / sizeof(int32_t) };

typedef struct {
    int32_t input[INPUTS];
    union {
        result_t result;
        int32_t words[RESULT_WORDS];
    } of;
    double period; /* the last one in which the law ran; -1: it has not */
} instance_t;

static void begin(instance_t *one)
{
    memset(one, 0, sizeof *one);
    one->period = -1;
}

static void run(instance_t *one, int32_t k)
{
    const int32_t *input = one->input;
    result_t *result = &one->of.result;
    (void)k; /* not every kind of law counts its periods */
    if (one->period >= 0 && input[OTHER_SENT] != 0) {
        @LAW@_sent(&result->state, @TOLD@);
    }
    @LAW@_inputs(@GIVEN@, &result->in, &result->events);
    if (one->period < 0) {
        @LAW@_start(&result->in, &result->state);
    }
    @LAW@_step(&result->state, &result->in, &result->out, &result->events);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String place,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    instance_t *one;
    (void)name, (void)place, (void)functions, (void)visible, (void)logging;
    if (type != fmi2CoSimulation || guid == NULL || strcmp(guid, "@GUID@") != 0) {
        return NULL;
    }
    one = malloc(sizeof *one);
    if (one != NULL) {
        begin(one);
    }
    return one;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2Reset(fmi2Component c)
{
    begin(c);
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer value[])
{
    const instance_t *one = c;
    size_t i;
    for (i = 0; i < n; i++) {
        if (r[i] < INPUTS) {
            value[i] = one->input[r[i]];
        } else if (r[i] >= RESULT && r[i] < RESULT + RESULT_WORDS) {
            value[i] = one->of.words[r[i] - RESULT];
        } else {
            return fmi2Error;
        }
    }
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer value[])
{
    instance_t *one = c;
    size_t i;
    for (i = 0; i < n; i++) {
        if (r[i] >= INPUTS) {
            return fmi2Error;
        }
        one->input[r[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now_s, fmi2Real step_s, fmi2Boolean no_return)
{
    instance_t *one = c;
    const double period = floor(now_s / PERIOD_S + NEARLY);
    (void)no_return;
    if (!(step_s > 0) || step_s > PERIOD_S * (1 + NEARLY) || period < one->period || period > INT32_MAX) {
        return fmi2Error;
    }
    if (period > one->period) {
        run(one, (int32_t)period);
        one->period = period;
    }
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start_s,
                               fmi2Boolean has_stop, fmi2Real stop_s)
{
    (void)c, (void)has_tolerance, (void)tolerance, (void)start_s, (void)has_stop, (void)stop_s;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)c, (void)on, (void)n, (void)categories;
    return fmi2OK;
}

/* There are no variables of other types, and no states to keep or derivatives; an importer looks these up all the same. */
#define NONE(n) ((n) == 0 ? fmi2OK : fmi2Error)

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[])
{
    (void)c, (void)r, (void)v;
    return NONE(n);
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean v[])
{
    (void)c, (void)r, (void)v;
    return NONE(n);
}

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[])
{
    (void)c, (void)r, (void)v;
    return NONE(n);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[])
{
    (void)c, (void)r, (void)v;
    return NONE(n);
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Boolean v[])
{
    (void)c, (void)r, (void)v;
    return NONE(n);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[])
{
    (void)c, (void)r, (void)v;
    return NONE(n);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) { (void)c, (void)s; return fmi2Error; }
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) { (void)c, (void)s; return fmi2Error; }
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) { (void)c, (void)s; return fmi2Error; }

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n)
{
    (void)c, (void)s, (void)n;
    return fmi2Error;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n)
{
    (void)c, (void)s, (void)b, (void)n;
    return fmi2Error;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
{
    (void)c, (void)b, (void)n, (void)s;
    return fmi2Error;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu,
                                        const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[])
{
    (void)c, (void)u, (void)nu, (void)k, (void)nk, (void)dk, (void)du;
    return fmi2Error;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[],
                                       const fmi2Real v[])
{
    (void)c, (void)r, (void)n, (void)o, (void)v;
    return fmi2Error;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[],
                                        fmi2Real v[])
{
    (void)c, (void)r, (void)n, (void)o, (void)v;
    return fmi2Error;
}

/* No step is pending. */
fmi2Status fmi2CancelStep(fmi2Component c) { (void)c; return fmi2Error; }

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind k, fmi2Status *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind k, fmi2Real *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind k, fmi2Integer *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind k, fmi2String *v) { (void)c, (void)k, (void)v; return fmi2Discard; }
