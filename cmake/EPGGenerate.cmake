# SPDX-License-Identifier: Apache-2.0
# Decides whether the generator must run: only if a file has changed that it has read or would read now.
#
# A successful run ends with a stamp.  The stamp holds a key (the arguments and the version of EPG) and a digest of the
# contents of all files that were read and written.  The stamp is not beside the generated files: it contains paths of
# this computer, and they do not.
#
# The stamp compares contents, not times: an upgraded wheel, another branch or an unpacked archive can bring changed
# files with old times.  MD5 is enough to notice edits, and faster than SHA-256; the digest does not protect against an
# attacker.  While the stamp is valid, Python is neither searched nor started, and no file is written.

# _epg_generate(<result> <name> <folder> <argument>...)
#
# Brings the generated files in <folder> up to date with `epg <argument>... --output <folder>`.
#   <result>    variable that is set to TRUE, or to FALSE if the run has failed; its messages are on the terminal
#   <name>      the target or model; the run writes <name>.cmake among other files
#   <folder>    folder of the generated files
#   <argument>  the arguments of EPG without --output, such as: generate jiwy --tcf jiwy.tcf ...
function(_epg_generate result name folder)
  set(record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${name}")
  set(stamp "${record}.stamp")
  set(EPG_TARGETS_DIR "")
  _epg_data_folder(data)
  set(EPG_TARGETS_DIR "${data}/targets")

  _epg_key(key ${ARGN})
  if(EXISTS "${stamp}")
    file(READ "${stamp}" known)
    if(known MATCHES "^${key} " AND EXISTS "${folder}/${name}.cmake")
      include("${folder}/${name}.cmake")
      _epg_digest(digest "${folder}")
      if(known STREQUAL "${key} ${digest}")
        _epg_configure_depends()
        _epg_repeat_warnings("${record}.warnings.txt")
        set(${result} TRUE PARENT_SCOPE)
        return()
      endif()
    endif()
    file(REMOVE "${stamp}")
  endif()

  set(started "${record}.started")
  file(WRITE "${started}" "")
  _epg_run(good ${ARGN} --output "${folder}" --warnings "${record}.warnings.txt")
  set(${result} "${good}" PARENT_SCOPE)
  if(good)
    include("${folder}/${name}.cmake")
    _epg_configure_depends()
    # A file that was edited while the generator ran may have been read before or after the edit: write no stamp.
    set(settled TRUE)
    foreach(file IN LISTS EPG_DEPENDS)
      if("${file}" IS_NEWER_THAN "${started}")
        set(settled FALSE)
      endif()
    endforeach()
    if(settled)
      _epg_key(key ${ARGN})
      _epg_digest(digest "${folder}")
      file(WRITE "${stamp}" "${key} ${digest}")
    endif()
  endif()
  file(REMOVE "${started}")
endfunction()

# _epg_key(<result> <argument>...)
#
# Sets <result> to a hash of everything that determines a run of EPG, except the contents of the user's files: the
# arguments, the user's folders of targets, the Python interpreter and the version of EPG.
function(_epg_key result)
  _epg_fingerprint(generator)
  set(interpreter "")
  if(EPG_PYTHON AND EXISTS "${EPG_PYTHON}")
    file(TIMESTAMP "${EPG_PYTHON}" time "%s" UTC)
    file(SIZE "${EPG_PYTHON}" size)
    set(interpreter "${EPG_PYTHON} ${time} ${size}")
  endif()
  _epg_wanted_python(wanted)
  # The folders count, not the way they are given: a variable here is an environment variable under <name>_connect.
  _epg_user_folders(roots)
  string(SHA256 key "${ARGN}\n${roots}\n${generator}\n${interpreter}\n${wanted}")
  set(${result} "${key}" PARENT_SCOPE)
endfunction()

# _epg_digest(<result> <folder>)
#
# Sets <result> to a hash of the contents of all files that were read and written, and of the names in all folders that
# were searched.  The caller must have included <name>.cmake, which lists them.
#   <folder>  folder of the generated files
function(_epg_digest result folder)
  set(text "")
  list(TRANSFORM EPG_OUTPUTS PREPEND "${folder}/" OUTPUT_VARIABLE outputs)
  foreach(file IN LISTS EPG_DEPENDS EPG_ABSENT outputs)
    if(EXISTS "${file}" AND NOT IS_DIRECTORY "${file}")
      file(MD5 "${file}" hash)
      string(APPEND text "${hash}\n")
    else()
      string(APPEND text "-\n")
    endif()
  endforeach()
  foreach(directory IN LISTS EPG_FOLDERS)
    file(GLOB names RELATIVE "${directory}" "${directory}/*")
    string(APPEND text "${names}\n")
  endforeach()
  _epg_user_folders(roots)
  foreach(root IN LISTS roots)
    file(GLOB_RECURSE names RELATIVE "${root}" "${root}/*")
    string(APPEND text "${names}\n")
  endforeach()
  string(SHA256 digest "${text}")
  set(${result} "${digest}" PARENT_SCOPE)
endfunction()

# _epg_fingerprint(<result>)
#
# Sets <result> to a hash that identifies this version of EPG.  For a wheel, pip's list of the hashes of its files is
# read, else the files.  This is done once per configure run.
function(_epg_fingerprint result)
  get_property(fingerprint GLOBAL PROPERTY _EPG_FINGERPRINT)
  if(NOT fingerprint)
    _epg_python_folder(python)
    _epg_data_folder(data)
    set(files "")
    if(data STREQUAL "${python}/_data")
      file(GLOB files "${python}/../epg-*.dist-info/RECORD" "${python}/../epg-*.dist-info/METADATA")
    endif()
    if(NOT files)
      file(GLOB_RECURSE files "${python}/*")
      list(FILTER files INCLUDE REGEX "\\.(py|j2)$")
      file(GLOB schemas "${data}/schemas/*.json")
      list(APPEND files ${schemas})
    endif()
    set(text "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
    foreach(file IN LISTS files)
      file(MD5 "${file}" hash)
      string(APPEND text "\n${hash}")
    endforeach()
    string(SHA256 fingerprint "${text}")
    set_property(GLOBAL PROPERTY _EPG_FINGERPRINT "${fingerprint}")
    set_property(DIRECTORY "${CMAKE_SOURCE_DIR}" APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
  endif()
  set(${result} "${fingerprint}" PARENT_SCOPE)
endfunction()

# _epg_configure_depends()
#
# Makes a build configure again after a change of a file that was read or of a folder that was searched.  The caller
# must have included <name>.cmake, which lists them.
function(_epg_configure_depends)
  set(folders ${EPG_FOLDERS})
  _epg_user_folders(roots)
  foreach(root IN LISTS roots)
    file(GLOB below LIST_DIRECTORIES true "${root}/*" "${root}/*/*")
    foreach(path IN LISTS root below)
      if(IS_DIRECTORY "${path}")
        list(APPEND folders "${path}")
      endif()
    endforeach()
  endforeach()
  # A folder changes with each file that is written into it.  A folder around or below the build tree changes with every
  # build, so watching it would configure again and again.
  set(watched "")
  foreach(folder IN LISTS folders)
    string(FIND "${CMAKE_BINARY_DIR}/" "${folder}/" around)
    string(FIND "${folder}/" "${CMAKE_BINARY_DIR}/" below)
    if(NOT around EQUAL 0 AND NOT below EQUAL 0)
      list(APPEND watched "${folder}")
    endif()
  endforeach()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${EPG_DEPENDS} ${watched})
endfunction()

# _epg_repeat_warnings(<file>)
#
# Prints the warnings of the last run again, if <file> has any, so that the user does not miss them.
function(_epg_repeat_warnings file)
  if(EXISTS "${file}")
    file(READ "${file}" text)
    message(NOTICE "${text}")
  endif()
endfunction()
