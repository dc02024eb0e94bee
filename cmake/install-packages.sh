#!/bin/sh
# Installs the Debian packages named in the file $1 that are not installed yet.
set -eu
missing=
for package in $(sed 's/#.*//' "$1"); do
    status=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
    [ "$status" = "install ok installed" ] || missing="$missing $package"
done
[ -z "$missing" ] && exit 0

sudo=
[ "$(id -u)" -eq 0 ] || sudo=sudo
echo "installing:$missing"
export DEBIAN_FRONTEND=noninteractive
$sudo apt-get update -qq
# shellcheck disable=SC2086  # the list is meant to split
$sudo apt-get install -y -qq --no-install-recommends $missing > build/packages.log 2>&1 ||
    { cat build/packages.log; exit 1; }
