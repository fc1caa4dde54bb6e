#!/usr/bin/env bash
# Installs what is missing of the named sections of packages.txt. Usage: setup.sh SECTION...
set -euo pipefail
cd "$(dirname "$(realpath "${BASH_SOURCE[0]}")")"

packages_of() {
   sed -n "/^\[$1\]/,/^\[/ { /^\[/d; s/[[:blank:]]*#.*//; /./p }" packages.txt
}

is_installed() {
   [[ $(dpkg-query --show --showformat '${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

# Sets as_root to the words that make a command run as root; fails where this user may not install.
become_root() {
   as_root=(env)
   [[ $(id -u) == 0 ]] && return
   # sudo hands on no variable by itself, the proxies are wanted.
   as_root=(sudo -n env ${http_proxy:+"http_proxy=$http_proxy"} ${https_proxy:+"https_proxy=$https_proxy"})
   "${as_root[@]}" true 2>/dev/null
}

missing=()
for section in "$@"; do
   packages=''
   [[ ! $section =~ ^[[:lower:]]+$ ]] || packages=$(packages_of "$section")
   if [[ -z $packages ]]; then
      echo "setup.sh: packages.txt has no section [$section]." >&2
      exit 2
   fi
   for package in $packages; do
      is_installed "$package" || missing+=("$package")
   done
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

if ! command -v apt-get >/dev/null || ! become_root; then
   echo "setup.sh: these Debian packages are missing and cannot be installed from here: ${missing[*]}." >&2
   exit 1
fi

echo "Installing ${missing[*]}"
apt=("${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get --yes -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0)
# A third party's broken list is no reason to stop: the installation tells whether our packages are to be had.
"${apt[@]}" -qq update | helpers/progress.sh /dev/null 'fetching package lists' ||
   echo 'setup.sh: not every package list could be fetched.' >&2
"${apt[@]}" -q install --no-install-recommends "${missing[@]}" | helpers/progress.sh /dev/null
