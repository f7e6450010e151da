#!/usr/bin/env bash
# Makes thin_chute_THETA.chunk with LAMMPS, some minutes each: ./thin_chute.sh [FOLDER]
set -euo pipefail
cd "$(dirname "$0")"
folder=$(realpath "${1:-.}")
scratch=$(mktemp -d)
lmp -in loose_packing.lmp -log none -screen none -var file "$scratch/packing"
# Below 1.5 d grains are frozen; those that reach through the top of the box are left out.
awk -v head="$scratch/head" 'NR > 9 && $4 < 11.25 {
  type = $4 < 1.5 ? 2 : 1
  ++count[type]
  if (type == 2 && $4 > highest) highest = $4
  printf "%d %d 1.0 1.909859317102744 %s %s %s\n", ++n, type, $2, $3, $4
} END {
  printf "thin chute, %d flowing grains, highest base centre %s\n\n%d atoms\n2 atom types\n", count[1], highest, n >head
  print "0 8 xlo xhi\n0 8 ylo yhi\n-1 24 zlo zhi\n\nAtoms # sphere\n" >head
}' "$scratch/packing" >"$scratch/grains"
cat "$scratch/head" "$scratch/grains" >"$scratch/start"
head -1 "$scratch/start"
for theta in 24 25 26; do
  lmp -in thin_chute.lmp -log none -screen none -var inclination "$theta" \
    -var start "$scratch/start" -var file "$folder/thin_chute_$theta.chunk"
done
rm -r "$scratch"
