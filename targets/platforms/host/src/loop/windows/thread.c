/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Threads of Windows.
 */
#include "loop/thread.h"

#include <windows.h>

static DWORD WINAPI thread_main(void *argument)
{
    epg_host_thread_t *self = argument;
    self->body(self->argument);
    return 0;
}

const char *epg_host_thread_start(epg_host_thread_t *self, epg_host_thread_body_t body, void *argument)
{
    self->body = body;
    self->argument = argument;
    self->handle = (uintptr_t)CreateThread(NULL, 0, thread_main, self, 0, NULL);
    return self->handle != 0 ? NULL : "Windows has no room for it";
}

/** The best priority that needs no permission: 15, where a program usually has 8. */
const char *epg_host_thread_start_control(epg_host_thread_t *self, epg_host_thread_body_t body, epg_host_run_t *run,
                                          void *argument)
{
    run->scheduler = "TIME_CRITICAL";
    run->scheduler_reason = NULL;
    const char *error = epg_host_thread_start(self, body, argument);
    if (error == NULL && !SetThreadPriority((HANDLE)self->handle, THREAD_PRIORITY_TIME_CRITICAL)) {
        run->scheduler = "NORMAL";
    }
    return error;
}

bool epg_host_thread_prepare(void)
{
    return false; /* Windows locks single pages only */
}

bool epg_host_thread_is_caller(const epg_host_thread_t *self)
{
    return GetThreadId((HANDLE)self->handle) == GetCurrentThreadId();
}

void epg_host_thread_join(epg_host_thread_t *self)
{
    WaitForSingleObject((HANDLE)self->handle, INFINITE);
    CloseHandle((HANDLE)self->handle);
}
