# SPDX-License-Identifier: Apache-2.0
# The layers of a frame that can have a role, a line each: a name that no layer has ends ssdo after the
# header of the file, with a list of them. In braces: zsh would give what is written to a pipe and to a
# file to both, by one more process, and at times nothing came through the pipe.
_ssdo_layers() {  # TOOL FRAME ROLE
  { command "$1" info "$2" --aov "$3=?" >/dev/null; } 2>&1 |
    sed -n "s/.* the file has '\(.*\)'$/\1/p" | sed "s/', '/\n/g"
}

