#!/usr/bin/env bash
# Reads what ninja, pip wheel --verbose, apt-get or another command prints and shows how far it is, on standard error:
# in place on a terminal, else a line every ten seconds, also while nothing comes. Hands on what it reads to a file.
# Usage: progress.sh FILE [NAME]     NAME is shown until something tells how far it is
set -euo pipefail

log=${1:?usage: progress.sh FILE [NAME]}
shown=${2-} # what was done last,
since=$SECONDS # since when
next=$((SECONDS + 10))
total='' # packages to be installed
declare -A count=([fetching]=0 [unpacking]=0 [setting up]=0)

draw() {
   if [[ -t 2 ]]; then
      printf '\r%s\e[K' "${1:0:${COLUMNS:-80}-1}" >&2
   elif ((SECONDS >= next)); then
      printf '%s\n' "$1" >&2
      next=$((SECONDS + 10))
   fi
}

show() {
   shown=$1
   since=$SECONDS
   draw "$1"
}

package() { # what is done, name
   count[$1]=$((count[$1] + 1))
   show "[$(printf '%3d' "${count[$1]}")/$total] $1 $2"
}

# Shows how far it is by a line that was read.
look_at() {
   local line=${1#  } name # pip indents what it hands on.
   case $line in
      \[*/*\]\ *)
         # The objects' names are those of the sources, in long folders.
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
}

start='' # of a line that is not complete yet
status=0
while ((status == 0 || status > 128)); do
   status=0
   IFS= read -r -t 1 line || status=$?
   start+=$line
   if ((status == 0)); then
      printf '%s\n' "$start"
      look_at "$start"
      start=''
   fi
   ((SECONDS - since < 2)) || [[ -z $shown ]] || draw "$shown, $((SECONDS - since)) s"
done >"$log"
printf '%s' "$start" >>"$log"
if [[ -t 2 ]]; then
   printf '\r\e[K' >&2
fi
