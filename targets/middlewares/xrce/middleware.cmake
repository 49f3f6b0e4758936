# SPDX-License-Identifier: Apache-2.0
# The libraries of the middleware xrce: eProsima's Micro-CDR and Micro XRCE-DDS client, in the versions with which it
# was written and tested.  They are compiled here, for the processor of this build.  Their own CMake files are not used,
# because they add transports, options and install rules, and a compiler check that fails in a cross build.

function(_epg_middleware_xrce library)
  foreach(tool micro_cdr micro_xrce_dds_client)
    _epg_find_sdk(${tool} ${tool})
    if(NOT ${tool})
      message(FATAL_ERROR "Middleware 'xrce' needs ${tool}. ${${tool}_PROBLEM}")
    endif()
  endforeach()
  if(NOT micro_xrce_dds_client_VERSION MATCHES "^2\\.4\\.")
    message(FATAL_ERROR "Middleware 'xrce' is written for Micro XRCE-DDS client 2.4; the one in "
      "${micro_xrce_dds_client} is ${micro_xrce_dds_client_VERSION}.  MICRO_XRCE_DDS_CLIENT_PATH names another one")
  endif()
  set(headers "${CMAKE_BINARY_DIR}/epg/xrce")
  _epg_xrce_configure("${headers}" "${micro_cdr}" "${micro_cdr_VERSION}" "${micro_xrce_dds_client}"
    "${micro_xrce_dds_client_VERSION}")

  set(types "${micro_cdr}/src/c/types")
  set(core "${micro_xrce_dds_client}/src/c/core")
  add_library(epg_micro_xrce_dds_client STATIC EXCLUDE_FROM_ALL
    "${micro_cdr}/src/c/common.c"
    ${types}/array.c ${types}/sequence.c ${types}/string.c "${CMAKE_CURRENT_FUNCTION_LIST_DIR}/micro_cdr/basic.c"
    ${core}/session/stream/input_best_effort_stream.c ${core}/session/stream/input_reliable_stream.c
    ${core}/session/stream/output_best_effort_stream.c ${core}/session/stream/output_reliable_stream.c
    ${core}/session/stream/stream_storage.c ${core}/session/stream/stream_id.c ${core}/session/stream/seq_num.c
    ${core}/session/session.c ${core}/session/session_info.c ${core}/session/submessage.c ${core}/session/object_id.c
    ${core}/session/common_create_entities.c ${core}/session/create_entities_bin.c
    ${core}/session/read_access.c ${core}/session/write_access.c
    ${core}/serialization/xrce_types.c ${core}/serialization/xrce_header.c ${core}/serialization/xrce_subheader.c
    "${micro_xrce_dds_client}/src/c/util/ping.c")
  target_include_directories(epg_micro_xrce_dds_client SYSTEM PUBLIC
    "${headers}" "${micro_cdr}/include" "${micro_xrce_dds_client}/include")
  set_target_properties(epg_micro_xrce_dds_client PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON UNITY_BUILD OFF)
  if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
    target_compile_options(epg_micro_xrce_dds_client PRIVATE -w -ffunction-sections -fdata-sections
      $<TARGET_PROPERTY:${library},COMPILE_OPTIONS>) # for size, for example
  endif()
  if(TARGET zephyr_interface)
    target_link_libraries(epg_micro_xrce_dds_client PRIVATE zephyr_interface) # the processor's flags
  endif()
  target_link_libraries(${library} PRIVATE epg_micro_xrce_dds_client)
  target_link_libraries(epg_micro_xrce_dds_client PRIVATE ${library}) # its clock is xrce_clock.c
endfunction()

# Writes the two configuration headers that the libraries' own CMake files would write.  They select one stream of each
# kind, no transport (EPG's platforms have their own), and no threads.
function(_epg_xrce_configure headers cdr cdr_version client client_version)
  set(PROJECT_VERSION "${cdr_version}")
  _epg_xrce_version_parts("${cdr_version}")
  set(CONFIG_MACHINE_ENDIANNESS UCDR_LITTLE_ENDIANNESS)
  configure_file("${cdr}/include/ucdr/config.h.in" "${headers}/ucdr/config.h")

  set(PROJECT_VERSION "${client_version}")
  _epg_xrce_version_parts("${client_version}")
  foreach(profile DISCOVERY UDP TCP CAN SERIAL CUSTOM_TRANSPORT MULTITHREAD SHARED_MEMORY STREAM_FRAMING)
    set(UCLIENT_PROFILE_${profile} OFF)
  endforeach()
  foreach(platform POSIX POSIX_NOPOLL WINDOWS FREERTOS_PLUS_TCP RTEMS_BSD_NET ZEPHYR)
    set(UCLIENT_PLATFORM_${platform} OFF)
  endforeach()
  foreach(stream OUTPUT_BEST_EFFORT OUTPUT_RELIABLE INPUT_BEST_EFFORT INPUT_RELIABLE)
    set(UCLIENT_MAX_${stream}_STREAMS 1)
  endforeach()
  set(UCLIENT_MAX_SESSION_CONNECTION_ATTEMPTS 1)
  set(UCLIENT_MIN_SESSION_CONNECTION_INTERVAL 1)
  set(UCLIENT_MIN_HEARTBEAT_TIME_INTERVAL 100)
  set(UCLIENT_TWEAK_XRCE_WRITE_LIMIT OFF)
  # An agent that receives no frame for this time asks the client three times within 0.6 s (GET_INFO), and then removes
  # its entities.  The guard drops the question, because a living client sends a ping every 0.1 s, also while it is
  # flooded, and the agent counts every frame as an answer.
  set(UCLIENT_HARD_LIVELINESS_CHECK ON)
  set(UCLIENT_HARD_LIVELINESS_CHECK_TIMEOUT 3000) # ms
  configure_file("${client}/include/uxr/client/config.h.in" "${headers}/uxr/client/config.h")
endfunction()

macro(_epg_xrce_version_parts version)
  string(REPLACE "." ";" _epg_parts "${version}")
  list(GET _epg_parts 0 PROJECT_VERSION_MAJOR)
  list(GET _epg_parts 1 PROJECT_VERSION_MINOR)
  list(GET _epg_parts 2 PROJECT_VERSION_PATCH)
endmacro()
