#!/usr/bin/env bash
# Makes SCENE_PER_STEP_series.csv and SCENE_PER_STEP_grains.csv: 0.03 time units of the chute and of the
# sheared box in LAMMPS, at steps of 1e-4 divided by 1, 4 and 16. Takes about a minute.
set -euo pipefail
cd "$(dirname "$0")"
bench=../../../bench
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for run in chute:chute_4000 shear:shear_4096; do
  scene=${run%:*} packing=${run#*:}
  zcat "$bench/packings/$packing.csv.gz" | awk -f "$bench/lammps/data_file.awk" >"$work/$packing.data"
  for divisor in 1 4 16; do
    output=$work/$scene
    lmp -in short_run.lmp -log none -screen none -var scene "$bench/lammps/$scene.lmp" \
      -var packing "$work/$packing.data" -var step "$(awk "BEGIN { printf \"%.10g\", 1e-4 / $divisor }")" \
      -var steps $((300 * divisor)) -var every $((30 * divisor)) -var output "$output"
    {
      echo "time,kinetic_energy,rotation_energy,px,py,pz,sum_x,sum_y,sum_z,kxx,kyy,kzz,kxy,kxz,kyz,wxx,wyy,wzz,wxy,wxz,wyz"
      awk '!/^#/ { line = $2; for (i = 3; i <= NF; i++) line = line "," $i; print line }' "$output.series"
    } >"${scene}_step_${divisor}_series.csv"
    {
      echo "grain,x,y,z,vx,vy,vz,wx,wy,wz"
      awk '/^ITEM: ATOMS/ { body = 1; next } body { $1 = $1; gsub(" ", ","); print }' "$output.grains"
    } >"${scene}_step_${divisor}_grains.csv"
  done
done
