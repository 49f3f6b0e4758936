/**
 * @file
 * An application with one input and one output.  A test can control and count each of its functions.
 *
 * The model has one state, the number of its steps since initialisation; its output is the input plus that state.
 */
#ifndef FAKE_APPLICATION_H
#define FAKE_APPLICATION_H

#include "epg/control.h"

enum { FAKE_SETPOINTS = 2 };
enum { FAKE_PERIOD_NS = 1000000 };
enum { FAKE_COMPONENT = 5 };

typedef struct fake_application {
    epg_control_t control;
    epg_application_t application; /**< a test may change it before fake_start() */
    epg_setpoint_t setpoints[FAKE_SETPOINTS];

    /* set by the test */
    double sensor;       /**< the value that sample() reads; the model's input is this plus setpoint 0 */
    epg_fault_t fault;   /**< the fault that the check of component FAKE_COMPONENT finds */
    double state_error;  /**< added to the model's state at each step */
    double output_error; /**< added to the model's output */
    double limit;        /**< limit of the output in both directions; 0: none */
    bool stop;           /**< the model requests to stop */
    bool fail_safe;      /**< level of the fail-safe input, if the application has it */
    uint64_t step_ns;    /**< duration of a model step */

    /* seen by the test */
    double sampled;
    double input;
    double state;
    double output;
    double actuator; /**< the value at the actuator; 0 is safe */
    unsigned int starts;
    unsigned int reads;
    unsigned int inits;
    unsigned int steps;
    unsigned int writes;
    uint64_t written_ns; /**< time of the last write to outputs */
    unsigned int safes;
    char calls[64]; /**< letters of the functions called in the last cycle, in order */
    uint64_t tick;  /**< number of the next cycle, from 0 */
} fake_application_t;

extern fake_application_t fake;

/** Resets everything: enabled at start, no limits, no fail-safe input, clock and port reset. */
void fake_reset(void);

/** Calls epg_control_start(). */
void fake_start(void);

/** Runs one cycle at its tick. */
void fake_cycle(void);

/** Runs `count` cycles, each at its tick. */
void fake_cycles(unsigned int count);

/** Runs one cycle that starts `late_ns` after its tick, after `missed` ticks without a cycle. */
void fake_late_cycle(uint64_t late_ns, uint32_t missed);

/** Receives a setpoint now. */
bool fake_receive(size_t index, double value);

/** The status after the last cycle. */
epg_status_t fake_status(void);

/** The value published last. */
double fake_published(void);

#endif
