#!/usr/bin/env bash
# Installs what is missing, builds, and runs all tests.  ./test.sh [ctest arguments, e.g. -R vision]
set -u
root=$(cd "$(dirname "$0")" && pwd)
build=${LONGARM_BUILD:-$root/build}
. "$root/cmake/setup.sh"
install_missing test peer || exit 1
build_longarm ON || exit 1
# Data sets by others (known answers); tests that need them say "skipped: no data" without.
if [ -z "${LONGARM_DATA:-}" ] && [ -d "$root/../shared/data" ]; then export LONGARM_DATA="$root/../shared/data"; fi
cd "$build" && exec ctest --output-on-failure -j "$(nproc)" --timeout 900 -LE campaign "$@"
