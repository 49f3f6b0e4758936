/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * A target of a system while it is simulated.
 */
#include "member.h"

#include <stdlib.h>
#include <string.h>

#include "loop/diverged.h"

#define BILLION 1000000000U

/** `value` * `factor` / `divisor`, rounded down, without overflow: `factor` and `divisor` are below 2^31. */
static uint64_t scaled(uint64_t value, uint64_t factor, uint64_t divisor)
{
    return value / divisor * factor + value % divisor * factor / divisor;
}

static uint64_t rate(const member_t *member)
{
    return (uint64_t)((int64_t)BILLION + member->facts->drift_ppb);
}

uint64_t member_true_ns(const member_t *member, uint64_t clock_ns)
{
    return member->started_ns + scaled(clock_ns, BILLION, rate(member));
}

uint64_t member_clock_ns(const member_t *member, uint64_t time_ns)
{
    return time_ns < member->started_ns ? 0U : scaled(time_ns - member->started_ns, rate(member), BILLION);
}

uint64_t member_tick_ns(const member_t *member, uint64_t number)
{
    return member_true_ns(member, number * member->unit->host->target->application->period_ns);
}

/* The plant ------------------------------------------------------------------------------------------------------ */

static void actuate(member_t *member)
{
    const epg_unit_plant_t *ports = member->unit->plant;
    if (member->plant == NULL) {
        return;
    }
    ports->actuate();
    for (size_t i = 0; i < ports->driven_count; i++) {
        const epg_unit_port_t *port = &ports->driven[i];
        char *inputs = member->plant->model->inputs;
        memcpy(inputs + port->offset, (const char *)ports->inputs + port->offset, port->size);
    }
}

/** Copies the outputs of the plant, which the trace has, too. */
static void take_outputs(const member_t *member)
{
    if (member->plant != NULL) {
        memcpy(member->unit->plant->outputs, member->plant->model->outputs, member->unit->plant->outputs_size);
    }
}

static void sense(const member_t *member)
{
    take_outputs(member);
    if (member->plant != NULL) {
        member->unit->plant->sense();
    }
}

static void advance(member_t *member, uint64_t time_ns)
{
    if (member->plant != NULL) {
        plant_advance(member->plant, time_ns);
    }
}

/* Start and end -------------------------------------------------------------------------------------------------- */

static bool load_unit(member_t *member)
{
    if (!module_load(&member->module, member->folder, member->facts->unit, EPG_UNIT_SYMBOL)) {
        return false;
    }
    member->unit = member->module.symbol;
    return true;
}

static bool load_plant(member_t *member)
{
    const epg_unit_plant_t *ports = member->unit->plant;
    member->plant = &member->own_plant;
    return plant_open(member->plant, member->folder, member->facts->plant,
                      member->unit->host->target->application->period_ns, ports->steps_per_period,
                      ports->starts_by_step);
}

/** Starts the application, which reads the sensors. */
static void start(member_t *member)
{
    sense(member);
    member->unit->start();
    actuate(member);
}

void member_die(member_t *member, uint64_t time_ns)
{
    advance(member, time_ns);
    member->unit->host->target->application->safe();
    actuate(member);
    member->state = MEMBER_IS_DEAD;
}

bool member_restart(member_t *member, uint64_t time_ns)
{
    member_die(member, time_ns);
    memset(member->announced, 0, member->unit->host->target->publication_count * sizeof *member->announced);
    module_unload(&member->module);
    if (!load_unit(member)) {
        return false;
    }
    member->trace.host = member->unit->host;
    member->life++;
    member->stall_ns = 0;
    member->is_stalled = false;
    member->missed = 0;
    member->started_ns = time_ns;
    member->state = MEMBER_RUNS;
    for (size_t i = 0; i < member->events.count && member->events.events[i].time_ns <= time_ns; i++) {
        const epg_host_event_t *event = &member->events.events[i];
        if (event->kind == EPG_HOST_INPUT) { /* the wires are as they were */
            member->unit->force((uint8_t)event->index, (epg_plant_force_t)event->value);
        }
    }
    start(member);
    return true;
}

bool member_open(member_t *member, const epg_system_target_t *facts, const char *folder, plant_t *plant)
{
    *member = (member_t){.facts = facts, .folder = folder, .started_ns = facts->start_ns};
    member->plant = facts->in_plant ? plant : NULL;
    if (!load_unit(member) || (facts->plant != NULL && !load_plant(member))) {
        return false;
    }
    start(member);
    const epg_target_t *target = member->unit->host->target;
    member->monitored = calloc(target->application->monitor_count + 1U, sizeof *member->monitored);
    member->published = calloc(target->application->monitor_count + 1U, sizeof *member->published);
    member->received = calloc(target->application->setpoint_count + 1U, sizeof *member->received);
    member->announced = calloc(target->publication_count + 1U, sizeof *member->announced);
    return member->monitored != NULL && member->published != NULL && member->received != NULL &&
           member->announced != NULL;
}

static uint64_t period_ns(const member_t *member)
{
    return member->unit->host->target->application->period_ns;
}

/** The time of the target's clock: at a tick on time it is that of the tick, without rounding. */
static uint64_t cycle_clock_ns(const member_t *member, uint64_t time_ns)
{
    const bool on_time = time_ns == member_tick_ns(member, member->tick);
    return on_time ? member->tick * period_ns(member) : member_clock_ns(member, time_ns);
}

static void end_cycle(member_t *member, uint64_t time_ns)
{
    const uint64_t tick_ns = member_tick_ns(member, member->tick);
    actuate(member);
    epg_host_trace_add(&member->trace, tick_ns, member->begin_ns - tick_ns, time_ns - member->begin_ns);
}

/** The control cycle that is stalled, on a stack of its own. */
static void stalled_cycle(void *context)
{
    member_t *member = context;
    member->unit->cycle(member->tick * period_ns(member), cycle_clock_ns(member, member->begin_ns), member->missed,
                        stall_wait, member->stall);
}

/** True if the outputs of the target's own plant are possible values.  Else false after a message. */
static bool own_plant_is_sound(const member_t *member, uint64_t time_ns)
{
    const epg_host_target_t *host = member->unit->host;
    for (size_t i = 0; member->plant == &member->own_plant && i < host->plant_output_count; i++) {
        const epg_host_signal_t *output = &host->plant_outputs[i];
        if (epg_host_has_diverged(*output->value)) {
            epg_host_tell_diverged(member->facts->name, output->name, *output->value, time_ns);
            return false;
        }
    }
    return true;
}

bool member_cycle(member_t *member, uint64_t number, uint64_t time_ns)
{
    advance(member, time_ns);
    sense(member);
    if (!own_plant_is_sound(member, time_ns)) {
        return false;
    }
    member->tick = number;
    member->begin_ns = time_ns;
    if (member->stall_ns > 0) {
        member->is_stalled = true;
        return stall_begin(&member->stall, stalled_cycle, member);
    }
    member->unit->cycle(number * period_ns(member), cycle_clock_ns(member, time_ns), member->missed, NULL, NULL);
    end_cycle(member, time_ns);
    return true;
}

void member_resume(member_t *member, uint64_t time_ns)
{
    advance(member, time_ns);
    take_outputs(member);
    member->is_stalled = false;
    stall_end(member->stall, member_clock_ns(member, time_ns));
    end_cycle(member, time_ns);
}

uint64_t member_next_tick(member_t *member, uint64_t time_ns)
{
    const uint64_t due = cycle_clock_ns(member, time_ns) / period_ns(member);
    const uint64_t next = due > member->tick + 1U ? due : member->tick + 1U;
    member->missed = (uint32_t)(next - member->tick - 1U);
    return next;
}

void member_close(member_t *member)
{
    epg_host_trace_end(&member->trace);
    epg_host_free_setpoints(&member->events);
    free(member->monitored);
    free(member->published);
    free(member->received);
    free(member->announced);
    stall_free(member->stall);
    module_unload(&member->module);
    plant_close(&member->own_plant);
}
