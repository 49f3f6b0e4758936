/* The functions of FMI 2.0 that a co-simulation needs.  Modes 1007 and 1008 fail and stop. */
#define FMI2_FUNCTION_PREFIX Servo_
#include "fmi2Functions.h"

#include <stdlib.h>
#include <string.h>

#include "law.h"

#define GUID "{6f1c9a0e-servo}"

enum { SETPOINT, POSITION, DUTY, KP, KI, INTEGRAL, RATE, START, REALS };

typedef struct {
    double reals[REALS];
    int integers[3];
    int booleans[2];
    law_t law;
    char *name;
    int stopped;
    const fmi2CallbackFunctions *functions;
} servo_t;

const int instances = 1; /* a global symbol, which another FMU may have too */

static double limit(double value)
{
    return value < 0.0 ? 0.0 : value;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    servo_t *self;
    (void)visible, (void)loggingOn;
    if (fmuType != fmi2CoSimulation || strcmp(fmuGUID, GUID) != 0 || fmuResourceLocation == NULL) {
        functions->logger(NULL, instanceName, fmi2Error, "error", "wrong FMU %s", fmuGUID);
        return NULL;
    }
    self = functions->allocateMemory(1, sizeof(servo_t));
    if (self == NULL) {
        return NULL;
    }
    self->name = strdup(instanceName);
    if (self->name == NULL) {
        functions->freeMemory(self);
        return NULL;
    }
    self->functions = functions;
    self->reals[KP] = 2.0;
    self->reals[KI] = 0.5;
    self->integers[2] = 4;
    return self;
}

void fmi2FreeInstance(fmi2Component c)
{
    servo_t *self = c;
    free(self->law.errors);
    free(self->name);
    self->functions->freeMemory(self);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    (void)toleranceDefined, (void)tolerance, (void)stopTimeDefined, (void)stopTime;
    ((servo_t *)c)->reals[START] = limit(startTime);
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    servo_t *self = c;
    self->law.size = self->integers[2];
    self->law.errors = calloc((size_t)self->law.size, sizeof(double));
    return self->law.errors == NULL ? fmi2Error : fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    servo_t *self = c;
    self->reals[DUTY] = self->booleans[0] ? self->reals[SETPOINT] : 0.0;
    return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    ((servo_t *)c)->reals[DUTY] = 0.0;
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    servo_t *self = c;
    double error = self->reals[SETPOINT] - self->reals[POSITION];
    (void)noSetFMUStatePriorToCurrentPoint;
    if (self->integers[0] == 1007) {
        return fmi2Error;
    }
    if (self->integers[0] == 1008) {
        self->stopped = 1;
        return fmi2Discard;
    }
    self->reals[DUTY] = 0.0;
    if (self->booleans[0]) {
        self->reals[DUTY] = law_step(&self->law, error, self->reals[KP], self->reals[KI], communicationStepSize);
    }
    self->reals[INTEGRAL] = self->law.integral;
    self->reals[RATE] = self->law.rate;
    self->integers[1] = (int)((currentCommunicationPoint + communicationStepSize) * 1000.0 + 0.5);
    self->booleans[1] = self->law.saturated;
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[])
{
    for (size_t i = 0; i < nvr; i++) {
        value[i] = ((servo_t *)c)->reals[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[])
{
    for (size_t i = 0; i < nvr; i++) {
        ((servo_t *)c)->reals[vr[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[])
{
    for (size_t i = 0; i < nvr; i++) {
        value[i] = ((servo_t *)c)->integers[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer value[])
{
    for (size_t i = 0; i < nvr; i++) {
        ((servo_t *)c)->integers[vr[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Boolean value[])
{
    for (size_t i = 0; i < nvr; i++) {
        value[i] = ((servo_t *)c)->booleans[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Boolean value[])
{
    for (size_t i = 0; i < nvr; i++) {
        ((servo_t *)c)->booleans[vr[i]] = value[i];
    }
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    if (s != fmi2Terminated) {
        return fmi2Discard;
    }
    *value = ((servo_t *)c)->stopped;
    return fmi2OK;
}
