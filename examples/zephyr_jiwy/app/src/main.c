/* JIWY's controller runs in threads of its own; this one says each second how it is. */
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>

#include "jiwy.h"

int main(void)
{
    epg_status_t status;

    if (!jiwy_start()) {
        printk("JIWY's controller cannot be started\n");
        return 0;
    }
    for (;;) {
        k_sleep(K_SECONDS(1));
        if (jiwy_status(&status)) {
            printk("%u cycles, %u overruns, %s\n", (unsigned)status.statistics.cycles,
                   (unsigned)status.statistics.overruns, status.enabled ? "enabled" : "disabled");
        }
    }
}
