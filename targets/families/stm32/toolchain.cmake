# SPDX-License-Identifier: Apache-2.0
# The Arm GNU toolchain for a Cortex-M7 with a double-precision FPU: epg_import_stm32() chooses this file.
#
#   EPG_STM32_TOOLCHAIN  folder of the toolchain; without it, the compiler on the PATH
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # a test program would need a linker script
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES EPG_STM32_TOOLCHAIN)

find_program(CMAKE_C_COMPILER arm-none-eabi-gcc HINTS "${EPG_STM32_TOOLCHAIN}/bin" "${EPG_STM32_TOOLCHAIN}" REQUIRED)
find_program(CMAKE_CXX_COMPILER arm-none-eabi-g++ HINTS "${EPG_STM32_TOOLCHAIN}/bin" "${EPG_STM32_TOOLCHAIN}")
find_program(CMAKE_OBJCOPY arm-none-eabi-objcopy HINTS "${EPG_STM32_TOOLCHAIN}/bin" "${EPG_STM32_TOOLCHAIN}")
set(CMAKE_ASM_COMPILER "${CMAKE_C_COMPILER}")

set(_epg_cpu "-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard")
foreach(_epg_language C CXX ASM)
  set(CMAKE_${_epg_language}_FLAGS_INIT "${_epg_cpu} -ffunction-sections -fdata-sections")
endforeach()
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections")
set(CMAKE_EXECUTABLE_SUFFIX .elf)
foreach(_epg_language C CXX ASM)
  set(CMAKE_EXECUTABLE_SUFFIX_${_epg_language} .elf)
endforeach()

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
