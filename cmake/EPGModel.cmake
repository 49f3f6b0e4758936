# SPDX-License-Identifier: Apache-2.0
# epg_add_model(<name> MODEL <folder or file> [INSTANCES <n>])
#
# The library EPG::<name> with the code of one model and a typed header <name>.h.  The model's own files are compiled as
# they are; several models, and the same one twice under two names, go together in one executable.

function(epg_add_model name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "MODEL;INSTANCES" "")
  _epg_require(epg_add_model "MODEL <folder or file> [INSTANCES <n>]" "${name}" "${arg_UNPARSED_ARGUMENTS}" "${arg_KEYWORDS_MISSING_VALUES}" MODEL)
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

# An empty library in place of one that could not be made, so that only the real mistake is reported.
function(_epg_placeholder name)
  if(NOT TARGET "${name}")
    add_library("${name}" INTERFACE)
    add_library(EPG::${name} ALIAS "${name}")
    set_property(TARGET "${name}" PROPERTY EPG_FAILED TRUE)
  endif()
endfunction()

# The static library of a model from the variables EPG_<name>_* of a generated .cmake file.
function(_epg_model_library name output)
  set(language "${EPG_${name}_LANGUAGE}")
  _epg_require_language(${language} "model '${name}'")
  list(TRANSFORM EPG_${name}_GENERATED PREPEND "${output}/" OUTPUT_VARIABLE generated)
  list(TRANSFORM EPG_${name}_EXPORTED_GENERATED PREPEND "${output}/" OUTPUT_VARIABLE exported)
  list(APPEND exported ${EPG_${name}_EXPORTED})

  set(objects "")
  if(exported)
    # The exported files: their own include path, their symbols renamed, and their warnings nobody's business.
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
    target_link_libraries(${name} PUBLIC m) # models compute sines; toolchains for microcontrollers link it anyway
  endif()
endfunction()
