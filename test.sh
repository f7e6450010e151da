#!/usr/bin/env bash
# Builds and tests on a fresh Debian 12 machine.
#   ./test.sh         release build, all fast tests
#   ./test.sh --ci    the same, address + undefined-behaviour sanitizers, install + find_package
#   ./test.sh --all   the same as --ci, clang, thread sanitizer, clang-tidy and slow validation
set -euo pipefail
cd "$(dirname "$0")"
. .ci/packages.sh

level=${1:-}
case "$level" in
  "" | --ci | --all) ;;
  *) echo "usage: ./test.sh [--ci | --all]" >&2; exit 1 ;;
esac

# configured_build NAME OPTIONS...: build/NAME from the preset of that name.
configured_build() {
  local preset=$1
  shift
  cmake --preset "$preset" "$@" >/dev/null
  cmake --build --preset "$preset"
}

# Installs build/release into a scratch folder and builds a program against find_package(grainlaw).
test_installed_package() {
  local scratch
  scratch=$(mktemp -d)
  cmake --install build/release --prefix "$scratch/usr" >/dev/null
  cmake -S tests/installed -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$scratch/usr" >/dev/null
  cmake --build "$scratch/build"
  "$scratch/build/installed"
  "$scratch/usr/bin/grainlaw" predict data/cases/chute.toml \
    --table "$scratch/usr/share/grainlaw/tables/shi2020_mu_p_0.50.toml" --quiet
  rm -rf "$scratch"
  echo "install and find_package: passed"
}

install_packages "${packages_build[@]}" "${packages_test[@]}"
configured_build release
if [[ -n "$level" ]]; then
  test_installed_package
  configured_build asan
  ctest --preset asan -L sanitize -j "$(nproc)"
fi
if [[ "$level" == --all ]]; then
  install_packages "${packages_all[@]}"
  configured_build tsan
  ctest --preset tsan -L sanitize -j "$(nproc)"
  cmake --preset dev -B build/clang -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ >/dev/null
  cmake --build build/clang
  ctest --test-dir build/clang --output-on-failure -j "$(nproc)" -LE slow
  run-clang-tidy -quiet -p build/clang '(dem|continuum|calibration|apps)/.*\.cpp$'
  ctest --preset release -L slow
fi
ctest --preset release -LE slow -j "$(nproc)"
