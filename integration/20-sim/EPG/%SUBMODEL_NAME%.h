/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The submodel `%SUBMODEL_NAME%` of 20-sim as re-entrant C: its complete state is in an instance.
 *
 *  subm:  %SUBMODEL_NAME%
 *  build: %GENERATION_BUILD%
 *
 *     static %SUBMODEL_NAME%_ModelInstance model;
 *     double u[] = {...}, y[...];
 *
 *     %SUBMODEL_NAME%_ModelInitialize(&model);           constants, parameters, initial values as in 20-sim
 *     model.%XX_PARAMETER_ARRAY_NAME%[2] = ...;          optional: other values of parameters
 *     %SUBMODEL_NAME%_InitializeSubmodel(&model, u, y, 0.0);
 *     for (;;) {                                         every %TIME_STEP_SIZE% s
 *         %SUBMODEL_NAME%_CalculateSubmodel(&model, u, y);
 *     }
 *
 * 20-sim numbers the inputs `u`, the outputs `y` and the parameters in the order of their names.  A new one can
 * therefore change the numbers of the others.
 *
 * All functions of one instance must be called by one thread at a time.  Different instances are independent.
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
    %SUBMODEL_NAME%_real %XX_RATE_ARRAY_NAME%[%NUMBER_STATES%]; /* rates of the states; if discrete, the next states */
%ENDIF%
%IF%%NUMBER_UNNAMED%
    %SUBMODEL_NAME%_real %XX_UNNAMED_ARRAY_NAME%[%NUMBER_UNNAMED%]; /* intermediate results */
%ENDIF%
%IF%%NUMBEROF_DELAYFUNCTION%
    %SUBMODEL_NAME%_real delayed[%NUMBEROF_DELAYFUNCTION%]; /* values that delay() returns in this step */
    %SUBMODEL_NAME%_real delay_inputs[%NUMBEROF_DELAYFUNCTION%]; /* values that delay() returns in the next step */
%ENDIF%
%IF%%NUMBEROF_INITIALFUNCTION%
    %SUBMODEL_NAME%_real first_values[%NUMBEROF_INITIALFUNCTION%]; /* values that initial() returns */
%ENDIF%
    %SUBMODEL_NAME%_real time; /* s */
    %SUBMODEL_NAME%_real start_time; /* s, of the experiment */
    %SUBMODEL_NAME%_real finish_time; /* s, of the experiment; the steps continue after it */
    %SUBMODEL_NAME%_real step_size; /* s */
    long steps; /* number of evaluations of the dynamic equations */
    unsigned random_state; /* state of the generator of random(); never 0 */
    char initialize; /* 1 while the submodel is being initialised */
    char major; /* 0 during the intermediate evaluations of a Runge-Kutta method */
    char stop_simulation; /* 1 after the model has executed stopsimulation */
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

/** Sets all inputs to zero.  Its body lists the index, the name and the {unit} of each input. */
static inline void %SUBMODEL_NAME%_ClearInputs(%SUBMODEL_NAME%_real *u)
{
    (void)u;
%INITIALIZE_INPUTS%
}

/** Sets all outputs to zero.  Its body lists the index, the name and the {unit} of each output. */
static inline void %SUBMODEL_NAME%_ClearOutputs(%SUBMODEL_NAME%_real *y)
{
    (void)y;
%INITIALIZE_OUTPUTS%
}

/** Sets constants, parameters and initial values to their values in 20-sim, and the rest to 0.  Call it first. */
void %SUBMODEL_NAME%_ModelInitialize(%SUBMODEL_NAME%_ModelInstance *self);

/** Starts at time `t` in seconds: runs the initial and static equations, and computes the first outputs. */
void %SUBMODEL_NAME%_InitializeSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const %SUBMODEL_NAME%_real *u,
                                        %SUBMODEL_NAME%_real *y, %SUBMODEL_NAME%_real t);

/** Runs one step: reads the inputs `u`, advances the time by `step_size`, and writes the outputs `y`. */
void %SUBMODEL_NAME%_CalculateSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const %SUBMODEL_NAME%_real *u,
                                       %SUBMODEL_NAME%_real *y);

/** Ends the model: runs its final equations. */
void %SUBMODEL_NAME%_TerminateSubmodel(%SUBMODEL_NAME%_ModelInstance *self, const %SUBMODEL_NAME%_real *u,
                                       %SUBMODEL_NAME%_real *y);

/** Runs the static equations, which compute values from the parameters.  Call it after a change of a parameter. */
void %SUBMODEL_NAME%_CalculateStatic(%SUBMODEL_NAME%_ModelInstance *self);

#ifdef __cplusplus
}
#endif

#endif
