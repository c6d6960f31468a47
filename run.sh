#!/usr/bin/env bash
# Installs what is missing, builds, and opens the console on the virtual robot with a task ready to do.
# Without a display it does the same under Xvfb, performs the task, and leaves pictures in ./screenshots.
# ./run.sh [arguments of longarm]
set -u
root=$(cd "$(dirname "$0")" && pwd)
build=${LONGARM_BUILD:-$root/build}
. "$root/cmake/setup.sh"
install_missing || exit 1
tests=OFF
[ -f "$build/CMakeCache.txt" ] && grep -q 'LONGARM_BUILD_TESTS:BOOL=ON' "$build/CMakeCache.txt" && tests=ON
build_longarm "$tests" || exit 1
if [ -n "${DISPLAY:-}" ] || [ -n "${WAYLAND_DISPLAY:-}" ]; then
  exec "$build/longarm" --scenario grab_pipe "$@"
fi
say "no display: performing the task under Xvfb; pictures go to $PWD/screenshots"
mkdir -p screenshots
export QT_QPA_PLATFORM=xcb LIBGL_ALWAYS_SOFTWARE=1
exec xvfb-run -a -s "-screen 0 1920x1080x24 -dpi 96" "$build/longarm" --scenario grab_pipe --perform --screenshots screenshots "$@"
