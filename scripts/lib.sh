# SPDX-License-Identifier: BSD-3-Clause
# Sourced by the other scripts: where things are, and what must be installed. POSIX shell.

root=$(cd "$(dirname "$0")/.." && pwd)

# What each part needs on a Debian 12 that has nothing; each list holds the one before. README.md names the same.
# (zlib1g-dev: libassimp-dev links its libz.so and does not bring it.) Ubuntu 24.04 has the same names (untried there).
packages_library="cmake g++ make libeigen3-dev libtbb-dev"
packages_io="$packages_library libassimp-dev zlib1g-dev liburdfdom-dev libstb-dev liblzf-dev libyaml-cpp-dev libxxhash-dev"
packages_command="$packages_io libcli11-dev nlohmann-json3-dev ninja-build"
packages_test="$packages_command catch2 libfcl-dev python3 ccache"
packages_all="$packages_test libbenchmark-dev"

say() { printf '%s\n' "$*"; }
fail() { say "$*" >&2; exit 1; }

# install_packages yes|no names...: does nothing where all are there; "no" only says what is missing.
install_packages() {
  may_install=$1
  shift
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
  say "Installing from your distribution:$missing"
  $become env DEBIAN_FRONTEND=noninteractive apt-get update -q >/dev/null &&
    $become env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing >/dev/null ||
    fail "The installation failed; please install: apt-get install --no-install-recommends$missing"
}

# A CUDA toolkit is used where there is one, also if it is not on the PATH.
find_cuda() {
  if ! command -v nvcc >/dev/null 2>&1 && [ -x /usr/local/cuda/bin/nvcc ]; then
    PATH=$PATH:/usr/local/cuda/bin
    export PATH
  fi
  command -v nvcc >/dev/null 2>&1
}

# The generator of a build folder is fixed when it is made, so it is only chosen for a new one.
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

jobs=${CLEARANCE_JOBS:-$(nproc 2>/dev/null || echo 2)}
