#!/usr/bin/env bash
# Measures this machine for the record: every scene, beside its limits and beside VTK. What `make bench-report` runs.
#
#   scripts/bench-report.sh [FOLDER]
#
# FOLDER (default bench/runs/, the day and the number of cores) gets figures.json, peers.json and report.html, docs/performance.md the tables.
# Takes about a quarter of an hour on two idle cores, after the build; anything else that runs there spoils the times.
# UMBRAVOX_BENCH_SET=short measures less. UMBRAVOX_PEERS_VENV names the virtual environment with VTK; it is made where it is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=${1:-bench/runs/$(date +%F)-$(nproc)core}
measured=${UMBRAVOX_BENCH_SET:-record}
venv=${UMBRAVOX_PEERS_VENV:-${TMPDIR:-/tmp}/umbravox-peers}
scenes=$(mktemp -d)
trap 'rm -rf "$scenes"' EXIT

scripts/setup.sh run
if ! "$venv/bin/python" -c 'import vtkmodules' 2>/dev/null; then
    python3 -m venv "$venv" # Debian: python3-venv
    "$venv/bin/pip" install --quiet -r bench/peers/requirements.txt
fi

bench() {
    cargo bench --quiet --bench gpu -- "$@"
}
mkdir -p "$folder"
bench --set "$measured" --into "$folder" >/dev/null
bench --set "$measured" --export "$scenes"
rm -f "$folder/peers.json" # of another day
"$venv/bin/python" bench/peers/run.py "$scenes" --program target/release/umbravox --json "$folder/peers.json" ||
    echo "NOT COMPARED with VTK: see above" >&2
bench --report "$folder" --document docs/performance.md
echo "written: $folder/report.html, and the tables of docs/performance.md"
