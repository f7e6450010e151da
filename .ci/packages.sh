# Debian 12 packages, one list for every script. Sourced, not run.
packages_build=(
  cmake ninja-build g++ gnuplot-nox
  libeigen3-dev libsundials-dev libceres-dev libhdf5-dev
  libcli11-dev libtomlplusplus-dev libfmt-dev nlohmann-json3-dev librandom123-dev
)
packages_test=(libgtest-dev clang-format python3-h5py python3-pandas parallel)
packages_all=(clang clang-tidy libomp-dev)

# install_packages NAME...: installs what is missing; asks for nothing when all is there.
install_packages() {
  local missing=()
  for package in "$@"; do
    dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
  done
  [[ ${#missing[@]} -eq 0 ]] && return 0
  echo "installing: ${missing[*]}"
  local as_root=()
  [[ $EUID -eq 0 ]] || as_root=(sudo)
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends \
    "${missing[@]}" >/dev/null
}
