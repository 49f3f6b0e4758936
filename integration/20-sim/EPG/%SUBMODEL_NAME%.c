/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The equations of the submodel `%SUBMODEL_NAME%`.  20-sim has written the equations into a file of EPG.
 *
 *  subm:  %SUBMODEL_NAME%
 *  build: %GENERATION_BUILD%
 */
#include "%SUBMODEL_NAME%.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

%IF%%EPG_SINGLE%
/* The constants in the equations are doubles.  With single precision each of them is converted. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
#pragma GCC diagnostic ignored "-Wdouble-promotion"
#endif
%ENDIF%
/* 20-sim stores truth values in real variables; clang warns about these conversions. */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wfloat-conversion"
#endif
%IF%%NUMBER_DEPSTATES%
#error This model contains dependent states: exported code does not solve them
%ENDIF%
%IF%%NUMBER_ALGLOOPS%
#error This model contains algebraic loops: exported code does not solve them
%ENDIF%
%IF%%NUMBER_CONSTRAINTS%
#error This model contains constraint variables: exported code does not solve them
%ENDIF%
%IF%%NUMBER_MATRICES%
#error This model uses matrices: export it with the target C function or C++ class
%ENDIF%
%IF%%OR(NUMBER_IMPORTS,NUMBER_EXPORTS)%
#error This submodel uses global variables of the model around it: make them ports of the submodel
%ENDIF%

typedef %SUBMODEL_NAME%_real XXDouble;
typedef int XXInteger;
typedef char XXBoolean;
typedef const char *XXString;

/* The equations use these names for the members of the instance. */
%IF%%NUMBER_CONSTANTS%
#define %VARPREFIX%%XX_CONSTANT_ARRAY_NAME% self->%XX_CONSTANT_ARRAY_NAME%
%ENDIF%
%IF%%NUMBER_PARAMETERS%
#define %VARPREFIX%%XX_PARAMETER_ARRAY_NAME% self->%XX_PARAMETER_ARRAY_NAME%
%ENDIF%
%IF%%NUMBER_INITIAL_VALUES%
#define %VARPREFIX%%XX_INITIAL_VALUE_ARRAY_NAME% self->%XX_INITIAL_VALUE_ARRAY_NAME%
%ENDIF%
%IF%%NUMBER_VARIABLES%
#define %VARPREFIX%%XX_VARIABLE_ARRAY_NAME% self->%XX_VARIABLE_ARRAY_NAME%
%ENDIF%
%IF%%NUMBER_STATES%
#define %VARPREFIX%%XX_STATE_ARRAY_NAME% self->%XX_STATE_ARRAY_NAME%
#define %VARPREFIX%%XX_RATE_ARRAY_NAME% self->%XX_RATE_ARRAY_NAME%
%ENDIF%
%IF%%NUMBER_UNNAMED%
#define %VARPREFIX%%XX_UNNAMED_ARRAY_NAME% self->%XX_UNNAMED_ARRAY_NAME%
%ENDIF%
#define %VARPREFIX%%XX_TIME% self->time
#define %VARPREFIX%%XX_INITIALIZE% self->initialize
#define %VARPREFIX%start_time self->start_time
#define %VARPREFIX%finish_time self->finish_time
#define %VARPREFIX%step_size self->step_size
#define %VARPREFIX%steps self->steps
#define %VARPREFIX%major self->major
#define %VARPREFIX%stop_simulation self->stop_simulation
#define %VARPREFIX%state_count %NUMBER_STATES%

#include "sidops.h"

%IF%%NUMBER_INPUTS%
const char *const %SUBMODEL_NAME%_input_names[] = {
%INPUT_NAMES%,
    NULL
};
%ENDIF%
%IF%%NUMBER_OUTPUTS%
const char *const %SUBMODEL_NAME%_output_names[] = {
%OUTPUT_NAMES%,
    NULL
};
%ENDIF%
%IF%%NUMBER_PARAMETERS%
const char *const %SUBMODEL_NAME%_parameter_names[] = {
%PARAMETER_NAMES%,
    NULL
};
%ENDIF%

%IF%%NUMBEROF_DELAYFUNCTION%
/* Returns the value of `x` one step ago; in the first step `initial`. */
static XXDouble delay_of(%SUBMODEL_NAME%_ModelInstance *self, XXDouble x, XXDouble initial, XXInteger id)
{
    const XXDouble value = self->initialize ? initial : self->delayed[id];

    if (self->major) {
        self->delay_inputs[id] = x;
    }
    return value;
}
#define XXDelay(x, initial, id) delay_of(self, x, initial, id)

%ENDIF%
%IF%%NUMBEROF_INITIALFUNCTION%
/* Returns the value of `x` at the start. */
static XXDouble initial_value_of(%SUBMODEL_NAME%_ModelInstance *self, XXDouble x, XXInteger id)
{
    if (self->initialize) {
        self->first_values[id] = x;
    }
    return self->first_values[id];
}
#define XXInitialValue(x, id) initial_value_of(self, x, id)

%ENDIF%
static void calculate_initial(%SUBMODEL_NAME%_ModelInstance *self)
{
    (void)self;
%INITIAL_EQUATIONS%
}

void %SUBMODEL_NAME%_CalculateStatic(%SUBMODEL_NAME%_ModelInstance *self)
{
    (void)self;
%STATIC_EQUATIONS%
}

static void calculate_input(%SUBMODEL_NAME%_ModelInstance *self)
{
    (void)self;
%INPUT_EQUATIONS%
}

static void calculate_dynamic(%SUBMODEL_NAME%_ModelInstance *self)
{
%DYNAMIC_EQUATIONS%
    self->steps++;
}

static void calculate_output(%SUBMODEL_NAME%_ModelInstance *self)
{
    (void)self;
%OUTPUT_EQUATIONS%
%IF%%NUMBEROF_DELAYFUNCTION%
    memcpy(self->delayed, self->delay_inputs, sizeof self->delayed);
%ENDIF%
}

static void calculate_final(%SUBMODEL_NAME%_ModelInstance *self)
{
    (void)self;
%FINAL_EQUATIONS%
}

static void take_inputs(%SUBMODEL_NAME%_ModelInstance *self, const XXDouble *u)
{
    (void)self;
    (void)u;
%INPUT_TO_VARIABLE_EQUATIONS%
}

static void give_outputs(const %SUBMODEL_NAME%_ModelInstance *self, XXDouble *y)
{
    (void)self;
    (void)y;
%VARIABLE_TO_OUTPUT_EQUATIONS%
}

/* One step of the integration method. */
static void %INTEGRATION_METHOD_NAME%Step(%SUBMODEL_NAME%_ModelInstance *self)
{
%IF%%NUMBER_STATES%
%IF%%EQ(INTEGRATION_METHOD_NAME,Discrete)%
    memcpy(self->%XX_STATE_ARRAY_NAME%, self->%XX_RATE_ARRAY_NAME%, sizeof self->%XX_STATE_ARRAY_NAME%);
    self->time += self->step_size;
%ENDIF%
%IF%%EQ(INTEGRATION_METHOD_NAME,Euler)%
    for (int i = 0; i < %NUMBER_STATES%; i++) {
        self->%XX_STATE_ARRAY_NAME%[i] =
            self->%XX_STATE_ARRAY_NAME%[i] + self->%XX_RATE_ARRAY_NAME%[i] * self->step_size;
    }
    self->time += self->step_size;
%ENDIF%
%IF%%EQ(INTEGRATION_METHOD_NAME,RungeKutta2)%
    const XXDouble time = self->time;
    XXDouble start[%NUMBER_STATES%];

    memcpy(start, self->%XX_STATE_ARRAY_NAME%, sizeof start);
    for (int i = 0; i < %NUMBER_STATES%; i++) {
        self->%XX_STATE_ARRAY_NAME%[i] = start[i] + self->%XX_RATE_ARRAY_NAME%[i] * (XXDouble)0.5 * self->step_size;
    }
    self->time = time + (XXDouble)0.5 * self->step_size;
    self->major = 0;
    calculate_dynamic(self);
    for (int i = 0; i < %NUMBER_STATES%; i++) {
        self->%XX_STATE_ARRAY_NAME%[i] = start[i] + self->%XX_RATE_ARRAY_NAME%[i] * self->step_size;
    }
    self->time = time + self->step_size;
%ENDIF%
%IF%%EQ(INTEGRATION_METHOD_NAME,RungeKutta4)%
    const XXDouble time = self->time;
    const XXDouble half = self->step_size / 2;
    XXDouble start[%NUMBER_STATES%];
    XXDouble k[4][%NUMBER_STATES%]; /* the four slopes of the classical method, multiplied by the step size */

    memcpy(start, self->%XX_STATE_ARRAY_NAME%, sizeof start);
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < %NUMBER_STATES%; i++) {
            k[stage][i] = self->%XX_RATE_ARRAY_NAME%[i] * self->step_size;
        }
        if (stage == 3) {
            break;
        }
        for (int i = 0; i < %NUMBER_STATES%; i++) {
            self->%XX_STATE_ARRAY_NAME%[i] = start[i] + (stage < 2 ? k[stage][i] / 2 : k[stage][i]);
        }
        self->time = time + (stage < 2 ? half : self->step_size);
        self->major = 0;
        calculate_dynamic(self);
    }
    for (int i = 0; i < %NUMBER_STATES%; i++) {
        self->%XX_STATE_ARRAY_NAME%[i] =
            start[i] +
            (k[0][i] + k[1][i] + k[1][i] + k[2][i] + k[2][i] + k[3][i]) * ((XXDouble)1.0 / (XXDouble)6.0);
    }
%ENDIF%
%ELSE%
    self->time += self->step_size;
%ENDIF%
    self->major = 1;
    calculate_dynamic(self);
}

void %SUBMODEL_NAME%_ModelInitialize(%SUBMODEL_NAME%_ModelInstance *self)
{
    memset(self, 0, sizeof *self);
    self->start_time = %START_TIME%;
    self->finish_time = %FINISH_TIME%;
    self->step_size = %TIME_STEP_SIZE%;
    self->random_state = 1u;
    self->initialize = 1;
    self->major = 1;
%IF%%NUMBER_CONSTANTS%
%INITIALIZE_CONSTANTS%
%ENDIF%
%IF%%NUMBER_PARAMETERS%
%INITIALIZE_PARAMETERS%
%ENDIF%
%IF%%NUMBER_INITIAL_VALUES%
%INITIALIZE_INITIAL_VALUES%
%ENDIF%
}

void %SUBMODEL_NAME%_InitializeSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const XXDouble *u, XXDouble *y, XXDouble t)
{
    self->initialize = 1;
    self->major = 1;
    self->stop_simulation = 0;
    self->steps = 0;
    self->time = t;
%IF%%NUMBER_STATES%
%INITIALIZE_STATES%
%ENDIF%
    take_inputs(self, u);
    calculate_initial(self);
    %SUBMODEL_NAME%_CalculateStatic(self);
    calculate_input(self);
    calculate_dynamic(self);
    calculate_output(self);
    give_outputs(self, y);
    self->initialize = 0;
}

void %SUBMODEL_NAME%_CalculateSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const XXDouble *u, XXDouble *y)
{
    take_inputs(self, u);
    calculate_input(self);
    %INTEGRATION_METHOD_NAME%Step(self);
    calculate_output(self);
    give_outputs(self, y);
}

void %SUBMODEL_NAME%_TerminateSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const XXDouble *u, XXDouble *y)
{
    take_inputs(self, u);
    calculate_final(self);
    give_outputs(self, y);
}
