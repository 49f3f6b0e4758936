/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control cycle: read the inputs, step the model, write the outputs, count.
 *
 * The generator writes one constant `epg_application_t` per target, which describes the target.  The code that is the
 * same for all targets is in control.c.
 *
 * Two contexts use a control object.  The *control side* calls epg_control_cycle() at every tick; it is a timer
 * interrupt, a processor core that does nothing else, or the thread with the highest priority.  The *communication
 * side* delivers setpoints, fetches monitoring values and requests enabling.  Neither side waits for the other: they
 * share only wait-free exchanges (epg/exchange.h) and a few atomic words.
 *
 * A control side looks like this; a hardware timer gives the ticks:
 *
 *     epg_control_start(&control, &application);
 *     for (;;) {
 *         // wait for the tick
 *         epg_control_cycle(&control, tick_ns, missed_ticks);
 *     }
 *
 * And a communication side:
 *
 *     epg_control_enable(&control, EPG_ENABLE_ANY);                                 // enable; epg_stop() disables
 *     epg_control_receive(&control, setpoint_index, 0.5, epg_port_time_ns(), true); // a new setpoint
 *     if (epg_control_monitor(&control, values)) { ... }                            // the newest monitoring values
 *     epg_control_alive(&control);
 *
 * | event                                   | effect                                                               |
 * |-----------------------------------------|----------------------------------------------------------------------|
 * | target is disabled                      | actuators are safe within one cycle; sensors, topics and the model   |
 * |                                         | continue; encoder resets are withheld, so that zero positions stay   |
 * | target is stopped                       | the same, in at least two cycles; older requests to enable do not    |
 * |                                         | act (epg/stop.h)                                                     |
 * | target is enabled                       | the model is initialised again; setpoints that must be fresh begin   |
 * |                                         | again; the ages of the others go on                                  |
 * | setpoint not finite, or outside limits  | dropped and counted; the value before it stays                       |
 * | model input, state or output not finite | disabled, fault EPG_FAULT_NOT_FINITE; the model is stopped           |
 * | model asks to stop (stopsimulation)     | disabled, fault EPG_FAULT_MODEL_STOPPED; the model is stopped        |
 * | `overrun_limit` overruns in a row       | disabled, fault EPG_FAULT_OVERRUN                                    |
 * | setpoint older than its timeout         | hold, zero or disable (fault EPG_FAULT_SETPOINT_TIMEOUT)             |
 * | fail-safe input inactive                | disabled, fault EPG_FAULT_FAIL_SAFE                                  |
 * | a component finds a fault               | disabled, fault with the component's index (epg_control_fault())     |
 * | late cycle                              | runs once; missed ticks are counted, but their cycles are not run    |
 *
 * Every fault is latched: only a request to enable or to reset clears it.  If several faults happen, the first one is
 * kept.  A reset does not enable the target, and a fault whose cause remains is latched again at once.  A stopped model is not stepped until the target is enabled again; its last monitoring values stay.  A setpoint that is
 * too old is not a fault while the target is disabled, because no sender is expected then.
 */
#ifndef EPG_CONTROL_H
#define EPG_CONTROL_H

#include <assert.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "epg/capture.h"
#include "epg/exchange.h"
#include "epg/finite.h"
#include "epg/history.h"
#include "epg/jog.h"
#include "epg/parameters.h"
#include "epg/status.h"
#include "epg/stop.h"
#include "epg/telemetry.h"

/** The reaction to a setpoint that is older than its timeout: keep the value, use 0, or disable the target. */
typedef enum epg_timeout_action { EPG_TIMEOUT_HOLD, EPG_TIMEOUT_ZERO, EPG_TIMEOUT_DISABLE } epg_timeout_action_t;

/**
 * The description of one setpoint, from the `.tcf` and the bindings.
 *
 * A value that moves something must not act after a stop: a `fresh` setpoint forgets its value when the target is
 * enabled.  It begins with `initial`, or with the measured value that it follows, and only a value that was received
 * after the enabling changes it.  Every other setpoint keeps its newest value.
 */
typedef struct epg_setpoint {
    double initial;      /**< value before the first sample, and after a timeout that disabled the target */
    double rate_limit;   /**< largest change per second of the model's value; 0: unlimited */
    double minimum;      /**< smallest value that is accepted */
    double maximum;      /**< largest value that is accepted; not more than `minimum`: every finite value is accepted */
    uint64_t timeout_ns; /**< largest age, from the reception; 0: never too old */
    epg_timeout_action_t action;
    bool fresh; /**< values that were received before the last enabling do not act */
    /** Returns the measured value that it follows, in its own unit.  Runs after sample(), on the control side.  NULL: it
     *  follows nothing.  Otherwise `fresh` must be true. */
    double (*measured)(void);
    uint16_t component;  /**< index of the component that receives it, for EPG_FAULT_SETPOINT_TIMEOUT */
    uint16_t guard;      /**< index of the component that guards the axis that it follows, or EPG_NO_COMPONENT */
    const char *follows; /**< name of the signal that it follows, such as "inputs.position_pan"; NULL: none */
    const char *unit;    /**< unit of a received value; NULL: not known */
} epg_setpoint_t;

/** Returns true if `setpoint` has limits. */
static inline bool epg_setpoint_is_limited(const epg_setpoint_t *setpoint)
{
    return setpoint->maximum > setpoint->minimum;
}

/** Returns true if a received value can be used: it is finite and inside of the limits. */
static inline bool epg_setpoint_accepts(const epg_setpoint_t *setpoint, double value)
{
    return epg_is_finite(value) &&
           (!epg_setpoint_is_limited(setpoint) || (value >= setpoint->minimum && value <= setpoint->maximum));
}

/** One received value of a setpoint, on its way from the communication side to the control side. */
typedef struct epg_setpoint_sample {
    double value;
    uint64_t received_ns;
    uint32_t count; /**< number of samples received so far; 0: none yet */
} epg_setpoint_sample_t;

/** The state of one setpoint on the control side. */
typedef struct epg_setpoint_state {
    double value;      /**< value for the model, after timeout and rate limit */
    double target;     /**< newest sample, or the value that its timeout has put in its place */
    uint64_t fresh_ns; /**< start of its age: the reception */
    uint64_t since_ns; /**< samples that were received before this time do not act */
    uint32_t count;    /**< `count` of the newest sample of the communication side; 0: none yet */
    bool begins;       /**< the next update begins with `initial`, or with the measured value */
    bool received;     /**< `target` is a received value, and has an age */
    bool timed_out;    /**< true from a timeout to the next sample, or to the enabling that forgets the value */
} epg_setpoint_state_t;

/**
 * The generator's description of a target.  Functions run on the control side unless their comment says otherwise.  The
 * generator defines all arrays, with the sizes that the counts state, so that no memory is allocated at run time.
 */
typedef struct epg_application {
    const char *name;
    uint64_t period_ns;
    uint32_t step_divider;    /**< the model is stepped in every n-th cycle; at least 1 */
    uint64_t output_delay_ns; /**< time from a tick to its outputs; 0: outputs are written as soon as computed */
    uint32_t overrun_limit;   /**< number of overruns in a row that disables the target; 0: never */
    bool enable_at_start;

    void (*start)(void);  /**< configures all peripherals with safe outputs; runs before the first cycle */
    void (*sample)(void); /**< samples all sensors; runs first in every cycle, so that the instant does not vary */
    void (*read)(void);   /**< fills the model's inputs and checks the components; runs in every cycle */
    bool (*inputs_finite)(void);
    void (*model_init)(void); /**< initialises the model (again) with the inputs that were read last */
    void (*model_step)(void);
    bool (*model_finite)(void);  /**< true if all states and outputs of the model are finite */
    bool (*model_stopped)(void); /**< true if the model has asked to stop; NULL: it never does */
    void (*prepare)(void);       /**< the part of writing that is not time-critical (arithmetic, resets); may be NULL */
    void (*write)(void); /**< writes the model's outputs to the actuators: after each step, at the output delay */
    void (*safe)(void);  /**< sets every actuator to its safe value; runs in every cycle while disabled */
    void (*monitor)(double *values); /**< fills `monitor_count` values, after the actuators are written; may be NULL */
    bool (*fail_safe)(void);         /**< true: the target may be enabled; runs before read(); NULL: no such input */
    uint16_t fail_safe_component;    /**< index of the component that is the fail-safe input */
    void (*arrived)(size_t index);   /**< communication side: a value for setpoint `index` has arrived; may be NULL */

    size_t setpoint_count;
    const epg_setpoint_t *setpoints;
    epg_setpoint_sample_t *samples;        /**< `setpoint_count` samples: the copy of the control side */
    epg_setpoint_sample_t *received;       /**< `setpoint_count` samples: the copy of the communication side */
    epg_setpoint_state_t *setpoint_states; /**< `setpoint_count` states */
    epg_exchange_t *setpoint_exchange;     /**< its value is `setpoint_count` samples; NULL: no setpoints */

    size_t monitor_count;
    double *monitor_values;           /**< `monitor_count` numbers: the copy of the control side */
    epg_exchange_t *monitor_exchange; /**< its value is `monitor_count` doubles; NULL: no monitoring values */
    epg_history_t *history;           /**< keeps the values of each cycle for publications; NULL: none */

    epg_parameters_t *parameters; /**< parameters that can be changed while the model runs; NULL: none */
    epg_capture_t *capture;       /**< recording of signals; NULL: none */
    epg_telemetry_t *telemetry;   /**< stream of signals; NULL: none.  Needs a capture, whose memory it shares */
    epg_jog_t *jog;               /**< actuators that can be moved by hand; NULL: none */
} epg_application_t;

typedef struct epg_control epg_control_t;

/** Values about the control loop that streams can contain beside the signals, in ns. */
typedef enum epg_loop_value {
    EPG_LOOP_LATENESS,    /**< start of this cycle after its tick */
    EPG_LOOP_COMPUTATION, /**< computation time of the cycle before; 0 in the first row */
    EPG_LOOP_VALUES
} epg_loop_value_t;

/**
 * Values that a recording needs beside the signals, so that the run can be repeated from the initialisation of the model
 * on.  Streams can contain them.
 */
typedef enum epg_replay_value {
    EPG_REPLAY_CYCLE,     /**< number of this cycle, from 1 for the one that initialised the model; 0 while disabled */
    EPG_REPLAY_PARAMETER, /**< 1 + the index of a parameter that changed (epg/parameter_log.h); 0: none; -1: unknown */
    EPG_REPLAY_VALUE,     /**< its value after the change */
    EPG_REPLAY_ACTED,     /**< the cycle in which the change acted */
    EPG_REPLAY_UNTOLD,    /**< number of changes up to this cycle that the next rows tell */
    EPG_REPLAY_VALUES
} epg_replay_value_t;

/** The points at which the user's program takes part in a target (epg/access.h). */
typedef enum epg_access_point {
    EPG_ACCESS_BEGIN,   /**< after the setpoints of the communication side; the result is true if there are new ones */
    EPG_ACCESS_RESTORE, /**< the model was initialised: its parameters have their generated values */
    EPG_ACCESS_STEPPED, /**< the model was stepped, and its outputs were written */
    EPG_ACCESS_RESTED,  /**< instead of that point: the model was not stepped in this cycle */
    EPG_ACCESS_TURN     /**< on the communication side: once in each turn of its loop */
} epg_access_point_t;

/** An access of the user's program: an element of a list. */
typedef struct epg_access {
    struct epg_access *next;
    /** Lets this access and all after it act.  Not part of the cycle's code, so that a program without access lacks it. */
    bool (*reach)(struct epg_access *self, epg_control_t *control, epg_access_point_t point);
    /** Lets this access act.  The result has a meaning only at EPG_ACCESS_BEGIN. */
    bool (*act)(struct epg_access *self, epg_control_t *control, epg_access_point_t point);
} epg_access_t;

/**
 * The state of one target.  Only the runtime writes its members; other code calls the functions below.  Code on the
 * control side may read the status.
 */
struct epg_control {
    const epg_application_t *application;
    /* The status, which each cycle publishes at its end.  The union gives its members short names. */
    union {
        epg_status_t status;
        struct {
            bool enabled;
            bool leased; /**< an enabled target stays enabled only until `lease` */
            uint16_t fault_component;
            epg_fault_t fault;
            uint64_t time_ns; /**< tick of the newest cycle */
            epg_statistics_t statistics;
            uint64_t stop_number;
            uint64_t stop_ns;
            epg_stop_source_t stop_source;
        };
    };
    bool initialise;     /**< the model must be initialised in this or the next cycle */
    bool model_valid;    /**< false: the model is not initialised, or stopped after a fault */
    bool setpoints_move; /**< values of setpoints change without a new sample: epg_setpoints_start() */
    uint64_t sampled_ns; /**< time at which the sensors were sampled in the newest cycle */
    uint32_t until_step; /**< cycles until the model's next step */
    uint32_t consecutive_overruns;
    atomic_uint lease;   /**< written by the communication side: end of the lease, in units of 2^20 ns, modulo 2^32 */
    atomic_uint dropped; /**< written by the communication side: number of refused setpoints */
    uint32_t refused;    /**< communication side: 1 + index of the setpoint that was refused last; 0: none */
    atomic_uint reconnects; /**< written by the communication side */
    atomic_uint alive;      /**< written by the communication side; 0 before the first epg_control_alive() */
    unsigned int alive_seen;
    uint32_t silence; /**< control cycles since `alive` last changed */
    struct {
        atomic_uint used;
        atomic_uint size;
    } stacks[EPG_STACKS];           /**< written by the communication side */
    epg_exchange_t status_exchange; /**< for epg_control_status() */
    epg_status_t status_buffers[4];
    epg_exchange_t observer_exchange; /**< for epg_control_observe() */
    epg_status_t observer_buffers[4];
    double loop[EPG_LOOP_VALUES];     /**< for streams; control side */
    double replay[EPG_REPLAY_VALUES]; /**< for streams; control side */
    uint64_t first_cycle;             /**< number of cycles before the one that initialised the model */
    uint64_t loop_total;              /**< computation time of all cycles up to the last one with a stream, ns */
    atomic_bool observed;             /**< epg_control_observe() has been called */
    atomic_bool reset;                /**< epg_control_reset() was called; the next cycle clears it */
    epg_access_t *_Atomic accesses;   /**< the first access of the user's program; NULL: none is used */
    epg_latch_t latch;                /**< stops and requests to enable; last, because a start keeps it */
};

#define EPG_STATUS_MEMBER(member)                                                                                      \
    static_assert(offsetof(epg_control_t, member) - offsetof(epg_control_t, status) == offsetof(epg_status_t, member), \
                  "a control object begins with the members of epg_status_t")
EPG_STATUS_MEMBER(enabled);
EPG_STATUS_MEMBER(leased);
EPG_STATUS_MEMBER(fault_component);
EPG_STATUS_MEMBER(fault);
EPG_STATUS_MEMBER(time_ns);
EPG_STATUS_MEMBER(stop_number);
EPG_STATUS_MEMBER(stop_ns);
EPG_STATUS_MEMBER(stop_source);
EPG_STATUS_MEMBER(statistics);
#undef EPG_STATUS_MEMBER

/*
 * One context must be the control side, and one other context the communication side.  Several contexts may share the
 * communication side if they take turns.  Only epg_stop(), epg_control_enable() and epg_control_reset() may be called
 * from every context.
 */

/* Control side ----------------------------------------------------------------------------------------------- */

/**
 * Starts the peripherals with safe outputs, and clears all state.  The first cycle initialises the model with that
 * cycle's inputs.  Must be called before the first cycle; may be called again while neither side is active.
 */
void epg_control_start(epg_control_t *control, const epg_application_t *application);

/**
 * Runs one control cycle, for the tick that was due at `tick_ns` (board time, as epg_port_time_ns()).  `missed` is the
 * number of ticks without a cycle since the cycle before.
 */
void epg_control_cycle(epg_control_t *control, uint64_t tick_ns, uint32_t missed);

/** Counts a value that was outside its limits.  Called by generated code. */
void epg_control_count_clamped(epg_control_t *control);

/**
 * Disables the target, and latches `fault` of `component` (an index, or EPG_NO_COMPONENT).  If a fault is latched
 * already, that one stays, because it is usually the cause of the new one.  The outputs become safe in the present
 * cycle, or in the next one if the present cycle has written them already.
 *
 * Called by generated checks within a cycle.  A platform that starts after a fault calls it between
 * epg_control_start() and the first cycle.
 */
void epg_control_fault(epg_control_t *control, epg_fault_t fault, uint16_t component);

/** Calls epg_control_fault() unless `fault` is EPG_FAULT_NONE.  Called by generated code. */
static inline void epg_control_check(epg_control_t *control, epg_fault_t fault, uint16_t component)
{
    if (fault != EPG_FAULT_NONE) {
        epg_control_fault(control, fault, component);
    }
}

/**
 * Returns the number of control cycles since the last epg_control_alive(), 0 before the first one.  A platform with a
 * watchdog feeds it after a cycle only while this number is small.  So the watchdog notices if either side stops.
 */
static inline uint32_t epg_control_silence(const epg_control_t *control)
{
    return control->silence;
}

/** Returns the value of setpoint `index` in this cycle, after timeout and rate limit. */
static inline double epg_control_setpoint(const epg_control_t *control, size_t index)
{
    return control->application->setpoint_states[index].value;
}

/* Communication side ----------------------------------------------------------------------------------------- */

/**
 * Delivers a received value to setpoint `index`.  `received_ns` is the instant of reception in board time
 * (epg_port_time_ns()).
 *
 * Values that arrived in one message can take effect in the same cycle: pass `publish` false for all of them but the
 * last.  Returns false if there is no such setpoint, or if epg_setpoint_accepts() is false: the value is then dropped
 * and counted.  With `publish` true, the values delivered before it are published all the same.
 */
bool epg_control_receive(epg_control_t *control, size_t index, double value, uint64_t received_ns, bool publish);

/**
 * Copies the newest `monitor_count` monitoring values.  All of them are finite and from the same cycle.  Returns false
 * before the model's first step, or if the target has no monitoring values.
 */
bool epg_control_monitor(epg_control_t *control, double *values);

/** Copies the newest status.  Returns false before the first cycle.  Only one context may call it: the user's code. */
bool epg_control_status(epg_control_t *control, epg_status_t *status);

/**
 * As epg_control_status(), for a second reader: the middleware.  Before the first cycle after its first call it returns
 * false, too.
 */
bool epg_control_observe(epg_control_t *control, epg_status_t *status);

/**
 * Requests to enable the target for the user's program (epg_gate_enable()): `request` is EPG_ENABLE_ANY or
 * epg_enable_after().  May be called from every context.  A request from the communication side uses its gate instead.
 */
void epg_control_enable(epg_control_t *control, unsigned int request);

/**
 * Moves the end of the lease to `until_ns` (board time, at most 2^51 ns ahead), rounded down to a multiple of 2^20 ns
 * (1.05 ms).  When that time has passed, the next cycle of a target that is enabled on a lease latches
 * EPG_FAULT_OPERATOR, and ends a movement by hand on the lease (EPG_JOG_LEASED).  Must be called before the request for
 * either.  Only one context may call it.
 */
void epg_control_extend(epg_control_t *control, uint64_t until_ns);

/**
 * Requests to clear a latched fault; takes effect in the next cycle.  The target stays disabled.  May be called from
 * every context.
 */
void epg_control_reset(epg_control_t *control);

/** Counts that the communication was lost and has come back. */
void epg_control_count_reconnect(epg_control_t *control);

/** Reports that the communication side is alive.  Must be called once in each turn of its loop. */
void epg_control_alive(epg_control_t *control);

/**
 * Reports the measured use of a stack (EPG_STACK_CONTROL or EPG_STACK_COMMUNICATION), in bytes.  The numbers are in the
 * statistics after the next epg_control_alive().
 */
void epg_control_report_stack(epg_control_t *control, unsigned int stack, uint32_t used, uint32_t size);

#endif
