# SPDX-License-Identifier: Apache-2.0
# Downloads a small library that the build compiles, if it is not found on this computer.  "fetch" in
# targets/tools/<name>.json names its repository and commit.  The id of a commit is a hash of its contents, so the
# contents cannot change.  The library is kept in EPG's cache, where later builds find it.
# FETCHCONTENT_FULLY_DISCONNECTED forbids the download, as it forbids CMake's own downloads.

# _epg_fetch_sdk(<result> <tool> <cache>)
#
#   <result>  variable that is set to the folder of the library; "" if the tool has no "fetch", downloads are forbidden,
#             there is no Git, or the download has failed
#   <tool>    name of the library: the file tools/<tool>.json
#   <cache>   EPG's cache
function(_epg_fetch_sdk result tool cache)
  set(${result} "" PARENT_SCOPE)
  _epg_tool_files(file "${tool}")
  file(READ "${file}" json)
  string(JSON commit ERROR_VARIABLE none GET "${json}" fetch commit)
  if(none OR FETCHCONTENT_FULLY_DISCONNECTED)
    return()
  endif()
  string(JSON title GET "${json}" title)
  string(JSON holds GET "${json}" holds)
  string(JSON url GET "${json}" fetch git)
  string(JSON name GET "${json}" fetch folder)
  find_program(EPG_GIT git NO_CMAKE_FIND_ROOT_PATH)
  mark_as_advanced(EPG_GIT)
  if(NOT EPG_GIT)
    return()
  endif()
  set(folder "${cache}/${name}")
  file(MAKE_DIRECTORY "${cache}")
  file(LOCK "${cache}/${name}.lock" GUARD FUNCTION TIMEOUT 600 RESULT_VARIABLE locked)
  if(NOT locked EQUAL 0)
    message(STATUS "EPG: ${title} is not fetched: ${locked}: ${cache}/${name}.lock")
    return()
  endif()
  if(NOT EXISTS "${folder}/${holds}") # another build may have fetched it before this one got the lock
    message(STATUS "EPG: fetching ${title} from ${url}")
    _epg_clone(good "${url}" "${commit}" "${folder}")
    if(NOT good OR NOT EXISTS "${folder}/${holds}")
      return()
    endif()
  endif()
  set(${result} "${folder}" PARENT_SCOPE)
endfunction()

# _epg_clone(<result> <url> <commit> <folder>)
#
# Puts one commit of a Git repository into a folder, completely or not at all.
#   <result>  variable that is set to TRUE, or to FALSE if Git has failed; its message is then printed
#   <url>     address of the repository
#   <commit>  id of the commit
#   <folder>  folder to write; an existing one is replaced
function(_epg_clone result url commit folder)
  # The name begins with a point, so no pattern of a tool's "cached" matches the folder while it is being filled.
  get_filename_component(parent "${folder}" DIRECTORY)
  get_filename_component(name "${folder}" NAME)
  set(part "${parent}/.${name}.part")
  file(REMOVE_RECURSE "${part}")
  file(MAKE_DIRECTORY "${part}")
  set(git "${EPG_GIT}" -C "${part}")
  execute_process(COMMAND ${git} init --quiet RESULT_VARIABLE status ERROR_VARIABLE problem)
  foreach(command "fetch;--quiet;--depth;1;${url};${commit}" "checkout;--quiet;${commit}")
    if(status EQUAL 0)
      execute_process(COMMAND ${git} ${command} RESULT_VARIABLE status ERROR_VARIABLE problem)
    endif()
  endforeach()
  set(${result} FALSE PARENT_SCOPE)
  if(status EQUAL 0)
    file(REMOVE_RECURSE "${part}/.git" "${folder}")
    file(RENAME "${part}" "${folder}")
    set(${result} TRUE PARENT_SCOPE)
  else()
    string(STRIP "${problem}" problem)
    message(STATUS "EPG: the download has failed: ${problem}")
    file(REMOVE_RECURSE "${part}")
  endif()
endfunction()
