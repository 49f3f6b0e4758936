# SPDX-License-Identifier: Apache-2.0
"""The form of 20-sim's C function target: ``xxsubmod.c``, ``xxmodel.c``, ``xxinteg.c``, ``xxfuncs.c``, ..."""

from __future__ import annotations

from writer.common import assignments, header, initial_states, initial_values, input_copies, output_copies, quoted
from writer.model import Definition
from writer.tokens import tokens_xml

_P = "xx_"


def c_function(model: Definition) -> dict[str, str]:
    """All files of the export, by name."""
    files = {
        "xxtypes.h": _types(),
        "xxfuncs.h": _funcs_h(model),
        "xxfuncs.c": _funcs_c(model),
        "xxinteg.h": _integ_h(model),
        "xxinteg.c": _integ_c(model),
        "xxmodel.h": _model_h(model),
        "xxmodel.c": _model_c(model),
        "xxsubmod.h": _submod_h(),
        "xxsubmod.c": _submod_c(model),
    }
    return {name: header(name, model) + text for name, text in files.items()} | {
        "tokens.xml": tokens_xml(model, "CFunction", _P)
    }


def _types() -> str:
    return """/* The types all files use */
#ifndef XX_TYPES_H
#define XX_TYPES_H

typedef double XXDouble;
typedef int XXInteger;
typedef char XXCharacter;
typedef char XXBoolean;
typedef const char* XXString;

/* Defines */
#define XXTRUE  1
#define XXFALSE 0

#endif
"""


def _funcs_h(model: Definition) -> str:
    absolute = "XXDouble XXAbsolute (XXDouble argument);\n" if "abs" in model.functions else ""
    return f"""/* Functions of the modelling language that C does not have; only those the model uses */
#ifndef XX_FUNCS_H
#define XX_FUNCS_H

/* Our own include files */
#include "xxtypes.h"

/* Global constants */
extern XXBoolean xx_initialize;
extern XXBoolean xx_major;
extern XXBoolean xx_stop_simulation;

/* 20-sim function prototypes */
{absolute}/* 20-sim stub prototypes */
#endif
"""


def _funcs_c(model: Definition) -> str:
    absolute = """
XXDouble XXAbsolute (XXDouble argument)
{
	return fabs (argument);
}
"""
    return f"""/* The system include files */
#include <stdlib.h>
#include <math.h>

/* Our own include files */
#include "xxfuncs.h"

/* The 20-sim functions */
{absolute if "abs" in model.functions else ""}
/* The 20-sim stub functions */
"""


def _integ_h(model: Definition) -> str:
    m = model.method
    return f"""/* The integration method */
#ifndef XX_INTEG_H
#define XX_INTEG_H

/* 20-sim include files */
#include "xxtypes.h"

/* the chosen integration method */
#define {m}_METHOD

/* the integration methods */
void XX{m}Initialize (void);
void XX{m}Terminate (void);
void XX{m}Step (void);

extern XXBoolean xx_major;

#endif
"""


_DISCRETE = """/* the initialization of the Discrete integration method */
void XXDiscreteInitialize (void)
{
	xx_major = XXTRUE;
}

/* the termination of the Discrete integration method */
void XXDiscreteTerminate (void)
{
	/* nothing to be done */
}

/* the Discrete integration method itself */
void XXDiscreteStep (void)
{
	XXInteger index;

	/* the new states become the states */
	for (index = 0; index < xx_STATE_SIZE; index++)
	{
		xx_s [index] = xx_R [index];
	}
	/* increment the simulation time */
	xx_time += xx_step_size;

	xx_major = XXTRUE;

	/* calculate the new states of the next step */
	XXCalculateDynamic ();
}
"""

_RUNGE_KUTTA_4 = """static XXDouble xx_q0 [xx_STATE_SIZE];
static XXDouble xx_q1 [xx_STATE_SIZE];
static XXDouble xx_q2 [xx_STATE_SIZE];
static XXDouble xx_q3 [xx_STATE_SIZE];

/* the initialization of the RungeKutta4 integration method */
void XXRungeKutta4Initialize (void)
{
	memset (xx_q0, 0, sizeof (xx_q0));
	memset (xx_q1, 0, sizeof (xx_q1));
	memset (xx_q2, 0, sizeof (xx_q2));
	memset (xx_q3, 0, sizeof (xx_q3));
	xx_major = XXTRUE;
}

/* the termination of the RungeKutta4 integration method */
void XXRungeKutta4Terminate (void)
{
	/* nothing to be done */
}

/* the RungeKutta4 integration method itself */
void XXRungeKutta4Step (void)
{
	XXInteger index;
	XXDouble start;

	start = xx_time;
	memcpy (xx_q0, xx_s, sizeof (xx_q0));
	xx_major = XXFALSE;

	/* first slope: at the start of the step, known from the step before */
	for (index = 0; index < xx_STATE_SIZE; index++)
	{
		xx_q1 [index] = xx_R [index] * xx_step_size;
		xx_s [index] = xx_q0 [index] + xx_q1 [index] / 2;
	}

	/* second slope: halfway */
	xx_time = start + xx_step_size / 2;
	XXCalculateDynamic ();
	for (index = 0; index < xx_STATE_SIZE; index++)
	{
		xx_q2 [index] = xx_R [index] * xx_step_size;
		xx_s [index] = xx_q0 [index] + xx_q2 [index] / 2;
	}

	/* third slope: halfway once more */
	XXCalculateDynamic ();
	for (index = 0; index < xx_STATE_SIZE; index++)
	{
		xx_q3 [index] = xx_R [index] * xx_step_size;
		xx_s [index] = xx_q0 [index] + xx_q3 [index];
	}

	/* fourth slope: at the end, and the new states */
	xx_time = start + xx_step_size;
	XXCalculateDynamic ();
	for (index = 0; index < xx_STATE_SIZE; index++)
	{
		xx_s [index] = xx_q0 [index] + (xx_q1 [index] + 2.0 * xx_q2 [index] + 2.0 * xx_q3 [index]
			+ xx_R [index] * xx_step_size) / 6.0;
	}

	xx_major = XXTRUE;

	/* calculate the rates of the next step */
	XXCalculateDynamic ();
}
"""


def _integ_c(model: Definition) -> str:
    return f"""/* The system include files */
#include <stdlib.h>
#include <string.h>
#include <math.h>

/* our own include files */
#include "xxinteg.h"
#include "xxmodel.h"

/* global variables prototypes */
extern XXDouble xx_time;
extern XXDouble xx_step_size;

#define xx_STATE_SIZE {len(model.states)}

/*********************************************************************
 * {model.method} integration method
 *********************************************************************/

{_DISCRETE if model.method == "Discrete" else _RUNGE_KUTTA_4}"""


def _model_h(model: Definition) -> str:
    return f"""/* The variables and equations of the model */
#ifndef XX_MODEL_H
#define XX_MODEL_H

/* Our own include files */
#include "xxtypes.h"

/* Simulation variables */
extern XXDouble xx_start_time;
extern XXDouble xx_finish_time;
extern XXDouble xx_step_size;
extern XXDouble xx_time;
extern XXInteger xx_steps;
extern XXBoolean xx_initialize;
extern XXBoolean xx_major;
extern XXBoolean xx_stop_simulation;

/* Model size constants */
#define xx_constants_size 0
#define xx_parameters_size {len(model.parameters)}
#define xx_initialvalues_size {len(model.states)}
#define xx_variables_size {len(model.variables)}
#define xx_states_size {len(model.states)}

/* Variable arrays */
extern XXDouble xx_P[];
extern XXDouble xx_I[];
extern XXDouble xx_V[];
extern XXDouble xx_s[];
extern XXDouble xx_R[];

/* Initialization methods */
void XXModelInitialize (void);
void XXModelInitialize_parameters(void);
void XXModelInitialize_initialvalues(void);
void XXModelInitialize_states(void);
void XXModelInitialize_variables(void);
void XXModelTerminate (void);

/* Computation methods */
void XXCalculateInitial (void);
void XXCalculateStatic (void);
void XXCalculateInput (void);
void XXCalculateDynamic (void);
void XXCalculateOutput (void);
void XXCalculateFinal (void);

#endif
"""


def _name_tables(model: Definition) -> str:
    tables = {
        "parameter": [p.name for p in model.parameters],
        "initial_value": [p.name for p in initial_values(model)],
        "variable": list(model.variables),
        "state": [s.name for s in model.states],
        "rate": [s.rate for s in model.states],
    }
    rows = "".join(f"XXString xx_{kind}_names[] = {{\n{quoted(names)},\tNULL\n}};\n" for kind, names in tables.items())
    title = "the names of the variables as used in the arrays above\n   uncomment this part if these names are needed"
    return f"/* {title}\n{rows}*/\n"


def _model_c(model: Definition) -> str:
    return f"""/* This file contains the actual model variables and equations */

/* system include files */
#include <stdlib.h>
#include <math.h>
#include <string.h>

/* 20-sim include files */
#include "xxmodel.h"
#include "xxfuncs.h"

/* the global variables */
XXDouble xx_start_time = 0.0;
XXDouble xx_finish_time = {model.finish};
XXDouble xx_step_size = {model.step};
XXDouble xx_time = 0.0;
XXInteger xx_steps = 0;
XXBoolean xx_initialize = XXTRUE;
XXBoolean xx_major = XXTRUE;
XXBoolean xx_stop_simulation = XXFALSE;

/* the variable arrays */
XXDouble xx_P[xx_parameters_size];		/* parameters */
XXDouble xx_I[xx_initialvalues_size];		/* initial values */
XXDouble xx_V[xx_variables_size];		/* variables */
XXDouble xx_s[xx_states_size];		/* states */
XXDouble xx_R[xx_states_size];		/* rates (or new states) */

{_name_tables(model)}
void XXModelInitialize_parameters(void)
{{
	/* set the parameters */
{assignments(model.parameters, "P", _P)}
}}

void XXModelInitialize_initialvalues(void)
{{
	/* set the initial values */
{assignments(initial_values(model), "I", _P)}
}}

void XXModelInitialize_states(void)
{{
	/* set the states */
{initial_states(model, _P)}
}}

void XXModelInitialize_variables(void)
{{
	/* initialize the variable memory to zero */
	memset(xx_V, 0, xx_variables_size * sizeof(XXDouble));
}}

/* this method is called before calculation is possible */
void XXModelInitialize (void)
{{
	XXModelInitialize_parameters();
	XXModelInitialize_variables();
	XXModelInitialize_initialvalues();
	XXModelInitialize_states();
}}

/* This function calculates the initial equations of the model:
 * before anything else
 */
void XXCalculateInitial (void)
{{
	XXModelInitialize_states();
}}

/* This function calculates the static equations of the model:
 * they depend on parameters and constants only
 */
void XXCalculateStatic (void)
{{
{model.code("static", _P)}}}

/* This function calculates the input equations of the model:
 * once per step, whatever the integration method
 */
void XXCalculateInput (void)
{{

}}

/* This function calculates the dynamic equations of the model:
 * the integration method calls it to get the rates
 */
void XXCalculateDynamic (void)
{{
{model.code("dynamic", _P)}
	/* increment the step counter */
	xx_steps++;
}}

/* This function calculates the output equations of the model:
 * no rate depends on them
 */
void XXCalculateOutput (void)
{{
{model.code("output", _P)}}}

/* This function calculates the final equations of the model:
 * after all other calculations
 */
void XXCalculateFinal (void)
{{

}}

/* this method is called after all calculations are performed */
void XXModelTerminate(void)
{{
}}
"""


def _submod_h() -> str:
    return """/* The functions to call */
#ifndef XX_SUBMOD_H
#define XX_SUBMOD_H

/* Our own include files */
#include "xxmodel.h"

/* Submodel I/O variables */
extern XXInteger xx_number_of_inputs;
extern XXInteger xx_number_of_outputs;

/* The submodel functions */
void XXInitializeSubmodel (XXDouble *u, XXDouble *y, XXDouble t);
void XXCalculateSubmodel (XXDouble *u, XXDouble *y, XXDouble t);
void XXTerminateSubmodel (XXDouble *u, XXDouble *y, XXDouble t);
void XXCopyInputsToVariables (XXDouble *u);
void XXCopyVariablesToOutputs (XXDouble *y);

#endif
"""


def _submod_c(model: Definition) -> str:
    m = model.method
    return f"""/* Standard include files */
#include <stdlib.h>

/* 20-sim include files */
#include "xxmodel.h"
#include "xxinteg.h"
#include "xxfuncs.h"
#include "xxsubmod.h"

/* The submodel I/O variables */
XXInteger xx_number_of_inputs = {len(model.inputs)};
XXInteger xx_number_of_outputs = {len(model.outputs)};

/* the names of the submodel io variables
   uncomment this part if you need these names
XXString xx_input_names[] = {{
{quoted(p.name for p in model.inputs)},	NULL
}};
XXString xx_output_names[] = {{
{quoted(p.name for p in model.outputs)},	NULL
}};
*/
/* This function sets the input variables from the input vector */
void XXCopyInputsToVariables (XXDouble *u)
{{
	/* Copy the input vector to the input variables */
{input_copies(model, _P)}
}}

/* This function uses the output variables to fill the output vector */
void XXCopyVariablesToOutputs (XXDouble *y)
{{
	/* Copy the output variables to the output vector */
{output_copies(model, _P)}
}}

/* The initialization function for submodel */
void XXInitializeSubmodel (XXDouble *u, XXDouble *y, XXDouble t)
{{
	/* Initialization phase */
	xx_initialize = XXTRUE;
	xx_steps = 0;
	XXModelInitialize ();
	XX{m}Initialize ();

	/* Copy the inputs */
	xx_time = t;
	XXCopyInputsToVariables (u);

	/* Calculate the model for the first time */
	XXCalculateInitial ();
	XXCalculateStatic ();
	XXCalculateInput ();
	XXCalculateDynamic ();
	XXCalculateOutput ();

	/* Set the outputs */
	XXCopyVariablesToOutputs (y);

	/* End of initialization phase */
	xx_initialize = XXFALSE;
}}

/* The function that calculates the submodel */
void XXCalculateSubmodel (XXDouble *u, XXDouble *y, XXDouble t)
{{
	/* Copy the inputs */
	xx_time = t;
	XXCopyInputsToVariables (u);

	/* Calculate the model */
	XXCalculateInput ();
	XX{m}Step ();
	XXCalculateOutput ();

	/* Copy the outputs */
	XXCopyVariablesToOutputs (y);
}}

/* The termination function for submodel */
void XXTerminateSubmodel (XXDouble *u, XXDouble *y, XXDouble t)
{{
	/* Copy the inputs */
	xx_time = t;
	XXCopyInputsToVariables (u);

	/* Calculate the final model equations */
	XXCalculateFinal ();

	/* Set the outputs */
	XXCopyVariablesToOutputs (y);

	/* and terminate the model itself */
	XXModelTerminate ();
	XX{m}Terminate ();
}}
"""
