# Written for EPG's tests, with the conventions of the Pico SDK: selects the toolchain file before project().
set(CMAKE_TOOLCHAIN_FILE "${CMAKE_CURRENT_LIST_DIR}/toolchain.cmake")
list(APPEND CMAKE_MODULE_PATH "${CMAKE_CURRENT_LIST_DIR}") # Platform/PICO.cmake
