# SPDX-License-Identifier: Apache-2.0
# Sourced by tests/platforms/run.sh and tests/package/run.sh, which have a function fail(): other
# releases of Debian in folders of this machine, with what its kernel lends them. For root.

export PATH=$PATH:/usr/sbin:/sbin

# The mirror that this machine's apt takes its own release from has the others too.
debian_mirror() {
  local own
  own=$(. /etc/os-release && echo "$VERSION_CODENAME")
  [ -n "${SSDO_DEBIAN_MIRROR:-}" ] && echo "$SSDO_DEBIAN_MIRROR" && return
  apt-get indextargets --format '$(CODENAME) $(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' |
    sed -n "s/^$own //p" | sed -n 1p
}

# make_root RELEASE FOLDER: a bare Debian in a folder that does not exist. A release that is newer than
# this machine's debootstrap is made as unstable is.
make_root() {
  local mirror script=()
  mirror=$(debian_mirror)
  [ -n "$mirror" ] || fail "apt knows no mirror; run apt-get update or set SSDO_DEBIAN_MIRROR"
  mkdir -p "$(dirname "$2")"
  [ -e "/usr/share/debootstrap/scripts/$1" ] || script=(/usr/share/debootstrap/scripts/sid)
  debootstrap --variant=minbase "$1" "$2.part" "$mirror" "${script[@]}" >"$2.log" ||
    { tail -5 "$2.log"; fail "debootstrap of $1 failed; its log is $2.log"; }
  # Mirrors of a suite that moves may be older than the days for which its list of files is signed.
  case $1 in
    testing | unstable | sid) echo 'Acquire::Check-Valid-Until "false";' >"$2.part/etc/apt/apt.conf.d/90moves" ;;
  esac
  mv "$2.part" "$2"
}

# in_root FOLDER USER COMMAND [VARIABLE=VALUE...]: with /proc, shared memory and terminals, which go
# away with the command. Folders of the machine that are to be seen in there: binds, "FROM TO
# [OPTION]" each. The root is a mount of its own, or the command could not make another one in it.
binds=()
in_root() {
  local folder=$1 user=$2 command=$3
  shift 3
  SSDO_BINDS=$(printf '%s\n' "${binds[@]}") unshare --mount bash -euc '
    mount --bind "$0" "$0"
    mount -t proc proc "$0/proc"
    mkdir -p "$0/dev/shm" && mount -t tmpfs -o mode=1777 tmpfs "$0/dev/shm"
    mkdir -p "$0/dev/pts" && mount -t devpts -o newinstance,ptmxmode=0666 devpts "$0/dev/pts"
    while read -r from to option; do
      [ -n "$from" ] || continue
      mkdir -p "$0$to"
      mount --bind "$from" "$0$to"
      [ -z "$option" ] || mount -o "remount,bind,$option" "$0$to"
    done <<<"$SSDO_BINDS"
    user=$1 command=$2
    shift 2
    exec chroot --userspec="$user" "$0" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin \
      DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@" sh -c "$command"' \
    "$folder" "$user" "$command" "$@" </dev/null
}
