/* The functions of FMI 3.0 that a co-simulation needs.  Mask 255 stops, gain 99 fails. */
#include "fmi3Functions.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "axes.h"

const int instances = 1;

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate)
{
    axes_t *self;
    (void)instanceName, (void)resourcePath, (void)visible, (void)loggingOn, (void)requiredIntermediateVariables;
    (void)intermediateUpdate;
    if (eventModeUsed || earlyReturnAllowed || nRequiredIntermediateVariables != 0) {
        return NULL;
    }
    if (strcmp(instantiationToken, "{axes-1}") != 0) {
        logMessage(instanceEnvironment, fmi3Error, "error", "wrong FMU");
        return NULL;
    }
    self = calloc(1, sizeof(axes_t));
    if (self != NULL) {
        self->slope = 0.25;
        self->offset = -1;
    }
    return self;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    free(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    (void)toleranceDefined, (void)tolerance, (void)stopTimeDefined, (void)stopTime;
    ((axes_t *)instance)->next = startTime;
    return fmi3OK;
}

static void compute(axes_t *self)
{
    for (int i = 0; i < AXES; i++) {
        double on = (self->mask >> i & 1) != 0 ? 1.0 : 0.0;
        self->duty[i] = on * (double)self->gain * self->setpoint[i] * (i + 1) + self->x + self->offset;
    }
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    compute(instance);
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    memset(((axes_t *)instance)->duty, 0, sizeof(double) * AXES);
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    axes_t *self = instance;
    (void)noSetFMUStatePriorToCurrentPoint;
    if (fabs(currentCommunicationPoint - self->next) > 1e-12 || self->gain == 99.0f) {
        return fmi3Error; /* the time must be the one of the last step's end */
    }
    self->next = currentCommunicationPoint + communicationStepSize;
    for (int k = 0; k < 4; k++) { /* the internal step is a quarter */
        self->rate = self->hold ? 0.0 : self->slope * self->setpoint[0] - self->x;
        self->x += self->rate * communicationStepSize / 4.0;
    }
    self->count += 1;
    compute(self);
    *eventHandlingNeeded = false;
    *terminateSimulation = self->mask == 255;
    *earlyReturn = false;
    *lastSuccessfulTime = self->next;
    return fmi3OK;
}

static fmi3Float64 *place(axes_t *self, fmi3ValueReference reference, size_t *count)
{
    *count = 1;
    switch (reference) {
    case 1:
        *count = AXES;
        return self->setpoint;
    case 5:
        *count = AXES;
        return self->duty;
    case 8:
        return &self->slope;
    case 11:
        return &self->x;
    case 12:
        return &self->rate;
    default:
        return NULL;
    }
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          fmi3Float64 values[], size_t nValues)
{
    size_t at = 0;
    for (size_t i = 0; i < nValueReferences; i++) {
        size_t count;
        fmi3Float64 *from = place(instance, valueReferences[i], &count);
        if (from == NULL || at + count > nValues) {
            return fmi3Error;
        }
        memcpy(&values[at], from, count * sizeof *values);
        at += count;
    }
    return at == nValues ? fmi3OK : fmi3Error;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          const fmi3Float64 values[], size_t nValues)
{
    size_t at = 0;
    for (size_t i = 0; i < nValueReferences; i++) {
        size_t count;
        fmi3Float64 *to = place(instance, valueReferences[i], &count);
        if (to == NULL || at + count > nValues) {
            return fmi3Error;
        }
        memcpy(to, &values[at], count * sizeof *values);
        at += count;
    }
    return at == nValues ? fmi3OK : fmi3Error;
}

#define SCALAR(type, get, set, reference, member)                                                                      \
    fmi3Status get(fmi3Instance instance, const fmi3ValueReference references[], size_t n, type values[], size_t m)    \
    {                                                                                                                  \
        (void)m;                                                                                                       \
        for (size_t i = 0; i < n; i++) {                                                                               \
            if (references[i] != (reference)) {                                                                        \
                return fmi3Error;                                                                                      \
            }                                                                                                          \
            values[i] = ((axes_t *)instance)->member;                                                                  \
        }                                                                                                              \
        return fmi3OK;                                                                                                 \
    }                                                                                                                  \
    fmi3Status set(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const type values[],        \
                   size_t m)                                                                                           \
    {                                                                                                                  \
        (void)m;                                                                                                       \
        for (size_t i = 0; i < n; i++) {                                                                               \
            if (references[i] != (reference)) {                                                                        \
                return fmi3Error;                                                                                      \
            }                                                                                                          \
            ((axes_t *)instance)->member = values[i];                                                                  \
        }                                                                                                              \
        return fmi3OK;                                                                                                 \
    }

SCALAR(fmi3Float32, fmi3GetFloat32, fmi3SetFloat32, 2, gain)
SCALAR(fmi3UInt8, fmi3GetUInt8, fmi3SetUInt8, 3, mask)
SCALAR(fmi3Int32, fmi3GetInt32, fmi3SetInt32, 9, offset)
SCALAR(fmi3Int64, fmi3GetInt64, fmi3SetInt64, 6, count)

fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          fmi3Boolean values[], size_t nValues)
{
    (void)valueReferences, (void)nValues;
    for (size_t i = 0; i < nValueReferences; i++) {
        values[i] = ((axes_t *)instance)->hold;
    }
    return fmi3OK;
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                          const fmi3Boolean values[], size_t nValues)
{
    (void)valueReferences, (void)nValues;
    for (size_t i = 0; i < nValueReferences; i++) {
        ((axes_t *)instance)->hold = values[i];
    }
    return fmi3OK;
}
