# SPDX-License-Identifier: Apache-2.0
# complete.bash SCRIPT LINE...: types each line and a tab into an interactive bash that has read the
# completion script. Prints a line "offer: WORD" for each word that is offered, and then "line: " and
# the line as the tab has left it.
rc=$(mktemp)
trap 'rm -f "$rc"' EXIT
cat >"$rc" <<EOF
PS1=
source "$1"
ssdo() { echo "line: ssdo \$*"; }
_traced() { _ssdo; [[ \${#COMPREPLY[@]} -eq 0 ]] || printf 'offer: %s\n' "\${COMPREPLY[@]}"; }
complete -F _traced ssdo
EOF
shift
for line; do printf '%s\t\n' "$line"; done | bash --noprofile --rcfile "$rc" -i 2>/dev/null
