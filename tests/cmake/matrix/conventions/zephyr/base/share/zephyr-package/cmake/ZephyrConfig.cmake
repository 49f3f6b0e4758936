# Written for EPG's tests, with the conventions of Zephyr's package: the parts that an application uses, without a
# kernel.
set(Zephyr_FOUND TRUE)
set(ZEPHYR_BASE "$ENV{ZEPHYR_BASE}" CACHE PATH "Zephyr base")
set(APPLICATION_SOURCE_DIR "${CMAKE_CURRENT_SOURCE_DIR}" CACHE PATH "Application Source Directory")
find_package(Python3 3.10 REQUIRED)
if(NOT BOARD)
  message(FATAL_ERROR "BOARD is not being defined on the CMake command-line in the environment or by the app.")
endif()

set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(BUILD_SHARED_LIBS OFF)
find_program(CMAKE_C_COMPILER ${CROSS}gcc REQUIRED)
find_program(CMAKE_CXX_COMPILER ${CROSS}g++ REQUIRED)
set(CMAKE_ASM_COMPILER "${CMAKE_C_COMPILER}")
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_EXPORT_COMPILE_COMMANDS TRUE CACHE BOOL "Export CMake compile commands" FORCE)

project(Zephyr-Kernel VERSION 4.1.0)
enable_language(ASM)
set(PROJECT_BINARY_DIR "${CMAKE_CURRENT_BINARY_DIR}/zephyr")
set(PROJECT_SOURCE_DIR "${ZEPHYR_BASE}")

# This target has every flag that all code of an image must share, such as those of the processor.
add_library(zephyr_interface INTERFACE)
target_compile_options(zephyr_interface INTERFACE -std=c11 -Wall -Wdouble-promotion -ffunction-sections -fdata-sections)
if(CROSS) # the prefix of the cross compiler
  target_compile_options(zephyr_interface INTERFACE -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard)
  target_link_options(zephyr_interface INTERFACE
    -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard --specs=nosys.specs)
endif()

add_library(app STATIC)
target_link_libraries(app PUBLIC zephyr_interface)
file(WRITE "${PROJECT_BINARY_DIR}/empty.c" "extern int main(void);\nvoid *zephyr_main = (void *)main;\n")
add_executable(zephyr_final "${PROJECT_BINARY_DIR}/empty.c")
set_target_properties(zephyr_final PROPERTIES OUTPUT_NAME zephyr SUFFIX .elf RUNTIME_OUTPUT_DIRECTORY zephyr)
target_link_libraries(zephyr_final PRIVATE -Wl,--whole-archive app -Wl,--no-whole-archive zephyr_interface)
