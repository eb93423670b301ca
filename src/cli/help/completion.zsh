# SPDX-License-Identifier: Apache-2.0
# WORD=FILE, for each of the words.
_ssdo_keys() {
  if compset -P '*='; then _files; else compadd -q -S = -- "$@"; fi
}

# WORD=LAYER of the frame on the line, or WORD=FILE.
_ssdo_role() {
  if ! compset -P '*='; then
    compadd -q -S = -- "$@"
    return
  fi
  local role=${${IPREFIX%=}##*=} frame=${words[(R)*.exr]}
  [[ -f $frame ]] && compadd -- ${(f)"$(_ssdo_layers $tool $frame $role)"}
  _files
}

# NAME= of the parameters of the method that the line names, and NAME=WORD.
_ssdo_parameters() {
  local at=${words[(I)--method]} method=${${words[(R)--method=*]}#*=}
  ((at)) && method=$words[at+1]
  local -a settings=(${=$(_ssdo_settings "$method")})
  compadd -S '' -- ${(M)settings:#*=}
  compadd -- ${settings:#*=}
}

_ssdo_input() {
  local -a names
  _ssdo_commands
  _alternative 'frames:frame:_files -g "*.exr(-.)"' 'commands:command:{_describe command names}'
}

_ssdo() {
  local command='' tool=$words[1]
  local -a names specs
  _ssdo_commands
  if ((CURRENT > 2)) && ((${names[(I)$words[2]:*]})); then
    command=$words[2]
    shift words
    ((CURRENT--))
  fi
  _ssdo_specs "$command"
  case $command in
    '') specs+=('1:INPUT:_ssdo_input') ;;
    compare) specs+=('*:FILE\:LAYER:_files') ;;
    *) specs+=('1:INPUT:_files -g "*.exr(-.)"') ;;
  esac
  _arguments -S $specs
}

if [[ $funcstack[1] == _ssdo ]]; then _ssdo "$@"; else compdef _ssdo ssdo; fi
