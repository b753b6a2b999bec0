# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the other scripts: paths, and what must be installed. POSIX shell.

root=$(cd "$(dirname "$0")" && while [ ! -f scripts/lib.sh ] && [ "$PWD" != / ]; do cd ..; done && pwd)

# What each part needs on a bare Debian 12; each list contains the one before. README.md lists the same. Ubuntu 24.04
# uses the same names (untested there).
packages_library="cmake g++ make libeigen3-dev libtbb-dev"
packages_io="$packages_library libexpat1-dev nlohmann-json3-dev libstb-dev liblzf-dev libyaml-cpp-dev libxxhash-dev"
packages_command="$packages_io libcli11-dev ninja-build"
packages_test="$packages_command catch2 libfcl-dev python3 ccache libopenmpi-dev openmpi-bin"
packages_all="$packages_test libbenchmark-dev"
packages_python="$packages_io python3-dev python3-venv ninja-build"
packages_aarch64="$packages_test g++-aarch64-linux-gnu qemu-user-static"
packages_clang="clang-19 libclang-rt-19-dev clang-format-19"  # sanitizers by another compiler, and the style: scripts/test --all

say() { printf '%s\n' "$*"; }
fail() { say "$*" >&2; exit 1; }

# need_room FOLDER MIB: stops with a sentence if less is free.
need_room() {
  free=$(df -Pk "$1" 2>/dev/null | awk 'NR == 2 { print int($4 / 1024) }')
  [ -z "$free" ] || [ "$free" -ge "$2" ] || fail "Only $free MiB are free in $1, and $2 are needed."
}

# install_packages yes|no names...: does nothing if all are there; "no" only says what is missing. Downloads everything
# before it unpacks anything, so that a lost network leaves nothing half installed.
install_packages() {
  may_install=$1
  shift
  need_cmake
  if ! command -v dpkg-query >/dev/null 2>&1; then
    say "This is no Debian or Ubuntu; make sure that you have the equivalents of: $*"
    return 0
  fi
  missing=""
  for package in "$@"; do
    case $(dpkg-query -W -f='${Status}' "$package" 2>/dev/null) in
      *"install ok installed"*) ;;
      *) missing="$missing $package" ;;
    esac
  done
  [ -n "$missing" ] || return 0
  become=""
  if [ "$(id -u)" != 0 ]; then
    if [ -t 0 ] && [ -z "${CI:-}" ]; then
      command -v sudo >/dev/null 2>&1 && become="sudo"
    else
      sudo -n true >/dev/null 2>&1 && become="sudo -n"
    fi
    [ -n "$become" ] || may_install=no
  fi
  [ "$may_install" = yes ] || fail "Please install first: apt-get install --no-install-recommends$missing"
  need_room /usr 1500
  say "Installing from your distribution:$missing"
  log=$(mktemp) || fail "There is no room for a temporary file."
  get="$become env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -q -y --no-install-recommends"
  if $get update >"$log" 2>&1 && $get install --download-only $missing >>"$log" 2>&1 && $get install $missing >>"$log" 2>&1; then
    rm -f "$log"
    need_cmake
  else
    why=$(sed -n 's/^E: //p' "$log" | head -n 1 | cut -c 1-200)
    rm -f "$log"
    fail "The installation of these packages failed: ${why:-apt-get gave no reason}"
  fi
}

# Refuses an older CMake before anything is installed; the minimum is in CMakeLists.txt.
need_cmake() {
  command -v cmake >/dev/null 2>&1 || return 0
  least=$(sed -n 's/^cmake_minimum_required(VERSION \([0-9.]*\))$/\1/p' "$root/CMakeLists.txt")
  have=$(cmake --version | sed -n '1s/[^0-9]*\([0-9.]*\).*/\1/p')
  [ "$(printf '%s\n%s\n' "$least" "$have" | sort -V | head -n 1)" = "$least" ] ||
    fail "The cmake on the PATH is $have, and $least is needed (a newer one: pip install cmake)."
}

# Uses a CUDA toolkit if there is one, even if it is not on the PATH.
find_cuda() {
  if ! command -v nvcc >/dev/null 2>&1 && [ -x /usr/local/cuda/bin/nvcc ]; then
    PATH=$PATH:/usr/local/cuda/bin
    export PATH
  fi
  command -v nvcc >/dev/null 2>&1
}

# A build folder keeps its generator, so only a new one gets a choice.
configure() {
  at=$1
  shift
  generator=""
  if [ ! -e "$at/CMakeCache.txt" ]; then
    generator="-GNinja"
    command -v ninja >/dev/null 2>&1 || generator="-GUnix Makefiles"
  fi
  cmake -S "$root" -B "$at" ${generator:+"$generator"} "$@"
}

# count_tests REPORT STATUS: of what ctest wrote and its exit code, sets ran, bad and not. CMake writes run, fail, notrun
# (skipped, or no program) or disabled.
count_tests() {
  ran=$(grep -c '<testcase .*status="run"' "$1" || true)
  bad=$(grep -c '<testcase .*status="fail"' "$1" || true)
  not=$(grep -c '<testcase .*status="\(notrun\|disabled\)"' "$1" || true)
  lost=$(grep -c '<skipped message="Unable to find executable' "$1" || true)  # a test that is not there has failed
  bad=$((bad + lost))
  not=$((not - lost))
  if [ "$2" != 0 ] && [ "$bad" = 0 ]; then bad=1; fi
}

jobs=${CLEARANCE_JOBS:-$(nproc 2>/dev/null || echo 2)}

# What one build folder has compiled need not be compiled in another: ccache knows paths from here on, not from the root.
CCACHE_BASEDIR=${CCACHE_BASEDIR:-$root}
export CCACHE_BASEDIR
