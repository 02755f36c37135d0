/* A train as an FMI 2.0 co-simulation FMU: first-order actuator, limits of force and power, Davis resistance, grade.
 * Written from the equations in docs/howto/fmi.md, for the tests of --plant-fmu. Position, speed and force, midpoint rule.
 * With mass 1 forces are accelerations. */
#include <math.h>
#include <stdlib.h>
#include <time.h>
#include "fmi2Functions.h"

enum { FORCE, ALLOWED, BRAKE_MIN, GRADE, POSITION, SPEED, EFFORT, MASS, POLE, A, B, C, PER_PERMIL, TRACTION_MAX,
       BRAKE_MAX, TRACTION_POWER, BRAKE_POWER, OUTSIDE, START_SPEED, START_EFFORT, COUNT };

typedef struct { double v[COUNT]; double actuator; } train_t;

static double limit(double force, double power, double speed) {
    return force * speed > power ? power / speed : force;
}

static double clipped(const train_t *t, double force, double speed) {
    double low = -limit(t->v[BRAKE_MAX], t->v[BRAKE_POWER], speed);
    double high = limit(t->v[TRACTION_MAX], t->v[TRACTION_POWER], speed);
    if (t->v[BRAKE_MIN] > 0) high = fmax(low, -t->v[BRAKE_MIN]);
    else if (t->v[ALLOWED] < 0.5) high = 0;
    return fmin(fmax(force, low), high);
}

static double resistance(const train_t *t, double speed) {
    return t->v[A] + speed * (t->v[B] + speed * t->v[C]) + t->v[PER_PERMIL] * t->v[GRADE] - t->v[OUTSIDE];
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String k[]) {
    (void)c; (void)on; (void)n; (void)k; return fmi2OK;
}
fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String place,
                              const fmi2CallbackFunctions *f, fmi2Boolean visible, fmi2Boolean log) {
    (void)name; (void)type; (void)guid; (void)place; (void)f; (void)visible; (void)log;
    train_t *t = calloc(1, sizeof(train_t));
    if (t) { t->v[ALLOWED] = 1; t->v[MASS] = 1; t->v[POLE] = 1; t->v[TRACTION_POWER] = t->v[BRAKE_POWER] = INFINITY;
             t->v[TRACTION_MAX] = t->v[BRAKE_MAX] = INFINITY; }
    return t;
}
void fmi2FreeInstance(fmi2Component c) { free(c); }
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean d, fmi2Real t, fmi2Real s, fmi2Boolean e, fmi2Real p) {
    (void)c; (void)d; (void)t; (void)s; (void)e; (void)p; return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    train_t *t = c;
    t->v[SPEED] = t->v[START_SPEED];
    t->v[EFFORT] = t->actuator = t->v[START_EFFORT];
    return fmi2OK;
}
fmi2Status fmi2Terminate(fmi2Component c) { (void)c; return fmi2OK; }
fmi2Status fmi2Reset(fmi2Component c) { (void)c; return fmi2Error; }
fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Real v[]) {
    for (size_t i = 0; i < n; i++) v[i] = ((train_t *)c)->v[r[i]];
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Real v[]) {
    for (size_t i = 0; i < n; i++) ((train_t *)c)->v[r[i]] = v[i];
    return fmi2OK;
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real at, fmi2Real h, fmi2Boolean keep) {
    train_t *t = c;
    (void)at; (void)keep;
    if (h <= 0) return fmi2Error;
    double steady = t->v[FORCE], speed = t->v[SPEED];
    if (t->v[ALLOWED] < 0.5 && t->actuator > 0) t->actuator = 0;
    double offset = t->actuator - steady, decay = exp(-t->v[POLE] * h);
    double mean = steady + offset * (1 - decay) / (t->v[POLE] * h);
    double rate = (clipped(t, t->actuator, speed) - resistance(t, speed)) / t->v[MASS];
    double middle = fmax(0, speed + rate * h / 2);
    double accel = (clipped(t, mean, middle) - resistance(t, middle)) / t->v[MASS];
    double next = speed + accel * h, moving = h;
    if (next <= 0) {
        moving = accel < 0 ? fmin(h, -speed / accel) : 0;
        next = 0;
    }
    t->v[POSITION] += (speed + next) / 2 * moving;
    t->v[SPEED] = next;
    t->actuator = steady + offset * decay;
    t->v[EFFORT] = clipped(t, t->actuator, next);
#ifdef DRIFT
    t->v[EFFORT] += clock() * 1e-9;
#endif
    return fmi2OK;
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Integer v[]) { (void)c; (void)r; (void)v; return n ? fmi2Error : fmi2OK; }
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2Boolean v[]) { (void)c; (void)r; (void)v; return n ? fmi2Error : fmi2OK; }
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) { (void)c; (void)r; (void)v; return n ? fmi2Error : fmi2OK; }
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer v[]) { (void)c; (void)r; (void)v; return n ? fmi2Error : fmi2OK; }
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Boolean v[]) { (void)c; (void)r; (void)v; return n ? fmi2Error : fmi2OK; }
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[]) { (void)c; (void)r; (void)v; return n ? fmi2Error : fmi2OK; }
fmi2Status fmi2CancelStep(fmi2Component c) { (void)c; return fmi2Error; }
/* Not supported, but every importer looks them up. */
fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *s) { (void)c; (void)s; return fmi2Error; }
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate s) { (void)c; (void)s; return fmi2Error; }
fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *s) { (void)c; (void)s; return fmi2Error; }
fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate s, size_t *n) { (void)c; (void)s; (void)n; return fmi2Error; }
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate s, fmi2Byte b[], size_t n) { (void)c; (void)s; (void)b; (void)n; return fmi2Error; }
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte b[], size_t n, fmi2FMUstate *s) { (void)c; (void)b; (void)n; (void)s; return fmi2Error; }
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference u[], size_t nu, const fmi2ValueReference k[], size_t nk, const fmi2Real dk[], fmi2Real du[]) { (void)c; (void)u; (void)nu; (void)k; (void)nk; (void)dk; (void)du; return fmi2Error; }
fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[], const fmi2Real v[]) { (void)c; (void)r; (void)n; (void)o; (void)v; return fmi2Error; }
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2Integer o[], fmi2Real v[]) { (void)c; (void)r; (void)n; (void)o; (void)v; return fmi2Error; }
fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind k, fmi2Status *v) { (void)c; (void)k; (void)v; return fmi2Discard; }
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind k, fmi2Real *v) { (void)c; (void)k; (void)v; return fmi2Discard; }
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind k, fmi2Integer *v) { (void)c; (void)k; (void)v; return fmi2Discard; }
fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind k, fmi2Boolean *v) { (void)c; (void)k; (void)v; return fmi2Discard; }
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind k, fmi2String *v) { (void)c; (void)k; (void)v; return fmi2Discard; }
