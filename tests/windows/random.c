/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * bcryptprimitives.dll, which Wine 8 does not have: packages written in Rust take random numbers from it.
 */
#include <windows.h>

#include <ntsecapi.h>

__declspec(dllexport) BOOL WINAPI ProcessPrng(BYTE *data, SIZE_T size);

BOOL WINAPI ProcessPrng(BYTE *data, SIZE_T size)
{
    return RtlGenRandom(data, (ULONG)size);
}
