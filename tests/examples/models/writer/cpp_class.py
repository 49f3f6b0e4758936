# SPDX-License-Identifier: Apache-2.0
# ruff: noqa: E101  (the templates indent by tabs, and continue comments by a blank)
"""The form of 20-sim's C++ class target: ``<Sub>.cpp``, ``<Sub>.h`` and the folder ``common``."""

from __future__ import annotations

from writer.common import assignments, header, initial_states, initial_values, input_copies, output_copies
from writer.model import Definition
from writer.tokens import tokens_xml

_P = "m_"


def cpp_class(model: Definition) -> dict[str, str]:
    """All files of the export, by path."""
    files = {
        f"{model.name}.h": _class_h(model),
        f"{model.name}.cpp": _class_cpp(model),
        "common/xxtypes.h": _TYPES,
        "common/xxmatrix.h": _MATRIX,
        "common/xxmodel.h": _MODEL,
        "common/xxinteg.h": _INTEG_H,
        "common/xxinteg.cpp": _INTEG_CPP,
        "common/xxfuncs.h": _FUNCS_H,
        "common/xxfuncs.cpp": _FUNCS_CPP,
    }
    return {path: header(path.replace("/", "\\"), model) + text for path, text in files.items()} | {
        f"{model.name}_tokens.xml": tokens_xml(model, "CppClass", _P)
    }


_TYPES = """/* The types all files use */
#ifndef XX_TYPES_H
#define XX_TYPES_H

typedef double XXDouble;
typedef int XXInteger;
typedef char XXCharacter;
typedef char XXBoolean;
typedef const char* XXString;

/* the matrix declaration */
typedef struct
{
	XXDouble *mat;
	XXInteger rows;
	XXInteger columns;
} XXMatrix;

/* Defines */
#define XXTRUE  1
#define XXFALSE 0

#endif
"""

_MATRIX = """/* The model has no matrices, so there are no matrix functions */
#ifndef XX_MATRIX_H
#define XX_MATRIX_H

#include "xxtypes.h"

#endif
"""

_MODEL = """/* The base class of all submodels */
#ifndef SUBMODEL20SIM_H
#define SUBMODEL20SIM_H

#include "xxtypes.h"
#include "xxmatrix.h"


class Submodel20sim
{
	protected:
		friend class IntegrationMethod;
		friend class Discrete;
		friend class RungeKutta4;
		virtual void CalculateDynamic (void) {};

		bool m_initialize;
		bool m_major;
		bool m_stop_run;
		XXDouble m_step_size;
		XXDouble m_start_time;
		XXDouble m_finish_time;
		XXDouble m_time;

	public:
		virtual ~Submodel20sim(){};

		XXDouble GetStepSize(void) { return m_step_size; };
		XXDouble GetStartTime(void) { return m_start_time; };
		XXDouble GetFinishTime(void) { return m_finish_time; };
		XXDouble GetTime(void) { return m_time; };

		/* the variable count */
		int m_number_constants;
		int m_number_parameters;
		int m_number_initialvalues;
		int m_number_variables;
		int m_number_states;
		int m_number_rates;
		int m_number_matrices;
		int m_number_unnamed;

		/* the variable arrays are allocated in the derived submodel class */
		XXDouble* m_C;		/* constants */
		XXDouble* m_P;		/* parameters */
		XXDouble* m_I;		/* initial values */
		XXDouble* m_V;		/* variables */
		XXDouble* m_s;		/* states */
		XXDouble* m_R;		/* rates (or new states) */
		XXMatrix* m_M;		/* matrices */
		XXDouble* m_U;		/* unnamed */
		XXDouble* m_workarray;
};

#endif 	/* SUBMODEL20SIM_H */
"""

_INTEG_H = """/* The integration methods */
#ifndef XX_INTEG_H
#define XX_INTEG_H

/* 20-sim include files */
#include "xxtypes.h"

class Submodel20sim;	//Forward declaration

class IntegrationMethod
{
  public:
	IntegrationMethod(void): model(NULL) {	};
	virtual ~IntegrationMethod(void) {	};
	virtual void Initialize(Submodel20sim* themodel) = 0;
	virtual void Terminate() = 0;
	virtual void Step() = 0;

  protected:
	Submodel20sim* model;
};

class Discrete: public IntegrationMethod
{
  public:
	void Initialize(Submodel20sim* themodel);
	void Terminate();
	void Step();
};

class RungeKutta4: public IntegrationMethod
{
  public:
	RungeKutta4(void);
	~RungeKutta4(void);
	void Initialize(Submodel20sim* themodel);
	void Terminate();
	void Step();

  private:
	XXDouble* q0;
	XXDouble* q1;
	XXDouble* q2;
	XXDouble* q3;
};

#endif
"""

_INTEG_CPP = """/* the system include files */
#include <stdlib.h>
#include <string.h>
#include <math.h>

/* our own include files */
#include "xxinteg.h"
#include "xxmodel.h"


/*********************************************************************
 * Discrete integration method
 *********************************************************************/
void Discrete::Initialize (Submodel20sim* themodel)
{
	model = themodel;
	model->m_major = true;
}

void Discrete::Terminate ()
{
	/* nothing to be done */
}

void Discrete::Step ()
{
	XXInteger index;

	/* the new states become the states */
	for (index = 0; index < model->m_number_states; index++)
	{
		model->m_s [index] = model->m_R [index];
	}

	model->m_time += model->m_step_size;
	model->m_major = true;
	model->CalculateDynamic ();
}


/*********************************************************************
 * RungeKutta4 integration method
 *********************************************************************/
RungeKutta4::RungeKutta4(void):
	q0(NULL),
	q1(NULL),
	q2(NULL),
	q3(NULL)
{
}

RungeKutta4::~RungeKutta4(void)
{
	delete[] q0;
	delete[] q1;
	delete[] q2;
	delete[] q3;
}

void RungeKutta4::Initialize (Submodel20sim* themodel)
{
	model = themodel;

	/* allocate internal arrays */
	if (q0 == NULL)
	{
		q0 = new XXDouble [model->m_number_states + 1];
		q1 = new XXDouble [model->m_number_states + 1];
		q2 = new XXDouble [model->m_number_states + 1];
		q3 = new XXDouble [model->m_number_states + 1];
	}
	model->m_major = true;
}

void RungeKutta4::Terminate ()
{
	/* nothing to be done */
}

void RungeKutta4::Step ()
{
	XXInteger index;
	const XXDouble start = model->m_time;
	const XXDouble h = model->m_step_size;

	memcpy (q0, model->m_s, model->m_number_states * sizeof (XXDouble));
	model->m_major = false;

	/* first slope: at the start of the step, known from the step before */
	for (index = 0; index < model->m_number_states; index++)
	{
		q1 [index] = model->m_R [index] * h;
		model->m_s [index] = q0 [index] + q1 [index] / 2;
	}

	/* second slope: halfway */
	model->m_time = start + h / 2;
	model->CalculateDynamic ();
	for (index = 0; index < model->m_number_states; index++)
	{
		q2 [index] = model->m_R [index] * h;
		model->m_s [index] = q0 [index] + q2 [index] / 2;
	}

	/* third slope: halfway once more */
	model->CalculateDynamic ();
	for (index = 0; index < model->m_number_states; index++)
	{
		q3 [index] = model->m_R [index] * h;
		model->m_s [index] = q0 [index] + q3 [index];
	}

	/* fourth slope: at the end, and the new states */
	model->m_time = start + h;
	model->CalculateDynamic ();
	for (index = 0; index < model->m_number_states; index++)
	{
		model->m_s [index] = q0 [index] + (q1 [index] + 2.0 * q2 [index] + 2.0 * q3 [index]
			+ model->m_R [index] * h) / 6.0;
	}

	model->m_major = true;
	model->CalculateDynamic ();
}
"""

_FUNCS_H = """/* Functions of the modelling language that C++ does not have */
#ifndef XX_FUNCS_H
#define XX_FUNCS_H

/* Our own include files */
#include "xxtypes.h"

/* 20-sim function prototypes */
XXDouble XXAbsolute (XXDouble argument);
XXDouble XXSign (XXDouble argument);

#endif
"""

_FUNCS_CPP = """/* The system include files */
#include <stdlib.h>
#include <math.h>

/* Our own include files */
#include "xxfuncs.h"

/* The 20-sim functions */

XXDouble XXAbsolute (XXDouble argument)
{
	return fabs (argument);
}

XXDouble XXSign (XXDouble argument)
{
	return (argument > 0.0) ? 1.0 : ((argument < 0.0) ? -1.0 : 0.0);
}
"""


def _class_h(model: Definition) -> str:
    n = model.name
    return f"""/* The class of the submodel */
#ifndef {n}_H
#define {n}_H

/* 20-sim include files */
#include "common/xxfuncs.h"
#include "common/xxmatrix.h"
#include "common/xxmodel.h"
#include "common/xxinteg.h"


class {n}: virtual public Submodel20sim
{{
	public:
		enum stateflags_{n} {{initialrun, mainrun, finished}};

		{n}(void);
		virtual ~{n}(void);

		/**
		 * Initializes the model and calculates the values for the start time t
		 * @param u	all input signals
		 * @param y	all output signals
		 * @param t	start time of this run
		 */
		void Initialize (XXDouble *u, XXDouble *y, XXDouble t);

		/**
		 * Calculates one step
		 * @param u	all input signals
		 * @param y	all output signals
		 */
		void Calculate (XXDouble *u, XXDouble *y /*, XXDouble t*/ );

		/**
		 * Calculates the final equations
		 * @param u	all input signals
		 * @param y	all output signals
		 */
		void Terminate (XXDouble *u, XXDouble *y /*, XXDouble t*/ );

		/**
		 * Replaces the finish time of the experiment; 0.0 means infinite
		 */
		bool SetFinishTime(XXDouble newtime);

		bool IsFinished(void);

		/**
		 * Resets the submodel to its initial state for a new run
		 */
		void Reset(XXDouble starttime);

		stateflags_{n} state;

	protected:
		void CalculateDynamic (void);

	private:
		/* internal submodel computation methods */
		void CalculateInitial (void);
		void CalculateStatic (void);
		void CalculateInput (void);
		void CalculateOutput (void);
		void CalculateFinal (void);
		void CopyInputsToVariables (XXDouble *u);
		void CopyVariablesToOutputs (XXDouble *y);

		{model.method} myintegmethod;	///< the integration method for this submodel
}};

#endif	/* {n}_H */
"""


def _class_cpp(model: Definition) -> str:
    n = model.name
    p, v, s = len(model.parameters), len(model.variables), len(model.states)
    sizes = {"C": 0, "P": p, "I": s, "V": v, "s": s, "R": s, "U": 0, "workarray": 0}
    allocate = "".join(f"\tm_{a} = new XXDouble[{k} + 1];\n" for a, k in sizes.items())
    clear = "".join(f"\tmemset(m_{a}, 0, ({k} + 1) * sizeof(XXDouble));\n" for a, k in sizes.items())
    free = "".join(f"\tdelete[] m_{a};\n" for a in (*sizes, "M"))
    return f"""/* Standard include files */
#include <stdio.h>
#include <math.h>
#include <string.h>

/* 20-sim include files */
#include "{n}.h"

/* Delta margin used for end time checking */
const XXDouble c_delta = 1.0e-7;

/* this PRIVATE function sets the input variables from the input vector */
void {n}::CopyInputsToVariables (XXDouble *u)
{{
	/* copy the input vector to the input variables */
{input_copies(model, _P)}
}}

/* this PRIVATE function uses the output variables to fill the output vector */
void {n}::CopyVariablesToOutputs (XXDouble *y)
{{
	/* copy the output variables to the output vector */
{output_copies(model, _P)}
}}

{n}::{n}(void)
{{
	m_number_constants = 0;
	m_number_parameters = {p};
	m_number_initialvalues = {s};
	m_number_variables = {v};
	m_number_states = {s};
	m_number_rates = {s};
	m_number_matrices = 0;
	m_number_unnamed = 0;

	/* the variable arrays */
{allocate}	m_M = new XXMatrix[0 + 1];

	Reset(0.0);
	m_finish_time = {model.finish};
}}

void {n}::Reset(XXDouble starttime)
{{
	m_start_time = starttime;
	m_step_size = {model.step};
	m_time = starttime;
	m_major = true;
	m_stop_run = false;

	/* Clear the allocated variable memory */
{clear}	memset(m_M, 0, (0 + 1) * sizeof(XXMatrix));

	state = initialrun;
}}

bool {n}::IsFinished(void)
{{
	return (state == finished);
}}

{n}::~{n}(void)
{{
	/* free memory */
{free}}}

/* the initialization function for submodel */
void {n}::Initialize (XXDouble *u, XXDouble *y, XXDouble t)
{{
	/* initialization phase */
	m_initialize = true;
	m_stop_run = false;

	/* set the constants */

	/* set the parameters */
{assignments(model.parameters, "P", _P)}
	/* set the initial values */
{assignments(initial_values(model), "I", _P)}
	/* set the states */
{initial_states(model, _P)}
	/* set the matrices */

	/* (re-)initialize the integration method */
	myintegmethod.Initialize (this);

	/* copy the inputs */
	m_time = t;
	CopyInputsToVariables (u);

	/* calculate initial and static equations */
	CalculateInitial ();
	CalculateStatic ();
	CalculateInput ();
	CalculateDynamic ();
	CalculateOutput ();

	/* Set the outputs */
	CopyVariablesToOutputs (y);

	/* end of initialization phase */
	m_initialize = false;

	state = mainrun;
}}

/* the function that calculates the submodel */
void {n}::Calculate (XXDouble *u, XXDouble *y /*, XXDouble t*/ )
{{
	switch (state)
	{{
		case initialrun:	/* calculate the model for the first time */
			Initialize (u, y, 0.0);
			break;
		case mainrun:		/* calculate the model */
			if ((m_time <= (m_finish_time - m_step_size + c_delta)) || (m_finish_time == 0.0))
			{{
				CalculateStatic ();
				CopyInputsToVariables (u);
				CalculateInput ();
				myintegmethod.Step ();
				CalculateOutput ();
				CopyVariablesToOutputs (y);
			}}
			else
			{{
				state = finished;
			}}

			if ((m_stop_run == true) || ((m_finish_time != 0.0) && (m_time + c_delta >= m_finish_time)))
			{{
				state = finished;
			}}
			break;
		case finished:
			break;
		default:
			break;
	}}
}}

/* the termination function for submodel */
void {n}::Terminate (XXDouble *u, XXDouble *y /*, XXDouble t */)
{{
	/* copy the inputs */
	CopyInputsToVariables (u);

	/* calculate the final model equations */
	CalculateFinal ();

	/* set the outputs */
	CopyVariablesToOutputs (y);
}}

/* This function calculates the initial equations of the model:
 * before anything else
 */
void {n}::CalculateInitial (void)
{{

}}

/* This function calculates the static equations of the model:
 * they depend on parameters and constants only
 */
void {n}::CalculateStatic (void)
{{
{model.code("static", _P)}}}

/* This function calculates the input equations of the model:
 * once per step, whatever the integration method
 */
void {n}::CalculateInput (void)
{{

}}

/* This function calculates the dynamic equations of the model:
 * the integration method calls it to get the rates
 */
void {n}::CalculateDynamic (void)
{{
{model.code("dynamic", _P)}}}

/* This function calculates the output equations of the model:
 * no rate depends on them
 */
void {n}::CalculateOutput (void)
{{
{model.code("output", _P)}}}

/* This function calculates the final equations of the model:
 * after all other calculations
 */
void {n}::CalculateFinal (void)
{{

}}

bool {n}::SetFinishTime(XXDouble newtime)
{{
	if ((newtime <= 0.0) || (newtime > m_time))
	{{
		m_finish_time = newtime;
		return true;
	}}
	return false;
}}
"""
