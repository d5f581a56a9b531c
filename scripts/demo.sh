#!/usr/bin/env bash
# Renders the CT in data/ with local ambient occlusion into out/. What `make demo` runs.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh run
cargo build --release
mkdir -p out
cargo run --release --quiet -- render examples/aorta.json -o out/aorta.png --stats out/aorta.json
echo
echo "The picture is $PWD/out/aorta.png"
echo "The timings are in $PWD/out/aorta.json; the scene is examples/aorta.json"
