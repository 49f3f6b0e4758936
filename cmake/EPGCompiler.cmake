# SPDX-License-Identifier: Apache-2.0
# Compiler options of EPG's libraries, of generated code and of models.  The project around EPG may have any options:
# with them, the controller still computes the same bits on every processor, and is still optimised.

# _epg_check_compiler()
#
# Stops with an error if the generator or the compiler of this build is Microsoft's, or behaves like it.  On Windows CMake
# takes these if no other generator is named.  Before project(), also if this computer has no C compiler.
function(_epg_check_compiler)
  get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  set(problem "")
  if(CMAKE_HOST_WIN32 AND CMAKE_GENERATOR MATCHES "^(NMake|Visual Studio|Borland|Watcom)")
    set(problem "CMake uses the generator '${CMAKE_GENERATOR}', whose compiler cannot build EPG's libraries.")
  elseif("${CMAKE_C_COMPILER_ID};${CMAKE_C_SIMULATE_ID}" MATCHES "MSVC")
    set(problem "the compiler ${CMAKE_C_COMPILER} cannot build EPG's libraries: MSVC, and Clang in its place, are not supported.")
  elseif(NOT languages AND NOT CMAKE_C_COMPILER AND NOT CMAKE_TOOLCHAIN_FILE)
    set(names cc gcc clang)
    set(wanted "")
    if(NOT "$ENV{CC}" STREQUAL "")
      separate_arguments(names NATIVE_COMMAND "$ENV{CC}")
      list(GET names 0 names)
      set(wanted " '${names}', which the environment variable CC names")
    endif()
    find_program(compiler NAMES ${names} NO_CACHE)
    if(NOT compiler)
      _epg_tools_of_project(needed)
      if("c_compiler" IN_LIST needed AND NOT "arm_gcc" IN_LIST needed) # it compiles the images
        set(problem "this computer has no C compiler${wanted}.")
      endif()
    endif()
  endif()
  if(problem STREQUAL "")
    return()
  endif()
  _epg_search_tools(answer c_compiler build_program)
  _epg_find_sdk(compiler c_compiler)
  set(text "EPG: ${problem} ${compiler_REMEDY}\n")
  if(CMAKE_HOST_WIN32)
    _epg_find_sdk(ninja build_program)
    string(APPEND text "Ninja starts the compiler. ${ninja_REMEDY}\n")
    string(APPEND text "Then open a new terminal, and configure in an empty build folder:\n  cmake -B build -G Ninja -DCMAKE_C_COMPILER=gcc")
  else()
    string(APPEND text "Then configure again.")
  endif()
  message(FATAL_ERROR "${text}")
endfunction()

# _epg_compiler_options(<target>)
#
# Sets the options of a CMake target whose sources are EPG's, generated, or a model's.
function(_epg_compiler_options target)
  set_target_properties(${target} PROPERTIES
    C_STANDARD 11 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF
    CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF
    UNITY_BUILD OFF) # static functions of two sources may have the same name
  _epg_optimize(${target})
  if(TARGET zephyr_interface)
    # This target has the flags that all code of a Zephyr image must share, such as those for the processor.
    target_link_libraries(${target} PRIVATE zephyr_interface)
  endif()
  _epg_arithmetic_library()
  target_link_libraries(${target} PRIVATE epg_arithmetic)
endfunction()

# _epg_arithmetic_library()
#
# Makes the library epg_arithmetic, which has options only, once per build: + - * / give the same bits on every processor,
# and constants have double precision.  The options of a linked library come behind all others, so they undo those of the
# project.  The compiler reports those that they cannot undo, because each source includes epg/exact_arithmetic.h.
function(_epg_arithmetic_library)
  if(TARGET epg_arithmetic)
    return()
  endif()
  _epg_data_folder(data)
  set(all "-fno-fast-math -fno-unsafe-math-optimizations -fno-finite-math-only -fno-associative-math -fno-reciprocal-math")
  string(APPEND all " -fsigned-zeros -ffp-contract=off")
  string(APPEND all " -include \"${data}/targets/runtime/include/epg/exact_arithmetic.h\"")
  # Clang has no -fsingle-precision-constant, and another meaning of -ftrapping-math.
  set(gnu "-fno-single-precision-constant -ftrapping-math")
  set(clang "")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86|i[3-6]86|x86_64|AMD64)$" AND CMAKE_SIZEOF_VOID_P EQUAL 4)
    string(APPEND all " -msse2 -mfpmath=sse") # the registers of the x87 have 80 bits
  endif()
  add_library(epg_arithmetic INTERFACE)
  foreach(language C CXX)
    target_compile_options(epg_arithmetic INTERFACE
      "$<$<COMPILE_LANG_AND_ID:${language},GNU>:SHELL:${all} ${gnu}>"
      "$<$<COMPILE_LANG_AND_ID:${language},Clang,AppleClang,ARMClang>:SHELL:${all}>")
  endforeach()
endfunction()

# _epg_optimize(<target>)
#
# Optimises a CMake target also in builds without optimisation: of the type Debug, and without a type.  The option is that
# of the project's Release builds if they are optimised for size, else -O2.  EPG_OPTIMIZE=OFF leaves it out.  Not for
# Zephyr, whose Kconfig has options for it.
function(_epg_optimize target)
  if((DEFINED EPG_OPTIMIZE AND NOT EPG_OPTIMIZE) OR TARGET zephyr_interface)
    return()
  endif()
  set(types "${CMAKE_CONFIGURATION_TYPES}")
  if(NOT types)
    set(types "${CMAKE_BUILD_TYPE}")
  endif()
  if(NOT types)
    set(types "-") # no type: foreach() does not run for an empty text
  endif()
  get_property(of_folder DIRECTORY PROPERTY COMPILE_OPTIONS)
  list(FILTER of_folder EXCLUDE REGEX "[$]<") # only a build can evaluate these
  foreach(language C CXX)
    _epg_optimization(release "${CMAKE_${language}_FLAGS_RELEASE}")
    set(wanted -O2)
    if(release MATCHES "^-O[sz]$")
      set(wanted "${release}")
    endif()
    set(compiler "$<COMPILE_LANG_AND_ID:${language},GNU,Clang,AppleClang,ARMClang>")
    foreach(type IN LISTS types)
      string(REGEX REPLACE "^-$" "" type "${type}")
      string(TOUPPER "${type}" TYPE)
      _epg_optimization(present "${CMAKE_${language}_FLAGS} ${CMAKE_${language}_FLAGS_${TYPE}} ${of_folder}")
      if(present MATCHES "^(|-O0|-Og)$")
        target_compile_options(${target} PRIVATE "$<$<AND:${compiler},$<CONFIG:${type}>>:${wanted}>")
      endif()
    endforeach()
  endforeach()
endfunction()

# Sets <result> to the last of the options -O... in the text <flags>, or to "".
function(_epg_optimization result flags)
  string(REGEX MATCHALL "(^|[ ;])-O[^ ;]*" found "${flags}")
  list(POP_BACK found last)
  string(STRIP "${last}" last)
  set(${result} "${last}" PARENT_SCOPE)
endfunction()
