# shellcheck shell=bash
# Shared by tools/setup, tools/run, tools/lint, tools/docs and tools/notebooks: where things lie and which way was chosen.

# Debian release of the private root; trixie is the first with DOLFINx 0.9. Another one is a root of
# its own, which neither the current python3 nor the distribution's packages replace.
readonly SUITE=${FEM_LIE_SUITE:-trixie}
[[ -z ${FEM_LIE_SUITE:-} ]] || export FEM_LIE_WAY=root
readonly LAYOUT=1       # count up when the same package list has to make a new private root
readonly PLAIN_PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin

: "${HOME:=~}"
export HOME

tools=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
checkout=${tools%/*}
cache=${XDG_CACHE_HOME:-$HOME/.cache}/fem_lie/environment
python=$(type -P python3 || true)
mount_point=$cache/mount

say() { printf 'fem_lie: %s\n' "$*" >&2; }

die() {
  say "error: $*"
  exit 1
}

packages() { sed 's/#.*//; s/[[:space:]]//g; /^$/d' "$tools/packages.txt"; }

# HOSTTYPE: a home folder may be shared by machines of different architectures.
key=$({ echo "$SUITE $LAYOUT $HOSTTYPE"; packages; } | sha256sum)
key=${key:0:12}
root=$cache/root-$key

# The choice holds for one host, one package list, one `python3` and one wish.
choice_file() {
  printf '%s' "$cache/chosen/$key/$HOSTNAME/${FEM_LIE_WAY:-any}${python//\//%}"
}

# Sets `way` and, in words, `found`; fails where nothing was chosen yet or the choice is gone.
read_choice() {
  local file
  way='' found=''
  if [[ -n ${FEM_LIE_INSIDE:-} ]]; then # a command in the private root that calls tools/run again
    way=python found="the private root that this command runs in"
    return 0
  fi
  file=$(choice_file)
  [[ -r $file ]] || return 1
  { read -r way && read -r found; } <"$file"
  [[ $way != root || -d $root ]]
}

# The distribution's Python must not see what belongs to another one.
forget_other_pythons() {
  PATH=$PLAIN_PATH
  unset PYTHONHOME PYTHONPATH VIRTUAL_ENV LD_LIBRARY_PATH LD_PRELOAD PETSC_DIR PETSC_ARCH SLEPC_DIR
  unset "${!CONDA_@}" "${!PYENV_@}"
  export PATH PYTHONNOUSERSITE=1
}

# Root has the right to make a mount namespace; others get it from a user namespace of their own.
# tools/enter keeps its mounts private, as unshare itself cannot do that in a chroot.
namespace=(unshare --mount --propagation unchanged)
((EUID == 0)) || namespace+=(--map-root-user)

# One shell at a time changes the cache folder. All that it starts inherits the lock.
take_lock() {
  while :; do
    mkdir --parents "$mount_point"
    exec {lock}>"$cache/lock"
    if ! flock --nonblock "$lock"; then
      say "another set-up is at work; waiting for it"
      flock "$lock"
    fi
    # --remove may have removed the file meanwhile.
    [[ ! $cache/lock -ef /proc/self/fd/$lock ]] || return 0
    exec {lock}>&-
  done
}

# Installs the packages of the requirements file $2 by pip, once, into a virtual environment of the
# cache that sees the environment's own packages. Sets `folder` to it; $1 is what it is for.
virtual_environment() {
  local list
  list=$({ cat "$2" && echo "$key"; } | sha256sum)
  folder=$cache/$1-${list:0:12}
  [[ ! -e $folder/complete ]] || return 0
  take_lock
  if [[ ! -e $folder/complete ]]; then
    say "installing $1 into $folder (once)"
    rm --recursive --force "$folder"
    "$tools/run" python3 -m venv --system-site-packages "$folder"
    PIP_ROOT_USER_ACTION=ignore "$tools/run" "$folder/bin/python" -m pip install --quiet --requirement "$2" ||
      die "pip could not install $1; give it an index to reach (pip config)"
    : >"$folder/complete"
  fi
  exec {lock}>&-
}
