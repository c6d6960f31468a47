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
# A decimal-comma locale of our own, so that the tests need none installed.
export LOCPATH="$build/locale"
if [ ! -d "$LOCPATH/de_DE.UTF-8" ]; then
  mkdir -p "$LOCPATH"
  localedef -i de_DE -f UTF-8 "$LOCPATH/de_DE.UTF-8" >/dev/null 2>&1 || say "no de_DE.UTF-8 locale could be made"
fi
cd "$build" || exit 1
if [ $# -gt 0 ]; then exec ctest --output-on-failure -j "$(nproc)" -LE campaign "$@"; fi
# Robot, link and window against the clock run alone, and get a second try: another program may take the machine just then.
ctest --output-on-failure -j "$(nproc)" -LE 'campaign|realtime|gl' || exit 1
ctest --output-on-failure -L 'realtime|gl' --repeat until-pass:2 || exit 1
# Everything that reads or writes numbers again under a decimal comma.
say "again under a decimal-comma locale"
LONGARM_TEST_LOCALE=de_DE.UTF-8 exec ctest --output-on-failure -j "$(nproc)" -L unit -R '^(core|vision|planning_robot|app)/'
