/* The functions of FMI 2.0 co-simulation around the @WHAT@ @LAW@. */
#include <stdlib.h>

#include "fmi2Functions.h"

#include "railhil_fmu.h"

static fmi2Status status(int done) { return done ? fmi2OK : fmi2Error; }

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String place,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    return type == fmi2CoSimulation ? fmu_new(guid) : NULL;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2Reset(fmi2Component c)
{
    fmu_begin(c);
    return fmi2OK;
}

fmi2Status fmi2Get@TYPE@(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2@TYPE@ value[])
{
    return status(fmu_get(c, r, n, value));
}

fmi2Status fmi2Set@TYPE@(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2@TYPE@ value[])
{
    return status(fmu_set(c, r, n, value));
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real now_s, fmi2Real step_s, fmi2Boolean no_return)
{
    return status(fmu_step(c, now_s, step_s));
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance, fmi2Real start_s,
                               fmi2Boolean has_stop, fmi2Real stop_s)
{
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return fmi2OK; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    return fmi2OK;
}

/* There are no variables of other types, and no derivatives; an importer looks these up all the same. */
#define NONE_OF(TYPE) \
    fmi2Status fmi2Get##TYPE(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2##TYPE v[]) \
    { \
        return status(n == 0); \
    } \
    fmi2Status fmi2Set##TYPE(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2##TYPE v[]) \
    { \
        return status(n == 0); \
    }

NONE_OF(@OTHER@)
NONE_OF(Boolean)
NONE_OF(String)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) { return status(fmu_keep(c, s)); }
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) { return status(fmu_go_back(c, s)); }

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s)
{
    if (s != NULL) {
        free(*s);
        *s = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n)
{
    *n = STATE_BYTES;
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n) { return status(fmu_to_bytes(s, b, n)); }

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s)
{
    return status(fmu_from_bytes(b, n, s));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu,
                                        const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[])
{
    return fmi2Error;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[],
                                       const fmi2Real v[])
{
    return fmi2Error;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[],
                                        fmi2Real v[])
{
    return fmi2Error;
}

/* No step is pending. */
fmi2Status fmi2CancelStep(fmi2Component c) { return fmi2Error; }
fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind k, fmi2Status *v) { return fmi2Discard; }
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind k, fmi2Real *v) { return fmi2Discard; }
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind k, fmi2Integer *v) { return fmi2Discard; }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v) { return fmi2Discard; }
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind k, fmi2String *v) { return fmi2Discard; }
