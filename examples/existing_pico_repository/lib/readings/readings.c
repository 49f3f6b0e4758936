#include "readings.h"

#include "hardware/adc.h"

#define TEMPERATURE_INPUT 4

void readings_start(void)
{
    adc_init();
    adc_set_temp_sensor_enabled(true);
}

float readings_temperature(void)
{
    adc_select_input(TEMPERATURE_INPUT);
    const float voltage = (float)adc_read() * 3.3f / 4096.0f;
    return 27.0f - (voltage - 0.706f) / 0.001721f; /* RP2040 data sheet, 4.9.5 */
}
