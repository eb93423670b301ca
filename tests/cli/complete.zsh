# SPDX-License-Identifier: Apache-2.0
# As complete.bash, in an interactive zsh that finds the script in its folder.
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "PS1=; fpath=(${1:h} \$fpath); autoload -Uz compinit; compinit -D -u"
zpty -w shell 'zstyle ":completion:*" list-max 1000; LISTMAX=10000
compadd() {
  if [[ ${@[1,(i)(-|--)]} == *-(O|A|D)\ * ]]; then builtin compadd "$@"; return; fi
  local -a offers
  builtin compadd -A offers "$@"
  print -l -- "<<offer: "$^offers">>"
  builtin compadd "$@"
}
show_line() { print -r -- "<<line: $BUFFER>>"; zle kill-whole-line; }
zle -N show_line
bindkey "^I" complete-word "^E" show_line
print "<<re""ady>>"'
zpty -r shell text '*<<ready>>*'
shift
for line; do
  zpty -w -n shell "$line"$'\t\x05'
  zpty -r shell text '*<<line: *>>*'
  print -r -- "$text" | tr -d '\r' | sed -n 's/.*<<\(offer: [^>]*\)>>.*/\1/p; s/.*<<\(line: [^>]*\)>>.*/\1/p'
done
zpty -d shell
