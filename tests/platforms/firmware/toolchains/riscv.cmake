# Debian's compiler for RISC-V microcontrollers, with picolibc.  PROCESSOR: options that select the processor.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv)
set(CMAKE_C_COMPILER riscv64-unknown-elf-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # programs need a linker script
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PROCESSOR)
set(CMAKE_C_FLAGS_INIT "${PROCESSOR} --specs=picolibc.specs -ffunction-sections -fdata-sections")
# picolibc's linker script asks for the memory of the board.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-nostartfiles -Wl,--gc-sections,-e,main,--defsym=__flash_size=1M,--defsym=__ram_size=256K")
