# Shared by run.sh and test.sh: installs what is missing and builds.  Sourced, not run.
# Asks nothing; works as root or with sudo; does nothing when everything is there.

say() { printf '%s\n' "longarm: $*" >&2; }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; elif command -v sudo >/dev/null 2>&1; then sudo -n "$@" || sudo "$@"; else
    say "cannot install packages: not root and no sudo. Install these with apt and run again: $*"; return 1
  fi
}

# wanted_packages SECTION...: names in cmake/packages.txt before the first section, and in the sections named.
wanted_packages() {
  awk -v want=" $* " '/^#/ || /^$/ {next} /^\[/ {s = substr($0, 2, length($0) - 2); next}
    s == "" || index(want, " " s " ") {print}' "$root/cmake/packages.txt"
}

install_missing() {
  local missing=() name
  for name in $(wanted_packages "$@"); do
    dpkg-query -W -f='${Status}' "$name" 2>/dev/null | grep -q 'ok installed' || missing+=("$name")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  say "installing ${#missing[@]} packages: ${missing[*]}"
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq update </dev/null &&
  as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends "${missing[@]}" </dev/null >&2
}

# build_longarm TESTS(ON|OFF): configures and builds $build; silent and quick when nothing changed.
build_longarm() {
  # Debian's compiler, cmake and python are meant, whatever else a developer has on the path.
  export PATH=/usr/sbin:/usr/bin:/sbin:/bin:$PATH
  local jobs; jobs=$(nproc)
  if [ ! -f "$build/build.ninja" ] || ! grep -q "LONGARM_BUILD_TESTS:BOOL=$1" "$build/CMakeCache.txt"; then
    say "configuring $build"
    cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DLONGARM_BUILD_TESTS="$1" >"$build.configure.log" 2>&1 ||
      { cat "$build.configure.log" >&2; return 1; }
  fi
  ninja -C "$build" -j "$jobs" >"$build.log" 2>&1 || { tail -n 60 "$build.log" >&2; say "the build failed; whole log: $build.log"; return 1; }
}
