# SPDX-License-Identifier: Apache-2.0 FreeRTOS: the control side runs in the interrupt of a timer, which the kernel
# never masks; the communication side in a task.

include("${CMAKE_CURRENT_LIST_DIR}/../../mcu/mcu.cmake")

# Called by epg_add_target(): adds the kernel and the port layer to target <name>.
function(_epg_freertos_target name)
  _epg_mcu_check("${name}" good)
  if(good)
    _epg_freertos_kernel("${name}" good)
  endif()
  if(good)
    _epg_mcu_target("${name}"
      SERVICE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/service.c" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/hooks.c"
      LIBRARIES FreeRTOS-Kernel-Static)
    target_include_directories(${name}_port INTERFACE "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/include")
    # At the end of the top directory, the folders of the headers are known.
    cmake_language(EVAL CODE
      "cmake_language(DEFER DIRECTORY [[${CMAKE_SOURCE_DIR}]] CALL _epg_freertos_check_programs [[${name}]] [[${CMAKE_SOURCE_DIR}]])")
  endif()
endfunction()

# Called by epg_add_executable(): adds an executable that contains target <name> and nothing else.
function(_epg_freertos_executable executable name)
  _epg_mcu_executable("${executable}" "${name}" "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/src/main.c")
endfunction()

# Adds the CMake target FreeRTOS-Kernel-Static: the FreeRTOS kernel with EPG's FreeRTOSConfig.h, unless the project has
# this target, or that of the kernel's own CMakeLists.txt, freertos_kernel.  Reports an error and sets <result> to FALSE
# if the kernel is not found.
function(_epg_freertos_kernel name result)
  set(${result} TRUE PARENT_SCOPE)
  if(NOT TARGET FreeRTOS-Kernel-Static AND TARGET freertos_kernel)
    add_library(FreeRTOS-Kernel-Static INTERFACE)
    target_link_libraries(FreeRTOS-Kernel-Static INTERFACE freertos_kernel)
  endif()
  if(TARGET FreeRTOS-Kernel-Static)
    return()
  endif()
  _epg_find_sdk(FREERTOS_KERNEL_PATH freertos_kernel)
  set(problem "${FREERTOS_KERNEL_PATH_PROBLEM}")
  cmake_language(CALL _epg_${EPG_FAMILY}_freertos_port port submodule)
  set(folder "${FREERTOS_KERNEL_PATH}/${port}")
  if(FREERTOS_KERNEL_PATH AND NOT EXISTS "${folder}/library.cmake" AND NOT EXISTS "${folder}/port.c")
    set(problem "The FreeRTOS kernel in ${FREERTOS_KERNEL_PATH} has no port for this chip: there is no ${port}.")
    if(submodule)
      string(APPEND problem " Get it:\n  git -C \"${FREERTOS_KERNEL_PATH}\" submodule update --init ${submodule}")
    endif()
  endif()
  if(problem)
    message(SEND_ERROR "epg_add_target(${name}): ${problem}")
    set_property(TARGET ${name} PROPERTY EPG_FAILED TRUE)
    set(${result} FALSE PARENT_SCOPE)
    return()
  endif()
  cmake_path(GET EPG_FAMILY_CMAKE PARENT_PATH family)
  set(FREERTOS_CONFIG_FILE_DIRECTORY "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/config" "${family}/freertos/include")
  if(EXISTS "${folder}/library.cmake")
    include("${folder}/library.cmake")
  else()
    _epg_freertos_library("${FREERTOS_KERNEL_PATH}" "${folder}" "${FREERTOS_CONFIG_FILE_DIRECTORY}")
  endif()
endfunction()

# Adds FreeRTOS-Kernel-Static for a port that has no library.cmake.  <config> lists the folders of FreeRTOSConfig.h and
# of the headers that it includes.
function(_epg_freertos_library kernel port config)
  set(sources croutine event_groups list queue stream_buffer tasks timers)
  list(TRANSFORM sources REPLACE "(.+)" "${kernel}/\\1.c")
  add_library(FreeRTOS-Kernel-Static STATIC EXCLUDE_FROM_ALL ${sources} "${port}/port.c")
  target_include_directories(FreeRTOS-Kernel-Static SYSTEM PUBLIC ${config} "${kernel}/include" "${port}")
  target_compile_options(FreeRTOS-Kernel-Static PRIVATE -w -ffunction-sections -fdata-sections) # the kernel's own style
  set_target_properties(FreeRTOS-Kernel-Static PROPERTIES UNITY_BUILD OFF)
  _epg_optimize(FreeRTOS-Kernel-Static)
endfunction()

# Compares the settings of FreeRTOSConfig.h with those that EPG needs, in each executable in or below <directory> that
# links target <name>.  Reports the lines to write in one error.
function(_epg_freertos_check_programs name directory)
  get_property(programs DIRECTORY "${directory}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(program IN LISTS programs)
    get_target_property(libraries ${program} LINK_LIBRARIES)
    if("${name}" IN_LIST libraries OR "EPG::${name}" IN_LIST libraries)
      _epg_freertos_check_settings("${program}")
    endif()
  endforeach()
  get_property(subdirectories DIRECTORY "${directory}" PROPERTY SUBDIRECTORIES)
  foreach(subdirectory IN LISTS subdirectories)
    _epg_freertos_check_programs("${name}" "${subdirectory}")
  endforeach()
endfunction()

# Checks the FreeRTOSConfig.h of an executable.  Where it is not found, or has headers that are not found, the compiler
# reports the same lines.  A file is checked once.
function(_epg_freertos_check_settings program)
  _epg_freertos_properties("${program}" folders INCLUDE_DIRECTORIES)
  find_file(file FreeRTOSConfig.h PATHS ${folders} NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH NO_CACHE)
  get_property(checked GLOBAL PROPERTY EPG_FREERTOS_CHECKED)
  if(NOT file OR file IN_LIST checked)
    return()
  endif()
  set_property(GLOBAL APPEND PROPERTY EPG_FREERTOS_CHECKED "${file}")
  set_property(DIRECTORY "${CMAKE_SOURCE_DIR}" APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
  _epg_freertos_properties("${program}" definitions COMPILE_DEFINITIONS)
  list(TRANSFORM folders PREPEND "-I")
  list(TRANSFORM definitions REPLACE "^-D" "")
  list(TRANSFORM definitions PREPEND "-D")
  separate_arguments(flags NATIVE_COMMAND "${CMAKE_C_FLAGS}")
  file(CONFIGURE OUTPUT "${CMAKE_BINARY_DIR}/CMakeFiles/epg/freertos_settings.c" @ONLY CONTENT
"#include \"FreeRTOSConfig.h\"
#include \"@CMAKE_CURRENT_FUNCTION_LIST_DIR@/include/epg/freertos_settings.h\"
EPG_TICK configTICK_RATE_HZ EPG_END
")
  execute_process(COMMAND "${CMAKE_C_COMPILER}" ${flags} -E -P -w ${definitions} ${folders}
      "${CMAKE_BINARY_DIR}/CMakeFiles/epg/freertos_settings.c"
    OUTPUT_VARIABLE text ERROR_QUIET RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    return()
  endif()
  string(REGEX MATCHALL "EPG_SETTING\\(\"[^\"]*" settings "${text}")
  list(TRANSFORM settings REPLACE "EPG_SETTING\\(\"" "  ")
  string(REGEX MATCH "EPG_TICK(.*)EPG_END" found "${text}")
  string(REGEX REPLACE "[A-Za-z_][A-Za-z_0-9]*|[() \n]" "" rate "${CMAKE_MATCH_1}") # ((TickType_t)1000) becomes 1000
  if(rate MATCHES "^[0-9]*$" AND NOT rate STREQUAL "1000")
    list(APPEND settings "  #define configTICK_RATE_HZ 1000 /* communication runs every millisecond */")
  endif()
  if(settings)
    list(JOIN settings "\n" lines)
    message(SEND_ERROR "EPG: ${program} contains a target on FreeRTOS, and settings of the kernel are wrong for it.\nWrite in ${file}:\n${lines}")
  endif()
endfunction()

# Sets <result> to the values of <property> of <target> and of the libraries that it links, without those that only a
# build can evaluate.
function(_epg_freertos_properties target result property)
  set(values "")
  set(pending "${target}")
  set(seen "")
  while(pending)
    list(POP_FRONT pending target)
    # the kernel's own CMakeLists.txt writes $<$<TARGET_EXISTS:freertos_config>:freertos_config>
    string(REGEX REPLACE "^[$]<(LINK_ONLY|BUILD_INTERFACE|[$]<TARGET_EXISTS:[^>]*>):(.*)>$" "\\2" target "${target}")
    if(NOT TARGET "${target}" OR target IN_LIST seen)
      continue()
    endif()
    set(names INTERFACE_${property} INTERFACE_SYSTEM_${property})
    set(links INTERFACE_LINK_LIBRARIES)
    if(NOT seen)
      list(PREPEND names ${property})
      set(links LINK_LIBRARIES)
    endif()
    list(APPEND seen "${target}")
    foreach(name IN LISTS names)
      get_target_property(of_target "${target}" ${name})
      if(of_target)
        list(APPEND values ${of_target})
      endif()
    endforeach()
    get_target_property(libraries "${target}" ${links})
    if(libraries)
      list(APPEND pending ${libraries})
    endif()
  endwhile()
  list(TRANSFORM values REPLACE "^[$]<BUILD_INTERFACE:(.*)>$" "\\1")
  list(FILTER values EXCLUDE REGEX "[$]<|>$")
  list(REMOVE_DUPLICATES values)
  set(${result} "${values}" PARENT_SCOPE)
endfunction()
