/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The communication side on FreeRTOS: a task beside the user's tasks, in static memory.
 *
 * It runs at least every millisecond, and at once after a transport's interrupt.  Tasks of higher priority run first.  If they
 * make it wait longer than EPG_FAMILY_SERVICE_TIMEOUT_MS, the watchdog is no longer fed and resets the chip.
 */
#include "epg/family.h"
#include "epg/freertos.h"
#include "epg/port_wait.h"

/**
 * Bytes of stack for the task itself, and for its registers while another task runs.  The middleware's bytes are added.
 * Interrupts use another stack.  Measured on RP2040 in six runs with USB flooded: 1652 bytes in all with the console.
 * RP2350 was not measured.
 */
#define SERVICE_AND_CONTEXT (128 + 2 * EPG_FAMILY_FPU_FRAME)

/** Words of the task's stack: a quarter more than was measured. */
#ifndef EPG_FREERTOS_STACK_WORDS
#define EPG_FREERTOS_STACK_WORDS ((EPG_FAMILY_MIDDLEWARE_STACK + SERVICE_AND_CONTEXT) * 5 / 16)
#endif

#ifndef EPG_FREERTOS_PRIORITY
#define EPG_FREERTOS_PRIORITY (tskIDLE_PRIORITY + 2)
#endif

/** PARKED: the task waits for the next start.  PARKING: a stop waits for the end of the task's turn. */
typedef enum state { PARKED, SERVING, PARKING } state_t;

/*
 * The first start creates the task; no stop deletes it, for two reasons.  Interrupts may notify it at any time.  And in
 * the middle of a turn it may own a mutex of TinyUSB, or be writing to flash.
 */
static StaticTask_t memory;
static StackType_t stack[EPG_FREERTOS_STACK_WORDS];
static TaskHandle_t task;
static atomic_uint state = PARKED;
static void (*service)(void);

void epg_mcu_service_wake(void)
{
    if (task != NULL && xTaskGetSchedulerState() != taskSCHEDULER_NOT_STARTED) {
        BaseType_t woken = pdFALSE;
        vTaskNotifyGiveFromISR(task, &woken);
        portYIELD_FROM_ISR(woken);
    }
}

/** Sleeps until the next kernel tick, or until a transport's interrupt. */
static void rest(void)
{
    (void)ulTaskNotifyTake(pdTRUE, pdMS_TO_TICKS(1));
}

/**
 * One turn, and a rest unless the kernel's tick has come meanwhile: from one turn to the next is at most a tick.
 *
 * A tick between the comparison and the rest would make the rest a whole tick long.  Interrupts are therefore off until
 * the kernel, within the rest, holds its tick count still or has put the task to sleep.  It then switches them on.
 */
static void serve_until_tick(void)
{
    const TickType_t begin = xTaskGetTickCount();
    service();
    portDISABLE_INTERRUPTS();
    if (xTaskGetTickCount() == begin) {
        rest();
    } else {
        portENABLE_INTERRUPTS();
    }
}

void epg_port_wait_for_bytes(void)
{
    epg_mcu_serve_others(rest);
}

static void run(void *argument)
{
    (void)argument;
    for (;;) {
        switch (atomic_load(&state)) {
        case SERVING:
            serve_until_tick();
            break;
        case PARKING:
            atomic_store(&state, PARKED);
            break;
        default:
            (void)ulTaskNotifyTake(pdTRUE, portMAX_DELAY);
            break;
        }
    }
}

bool epg_mcu_service_start(void (*serve)(void))
{
    service = serve;
    atomic_store(&state, SERVING);
    if (task == NULL) {
        task = xTaskCreateStatic(run, "epg", EPG_FREERTOS_STACK_WORDS, NULL, EPG_FREERTOS_PRIORITY, stack, &memory);
    } else {
        (void)xTaskNotifyGive(task);
    }
    return task != NULL;
}

bool epg_mcu_service_stop(void)
{
    const BaseType_t scheduler = xTaskGetSchedulerState();
    if (scheduler == taskSCHEDULER_NOT_STARTED) {
        atomic_store(&state, PARKED); /* the task has never run */
        return true;
    }
    if (scheduler == taskSCHEDULER_SUSPENDED || epg_family_in_interrupt() || xTaskGetCurrentTaskHandle() == task) {
        return false;
    }
    atomic_store(&state, PARKING);
    (void)xTaskNotifyGive(task);
    while (atomic_load(&state) != PARKED) {
        vTaskDelay(1);
    }
    return true;
}

void epg_mcu_service_stack(uint32_t *size, uint32_t *used)
{
    *size = sizeof stack;
    *used = task == NULL ? 0U : (uint32_t)(sizeof stack - uxTaskGetStackHighWaterMark(task) * sizeof(StackType_t));
}
