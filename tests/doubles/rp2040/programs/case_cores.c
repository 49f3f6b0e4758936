/* Both cores, and exceptions. */
#include "cases.h"
#include "hardware/divider.h"
#include "hardware/exception.h"
#include "hardware/irq.h"
#include "hardware/pwm.h"
#include "hardware/sync.h"
#include "pico/multicore.h"
#include "pico/stdlib.h"

#define ROUNDS 500u

static volatile uint32_t shared;
static volatile uint32_t core_1_done;

static void add_under_lock(void)
{
    spin_lock_t *lock = spin_lock_instance(20);
    for (uint32_t n = 0; n < ROUNDS; n++) {
        const uint32_t saved = spin_lock_blocking(lock);
        const uint32_t value = shared;
        busy_wait_at_least_cycles(n % 7u);
        shared = value + 1u;
        spin_unlock(lock, saved);
    }
}

static void core_1_adds(void)
{
    multicore_fifo_push_blocking(get_core_num() + 100u);
    results[2] = multicore_fifo_pop_blocking();
    add_under_lock();
    core_1_done = 1;
    __sev();
    for (;;) {
        __wfe();
    }
}

/* Launch, mailboxes in both directions, spinlocks, and a second launch after a reset. */
void case_two_cores(void)
{
    shared = 0;
    core_1_done = 0;
    multicore_reset_core1();
    multicore_launch_core1(core_1_adds);
    results[0] = get_core_num();
    results[1] = multicore_fifo_pop_blocking();
    multicore_fifo_push_blocking(77);
    add_under_lock();
    while (core_1_done == 0) {
        __wfe();
    }
    results[3] = shared;
}

static void __attribute__((noinline)) divide_many(uint32_t seed, uint32_t *sum)
{
    uint32_t x = seed;
    for (uint32_t n = 1; n < ROUNDS; n++) {
        x = x * 1664525u + 1013904223u;
        hw_divider_divmod_u32_start(x, n);
        const divmod_result_t result = hw_divider_result_wait();
        *sum += to_quotient_u32(result) ^ to_remainder_u32(result);
        hw_divider_divmod_s32_start((int32_t)x, -(int32_t)n);
        const divmod_result_t signed_result = hw_divider_result_wait();
        *sum += (uint32_t)to_quotient_s32(signed_result) ^ (uint32_t)to_remainder_s32(signed_result);
    }
}

static void core_1_divides(void)
{
    uint32_t sum = 0;
    divide_many(2, &sum);
    results[1] = sum;
    multicore_fifo_push_blocking(1);
    for (;;) {
        __wfe();
    }
}

/* Each core has its own divider. */
void case_divide_on_both(void)
{
    uint32_t sum = 0;
    multicore_reset_core1();
    multicore_launch_core1(core_1_divides);
    divide_many(1, &sum);
    results[0] = sum;
    (void)multicore_fifo_pop_blocking();
    hw_divider_divmod_u32_start(5, 0);
    const divmod_result_t by_zero = hw_divider_result_wait();
    results[2] = to_quotient_u32(by_zero);
    results[3] = to_remainder_u32(by_zero);
}

static void core_1_sleeps(void)
{
    for (uint32_t n = 0; n < 5; n++) {
        __wfe();
        shared++;
    }
    core_1_done = 1;
    for (;;) {
        __wfe();
    }
}

/* WFE returns once per event: core 1 counts the events of core 0. */
void case_events(void)
{
    shared = 0;
    core_1_done = 0;
    multicore_reset_core1();
    multicore_launch_core1(core_1_sleeps);
    busy_wait_us(100);
    results[0] = shared; /* events that were registered during the launch */
    for (uint32_t n = 1; core_1_done == 0; n++) {
        __sev();
        busy_wait_us(10);
        results[1] = n;
    }
    results[2] = shared;
}

static void __not_in_flash_func(on_wrap)(void)
{
    pwm_clear_irq(3);
    results[8 + get_core_num()]++;
}

static void core_1_waits_for_wraps(void)
{
    irq_set_exclusive_handler(PWM_IRQ_WRAP, on_wrap);
    irq_set_enabled(PWM_IRQ_WRAP, true);
    for (;;) {
        __wfi();
        results[10]++;
    }
}

/* The wrap interrupt reaches the core that enabled it. */
void case_interrupt_of_core_1(void)
{
    results[8] = results[9] = results[10] = 0;
    multicore_reset_core1();
    multicore_launch_core1(core_1_waits_for_wraps);
    busy_wait_us(50);
    pwm_set_wrap(3, 12499);
    pwm_set_irq_enabled(3, true);
    pwm_set_enabled(3, true);
    busy_wait_us(1050);
    pwm_set_enabled(3, false);
    pwm_set_irq_enabled(3, false);
    multicore_reset_core1();
}

static volatile uint32_t handled;

static void on_wrap_of_core_0(void)
{
    pwm_clear_irq(3);
    handled++;
}

/* While PRIMASK is set, an interrupt ends WFI; its handler runs when PRIMASK is cleared. */
void case_masked_sleep(void)
{
    handled = 0;
    irq_set_exclusive_handler(PWM_IRQ_WRAP, on_wrap_of_core_0);
    irq_set_enabled(PWM_IRQ_WRAP, true);
    pwm_set_wrap(3, 999);
    pwm_set_irq_enabled(3, true);
    const uint32_t saved = save_and_disable_interrupts();
    pwm_set_enabled(3, true);
    __wfi();
    results[0] = handled;
    pwm_set_enabled(3, false);
    restore_interrupts(saved);
    results[1] = handled;
    pwm_set_irq_enabled(3, false);
    irq_set_enabled(PWM_IRQ_WRAP, false);
    irq_remove_handler(PWM_IRQ_WRAP, on_wrap_of_core_0);
}

static volatile uint32_t sequence;

static void step(uint32_t digit)
{
    sequence = sequence * 10u + digit;
}

static void on_low(void)
{
    step(1);
    irq_set_pending(31); /* higher priority: runs at once */
    __dsb();
    __isb();
    step(3);
    irq_set_pending(29); /* same priority: runs afterwards */
    __dsb();
    __isb();
    step(4);
}

static void on_high(void)
{
    step(2);
}

static void on_same(void)
{
    step(5);
}

static void on_supervisor_call(void)
{
    step(6);
}

/* Priorities, preemption and SVC. */
void case_nested(void)
{
    sequence = 0;
    irq_set_exclusive_handler(30, on_low);
    irq_set_exclusive_handler(31, on_high);
    irq_set_exclusive_handler(29, on_same);
    irq_set_priority(30, 0xc0);
    irq_set_priority(29, 0xc0);
    irq_set_priority(31, 0x40);
    for (uint32_t n = 29; n < 32; n++) {
        irq_set_enabled(n, true);
    }
    exception_set_exclusive_handler(SVCALL_EXCEPTION, on_supervisor_call);
    irq_set_pending(30);
    __dsb();
    __isb();
    __asm volatile("svc #0");
    results[0] = sequence;
    results[1] = __get_current_exception();
}
