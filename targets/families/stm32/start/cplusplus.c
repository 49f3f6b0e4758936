/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * What a model in C++ needs besides the language itself.  The linker removes all of it from a program without C++.
 *
 * Models exported by 20-sim allocate their arrays when they are constructed, before the first control cycle.  The memory
 * is next to the model's other data.  The functions have the names that the C++ ABI for Arm gives them (IHI 0041), so
 * that the library's own, with exceptions, are not linked.
 */
#include <errno.h>
#include <stdlib.h>

#include "epg/family.h"

/** Bytes for `new` in models. */
#ifndef EPG_STM32_MODEL_MEMORY
#define EPG_STM32_MODEL_MEMORY 16384
#endif

static unsigned char memory[EPG_STM32_MODEL_MEMORY] EPG_ONE_CORE_DATA __attribute__((aligned(8)));

void *_sbrk(ptrdiff_t increment);

/** The memory of malloc(). */
void *_sbrk(ptrdiff_t increment)
{
    static ptrdiff_t used;
    if (increment > (ptrdiff_t)sizeof memory - used || increment < -used) {
        errno = ENOMEM;
        return (void *)UINTPTR_MAX;
    }
    void *begin = memory + used;
    used += increment;
    return begin;
}

void *_Znwj(size_t size);
void *_Znaj(size_t size);
void _ZdlPv(void *block);
void _ZdlPvj(void *block, size_t size);
void _ZdaPv(void *block);
void _ZdaPvj(void *block, size_t size);

/** operator new */
void *_Znwj(size_t size)
{
    void *block = malloc(size == 0U ? 1U : size);
    if (block == NULL) {
        epg_family_panic("the model needs more memory: compile with a larger EPG_STM32_MODEL_MEMORY");
    }
    return block;
}

/** operator new[] */
void *_Znaj(size_t size)
{
    return _Znwj(size);
}

/** operator delete */
void _ZdlPv(void *block)
{
    free(block);
}

void _ZdlPvj(void *block, size_t size)
{
    (void)size;
    free(block);
}

/** operator delete[] */
void _ZdaPv(void *block)
{
    free(block);
}

void _ZdaPvj(void *block, size_t size)
{
    (void)size;
    free(block);
}

/* A program never ends, so no destructor of a static object is called. */
int __aeabi_atexit(void *object, void (*destructor)(void *), void *library);
extern void *__dso_handle;
void *__dso_handle __attribute__((visibility("hidden")));

int __aeabi_atexit(void *object, void (*destructor)(void *), void *library)
{
    (void)object;
    (void)destructor;
    (void)library;
    return 0;
}

void __cxa_pure_virtual(void);

void __cxa_pure_virtual(void)
{
    epg_family_panic("a model in C++ has called a pure virtual function");
}

void __attribute__((noreturn)) abort(void);

void __attribute__((noreturn)) abort(void)
{
    epg_family_panic("abort() was called");
}
