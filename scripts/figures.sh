#!/usr/bin/env bash
# Renders every scene in examples/figures/ into docs/figures/. What `make figures` runs.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh run
cargo build --release
mkdir -p docs/figures
shopt -s nullglob
scenes=(examples/figures/*.json)
if [ ${#scenes[@]} -eq 0 ]; then
    echo "no scenes in examples/figures/" >&2
    exit 1
fi
for scene in "${scenes[@]}"; do
    name=$(basename "$scene" .json)
    cargo run --release --quiet -- render "$scene" -o "docs/figures/$name.png"
    echo "docs/figures/$name.png"
done
