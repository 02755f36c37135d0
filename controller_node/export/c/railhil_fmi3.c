/* The functions of FMI 3.0 co-simulation around the exported law @LAW@. */
#include <stdlib.h>

#include "fmi3Functions.h"

#include "railhil_fmu.h"

static fmi3Status status(int done) { return done ? fmi3OK : fmi3Error; }

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean event_mode, fmi3Boolean early_return,
                                         const fmi3ValueReference required[], size_t count,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update)
{
    return fmu_new(token);
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                          fmi3Boolean logging, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log)
{
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                               fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    return NULL;
}

void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3Reset(fmi3Instance c)
{
    fmu_begin(c);
    return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
                                       fmi3Float64 start_s, fmi3Boolean has_stop, fmi3Float64 stop_s)
{
    ((fmu_t *)c)->time_s = start_s;
    return fmi3OK;
}

/* Without event mode an instance is in step mode from here on. */
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) { return fmi3OK; }
fmi3Status fmi3Terminate(fmi3Instance c) { return fmi3OK; }
fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) { return fmi3OK; }

fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Int32 v[], size_t values)
{
    return status(values == n && fmu_get(c, r, n, v));
}

fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 v[], size_t values)
{
    return status(values == n && fmu_set(c, r, n, v));
}

/* The time is the only variable of this type. */
fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[], size_t values)
{
    size_t i;
    for (i = 0; i < n && i < values && r[i] == TIME; i++) {
        v[i] = ((const fmu_t *)c)->time_s;
    }
    return status(values == n && i == n);
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 now_s, fmi3Float64 step_s, fmi3Boolean no_return, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached_s)
{
    const int done = fmu_step(c, now_s, step_s);
    *event = *terminate = *early = fmi3False;
    *reached_s = ((const fmu_t *)c)->time_s;
    return status(done);
}

/* There are no variables of other types; an importer looks these functions up all the same. */
#define NO_VALUES_TO_SET(TYPE) \
    fmi3Status fmi3Set##TYPE(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3##TYPE v[], size_t m) \
    { \
        return status(n == 0); \
    }
#define NONE_OF(TYPE) \
    fmi3Status fmi3Get##TYPE(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3##TYPE v[], size_t m) \
    { \
        return status(n == 0); \
    } \
    NO_VALUES_TO_SET(TYPE)

NO_VALUES_TO_SET(Float64)
NONE_OF(Float32)
NONE_OF(Int8)
NONE_OF(UInt8)
NONE_OF(Int16)
NONE_OF(UInt16)
NONE_OF(UInt32)
NONE_OF(Int64)
NONE_OF(UInt64)
NONE_OF(Boolean)
NONE_OF(String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, size_t sizes[], fmi3Binary v[], size_t m)
{
    return status(n == 0);
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference r[], size_t n, const size_t sizes[],
                         const fmi3Binary v[], size_t m)
{
    return status(n == 0);
}

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Clock v[]) { return status(n == 0); }

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Clock v[])
{
    return status(n == 0);
}

/* Not declared in modelDescription.xml: other modes, events, clocks, derivatives. */
fmi3Status fmi3EnterEventMode(fmi3Instance c) { return fmi3Error; }
fmi3Status fmi3EnterStepMode(fmi3Instance c) { return fmi3Error; }
fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) { return fmi3Error; }
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) { return fmi3Error; }
fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) { return fmi3Error; }
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) { return fmi3Error; }
fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 t) { return fmi3Error; }
fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference r, fmi3Float64 t) { return fmi3Error; }

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *update, fmi3Boolean *terminate, fmi3Boolean *nominals,
                                    fmi3Boolean *values, fmi3Boolean *next, fmi3Float64 *next_s)
{
    return fmi3Error;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *terminate)
{
    return fmi3Error;
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference r, size_t *n) { return fmi3Error; }

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference r, size_t of[], fmi3ValueReference on[],
                                       size_t from[], fmi3DependencyKind kinds[], size_t n)
{
    return fmi3Error;
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *s) { return status(fmu_keep(c, s)); }
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState s) { return status(fmu_go_back(c, s)); }

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *s)
{
    if (s != NULL) {
        free(*s);
        *s = NULL;
    }
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState s, size_t *n)
{
    *n = STATE_BYTES;
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState s, fmi3Byte b[], size_t n) { return status(fmu_to_bytes(s, b, n)); }

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte b[], size_t n, fmi3FMUState *s)
{
    return status(fmu_from_bytes(b, n, s));
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, const fmi3ValueReference u[], size_t nu,
                                        const fmi3ValueReference k[], size_t nk, const fmi3Float64 seed[], size_t seeds,
                                        fmi3Float64 d[], size_t nd)
{
    return fmi3Error;
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, const fmi3ValueReference u[], size_t nu,
                                    const fmi3ValueReference k[], size_t nk, const fmi3Float64 seed[], size_t seeds,
                                    fmi3Float64 d[], size_t nd)
{
    return fmi3Error;
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference r[], size_t n, const fmi3Int32 orders[],
                                    fmi3Float64 v[], size_t m)
{
    return fmi3Error;
}

#define NO_CLOCK(NAME, TYPE) \
    fmi3Status NAME(fmi3Instance c, const fmi3ValueReference r[], size_t n, TYPE v[]) { return status(n == 0); }
#define NO_CLOCK_FRACTION(NAME, TYPE) \
    fmi3Status NAME(fmi3Instance c, const fmi3ValueReference r[], size_t n, TYPE v[], TYPE resolutions[]) \
    { \
        return status(n == 0); \
    }

NO_CLOCK(fmi3GetShiftDecimal, fmi3Float64)
NO_CLOCK(fmi3SetShiftDecimal, const fmi3Float64)
NO_CLOCK(fmi3SetIntervalDecimal, const fmi3Float64)
NO_CLOCK_FRACTION(fmi3GetShiftFraction, fmi3UInt64)
NO_CLOCK_FRACTION(fmi3SetShiftFraction, const fmi3UInt64)
NO_CLOCK_FRACTION(fmi3SetIntervalFraction, const fmi3UInt64)

fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3Float64 v[],
                                  fmi3IntervalQualifier qualifiers[])
{
    return status(n == 0);
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference r[], size_t n, fmi3UInt64 v[],
                                   fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
{
    return status(n == 0);
}

#define NO_STATES(NAME, TYPE) \
    fmi3Status NAME(fmi3Instance c, TYPE v[], size_t n) { return status(n == 0); }
#define NUMBER_IS_0(NAME) \
    fmi3Status NAME(fmi3Instance c, size_t *n) \
    { \
        *n = 0; \
        return fmi3OK; \
    }

NO_STATES(fmi3GetContinuousStates, fmi3Float64)
NO_STATES(fmi3SetContinuousStates, const fmi3Float64)
NO_STATES(fmi3GetContinuousStateDerivatives, fmi3Float64)
NO_STATES(fmi3GetEventIndicators, fmi3Float64)
NO_STATES(fmi3GetNominalsOfContinuousStates, fmi3Float64)
NUMBER_IS_0(fmi3GetNumberOfContinuousStates)
NUMBER_IS_0(fmi3GetNumberOfEventIndicators)
