/* A program that sets clocks when the test orders it, and then starts its target. */
#include <stdint.h>

#include "changed.h"
#include "epg/pico.h"
#include "hardware/clocks.h"
#include "pico/stdlib.h"

volatile uint32_t sys_khz;     /* for set_sys_clock_khz(), which switches clk_peri to 48 MHz; 0: no change */
volatile uint32_t peri_as_sys; /* clk_peri follows clk_sys again */
volatile uint32_t order;

volatile uint32_t started = 2; /* not called yet */
epg_pico_status_t status;
epg_mcu_clock_t wrong_clock_found;

int main(void)
{
    for (;;) {
        while (order == 0U) {
        }
        order = 0;
        if (sys_khz != 0U) {
            (void)set_sys_clock_khz(sys_khz, true);
        }
        if (peri_as_sys != 0U) {
            clock_configure_undivided(clk_peri, 0, CLOCKS_CLK_PERI_CTRL_AUXSRC_VALUE_CLK_SYS, clock_get_hz(clk_sys));
        }
        started = changed_start() ? 1U : 0U;
        epg_pico_status(&status);
        wrong_clock_found = *epg_pico_wrong_clock();
    }
}
