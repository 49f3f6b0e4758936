# Debian's compiler for Arm microcontrollers, with newlib.  PROCESSOR: options that select the processor.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # programs need a linker script
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PROCESSOR)
set(CMAKE_C_FLAGS_INIT "${PROCESSOR} -mthumb -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostartfiles -Wl,--gc-sections,-e,main")
