/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The submodel `%SUBMODEL_NAME%` of 20-sim as re-entrant C: everything it remembers is in an instance.
 *
 *  subm:  %SUBMODEL_NAME%
 *  build: %GENERATION_BUILD%
 *
 *     static %SUBMODEL_NAME%_ModelInstance model;
 *     double u[] = {...}, y[...];
 *
 *     %SUBMODEL_NAME%_ModelInitialize(&model);           constants, parameters, initial values as in 20-sim
 *     model.%XX_PARAMETER_ARRAY_NAME%[2] = ...;          change some, if you like
 *     %SUBMODEL_NAME%_InitializeSubmodel(&model, u, y, 0.0);
 *     for (;;) {                                         every %TIME_STEP_SIZE% s
 *         %SUBMODEL_NAME%_CalculateSubmodel(&model, u, y);
 *     }
 *
 * 20-sim numbers the inputs `u`, the outputs `y` and the parameters by their names: adding one renumbers the others.
 */
#ifndef %SUBMODEL_NAME%_H
#define %SUBMODEL_NAME%_H

#ifdef __cplusplus
extern "C" {
#endif

#define %SUBMODEL_NAME%_STEP_SIZE %TIME_STEP_SIZE% /* s: time between two steps */
#define %SUBMODEL_NAME%_INPUTS %NUMBER_INPUTS%
#define %SUBMODEL_NAME%_OUTPUTS %NUMBER_OUTPUTS%
#define %SUBMODEL_NAME%_PARAMETERS %NUMBER_PARAMETERS%

typedef %EPG_REAL% %SUBMODEL_NAME%_real;

typedef struct %SUBMODEL_NAME%_ModelInstance {
%IF%%NUMBER_CONSTANTS%
    %SUBMODEL_NAME%_real %XX_CONSTANT_ARRAY_NAME%[%NUMBER_CONSTANTS%]; /* constants */
%ENDIF%
%IF%%NUMBER_PARAMETERS%
    %SUBMODEL_NAME%_real %XX_PARAMETER_ARRAY_NAME%[%NUMBER_PARAMETERS%]; /* parameters, see %SUBMODEL_NAME%_parameter_names */
%ENDIF%
%IF%%NUMBER_INITIAL_VALUES%
    %SUBMODEL_NAME%_real %XX_INITIAL_VALUE_ARRAY_NAME%[%NUMBER_INITIAL_VALUES%]; /* initial values of the states */
%ENDIF%
%IF%%NUMBER_VARIABLES%
    %SUBMODEL_NAME%_real %XX_VARIABLE_ARRAY_NAME%[%NUMBER_VARIABLES%]; /* variables */
%ENDIF%
%IF%%NUMBER_STATES%
    %SUBMODEL_NAME%_real %XX_STATE_ARRAY_NAME%[%NUMBER_STATES%]; /* states */
    %SUBMODEL_NAME%_real %XX_RATE_ARRAY_NAME%[%NUMBER_STATES%]; /* their rates; of a discrete model, the next states */
%ENDIF%
%IF%%NUMBER_UNNAMED%
    %SUBMODEL_NAME%_real %XX_UNNAMED_ARRAY_NAME%[%NUMBER_UNNAMED%]; /* intermediate results */
%ENDIF%
%IF%%NUMBEROF_DELAYFUNCTION%
    %SUBMODEL_NAME%_real delayed[%NUMBEROF_DELAYFUNCTION%]; /* what delay() returns in this step */
    %SUBMODEL_NAME%_real delay_inputs[%NUMBEROF_DELAYFUNCTION%]; /* and in the next one */
%ENDIF%
%IF%%NUMBEROF_INITIALFUNCTION%
    %SUBMODEL_NAME%_real first_values[%NUMBEROF_INITIALFUNCTION%]; /* what initial() returns */
%ENDIF%
    %SUBMODEL_NAME%_real time; /* s */
    %SUBMODEL_NAME%_real start_time; /* s, of the experiment */
    %SUBMODEL_NAME%_real finish_time; /* s, of the experiment: nothing ends there */
    %SUBMODEL_NAME%_real step_size; /* s */
    long steps; /* evaluations of the dynamic equations */
    unsigned random_state; /* of random(); never 0 */
    char initialize; /* 1 while the submodel is being initialised */
    char major; /* 0 within a step of a Runge Kutta method */
    char stop_simulation; /* 1: the model has executed stopsimulation */
} %SUBMODEL_NAME%_ModelInstance;

%IF%%NUMBER_INPUTS%
/** Names of the inputs, in the order of `u`; the last entry is NULL. */
extern const char *const %SUBMODEL_NAME%_input_names[];
%ENDIF%
%IF%%NUMBER_OUTPUTS%
/** Names of the outputs, in the order of `y`; the last entry is NULL. */
extern const char *const %SUBMODEL_NAME%_output_names[];
%ENDIF%
%IF%%NUMBER_PARAMETERS%
/** Names of the parameters, in the order of their array; the last entry is NULL. */
extern const char *const %SUBMODEL_NAME%_parameter_names[];
%ENDIF%

/** Sets all inputs to zero; and tells the index, the name and the {unit} of each. */
static inline void %SUBMODEL_NAME%_ClearInputs(%SUBMODEL_NAME%_real *u)
{
    (void)u;
%INITIALIZE_INPUTS%
}

/** Sets all outputs to zero; and tells the index, the name and the {unit} of each. */
static inline void %SUBMODEL_NAME%_ClearOutputs(%SUBMODEL_NAME%_real *y)
{
    (void)y;
%INITIALIZE_OUTPUTS%
}

/** Gives constants, parameters and initial values the values they have in 20-sim, and clears everything else. */
void %SUBMODEL_NAME%_ModelInitialize(%SUBMODEL_NAME%_ModelInstance *self);

/** Starts at time `t` in seconds: initial equations, static equations, the first outputs. */
void %SUBMODEL_NAME%_InitializeSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const %SUBMODEL_NAME%_real *u,
                                        %SUBMODEL_NAME%_real *y, %SUBMODEL_NAME%_real t);

/** One step: reads the inputs, moves time on by `step_size`, writes the outputs. */
void %SUBMODEL_NAME%_CalculateSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const %SUBMODEL_NAME%_real *u,
                                       %SUBMODEL_NAME%_real *y);

/** The final equations. */
void %SUBMODEL_NAME%_TerminateSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const %SUBMODEL_NAME%_real *u,
                                       %SUBMODEL_NAME%_real *y);

/** What the model derives from its parameters: call it after changing one between two steps. */
void %SUBMODEL_NAME%_CalculateStatic(%SUBMODEL_NAME%_ModelInstance *self);

#ifdef __cplusplus
}
#endif

#endif
