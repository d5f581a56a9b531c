#!/usr/bin/env bash
# Renders the figures into docs/figures/ and measures docs/results.md. What `make figures` runs.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh run
cargo run --release --quiet --example figures
