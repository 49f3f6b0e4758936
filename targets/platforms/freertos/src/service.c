/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Communication on FreeRTOS: a task, from static memory, with the user's tasks beside it.
 *
 * It runs every millisecond and at once when a transport's interrupt asks for it.  Tasks of higher priority go before
 * it; if they keep it waiting longer than EPG_FAMILY_SERVICE_TIMEOUT_MS, communication counts as stuck.
 */
#include "epg/family.h"
#include "epg/port_wait.h"
#include "rtos.h"

/**
 * Bytes that the task takes besides its middleware, with its registers while others run; interrupts have a stack of
 * their own.  Measured on RP2040 over six runs with USB flooded: 1652 in all with the console.  RP2350 was not measured.
 */
#define SERVICE_AND_CONTEXT (128 + 2 * EPG_FAMILY_FPU_FRAME)

/** Words of the task's stack, a quarter more than was measured. */
#ifndef EPG_FREERTOS_STACK_WORDS
#define EPG_FREERTOS_STACK_WORDS ((EPG_FAMILY_MIDDLEWARE_STACK + SERVICE_AND_CONTEXT) * 5 / 16)
#endif

#ifndef EPG_FREERTOS_PRIORITY
#define EPG_FREERTOS_PRIORITY (tskIDLE_PRIORITY + 2)
#endif

/** PARKED: the task waits for a start.  PARKING: it shall park after its turn. */
typedef enum state { PARKED, SERVING, PARKING } state_t;

/*
 * The task is made by the first start and is never deleted: interrupts notify it at any time, and in the middle of a
 * turn it may own a mutex of TinyUSB, or write to flash.
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

/** For a tick, or until a transport has something. */
static void rest(void)
{
    (void)ulTaskNotifyTake(pdTRUE, pdMS_TO_TICKS(1));
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
            service();
            rest();
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
