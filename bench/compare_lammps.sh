#!/usr/bin/env bash
# Speed of grainlaw against LAMMPS: the same packings, contact law and time step, one core, run in turn.
#   bench/compare_lammps.sh [BUILD]    BUILD/bin/grainlaw is measured; BUILD is build/release if left out
#   ROUNDS=9 bench/compare_lammps.sh   more rounds than the usual 5
# A rate is flowing grains x steps / wall seconds of the stepping loop. grainlaw counts the whole run.
# LAMMPS starts the same run from the same packing, and its clock starts after the first eleventh.
# The ratio grainlaw / LAMMPS is taken within a round, the last line gives the medians over the rounds.
set -euo pipefail

bench=$(cd "$(dirname "$0")" && pwd)
build=$(realpath -m "${1:-$bench/../build/release}")
grainlaw=$build/bin/grainlaw
rounds=${ROUNDS:-5}
core=$(($(nproc) - 1))
export OMP_NUM_THREADS=1

refuse() { echo "compare_lammps.sh: $1" >&2; exit 1; }
command -v lmp >/dev/null || refuse "lmp, the program of LAMMPS, is not installed (Debian: apt-get install lammps)."
[[ -x "$grainlaw" ]] || refuse "$grainlaw is not there; build it first, or give the build folder as the argument."
((rounds >= 1)) || refuse "ROUNDS=$rounds: must be at least 1."

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
pin=()
if taskset -c "$core" true 2>/dev/null; then pin=(taskset -c "$core"); fi

# case -> LAMMPS scene, packing, best skin of LAMMPS: measured at 0.05 to 0.3, 0.2 to 0.6, 0.1 to 0.25 d
declare -A scene=([chute4k]=chute [chute36k]=chute [shear]=shear)
declare -A packing=([chute4k]=chute_4000 [chute36k]=chute_36000 [shear]=shear_4096)
declare -A skin=([chute4k]=0.1 [chute36k]=0.45 [shear]=0.25)
declare -A flowing steps
cases="chute4k chute36k shear"

# toml_number KEY FILE
toml_number() { awk -v key="$1" '$1 == key && $2 == "=" { print $3; exit }' "$2"; }

# prepare CASE: its packing for both programs, its number of flowing grains and of steps.
prepare() {
  local csv=$work/${packing[$1]}.csv
  cp "$bench/lammps/$1.toml" "$work"
  zcat "$bench/packings/${packing[$1]}.csv.gz" >"$csv"
  awk -f "$bench/lammps/data_file.awk" "$csv" >"${csv%.csv}.data"
  flowing[$1]=$(grep -c ',0$' "$csv")
  steps[$1]=$(awk -v t="$(toml_number time_limit "$work/$1.toml")" -v dt="$(toml_number step "$work/$1.toml")" \
    'BEGIN { printf "%.0f", t / dt }')
}

# lammps_rate CASE: million grain steps per second, from the time of the last run.
lammps_rate() {
  local warm_up=$((steps[$1] / 11)) log=$work/$1.lammps.log
  local timed=$((steps[$1] - warm_up))
  (cd "$bench/lammps" && "${pin[@]}" lmp -in timed.lmp -log none -var scene "${scene[$1]}.lmp" \
    -var packing "$work/${packing[$1]}.data" -var skin "${skin[$1]}" \
    -var warm_up "$warm_up" -var steps "$timed") >"$log" 2>&1 ||
    { tail -n 5 "$log" >&2; refuse "lmp failed on $1."; }
  awk -v work="$((flowing[$1] * timed))" '/^Loop time of/ { seconds = $4 } END { printf "%.3f", work / seconds / 1e6 }' "$log"
}

# grainlaw_rate CASE: the same from the summary. Exit code 2 (no steady state in so short a run) is expected.
grainlaw_rate() {
  local status=0 rate
  (cd "$work" && "${pin[@]}" "$grainlaw" dem "$1.toml" --json --threads 1 -o "$1.h5") \
    >"$work/$1.json" 2>"$work/$1.log" || status=$?
  ((status == 0 || status == 2)) || { cat "$work/$1.log" >&2; refuse "grainlaw dem failed on $1.toml."; }
  rate=$(grep -oE '"grain_steps_per_second": *[0-9.e+]+' "$work/$1.json" | sed 's/.*: *//') ||
    { cat "$work/$1.log" >&2; refuse "no grain_steps_per_second in the summary of $1.toml."; }
  awk -v rate="$rate" 'BEGIN { printf "%.3f", rate / 1e6 }'
}

# median: of the numbers on standard input
median() { sort -g | awk '{ x[NR] = $1 } END { print (x[int((NR + 1) / 2)] + x[int(NR / 2) + 1]) / 2 }'; }

echo "LAMMPS:   $(lmp -h | sed -n 's/^Large-scale.*Simulator - //p')"
echo "grainlaw: $("$grainlaw" --version | head -n 1), $grainlaw"
if ((${#pin[@]})); then echo "core:     $core, by taskset"; else echo "core:     not pinned (no taskset)"; fi
echo
for case in $cases; do prepare "$case"; done
echo "million grain steps per second"
printf '%5s  %-8s %9s %9s %7s\n' round case LAMMPS grainlaw ratio
for ((round = 1; round <= rounds; ++round)); do
  for case in $cases; do
    lammps=$(lammps_rate "$case")
    ours=$(grainlaw_rate "$case")
    ratio=$(awk -v a="$ours" -v b="$lammps" 'BEGIN { printf "%.3f", a / b }')
    printf '%5d  %-8s %9.2f %9.2f %7.2f\n' "$round" "$case" "$lammps" "$ours" "$ratio"
    echo "$ratio" >>"$work/$case.ratios"
  done
done
line=ratio
for case in $cases; do line+=" $case=$(median <"$work/$case.ratios" | xargs printf '%.2f')"; done
echo "$line"
