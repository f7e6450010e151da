#!/usr/bin/env bash
# From a fresh Debian 12 machine to a report: installs the packages, builds, runs the main job.
#   ./quickstart.sh           the whole quickstart (chutes at five tilts, about 3 minutes of DEM)
#   ./quickstart.sh --short   the same way on smaller, shorter chutes; for checks of the program,
#                             its numbers mean little
set -euo pipefail
cd "$(dirname "$0")"
. .ci/packages.sh

campaign=data/campaigns/quickstart/campaign.toml
output=quickstart-report
if [[ "${1:-}" == --short ]]; then
  campaign=data/campaigns/quickstart/short.toml
  output=quickstart-report-short
elif [[ $# -gt 0 ]]; then
  echo "usage: ./quickstart.sh [--short]" >&2
  exit 1
fi

install_packages "${packages_build[@]}"

build_begin=$SECONDS
cmake --preset release -DGRAINLAW_BUILD_TESTS=OFF -B build/quickstart >build-quickstart.log 2>&1 &&
  cmake --build build/quickstart >>build-quickstart.log 2>&1 ||
  { tail -n 40 build-quickstart.log; echo "quickstart: the build failed, see build-quickstart.log" >&2; exit 1; }
rm -f build-quickstart.log
echo "build: $((SECONDS - build_begin)) s"

run_begin=$SECONDS
build/quickstart/bin/grainlaw calibrate "$campaign" -o "$output"
echo
echo "run: $((SECONDS - run_begin)) s"
echo "Open $PWD/$output/report.html in a browser."
