#!/usr/bin/env bash
# Runs both commands of the README on other systems, from nothing: in a clean root of each Debian, with each gfortran
# and flang that it packages and that compiles the program. Prints a row for each; logs are in build/elsewhere.
# Usage: elsewhere.sh [--table1] [SUITE[:COMPILER]]...     for instance elsewhere.sh bookworm trixie:gfortran-13
#        elsewhere.sh --packages [SUITE]...
#   --table1    only the first command
#   --packages  makes the Debian packages in a clean root instead, and installs and tries them in another one
# Exit status: 0 if every command passed, 1 if one failed, 77 if a root cannot be made here.
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/.."

if (($(id -u) != 0)); then
   echo 'elsewhere.sh: only root can make clean roots; run it with sudo.' >&2
   exit 77
fi
scripts/setup.sh elsewhere || exit 77
if ! unshare --mount --pid --fork --kill-child --mount-proc true; then
   echo 'elsewhere.sh: no clean roots can be made here: mounts of its own are forbidden to this process.' >&2
   exit 77
fi
action=all
if [[ ${1-} == --table1 || ${1-} == --packages ]]; then
   action=${1#--}
   shift
fi

folder=build/elsewhere
root=$folder/root
mkdir -p "$folder"
# unshare heeds no signal but this one, and takes all that it started with it.
trap 'jobs -p | xargs --no-run-if-empty kill -KILL; wait; rm -rf "$root"' EXIT
trap 'exit 1' INT TERM

# Runs a command that sees its own mounts and processes only: they end with it.
alone() {
   unshare --mount --pid --fork --kill-child --mount-proc "$@" &
   wait "$!"
}

# Runs a command in the root, where nothing of this machine's environment is left.
inside() {
   # shellcheck disable=SC2016 # the arguments are those of the inner shell
   alone bash -c 'mount --rbind /dev "$0/dev" && mount -t proc proc "$0/proc" && mount -t sysfs sysfs "$0/sys" &&
      exec chroot "$0" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"' "$root" "$@"
}

apt() {
   inside DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 "$@"
}

# Makes the root of a suite, from the mirror and through the proxy that this machine installs from.
make_root() {
   local suite=$1 mirror
   # shellcheck disable=SC2016 # the words are those of apt-get
   mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' |
      sed -n 's/^Debian //p' | head -n 1)
   eval "$(apt-config shell http_proxy Acquire::http::Proxy https_proxy Acquire::https::Proxy)"
   export http_proxy=${http_proxy:-} https_proxy=${https_proxy:-}
   rm -rf "$root"
   alone debootstrap --variant=minbase "$suite" "$root" ${mirror:+"$mirror"}
   apt-config dump | grep -E '^Acquire::(http|https|Retries|Check)' >"$root/etc/apt/apt.conf.d/90host" || true
   cp /etc/hosts "$root/etc/hosts"
   apt update
}

# The compiler that the package gfortran brings.
default_compiler() {
   inside apt-cache depends gfortran | sed -n 's/^ *Depends: \(gfortran-[0-9]*\)$/\1/p'
}

# The compilers that can compile the program, the default one first.
compilers() {
   local name version
   local -A oldest=([gfortran]=12 [flang]=19)
   default_compiler
   inside apt-cache --names-only search '^(gfortran|flang)-[0-9]+$' | sed 's/ .*//' | sort --version-sort |
      grep --invert-match --line-regexp "$(default_compiler)" |
      while IFS=- read -r name version; do
         ((version < oldest[$name])) || echo "$name-$version"
      done
}

# Installs a compiler, unless the README's commands do, and puts what makes them take it into `variables`.
install_compiler() {
   local compiler=$1 version=${1#*-}
   variables=()
   case $compiler in
      "$(default_compiler)") ;;
      gfortran-*)
         apt install --no-install-recommends "$compiler" >/dev/null
         variables=("FC=$compiler")
         ;;
      flang-*)
         apt install --no-install-recommends "$compiler" "libomp-$version-dev" >/dev/null
         variables=("FC=$(inside bash -c "command -v flang-$version flang-new-$version | head -n 1")")
         ;;
      *)
         echo "elsewhere.sh: '$compiler' is no gfortran-N and no flang-N" >&2
         exit 1
         ;;
   esac
}

status=0
# Puts a fresh copy of this tree into the root.
copy_tree() {
   rm -rf "$root/amontons"
   mkdir "$root/amontons"
   git ls-files -z --cached --others --exclude-standard | tar --create --null --files-from - |
      tar --extract --directory "$root/amontons"
}

# Makes the Debian packages in the root, then installs them in a new one and uses each.
try_packages() {
   local suite=$1 log=$folder/$1-packages.log start=$SECONDS packages result=passed
   packages=$(realpath "$folder")/packages
   rm -rf "$packages"
   mkdir "$packages"
   copy_tree
   {
      inside /amontons/scripts/deb.sh && cp "$root"/amontons/build/deb/*.deb "$packages" && make_root "$suite" &&
         mkdir "$root/packages" && cp "$packages"/*.deb input/long_bar_1.nml "$root/packages" &&
         inside sh -ec 'cd /packages; DEBIAN_FRONTEND=noninteractive apt-get -qq install ./*.deb
            amontons --output results long_bar_1.nml; amontons --verify results
            python3 -c "import amontons; print(amontons.solve_deck(\"long_bar_1.nml\").summary[\"lengths\"])"
            amontons-plot results/long_bar_1; amontons-report results; amontons-adapt --help'
   } &>"$log" || result=failed
   if [[ $result == failed ]]; then
      status=1
      tail -n 40 "$log" >&2
   fi
   printf '%-10s packages %-8s %7d\n' "$suite" "$result" $((SECONDS - start))
}

# Runs both commands in a fresh copy of this tree and prints their row.
run_commands() {
   local suite=$1 compiler=$2 log=$folder/$1-$2 table=passed tests=- start middle
   copy_tree
   install_compiler "$compiler"
   start=$SECONDS
   inside "${variables[@]}" /amontons/scripts/table1.sh &>"$log.table1.log" || table=failed
   middle=$SECONDS
   if [[ $action == all ]]; then
      tests=passed
      inside "${variables[@]}" /amontons/scripts/test.sh &>"$log.test.log" || tests=failed
      if [[ $tests == failed ]]; then
         status=1
         tail -n 40 "$log.test.log" >&2
      fi
      tests=$(grep --extended-regexp '^[0-9]+ passed, ' "$log.test.log" || echo "$tests")
   fi
   if [[ $table == failed ]]; then
      status=1
      tail -n 40 "$log.table1.log" >&2
   fi
   printf '%-10s %-12s %-8s %7d  %-28s %7d\n' "$suite" "$compiler" "$table" $((middle - start)) "$tests" \
      $((SECONDS - middle))
}

[[ $action == packages ]] || printf '%-10s %-12s %-8s %7s  %-28s %7s\n' suite compiler table1.sh s test.sh s
(($# > 0)) || set -- bookworm trixie
for argument in "$@"; do
   suite=${argument%%:*}
   make_root "$suite" &>"$folder/$suite.log" || {
      tail -n 40 "$folder/$suite.log" >&2
      echo "elsewhere.sh: no clean root of $suite can be made here." >&2
      exit 77
   }
   if [[ $action == packages ]]; then
      try_packages "$suite"
   elif [[ $argument == *:* ]]; then
      run_commands "$suite" "${argument#*:}"
   else
      for compiler in $(compilers); do
         run_commands "$suite" "$compiler"
      done
   fi
done
exit "$status"
