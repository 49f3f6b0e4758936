#include "FreeRTOS.h"
#include "mischief.h"
#include "task.h"

static StaticTask_t memory;
static StackType_t stack[512];

/** Priority of the task below.  A test raises it above that of communication. */
volatile uint32_t priority = 1;

static void run(void *argument)
{
    (void)argument;
    for (;;) {
        vTaskPrioritySet(NULL, priority);
        obey();
        vTaskDelay(1);
    }
}

int main(void)
{
    if (!CALL(start)()) {
        panic("start");
    }
    xTaskCreateStatic(run, "user", 512, NULL, 1, stack, &memory);
    vTaskStartScheduler();
    return 0;
}
