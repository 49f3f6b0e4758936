# Written for EPG's tests: the platform PICO.
set_property(GLOBAL PROPERTY TARGET_SUPPORTS_SHARED_LIBS FALSE)
set(CMAKE_EXECUTABLE_SUFFIX .elf)
include(Platform/UnixPaths)
