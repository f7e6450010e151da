#!/usr/bin/env bash
# Runs the commands a document shows, in order, each block in one shell, in a folder of its own:
#   run_commands.sh [--slow] DOCUMENT.md SOURCE_DIR BIN_DIR
# Blocks are fenced as ```sh. Words after it: "exit=2" where the last command answers with that code,
# "slow" for minutes of work (run only with --slow, and so is all that follows in the document, which
# may need its files), "elsewhere" for what this machine cannot run. ```python blocks run in python3
# where it has h5py and pandas.
set -uo pipefail
slow=no
if [[ "$1" == --slow ]]; then slow=yes; shift; fi
document=$(realpath "$1") source=$(realpath "$2") bin=$(realpath "$3")

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
ln -s "$source/data" data
export PATH="$bin:$PATH"

awk -v folder="$folder" '
  /^```/ && inside { inside = 0; close(file); next }
  /^```(sh|python)/ { inside = 1; file = sprintf("%s/.block_%03d", folder, ++n)
                      print "#" substr($0, 4) " (line " NR ")" > file; next }
  inside { print > file }
' "$document"

# The interpreter of the system has Debian's h5py and pandas; another one may stand before it.
python=python3
"$python" -c "import h5py, pandas" 2>/dev/null || python=/usr/bin/python3

failures=0
run=0
for block in .block_*; do
  [[ -e "$block" ]] || break
  head=$(head -n 1 "$block")
  [[ "$head" == *" elsewhere"* ]] && continue
  if [[ "$head" == *" slow"* && $slow == no ]]; then break; fi
  expected=0
  [[ "$head" =~ exit=([0-9]+) ]] && expected=${BASH_REMATCH[1]}
  if [[ "$head" == "#python"* ]]; then
    "$python" -c "import h5py, pandas" 2>/dev/null || continue
    "$python" "$block" >"$block.out" 2>&1
  else
    bash -eo pipefail "$block" >"$block.out" 2>&1
  fi
  code=$?
  run=$((run + 1))
  if [[ $code -ne $expected ]]; then
    failures=$((failures + 1))
    echo "$(basename "$document") ${head#\#}: exit code $code, not $expected"
    sed 1d "$block" | sed 's/^/    /'
    tail -n 20 "$block.out" | sed 's/^/  | /'
  fi
done
echo "$(basename "$document"): $run blocks, $failures failed"
[[ $failures -eq 0 ]]
