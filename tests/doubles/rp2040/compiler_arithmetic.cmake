# project() includes this file in builds for EPG's replacement of the boot ROM.  That ROM has no floating-point
# functions: executables use the compiler's float and double.  (The SDK has a variable for double only; the property
# sets both.)
function(epg_use_compiler_arithmetic directory)
  get_property(targets DIRECTORY "${directory}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type "${target}" TYPE)
    if(type STREQUAL "EXECUTABLE")
      set_target_properties("${target}" PROPERTIES
        PICO_TARGET_FLOAT_IMPL pico_float_compiler PICO_TARGET_DOUBLE_IMPL pico_double_compiler)
    endif()
  endforeach()
  get_property(below DIRECTORY "${directory}" PROPERTY SUBDIRECTORIES)
  foreach(folder IN LISTS below)
    epg_use_compiler_arithmetic("${folder}")
  endforeach()
endfunction()

if(NOT EPG_COMPILER_ARITHMETIC_DEFERRED)
  set(EPG_COMPILER_ARITHMETIC_DEFERRED TRUE)
  cmake_language(DEFER DIRECTORY "${CMAKE_SOURCE_DIR}" CALL epg_use_compiler_arithmetic "${CMAKE_SOURCE_DIR}")
endif()
