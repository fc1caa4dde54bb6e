#!/usr/bin/env bash
# Reads what ninja, pip wheel --verbose or apt-get prints and shows how far it is, on standard error: in place on a
# terminal, else a line every ten seconds. Hands on what it reads to a file. Usage: progress.sh FILE
set -euo pipefail

log=${1:?usage: progress.sh FILE}
next=$((SECONDS + 10))
total='' # packages to be installed
declare -A count=([fetching]=0 [unpacking]=0 [setting up]=0)

show() {
   if [[ -t 2 ]]; then
      printf '\r%s\e[K' "${1:0:${COLUMNS:-80}-1}" >&2
   elif ((SECONDS >= next)); then
      printf '%s\n' "$1" >&2
      next=$((SECONDS + 10))
   fi
}

package() { # what is done, name
   count[$1]=$((count[$1] + 1))
   show "[$(printf '%3d' "${count[$1]}")/$total] $1 $2"
}

while IFS= read -r line; do
   printf '%s\n' "$line"
   # pip indents what it hands on.
   case ${line#  } in
      \[*/*\]\ *)
         # The objects' names are those of the sources, in long folders.
         line=${line#  }
         show "${line%%]*}] ${line##*/}"
         ;;
      *\ newly\ installed,*)
         [[ $line =~ ([0-9]+)\ newly ]] && total=${BASH_REMATCH[1]}
         ;;
      Get:*)
         read -r _ _ _ _ name _ <<<"$line"
         package fetching "$name"
         ;;
      Unpacking\ *) package unpacking "$(cut -d ' ' -f 2 <<<"$line")" ;;
      Setting\ up\ *) package 'setting up' "$(cut -d ' ' -f 3 <<<"$line")" ;;
      *) ;;
   esac
done >"$log"
if [[ -t 2 ]]; then
   printf '\r\e[K' >&2
fi
