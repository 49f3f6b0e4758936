/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The control loop in steps: each tick comes over UART 0, with the time and the counts that the drivers return.
 *
 * So each run has the same numbers, although two programs run it.  The cycle runs in an interrupt of high priority,
 * which the main loop or the task requests.
 */
#include "board.h"
#include "frames.h"
#include "jiwy_firmware.h"
#include "line.h"
#include "program.h"

const bool program_sleeps = true;

static frame_tick_t tick;
static frame_cycle_t cycle;

uint64_t jiwy_time_ns(void)
{
    return tick.time_ns;
}

PAN_COUNT_T jiwy_encoder_pan_count(void)
{
    return (PAN_COUNT_T)tick.counts[0];
}

TILT_COUNT_T jiwy_encoder_tilt_count(void)
{
    return (TILT_COUNT_T)tick.counts[1];
}

void jiwy_pwm_pan_write(uint32_t level)
{
    cycle.levels[0] = level;
}

void jiwy_pwm_tilt_write(uint32_t level)
{
    cycle.levels[1] = level;
}

void jiwy_pwm_pan_direction_a_set(bool high)
{
    cycle.directions[0] = high;
}

void jiwy_pwm_pan_direction_b_set(bool high)
{
    cycle.directions[1] = high;
}

void jiwy_pwm_tilt_direction_a_set(bool high)
{
    cycle.directions[2] = high;
}

void jiwy_pwm_tilt_direction_b_set(bool high)
{
    cycle.directions[3] = high;
}

/* There is no agent and no terminal. */

size_t jiwy_xrce_receive(void *data, size_t size)
{
    (void)data;
    (void)size;
    return 0;
}

size_t jiwy_xrce_send(const void *data, size_t size)
{
    (void)data;
    return size;
}

size_t jiwy_console_receive(void *data, size_t size)
{
    (void)data;
    (void)size;
    return 0;
}

size_t jiwy_console_send(const void *data, size_t size)
{
    (void)data;
    return size;
}

/** QEMU has no random number; each run is one start. */
uint32_t jiwy_boot_id(void)
{
    return 1U;
}

size_t jiwy_store_load(void *data, size_t size)
{
    (void)data;
    (void)size;
    return 0;
}

bool jiwy_store_save(const void *data, size_t size)
{
    (void)data;
    (void)size;
    return false;
}

void free_handler(void);

void free_handler(void)
{
    jiwy_cycle();
}

void program_start(void)
{
    line_start(0);
    board_interrupt_on(IRQ_FREE, PRIORITY_CYCLE);
}

/** Reads the next tick as soon as all of its bytes are there. */
static bool read_tick(void)
{
    static size_t have;
    const size_t head = offsetof(frame_tick_t, setpoints);
    unsigned char *bytes = (unsigned char *)&tick;
    if (have < head) {
        if (line_waiting(0) < head) {
            return false;
        }
        have = line_read(0, bytes, head);
    }
    const size_t size = (tick.flags & FRAME_SETPOINTS) != 0 ? sizeof tick : head;
    if (line_waiting(0) < size - have) {
        return false;
    }
    (void)line_read(0, bytes + have, size - have);
    have = 0;
    return true;
}

void program_turn(void)
{
    jiwy_values_t values;
    epg_status_t status;
    jiwy_communicate();
    if (!read_tick()) {
        return;
    }
    if ((tick.flags & FRAME_START) != 0) {
        (void)jiwy_start();
        jiwy_enable(true);
        (void)jiwy_get(&values); /* requests the values from the first cycle on */
    }
    if ((tick.flags & FRAME_SETPOINTS) != 0) {
        (void)jiwy_set_setpoint_pan(tick.setpoints[0]);
        (void)jiwy_set_setpoint_tilt(tick.setpoints[1]);
    }
    NVIC_PEND = 1U << IRQ_FREE;
    __asm volatile("dsb\n isb" ::: "memory"); /* the cycle runs here */
    if (jiwy_get(&values) && jiwy_status(&status)) {
        const double inputs[4] = {values.inputs.position_pan, values.inputs.position_tilt, values.inputs.setpoint_pan,
                                  values.inputs.setpoint_tilt};
        const double outputs[6] = {values.outputs.encoder_reset_pan, values.outputs.encoder_reset_tilt,
                                   values.outputs.pan_logging,       values.outputs.tilt_logging,
                                   values.outputs.pwm_pan,           values.outputs.pwm_tilt};
        for (unsigned int i = 0; i < 4U; i++) {
            cycle.inputs[i] = inputs[i];
        }
        for (unsigned int i = 0; i < 6U; i++) {
            cycle.outputs[i] = outputs[i];
        }
        cycle.cycles = status.statistics.cycles;
        cycle.missed = status.statistics.missed;
        cycle.overruns = status.statistics.overruns;
        cycle.fault = status.fault;
    }
    line_write_all(0, &cycle, sizeof cycle);
}
