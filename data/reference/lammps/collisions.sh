#!/usr/bin/env bash
# Makes head_on.csv and oblique.csv: collisions of two spheres in LAMMPS. Takes about a minute.
set -euo pipefail
cd "$(dirname "$0")"

declare -A force=(
  [hooke]="gran/hooke/history 2.0e5 NULL 50.0 NULL 0.5 0"
  [hertz]="gran/hertz/history 4.0e5 NULL 100.0 NULL 0.5 0"  # twice the coefficients: see README.md
)
step_counts="50 200 1000"  # steps per contact time

# contact_time LAW D1 D2 SPEED: of Hooke with damping (Brewster et al. 2008, Eq. 8, for masses D^3);
# of undamped equal Hertz spheres, 3.2181 (reduced mass/k)^0.4 speed^-0.2.
contact_time() {
  awk -v law="$1" -v m1="$(awk "BEGIN { print $2 ^ 3 }")" -v m2="$(awk "BEGIN { print $3 ^ 3 }")" -v speed="$4" 'BEGIN {
    m = m1 * m2 / (m1 + m2)
    if (law == "hooke") printf "%.15g", atan2(0, -1) / sqrt(2e5 / m - 50.0 ^ 2 / 4)
    else printf "%.15g", 3.2181 * (m / 2e5) ^ 0.4 * speed ^ -0.2 }'
}

# collide LAW D1 D2 NORMAL TANGENTIAL STEPS: sets step and the six final velocities, result.
collide() {
  local law=$1 d1=$2 d2=$3 normal=$4 tangential=$5 per_contact=$6
  step=$(awk -v t="$(contact_time "$law" "$d1" "$d2" "$normal")" -v n="$per_contact" 'BEGIN { printf "%.10g", t / n }')
  result=$(lmp -in collision.lmp -log none -var force "${force[$law]}" -var diameter_1 "$d1" -var diameter_2 "$d2" \
    -var normal "$normal" -var tangential "$tangential" -var step "$step" \
    -var steps "$((per_contact * 3 / 2))" | sed -n 's/^RESULT //p')
  [[ -n "$result" ]] || { echo "collisions.sh: no result for $*" >&2; exit 1; }
}

{
  echo "law,speed,steps_per_contact,step,restitution"
  for law in hooke hertz; do
    for speed in 0.01 0.1 1 10; do
      for steps in $step_counts; do
        collide $law 1 1 $speed 0 "$steps"
        echo "$law,$speed,$steps,$step,$(awk -F, -v v=$speed '{ printf "%.8f", ($4 - $1) / v }' <<<"$result")"
      done
    done
  done
} >head_on.csv

{
  echo "law,diameter_1,diameter_2,tangential_speed,steps_per_contact,step,v1x,v1y,w1z,v2x,v2y,w2z"
  for case in "hooke 1 1" "hooke 0.6666666666666667 1.333333333333333" "hertz 1 1"; do
    for speed in 0.02 0.5 1 1.5 2 3 4 8; do
      for steps in $step_counts; do
        # shellcheck disable=SC2086  # a case is three words
        collide $case 1 $speed "$steps"
        echo "${case// /,},$speed,$steps,$step,$result"
      done
    done
  done
} >oblique.csv
