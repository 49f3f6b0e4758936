/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file
 * Configuration of TinyUSB, and of EPG's USB device (`epg/usb.h`), for STM32.
 *
 * Names and numbers are in epg_stm32_target.h: those of the target configuration (`communication: {usb: ...}`), else
 * those of family.yaml.
 */
#ifndef EPG_STM32_TUSB_CONFIG_H
#define EPG_STM32_TUSB_CONFIG_H

#pragma GCC system_header

#include "epg/stm32_device.h"
#include "epg_stm32_target.h"

#if defined(EPG_STM32_H7)
#define CFG_TUSB_MCU OPT_MCU_STM32H7
#elif defined(EPG_STM32_F7)
#define CFG_TUSB_MCU OPT_MCU_STM32F7
#endif

/*
 * TinyUSB needs no function of a kernel: on FreeRTOS, too, only the communication side calls it.  Its critical sections
 * disable the interrupt of the USB device, and no other one.
 */
#define CFG_TUSB_OS OPT_OS_NONE
#define CFG_TUSB_DEBUG 0
#define CFG_TUD_MAX_SPEED OPT_MODE_FULL_SPEED

/* The core copies the packets to and from the FIFOs, so buffers can be in any memory, cached or not. */
#define CFG_TUD_DWC2_SLAVE_ENABLE 1
#define CFG_TUD_DWC2_DMA_ENABLE 0

/* TinyUSB takes the clock of the core from this variable, which a program can have wrong, or not at all. */
uint32_t epg_stm32_clock_hz(const char *name);
#define SystemCoreClock (epg_stm32_clock_hz("core"))

#include "epg/usb_config.h"

#endif
