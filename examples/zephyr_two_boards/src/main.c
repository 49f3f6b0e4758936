/* One axis: its controller runs in threads of its own. */
#include <zephyr/kernel.h>
#include <zephyr/sys/printk.h>

#include "axis.h"

int main(void)
{
    if (!axis_start()) {
        printk("the axis cannot be started\n");
    }
    return 0;
}
