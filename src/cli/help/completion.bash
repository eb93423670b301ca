# SPDX-License-Identifier: Apache-2.0
# Offers those of the words that begin with $typed.
_ssdo_offer() {
  mapfile -t COMPREPLY < <(compgen -W "$*" -- "$typed")
  [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *= ]] && compopt -o nospace 2>/dev/null
}

# Offers folders and the files with this ending, or all files.
_ssdo_files() {
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen -d -- "$typed"; compgen -f -X "!*${1:+.$1}" -- "$typed")
  mapfile -t COMPREPLY < <(printf '%s\n' "${COMPREPLY[@]}" | sort -u | sed '/^$/d')
}

# The method that the words name; nothing: the default.
_ssdo_method() {
  local i
  for ((i = 1; i < $#; ++i)); do
    [[ ${!i} == --method ]] && { ((++i)); echo "${!i}"; return; }
    [[ ${!i} == --method=* ]] && { echo "${!i#*=}"; return; }
  done
}

# Offers the layers that can have this role, of the frame on the line.
_ssdo_offer_layers() {
  local word layer
  for word in "${line[@]:1}"; do
    [[ $word == *.exr && -f $word ]] || continue
    while read -r layer; do
      [[ $layer == "$typed"* ]] && COMPREPLY+=("$layer")
    done < <(_ssdo_layers "${line[0]}" "$word" "$1")
    return
  done
}

_ssdo() {
  # Readline divides words at "=" and ":" too.
  local -a line=()
  local word
  for word in "${COMP_WORDS[@]:0:COMP_CWORD+1}"; do
    if [[ ${#line[@]} -gt 1 && ($word == [=:]* || ${line[-1]} == *[=:]) ]]; then
      line[-1]+=$word
    else
      line+=("$word")
    fi
  done

  # $head is what stays of the last word, $typed what is completed.
  local whole=${line[-1]} head='' command='' kind words
  [[ ${#line[@]} -gt 2 && " $(_ssdo_commands) " == *" ${line[1]} "* ]] && command=${line[1]}
  if [[ $whole == --*=* ]]; then
    head=${whole%%=*}=
    read -r kind words < <(_ssdo_value "${whole%%=*}")
  else
    read -r kind words < <(_ssdo_value "${line[-2]}")
  fi
  local typed=${whole#"$head"}
  COMPREPLY=()
  case $kind in
    words) _ssdo_offer "$words" ;;
    list)
      head+=${typed%"${typed##*,}"} typed=${typed##*,}
      _ssdo_offer "$words"
      ;;
    keys | layers)
      if [[ $typed == *=* ]]; then
        local key=${typed%%=*}
        head+=$key= typed=${typed#*=}
        _ssdo_files
        [[ $kind == layers ]] && _ssdo_offer_layers "$key"
      else
        _ssdo_offer "${words// /= }="
      fi
      ;;
    parameters) _ssdo_offer "$(_ssdo_settings "$(_ssdo_method "${line[@]}")")" ;;
    files) _ssdo_files "$words" ;;
    text) ;;
    *)
      if [[ $whole == -* ]]; then
        _ssdo_offer "$(_ssdo_options "$command")"
      else
        # compare takes pictures of all kinds
        if [[ $command == compare ]]; then _ssdo_files; else _ssdo_files exr; fi
        ((${#line[@]} > 2)) || COMPREPLY+=($(compgen -W "$(_ssdo_commands)" -- "$typed"))
      fi
      ;;
  esac

  # Readline replaces what follows its last division.
  local replaced=${COMP_WORDS[COMP_CWORD]}
  [[ $replaced == [=:] ]] && replaced=''
  local kept=${whole%"$replaced"}
  COMPREPLY=("${COMPREPLY[@]/#/"$head"}")
  COMPREPLY=("${COMPREPLY[@]#"$kept"}")
}

complete -F _ssdo ssdo
