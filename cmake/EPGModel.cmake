# SPDX-License-Identifier: Apache-2.0
# epg_add_model(<name> MODEL <folder or file> [INSTANCES <n>])
#
# Makes the library EPG::<name> with the code of one model and a typed header <name>.h.  The model's own files are
# compiled unchanged.  An executable may link several such libraries, also of the same model under two names.
#
#   <name>     name of the library; a prefix of its functions in C
#   MODEL      the model: a folder or a file; a relative path begins at the current source folder
#   INSTANCES  number of instances, 1 by default; only for a model without global state
#
# It stops with an error if an argument is missing or unknown.  A mistake in the model's files is reported, and the
# configure run fails at its end, so that all mistakes are reported together.

function(epg_add_model name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "MODEL;INSTANCES" "")
  _epg_require(epg_add_model "MODEL <folder or file> [INSTANCES <n>]" "${name}" "${arg_UNPARSED_ARGUMENTS}" "${arg_KEYWORDS_MISSING_VALUES}" MODEL)
  _epg_require_new(epg_add_model "${name}")
  _epg_require_language(C "EPG")
  if(NOT arg_INSTANCES)
    set(arg_INSTANCES 1)
  endif()
  get_filename_component(model "${arg_MODEL}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_SOURCE_DIR}")
  set(output "${CMAKE_BINARY_DIR}/epg/${name}")
  _epg_generate(good "${name}" "${output}" generate-model "${name}" --model "${model}" --instances "${arg_INSTANCES}"
    --source-dir "${CMAKE_SOURCE_DIR}" --caller "${CMAKE_CURRENT_LIST_FILE}")
  if(NOT good)
    message(SEND_ERROR "EPG: model '${name}' was not generated; the messages above say why")
    _epg_placeholder("${name}")
    return()
  endif()
  _epg_include("${output}" "${name}")
  _epg_model_library("${name}" "${output}" "${arg_INSTANCES}")
  add_library(EPG::${name} ALIAS ${name})
endfunction()

# _epg_placeholder(<name>)
#
# Makes an empty library EPG::<name> in place of one that could not be made.  Otherwise CMake would also report each use
# of the missing library.
function(_epg_placeholder name)
  if(NOT TARGET "${name}")
    add_library("${name}" INTERFACE)
    add_library(EPG::${name} ALIAS "${name}")
    set_property(TARGET "${name}" PROPERTY EPG_FAILED TRUE)
  endif()
endfunction()

# _epg_model_library(<name> <output> <instances>)
#
# Makes the static library of a model.  The caller must have included the generated .cmake file, which sets the
# variables EPG_<name>_*.
#   <name>       name of the library and of the model
#   <output>     folder of the generated files
#   <instances>  number of instances
function(_epg_model_library name output instances)
  set(language "${EPG_${name}_LANGUAGE}")
  _epg_require_language(${language} "model '${name}'")
  list(TRANSFORM EPG_${name}_GENERATED PREPEND "${output}/" OUTPUT_VARIABLE generated)
  list(TRANSFORM EPG_${name}_EXPORTED_GENERATED PREPEND "${output}/" OUTPUT_VARIABLE exported)
  list(APPEND exported ${EPG_${name}_EXPORTED})

  # Compile the exported files with their own include path, renamed symbols and no warnings: the user cannot change
  # them.
  add_library(${name}_export OBJECT EXCLUDE_FROM_ALL ${exported})
  target_include_directories(${name}_export PRIVATE ${EPG_${name}_INCLUDES} "${output}" "${output}/${name}_headers")
  target_compile_options(${name}_export PRIVATE
    $<IF:$<BOOL:${MSVC}>,/w,-w> $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<BOOL:${MSVC}>>>:-fno-exceptions>)
  if(EPG_${name}_FORCED_HEADER)
    if(MSVC)
      target_compile_options(${name}_export PRIVATE "/FI${output}/${EPG_${name}_FORCED_HEADER}")
    else()
      target_compile_options(${name}_export PRIVATE "SHELL:-include \"${output}/${EPG_${name}_FORCED_HEADER}\"")
    endif()
  endif()
  _epg_compiler_options(${name}_export)
  if(DEFINED EPG_${name}_FOREIGN)
    _epg_link_model("${name}" "${output}" ${exported})
  endif()
  if(APPLE)
    _epg_model_without_variables(objects variables "${name}")
  else()
    _epg_model_variables(objects variables "${name}" "${instances}" ${exported})
  endif()

  _epg_variables_library()
  add_library(${name} STATIC ${generated} "${variables}" ${objects})
  target_include_directories(${name} PUBLIC "${output}")
  target_link_libraries(${name} PRIVATE epg_variables)
  _epg_compiler_options(${name})
  if(UNIX)
    target_link_libraries(${name} PUBLIC m) # the mathematical functions of C; embedded toolchains link them anyway
  endif()
endfunction()

# _epg_link_model(<name> <output> <source>...)
#
# Compiles and links the code of a model of another tool alone, so that a missing source is one error here instead of
# many in the build.  It is done again only if the generated files, the compiler, its version or its options have changed.  The caller
# must have included the generated .cmake file.  EPG_LINK_CHECK=OFF leaves it out.  Not for compilers without the options
# of GNU ld, and not for Zephyr, whose options for the processor exist later.
#   <name>    name of the library and of the model
#   <output>  folder of the generated files
#   <source>  the model's own code
function(_epg_link_model name output)
  if(DEFINED EPG_LINK_CHECK AND NOT EPG_LINK_CHECK)
    return()
  endif()
  if(NOT CMAKE_C_COMPILER_ID MATCHES "^(GNU|Clang)$" OR CMAKE_C_COMPILER_TARGET OR APPLE OR TARGET zephyr_interface)
    return()
  endif()
  set(flags "${CMAKE_C_COMPILER_ARG1} ${CMAKE_C_FLAGS}")
  if(CMAKE_CROSSCOMPILING)
    string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
    string(APPEND flags " ${CMAKE_C_FLAGS_${type}}")
  endif()
  separate_arguments(flags NATIVE_COMMAND "${flags}")
  set(text "compiler\t${CMAKE_C_COMPILER}\narchiver\t${CMAKE_AR}\nforced\t${output}/${EPG_${name}_FORCED_HEADER}\n")
  if(CMAKE_CROSSCOMPILING)
    string(APPEND text "sections\tTRUE\nram\t${EPG_RAM_SIZE}\nflash\t${EPG_FLASH_SIZE}\n")
  endif()
  # the options of the project's folder, without those that only a build can evaluate
  get_property(options DIRECTORY PROPERTY COMPILE_OPTIONS)
  get_property(definitions DIRECTORY PROPERTY COMPILE_DEFINITIONS)
  get_property(folders DIRECTORY PROPERTY INCLUDE_DIRECTORIES)
  list(TRANSFORM definitions PREPEND "-D")
  list(TRANSFORM folders PREPEND "-I")
  list(APPEND flags ${options} ${definitions} ${folders})
  list(FILTER flags EXCLUDE REGEX "[$]<|^SHELL:")
  if(CMAKE_SYSROOT)
    list(APPEND flags "--sysroot=${CMAKE_SYSROOT}")
  endif()
  foreach(flag IN LISTS flags)
    string(APPEND text "flag\t${flag}\n")
  endforeach()
  foreach(folder IN LISTS EPG_${name}_INCLUDES ITEMS "${output}" "${output}/${name}_headers")
    string(APPEND text "include\t${folder}\n")
  endforeach()
  foreach(source IN LISTS ARGN)
    string(APPEND text "source\t${source}\n")
  endforeach()
  string(APPEND text "model\t${EPG_${name}_FOREIGN}\n") # the last line: the command reads it to the end of the file
  # CMake finds out the version of a compiler only once per build folder.  A compiler that is started by another program,
  # such as ccache, can be updated without a change of this program.
  _epg_program(program "${CMAKE_C_COMPILER}")
  execute_process(COMMAND "${CMAKE_C_COMPILER}" --version OUTPUT_VARIABLE version ERROR_QUIET)
  _epg_digest(files "${output}")
  string(SHA256 digest "${text}${files}${program}${version}")
  set(record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${name}.link")
  set(known "")
  if(EXISTS "${record}.stamp")
    file(READ "${record}.stamp" known)
  endif()
  if(NOT known STREQUAL digest)
    file(WRITE "${record}.txt" "${text}")
    _epg_run(good link-model "${name}" --inputs "${record}.txt" --summary "${record}.memory")
    if(NOT good)
      file(REMOVE "${record}.stamp")
      message(SEND_ERROR "EPG: model '${name}' cannot run on this target; the messages above say why")
      return()
    endif()
    file(WRITE "${record}.stamp" "${digest}")
  endif()
  file(READ "${record}.memory" memory)
  if(memory AND CMAKE_CROSSCOMPILING)
    message(STATUS "EPG: model '${name}' needs ${memory}, and of this ${EPG_${name}_HEAP} bytes of heap for each instance")
  endif()
endfunction()

# _epg_variables_library()
#
# Makes the library epg_variables, which keeps and restores the variables of models, once per build.
function(_epg_variables_library)
  if(TARGET epg_variables)
    return()
  endif()
  _epg_data_folder(data)
  set(runtime "${data}/targets/runtime")
  add_library(epg_variables STATIC EXCLUDE_FROM_ALL "${runtime}/src/model/variables.c")
  target_include_directories(epg_variables PUBLIC "${runtime}/include")
  _epg_compiler_options(epg_variables)
endfunction()

# _epg_model_variables(<objects> <table> <name> <instances> <source>...)
#
# Finds the variables of a model in its object files, those of the library <name>_export, so that each initialisation can
# give them the values of the start of the program.  `epg model-variables` does this while the project is built.
#   <objects>    variable that is set to the object files of the model's own code
#   <table>      variable that is set to the C file with the table of variables
#   <name>       name of the library
#   <instances>  number of instances
#   <source>     the sources of <name>_export
function(_epg_model_variables objects table name instances)
  set(folder "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/epg/${name}_objects$<CONFIG>")
  # The regions of variables are whole sections: few of them, and no common symbols.  Code of link-time optimisation has
  # no sections yet.  The options of a linked library come last, also after those of zephyr_interface.
  set_target_properties(${name}_export PROPERTIES INTERPROCEDURAL_OPTIMIZATION OFF UNITY_BUILD OFF)
  if(NOT TARGET epg_model_options)
    add_library(epg_model_options INTERFACE)
    target_compile_options(epg_model_options INTERFACE -fno-lto -fno-common -fno-data-sections)
  endif()
  target_link_libraries(${name}_export PRIVATE epg_model_options)
  set(copies "")
  set(index 0)
  foreach(source IN LISTS ARGN)
    set(extension "${CMAKE_C_OUTPUT_EXTENSION}")
    if(EPG_${name}_LANGUAGE STREQUAL "CXX")
      set(extension "${CMAKE_CXX_OUTPUT_EXTENSION}")
    endif()
    list(APPEND copies "${folder}/${name}_${index}${extension}")
    math(EXPR index "${index} + 1")
  endforeach()
  set(c_file "${folder}/${name}_export_variables.c")
  # Editors read compile_commands.json before the first build.
  set(configurations "${CMAKE_CONFIGURATION_TYPES}")
  if(NOT configurations)
    set(configurations "${CMAKE_BUILD_TYPE}")
  endif()
  foreach(configuration IN LISTS configurations ITEMS "")
    string(REPLACE "$<CONFIG>" "${configuration}" early "${c_file}")
    if(NOT EXISTS "${early}" AND (configuration OR NOT configurations))
      file(CONFIGURE OUTPUT "${early}" @ONLY CONTENT
"/* SPDX-License-Identifier: Apache-2.0 */
/* Generated by EPG: the build writes the table of the variables of model @name@ here. */
#include \"epg/variables.h\"

extern const epg_variables_t @name@_export_variables;
")
    endif()
  endforeach()
  _epg_find_python(python)
  _epg_python_folder(package)
  _epg_environment_command(environment)
  # A change of any file of EPG configures again, and changes this file.
  _epg_fingerprint(fingerprint)
  set(version "${CMAKE_BINARY_DIR}/CMakeFiles/epg/fingerprint.txt")
  file(CONFIGURE OUTPUT "${version}" @ONLY CONTENT "@fingerprint@\n")
  add_custom_command(OUTPUT ${copies} "${c_file}" VERBATIM COMMAND_EXPAND_LISTS
    COMMAND ${environment} EPG_ABSOLUTE_PATHS=1 "${python}" "${package}/__main__.py" model-variables "${name}"
      "$<TARGET_OBJECTS:${name}_export>" --instances "${instances}" --output "${folder}"
    DEPENDS ${name}_export "$<TARGET_OBJECTS:${name}_export>" "${version}"
    COMMENT "Finding the variables of model ${name}")
  set_source_files_properties(${copies} PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
  if(EPG_${name}_LANGUAGE STREQUAL "CXX") # CMake does not see the language of the copies
    set(language "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/epg/${name}_language.cpp")
    file(CONFIGURE OUTPUT "${language}" CONTENT "/* Generated by EPG: programs with this library need the library of C++. */\n")
    list(APPEND copies "${language}")
  endif()
  set(${objects} ${copies} PARENT_SCOPE)
  set(${table} "${c_file}" PARENT_SCOPE)
endfunction()

# _epg_model_without_variables(<objects> <table> <name>)
#
# Replaces _epg_model_variables() on macOS, whose linker moves each variable alone, and warns once.
function(_epg_model_without_variables objects table name)
  get_property(warned GLOBAL PROPERTY EPG_WARNED_OF_VARIABLES)
  if(NOT warned)
    set_property(GLOBAL PROPERTY EPG_WARNED_OF_VARIABLES TRUE)
    message(WARNING "EPG: in programs for ${CMAKE_SYSTEM_NAME}, EPG cannot find the variables of a model. If the target is enabled a second time, variables that the model's own initialisation leaves unchanged keep their values [model-not-restartable]")
  endif()
  set(c_file "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/epg/${name}_export_variables.c")
  file(CONFIGURE OUTPUT "${c_file}" @ONLY CONTENT
"/* SPDX-License-Identifier: Apache-2.0 */
/* Generated by EPG: the table of the variables of model @name@ is empty. */
#include \"epg/variables.h\"

extern const epg_variables_t @name@_export_variables;

const epg_variables_t @name@_export_variables = {.count = 0};
")
  set(${objects} "$<TARGET_OBJECTS:${name}_export>" PARENT_SCOPE)
  set(${table} "${c_file}" PARENT_SCOPE)
endfunction()
