/* The drivers of the target `turntable`, by those of this repository. */
#include <stdatomic.h>

#include "main.h"
#include "turntable_firmware.h"

_Static_assert(TIMERS_HZ / TURNTABLE_MOTOR_PRESCALER / (TURNTABLE_MOTOR_TOP + 1) == 20000,
               "turntable.tcf has another clock for the timers");

/* Extends TIM5 to 64 bits: the number of times that its highest bit has changed, as far as the last call has seen. */
static atomic_uint halves;

uint64_t turntable_time_ns(void)
{
    unsigned int half = atomic_load(&halves); /* must be read before the counter */
    const uint32_t now = microseconds();
    if ((half & 1u) != now >> 31) {
        atomic_store(&halves, ++half);
    }
    return (((uint64_t)half << 31) | (now & 0x7FFFFFFFu)) * 1000u;
}

uint32_t turntable_boot_id(void)
{
    return random_number();
}

uint16_t turntable_encoder_count(void)
{
    return encoder_count();
}

void turntable_motor_write(uint32_t level)
{
    motor_pwm(level);
}

void turntable_motor_direction_a_set(bool high)
{
    motor_direction(13, high);
}

void turntable_motor_direction_b_set(bool high)
{
    motor_direction(14, high);
}

size_t turntable_console_receive(void *data, size_t size)
{
    return serial_read(data, size);
}

size_t turntable_console_send(const void *data, size_t size)
{
    return serial_write(data, size);
}

/* The station has no memory for settings. */
size_t turntable_store_load(void *data, size_t size)
{
    (void)data;
    (void)size;
    return 0;
}

bool turntable_store_save(const void *data, size_t size)
{
    (void)data;
    (void)size;
    return false;
}
