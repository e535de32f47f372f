#!/usr/bin/env bash
# Installs the Debian packages of scripts/packages.txt that are missing, and Node.js if there is
# none. Says nothing and needs no rights when everything is there.
set -euo pipefail
cd "$(dirname "$0")"

installed() { [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

if ! command -v apt-get >/dev/null; then
  echo "install_packages.sh knows Debian's apt-get only: install what scripts/packages.txt names" >&2
  exit 1
fi

missing=()
for package in $(sed 's/#.*//' packages.txt); do
  installed "$package" || missing+=("$package")
done
command -v node >/dev/null || missing+=(nodejs)
command -v npm >/dev/null || missing+=(npm)
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
echo "Installing: ${missing[*]}" >&2
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
