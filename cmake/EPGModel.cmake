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
  _epg_data_folder(data)
  set(EPG_TARGETS_DIR "${data}/targets")
  include("${output}/${name}.cmake")
  _epg_model_library("${name}" "${output}")
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

# _epg_model_library(<name> <output>)
#
# Makes the static library of a model.  The caller must have included the generated .cmake file, which sets the
# variables EPG_<name>_*.
#   <name>    name of the library and of the model
#   <output>  folder of the generated files
function(_epg_model_library name output)
  set(language "${EPG_${name}_LANGUAGE}")
  _epg_require_language(${language} "model '${name}'")
  list(TRANSFORM EPG_${name}_GENERATED PREPEND "${output}/" OUTPUT_VARIABLE generated)
  list(TRANSFORM EPG_${name}_EXPORTED_GENERATED PREPEND "${output}/" OUTPUT_VARIABLE exported)
  list(APPEND exported ${EPG_${name}_EXPORTED})

  set(objects "")
  if(exported)
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
    _epg_exact_arithmetic(${name}_export)
    set(objects "$<TARGET_OBJECTS:${name}_export>")
  endif()

  add_library(${name} STATIC ${generated} ${objects})
  target_include_directories(${name} PUBLIC "${output}")
  _epg_exact_arithmetic(${name})
  if(UNIX)
    target_link_libraries(${name} PUBLIC m) # the mathematical functions of C; embedded toolchains link them anyway
  endif()
endfunction()
