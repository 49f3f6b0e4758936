/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control cycle: read inputs, step the model, write outputs, count.
 *
 * The generator writes one constant `epg_application_t` per target; everything else is here.  Two contexts use a
 * control object: the *control side* (a timer interrupt, a core of its own or a thread of highest priority) calls
 * epg_control_cycle() at every tick; the *communication side* delivers setpoints, fetches monitoring values and
 * requests enabling.  The two share nothing but the wait-free exchanges and a few atomic words.
 *
 * | event                                   | effect                                                             |
 * |-----------------------------------------|--------------------------------------------------------------------|
 * | disabled                                | actuators safe within one cycle; sensors, topics and model run on; |
 * |                                         | encoder resets are withheld, so zero positions stay                |
 * | enabled                                 | the model is initialised again, timeouts start again               |
 * | setpoint not finite                     | dropped and counted, the value before it stays                     |
 * | model input, state or output not finite | disabled, latched: EPG_FAULT_NOT_FINITE; the model rests           |
 * | model asks to stop (stopsimulation)     | disabled, latched: EPG_FAULT_MODEL_STOPPED; the model rests        |
 * | `overrun_limit` overruns in a row       | disabled, latched: EPG_FAULT_OVERRUN                               |
 * | setpoint older than its timeout         | hold, zero or disable (latched: EPG_FAULT_SETPOINT_TIMEOUT)        |
 * | fail-safe input inactive                | disabled, latched: EPG_FAULT_FAIL_SAFE                             |
 * | a component finds a fault               | disabled, latched with the component's index (epg_control_fault()) |
 * | late cycle                              | runs once; cycles that were missed are counted, not made up        |
 *
 * A model that rests is not run until the target is enabled again; what it published last stays.  Of several faults
 * the first is kept.  An old setpoint is no fault while the target is disabled: nobody need send any then.
 * A latched fault is cleared only by an explicit request to enable.
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
#include "epg/jog.h"
#include "epg/parameters.h"
#include "epg/status.h"

/** What happens when a setpoint is older than its timeout. */
typedef enum epg_timeout_action { EPG_TIMEOUT_HOLD, EPG_TIMEOUT_ZERO, EPG_TIMEOUT_DISABLE } epg_timeout_action_t;

/** One setpoint as the `.tcf` declares it. */
typedef struct epg_setpoint {
    double initial;      /**< value before the first one arrives, and after a timeout that disabled */
    double rate_limit;   /**< largest change per second of the value the model sees; 0: unlimited */
    uint64_t timeout_ns; /**< largest age, counted from the first sample and from enabling; 0: never too old */
    epg_timeout_action_t action;
    uint16_t component; /**< index of the component it comes from, for EPG_FAULT_SETPOINT_TIMEOUT */
} epg_setpoint_t;

/** One setpoint on its way from the communication side to the control side. */
typedef struct epg_setpoint_sample {
    double value;
    uint64_t received_ns;
    uint32_t count; /**< samples received so far; 0: none yet */
} epg_setpoint_sample_t;

/** What the control side keeps for one setpoint. */
typedef struct epg_setpoint_state {
    double value;      /**< as the model sees it: after timeout and rate limit */
    double target;     /**< as received last, or what its timeout made of it */
    uint64_t fresh_ns; /**< when its age began to count: received, or enabled after that */
    uint32_t count;    /**< of the sample taken last; 0: none yet */
    bool timed_out;    /**< until the next sample */
} epg_setpoint_state_t;

/**
 * A target as the generator describes it.  All functions run on the control side.  Arrays are the generator's, sized
 * by the counts, so that nothing is allocated at run time.
 */
typedef struct epg_application {
    const char *name;
    uint64_t period_ns;
    uint32_t step_divider;    /**< the model runs every n-th cycle; at least 1 */
    uint64_t output_delay_ns; /**< from a tick to its outputs; 0: they follow as soon as they are computed */
    uint32_t overrun_limit;   /**< overruns in a row that disable; 0: never */
    bool enable_at_start;

    void (*start)(void);  /**< configures all peripherals, outputs safe; before the first cycle */
    void (*sample)(void); /**< samples all sensors; first of all in every cycle, so that the instant does not vary */
    void (*read)(void);   /**< fills the model's inputs and checks components; every cycle */
    bool (*inputs_finite)(void);
    void (*model_init)(void); /**< (re-)initialises the model with the inputs read last */
    void (*model_step)(void);
    bool (*model_finite)(void);  /**< states and outputs */
    bool (*model_stopped)(void); /**< the model has asked to stop; NULL: it never does */
    void (*prepare)(void);       /**< what of write() needs no instant: arithmetic, resets; before it; NULL: nothing */
    void (*write)(void);         /**< model outputs to actuators, after each step, at the output delay */
    void (*safe)(void);          /**< every actuator to its safe value; every cycle while disabled */
    void (*monitor)(double *values); /**< fills `monitor_count` values to publish, after actuators; NULL: none */
    bool (*fail_safe)(void);         /**< true: the target may be enabled; before read(); NULL: no such input */
    uint16_t fail_safe_component;    /**< index of the component that is the fail-safe input */
    void (*arrived)(size_t index);   /**< communication side: a value for setpoint `index` is here; NULL: not wanted */

    size_t setpoint_count;
    const epg_setpoint_t *setpoints;
    epg_setpoint_sample_t *samples;        /**< `setpoint_count`: the control side's copy */
    epg_setpoint_sample_t *received;       /**< `setpoint_count`: the communication side's copy */
    epg_setpoint_state_t *setpoint_states; /**< `setpoint_count` */
    epg_exchange_t *setpoint_exchange;     /**< of `setpoint_count` samples; NULL: no setpoints */

    size_t monitor_count;
    double *monitor_values;           /**< `monitor_count`: the control side's copy */
    epg_exchange_t *monitor_exchange; /**< of `monitor_count` doubles; NULL: nothing to publish */

    epg_parameters_t *parameters; /**< that can be changed; NULL: none */
    epg_capture_t *capture;       /**< recording of signals; NULL: none */
    epg_jog_t *jog;               /**< actuators that can be moved by hand; NULL: none */
} epg_application_t;

typedef struct epg_control {
    const epg_application_t *application;
    /* What is handed over at the end of each cycle, as a whole and by the names of its members. */
    union {
        epg_status_t status;
        struct {
            bool enabled;
            uint16_t fault_component;
            epg_fault_t fault;
            uint64_t time_ns; /**< tick of the newest cycle */
            epg_statistics_t statistics;
        };
    };
    bool initialise;     /**< the model is to be initialised in this or the next cycle */
    bool model_valid;    /**< false: not initialised, or it rests after a fault */
    bool setpoints_move; /**< a setpoint has a timeout or a rate limit: they change without a new sample */
    uint32_t until_step; /**< cycles until the model's next step */
    uint32_t consecutive_overruns;
    uint32_t request_seen;
    atomic_uint request;    /**< written by the communication side: (sequence << 1) | enable */
    atomic_uint dropped;    /**< setpoints the communication side refused */
    atomic_uint reconnects; /**< written by the communication side */
    atomic_uint alive;      /**< written by the communication side: 0 before it first showed life */
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
    atomic_bool observed; /**< somebody calls epg_control_observe() */
} epg_control_t;

#define EPG_STATUS_MEMBER(member)                                                                                      \
    static_assert(offsetof(epg_control_t, member) - offsetof(epg_control_t, status) == offsetof(epg_status_t, member), \
                  "a control object begins with the members of epg_status_t")
EPG_STATUS_MEMBER(enabled);
EPG_STATUS_MEMBER(fault_component);
EPG_STATUS_MEMBER(fault);
EPG_STATUS_MEMBER(time_ns);
EPG_STATUS_MEMBER(statistics);
#undef EPG_STATUS_MEMBER

/*
 * One context is the control side, one other the communication side; two contexts may be the communication side if
 * they take turns.  epg_control_request() alone may be called from anywhere: of two calls at the same time one acts.
 */

/* Control side ----------------------------------------------------------------------------------------------- */

/**
 * Starts peripherals (outputs safe) and clears all state; the model is initialised in the first cycle, with that
 * cycle's inputs.  Before the first cycle; may be called again while neither side is active.
 */
void epg_control_start(epg_control_t *control, const epg_application_t *application);

/**
 * One control cycle for the tick that was due at `tick_ns` (epg_port_time_ns()'s time base); `missed` ticks before
 * it ran no cycle.
 */
void epg_control_cycle(epg_control_t *control, uint64_t tick_ns, uint32_t missed);

/** Counts a value that had to be limited.  Called by generated code. */
void epg_control_count_clamped(epg_control_t *control);

/**
 * Disables and latches `fault` of `component` (an index, or EPG_NO_COMPONENT), unless one is latched already: the
 * first is the cause of what follows.  The outputs are made safe in the cycle at hand, or in the next one if called
 * after its outputs.  For generated checks, and for a platform that starts after a fault: between
 * epg_control_start() and the first cycle.
 */
void epg_control_fault(epg_control_t *control, epg_fault_t fault, uint16_t component);

/** epg_control_fault() unless `fault` is EPG_FAULT_NONE.  Called by generated code. */
static inline void epg_control_check(epg_control_t *control, epg_fault_t fault, uint16_t component)
{
    if (fault != EPG_FAULT_NONE) {
        epg_control_fault(control, fault, component);
    }
}

/**
 * Control cycles since the communication side last called epg_control_alive(); 0 before it has ever done so.  A
 * platform with a watchdog feeds it after a cycle while this is small.
 */
static inline uint32_t epg_control_silence(const epg_control_t *control)
{
    return control->silence;
}

/** Value of setpoint `index` in this cycle. */
static inline double epg_control_setpoint(const epg_control_t *control, size_t index)
{
    return control->application->setpoint_states[index].value;
}

/* Communication side ----------------------------------------------------------------------------------------- */

/**
 * Delivers a received value to setpoint `index`.  Several values that arrived together can be handed over as one
 * by `publish` false for all but the last: the model sees them in the same cycle.  Returns false if the value is not
 * finite (then it is dropped and counted, and those handed over before it are published all the same) or if there is
 * no such setpoint.  `received_ns` is in epg_port_time_ns()'s time base.
 */
bool epg_control_receive(epg_control_t *control, size_t index, double value, uint64_t received_ns, bool publish);

/**
 * Copies the newest monitoring values (`monitor_count`, all of one cycle and finite); false before the model's first
 * step, or when there are none.
 */
bool epg_control_monitor(epg_control_t *control, double *values);

/** Copies the newest status; false before the first cycle.  For one reader. */
bool epg_control_status(epg_control_t *control, epg_status_t *status);

/**
 * As epg_control_status(), for a second reader: a middleware, so that user code has the other one for itself.  False
 * also before the first cycle after its first call.
 */
bool epg_control_observe(epg_control_t *control, epg_status_t *status);

/** Requests enabling (initialises the model, clears a latched fault) or disabling; acts in the next cycle. */
void epg_control_request(epg_control_t *control, bool enable);

/** Counts a reconnection of the communication. */
void epg_control_count_reconnect(epg_control_t *control);

/** The communication side is alive: once in each turn of its loop. */
void epg_control_alive(epg_control_t *control);

/**
 * What a platform has measured of a stack (EPG_STACK_CONTROL or EPG_STACK_COMMUNICATION), in bytes.  In the statistics
 * after the next epg_control_alive().
 */
void epg_control_report_stack(epg_control_t *control, unsigned int stack, uint32_t used, uint32_t size);

#endif
