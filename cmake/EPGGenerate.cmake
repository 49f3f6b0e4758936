# SPDX-License-Identifier: Apache-2.0
# Decides whether the generator must run: only if a file has changed that it has read or would read now.
#
# A successful run ends with a stamp.  The stamp holds a key (the arguments and the version of EPG) and a digest of the
# contents of all files that were read and written.  The stamp is not beside the generated files: it contains paths of
# this computer, and they do not.
#
# The stamp compares contents, not times: an upgraded wheel, another branch or an unpacked archive can bring changed
# files with old times.  For EPG's own code it compares contents only if a size or a time differs.  MD5 is enough to
# notice edits, and faster than SHA-256; the digest does not protect against an attacker.  While the stamp is valid,
# Python is neither searched nor started, and no generated file is written.
#
# The first call for which Python must start also brings the other targets up to date of which a file has changed since
# the last configure run.  The record runs.cmake has their arguments.

# _epg_generate(<result> <name> <folder> <argument>...)
#
# Brings the generated files in <folder> up to date with `epg <argument>... --output <folder>`.
#   <result>    variable that is set to TRUE, or to FALSE if the run has failed; its messages are on the terminal
#   <name>      the target or model; the run writes <name>.cmake among other files
#   <folder>    folder of the generated files
#   <argument>  the arguments of EPG without --output, such as: generate jiwy --tcf jiwy.tcf ...
function(_epg_generate result name folder)
  set(record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${name}")
  _epg_record_run("${name}" "${folder}" ${ARGN})
  _epg_is_current(current "${name}" "${folder}" ${ARGN})
  if(current)
    _epg_configure_depends()
    _epg_repeat_warnings("${record}.warnings.txt")
    set(${result} TRUE PARENT_SCOPE)
    return()
  endif()
  file(REMOVE "${record}.stamp")
  _epg_fingerprint(version) # of the code that runs now, even if it is edited meanwhile
  # A run without a stamp may have read a file before it was edited.  The build would not notice this edit, because it is
  # older than the build files.  Such a run is therefore repeated once.
  set(before "")
  foreach(attempt first second)
    _epg_start(good "${name}" "${folder}" "${before}" ${ARGN})
    if(NOT good OR EXISTS "${record}.stamp")
      break()
    endif()
    _epg_include("${folder}" "${name}")
    _epg_digest(before "${folder}")
  endforeach()
  set(${result} "${good}" PARENT_SCOPE)
  if(good)
    _epg_include("${folder}" "${name}")
    _epg_configure_depends()
  endif()
endfunction()

# _epg_start(<result> <name> <folder> <before> <argument>...)
#
# Starts the generator for a run, and for other targets of which a file has changed.  Writes the stamps of those that were
# successful.  <before> is the digest of the run's files now, or "" if they are not known yet.  The other arguments are
# those of _epg_generate().
function(_epg_start result name folder before)
  set(record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${name}")
  set(started "${record}.started")
  file(WRITE "${started}" "")
  set(command ${ARGN} --output "${folder}" --warnings "${record}.warnings.txt")
  _epg_other_runs(others "${name}")
  if(others)
    list(JOIN command "\n\t" runs)
    set(runs "${record}.done\n\t${runs}\n")
    foreach(other IN LISTS others)
      get_property(arguments GLOBAL PROPERTY _EPG_RUN_${other})
      get_property(other_folder GLOBAL PROPERTY _EPG_FOLDER_${other})
      set(other_record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${other}")
      file(REMOVE "${other_record}.done")
      list(APPEND arguments --output "${other_folder}" --warnings "${other_record}.warnings.txt")
      list(JOIN arguments "\n\t" words)
      string(APPEND runs "\n${other_record}.done\n\t${words}\n")
    endforeach()
    file(WRITE "${record}.runs.txt" "${runs}")
    set(command generate-all "${record}.runs.txt")
  endif()
  _epg_run(good ${command})
  set(${result} "${good}" PARENT_SCOPE)
  foreach(other IN LISTS others)
    if(EXISTS "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${other}.done")
      get_property(arguments GLOBAL PROPERTY _EPG_RUN_${other})
      get_property(other_folder GLOBAL PROPERTY _EPG_FOLDER_${other})
      _epg_write_stamp("${other}" "${other_folder}" "${started}" "" ${arguments})
      file(REMOVE "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${other}.done")
    endif()
  endforeach()
  if(good)
    _epg_write_stamp("${name}" "${folder}" "${started}" "${before}" ${ARGN})
  endif()
  file(REMOVE "${started}" "${record}.runs.txt")
endfunction()

# _epg_include(<folder> <name>)
#
# Sets the variables of the generated file <folder>/<name>.cmake.  Paths of EPG's own files in it begin with the variable
# EPG_TARGETS_DIR, which must be set before.
macro(_epg_include folder name)
  _epg_data_folder(EPG_TARGETS_DIR)
  string(APPEND EPG_TARGETS_DIR "/targets")
  include("${folder}/${name}.cmake")
endmacro()

# _epg_is_current(<result> <name> <folder> <argument>...)
#
# Sets <result> to TRUE if the stamp of a run is valid.  The variables of <name>.cmake are then set, too.
function(_epg_is_current result name folder)
  set(${result} FALSE PARENT_SCOPE)
  set(stamp "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${name}.stamp")
  if(NOT EXISTS "${stamp}" OR NOT EXISTS "${folder}/${name}.cmake")
    return()
  endif()
  file(READ "${stamp}" known)
  _epg_key(key ${ARGN})
  if(known MATCHES "^${key} ")
    _epg_include("${folder}" "${name}")
    _epg_digest(digest "${folder}")
    if(known STREQUAL "${key} ${digest}")
      set(${result} TRUE PARENT_SCOPE)
      foreach(variable EPG_DEPENDS EPG_FOLDERS EPG_ABSENT)
        set(${variable} "${${variable}}" PARENT_SCOPE)
      endforeach()
    endif()
  endif()
endfunction()

# _epg_write_stamp(<name> <folder> <started> <before> <argument>...)
#
# Writes the stamp of a run that was successful, began when the file <started> was written, and had files with the digest
# <before> then.
function(_epg_write_stamp name folder started before)
  _epg_include("${folder}" "${name}")
  _epg_digest(digest "${folder}")
  # A file that was edited while the generator ran may have been read before or after the edit: write no stamp.  The time
  # of a file can also be in the future, because it is from a computer with another clock: the contents then decide.
  if(NOT digest STREQUAL before)
    foreach(file IN LISTS EPG_DEPENDS)
      if("${file}" IS_NEWER_THAN "${started}")
        return()
      endif()
    endforeach()
  endif()
  _epg_key(key ${ARGN})
  file(WRITE "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${name}.stamp" "${key} ${digest}")
endfunction()

# _epg_record_run(<name> <folder> <argument>...)
#
# Adds a run to a record in the build folder.  The first one of a configure run begins a new record, and keeps the
# former one for _epg_other_runs().
function(_epg_record_run name folder)
  set(record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/runs.cmake")
  get_property(begun GLOBAL PROPERTY _EPG_RECORDS_RUNS)
  if(NOT begun)
    set_property(GLOBAL PROPERTY _EPG_RECORDS_RUNS TRUE)
    if(EXISTS "${record}")
      file(RENAME "${record}" "${record}.before")
    endif()
  endif()
  _epg_user_folders(roots)
  set(text "_epg_known_run(")
  foreach(word IN ITEMS "${roots}" "${name}" "${folder}" LISTS ARGN)
    string(APPEND text " [==[${word}]==]")
  endforeach()
  file(APPEND "${record}" "${text})\n")
endfunction()

# _epg_known_run(<folders of targets> <name> <folder> <argument>...)
#
# A line of the record: a run of the last configure run.
function(_epg_known_run roots name folder)
  set_property(GLOBAL APPEND PROPERTY _EPG_RUNS "${name}")
  set_property(GLOBAL PROPERTY _EPG_ROOTS_${name} "${roots}")
  set_property(GLOBAL PROPERTY _EPG_FOLDER_${name} "${folder}")
  set_property(GLOBAL PROPERTY _EPG_RUN_${name} "${ARGN}")
endfunction()

# _epg_other_runs(<result> <name>)
#
# Sets <result> to the names of other runs that the run <name> can do in the same process: those of the last configure
# run that were successful, have the same folders of targets, and are not up to date.  A configure run asks once, when
# the first target has changed: later targets are then up to date, unless their arguments have changed.
function(_epg_other_runs result name)
  set(${result} "" PARENT_SCOPE)
  set(record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/runs.cmake.before")
  if(NOT EXISTS "${record}")
    return()
  endif()
  include("${record}")
  file(REMOVE "${record}")
  _epg_user_folders(roots)
  get_property(names GLOBAL PROPERTY _EPG_RUNS)
  set(others "")
  foreach(other IN LISTS names)
    get_property(other_roots GLOBAL PROPERTY _EPG_ROOTS_${other})
    get_property(folder GLOBAL PROPERTY _EPG_FOLDER_${other})
    get_property(arguments GLOBAL PROPERTY _EPG_RUN_${other})
    if(NOT other STREQUAL name AND other_roots STREQUAL roots
        AND EXISTS "${CMAKE_BINARY_DIR}/CMakeFiles/epg/${other}.stamp")
      _epg_is_current(current "${other}" "${folder}" ${arguments})
      if(NOT current)
        list(APPEND others "${other}")
      endif()
    endif()
  endforeach()
  set(${result} "${others}" PARENT_SCOPE)
endfunction()

# _epg_key(<result> <argument>...)
#
# Sets <result> to a hash of everything that determines a run of EPG, except the contents of the user's files: the
# arguments, the user's folders of targets, the Python interpreter and the version of EPG.
function(_epg_key result)
  _epg_fingerprint(generator)
  _epg_program(interpreter "${EPG_PYTHON}")
  _epg_wanted_python(wanted)
  # The folders count, not the way they are given: a variable here is an environment variable under <name>_connect.
  _epg_user_folders(roots)
  string(SHA256 key "${ARGN}\n${roots}\n${generator}\n${interpreter}\n${wanted}")
  set(${result} "${key}" PARENT_SCOPE)
endfunction()

# _epg_program(<result> <program>)
#
# Sets <result> to the path, time and size of a program, which an update changes; to "" if there is no such program.
function(_epg_program result program)
  set(${result} "" PARENT_SCOPE)
  if(program AND EXISTS "${program}")
    file(TIMESTAMP "${program}" time "%s" UTC)
    file(SIZE "${program}" size)
    set(${result} "${program} ${time} ${size}" PARENT_SCOPE)
  endif()
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
    _epg_pattern(pattern "${directory}")
    file(GLOB names RELATIVE "${directory}" "${pattern}/*")
    string(APPEND text "${names}\n")
  endforeach()
  _epg_user_folders(roots)
  foreach(root IN LISTS roots)
    _epg_pattern(pattern "${root}")
    file(GLOB_RECURSE names RELATIVE "${root}" "${pattern}/*")
    string(APPEND text "${names}\n")
  endforeach()
  string(SHA256 digest "${text}")
  set(${result} "${digest}" PARENT_SCOPE)
endfunction()

# _epg_entries(<result> <folder>...)
#
# Sets <result> to all files and folders below the folders, except temporary files of editors.
function(_epg_entries result)
  _epg_pattern(patterns "${ARGN}")
  list(TRANSFORM patterns APPEND "/*")
  file(GLOB_RECURSE found LIST_DIRECTORIES true ${patterns})
  list(FILTER found EXCLUDE REGEX "/[.][^/]*$")
  set(${result} "${found}" PARENT_SCOPE)
endfunction()

# _epg_fingerprint(<result>)
#
# Sets <result> to a hash that identifies this version of EPG.  For a wheel, pip's list of the hashes of its files is
# read, else all files of the Python package and the schemas.  A run reads files in EPG's folders of targets, too; the
# generated file <name>.cmake lists them.  A new file there can take precedence over one of them, so the names of all
# files there are part of the hash.  All of this is done once per configure run.
function(_epg_fingerprint result)
  get_property(fingerprint GLOBAL PROPERTY _EPG_FINGERPRINT)
  if(NOT fingerprint)
    _epg_python_folder(python)
    _epg_data_folder(data)
    _epg_pattern(package "${python}")
    _epg_pattern(around "${data}")
    set(files "")
    set(record "")
    if(data STREQUAL "${python}/_data")
      file(GLOB files "${package}/../epg-*.dist-info/RECORD" "${package}/../epg-*.dist-info/METADATA")
    endif()
    if(NOT files)
      set(record "${CMAKE_BINARY_DIR}/CMakeFiles/epg/generator.txt")
      file(GLOB_RECURSE files "${package}/*")
      file(GLOB schemas "${around}/schemas/*.json") # not schemas/editor: no run reads those
      list(APPEND files ${schemas})
      list(FILTER files EXCLUDE REGEX "/(__pycache__/[^/]+|[.][^/]*)$") # bytecode, temporary files of editors
    endif()
    _epg_hash_of_files(fingerprint "${record}" ${files})
    _epg_own_roots(roots)
    _epg_entries(names ${roots})
    string(SHA256 fingerprint "${fingerprint}\n${names}")
    list(TRANSFORM names REPLACE "/[^/]*$" "" OUTPUT_VARIABLE folders) # faster than to ask whether each is a folder
    list(REMOVE_DUPLICATES folders)
    set_property(GLOBAL PROPERTY _EPG_FINGERPRINT "${fingerprint}")
    set_property(DIRECTORY "${CMAKE_SOURCE_DIR}" APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files} ${folders})
  endif()
  set(${result} "${fingerprint}" PARENT_SCOPE)
endfunction()

# _epg_hash_of_files(<result> <record> <file>...)
#
# Sets <result> to a hash of the names and contents of files.
#   <record>  a file that is written with the hash, so that the next run need not read all contents: the hash is still
#             valid if all files have the same names and sizes, and none is newer than the record; "" for no record
function(_epg_hash_of_files result record)
  if(record)
    set(sizes "${ARGN}\n")
    set(newer FALSE)
    foreach(file IN LISTS ARGN)
      file(SIZE "${file}" size)
      string(APPEND sizes " ${size}")
      if("${file}" IS_NEWER_THAN "${record}")
        set(newer TRUE)
      endif()
    endforeach()
    string(SHA256 sizes "${sizes}")
    if(NOT newer)
      file(READ "${record}" known)
      if(known MATCHES "^${sizes} ([0-9a-f]+)$")
        set(${result} "${CMAKE_MATCH_1}" PARENT_SCOPE)
        return()
      endif()
    endif()
  endif()
  set(text "")
  foreach(file IN LISTS ARGN)
    file(MD5 "${file}" hash)
    string(APPEND text "${file} ${hash}\n")
  endforeach()
  string(SHA256 hash "${text}")
  if(record)
    file(WRITE "${record}" "${sizes} ${hash}")
  endif()
  set(${result} "${hash}" PARENT_SCOPE)
endfunction()

# _epg_configure_depends()
#
# Makes a build configure again after a change of a file that was read or of a folder that was searched, or after a file
# has appeared that was missing.  The caller must have included <name>.cmake, which lists them.
function(_epg_configure_depends)
  set(folders ${EPG_FOLDERS})
  _epg_user_folders(roots)
  foreach(root IN LISTS roots)
    _epg_entries(entries "${root}")
    foreach(path IN LISTS root entries)
      if(IS_DIRECTORY "${path}")
        list(APPEND folders "${path}")
      endif()
    endforeach()
  endforeach()
  # A folder changes with each file that is written into it.  Those of the build tree change with every build, so watching
  # them would configure again and again.
  set(watched "")
  foreach(folder IN LISTS folders)
    string(FIND "${folder}/" "${CMAKE_BINARY_DIR}/" below)
    if(NOT below EQUAL 0)
      list(APPEND watched "${folder}")
    endif()
  endforeach()
  # A missing file cannot be watched by its time, and its folder may be one in which users edit files all the time.
  # CMake looks for it at the beginning of each build, which takes as long as a start of CMake.
  set(absent "")
  foreach(file IN LISTS EPG_ABSENT)
    get_filename_component(folder "${file}" DIRECTORY)
    if(NOT folder IN_LIST watched)
      _epg_pattern(pattern "${file}")
      list(APPEND absent "${pattern}")
    endif()
  endforeach()
  if(absent)
    file(GLOB found CONFIGURE_DEPENDS ${absent})
  endif()
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
