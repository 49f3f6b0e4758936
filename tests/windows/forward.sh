#!/usr/bin/env bash
# Runs a tool of mingw-w64 for forward.c, or the program of this name beside this file.  The argument is the beginning of the names of the call's files: NAME.arguments
# holds the tool, the working folder and the arguments, each with a final 0; NAME.output and NAME.status are written.
PATH=/usr/bin:/bin
export LC_ALL=C.UTF-8
job="$1"
drive_c="${job%/tools/jobs/*}/wine/drive_c"

# A path of Wine as Linux sees it.  A definition (-D...) can have backslashes that belong to a text of C.
linux() {
    local word="${1//\\//}"
    word="${word//[Cc]:\//$drive_c/}"
    printf '%s' "${word//[Zz]:\//\/}"
}

mapfile -d '' -t words <"$job.arguments"
tool="${words[0]%.exe}"
case "$tool" in ar | ranlib) tool="gcc-$tool" ;; esac
arguments=()
for word in "${words[@]:2}"; do
    case "$word" in
    -D*) arguments+=("$word") ;;
    @*) # a file with arguments
        sed "s,\\\\,/,g; s,[Cc]:/,$drive_c/,g; s,[Zz]:/,/,g" "$(linux "${word#@}")" >"$job.response"
        arguments+=("@$job.response")
        ;;
    *) arguments+=("$(linux "$word")") ;;
    esac
done
program="${job%/jobs/*}/$tool" # a stand-in
[[ -x $program ]] || program="x86_64-w64-mingw32-$tool"
cd "$(linux "${words[1]}")" && "$program" "${arguments[@]}" >"$job.output" 2>&1 </dev/null
echo "$?" >"$job.new"
mv "$job.new" "$job.status"
