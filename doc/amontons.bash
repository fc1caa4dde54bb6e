# Completes the command line of amontons in bash: options, directories, decks; behind --reduced, reduced problems, behind
# --verify, directories alone, and behind --reference, groups of a deck.
# shellcheck shell=bash

_amontons() {
   local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} kinds='*.nml' groups i
   local options='--output --set --refine --check --quiet --progress --skip-unchanged --threads --reduced --write-reduced --all-solutions --verify'
   local only_decks=false

   COMPREPLY=()
   # An equals sign is a word of its own: --output = results.
   if [[ $word == = ]]; then
      word=''
   elif [[ $before == = ]]; then
      before=${COMP_WORDS[COMP_CWORD - 2]}
   fi
   for ((i = 1; i < COMP_CWORD; i++)); do
      case ${COMP_WORDS[i]} in
      --) only_decks=true ;;
      --reduced) kinds='*.dat' ;;
      --reference) kinds=groups ;;
      --verify) kinds='' ;;
      *) ;;
      esac
   done
   if [[ $only_decks == false ]]; then
      case $before in
      --output | -o)
         mapfile -t COMPREPLY < <(compgen -d -- "$word")
         compopt -o filenames 2>/dev/null || true
         return
         ;;
      --set | --refine | --threads | -t) return ;;
      *) ;;
      esac
      if [[ $word == -* ]]; then
         mapfile -t COMPREPLY < <(compgen -W "$options --reference --help --version" -- "$word")
         return
      fi
   fi
   if [[ $kinds == groups ]]; then
      # The program knows them: ### `&mesh`
      groups=$("$1" --reference 2>/dev/null | sed -n 's/^### .&\([[:alpha:]]*\).*/\1/p')
      mapfile -t COMPREPLY < <(compgen -W "$groups" -- "$word")
      return
   fi
   # The pattern excludes what it does not match; directories lead to decks, or hold what is verified.
   mapfile -t COMPREPLY < <(shopt -s extglob; compgen -f -X "!$kinds" -- "$word"; compgen -d -- "$word")
   compopt -o filenames 2>/dev/null || true
}

complete -F _amontons amontons
