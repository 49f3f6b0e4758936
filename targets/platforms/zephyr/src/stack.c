/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * The use of a thread's stack.
 */
#include <zephyr/kernel.h>

#include "parts.h"

/* On native_sim (CONFIG_ARCH_POSIX) threads run on stacks of the computer, which Zephyr does not measure. */
uint32_t epg_zephyr_stack_used(const struct k_thread *thread, size_t size)
{
#if defined(CONFIG_INIT_STACKS) && defined(CONFIG_THREAD_STACK_INFO) && !defined(CONFIG_ARCH_POSIX)
    size_t unused = 0;
    return k_thread_stack_space_get(thread, &unused) == 0 ? (uint32_t)(size - unused) : 0U;
#else
    ARG_UNUSED(thread);
    ARG_UNUSED(size);
    return 0U;
#endif
}
