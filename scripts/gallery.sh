#!/usr/bin/env bash
# Renders every volume of data/, and of ../shared/data where there is one, into docs/gallery.png. What `make gallery` runs.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh run
cargo run --release --quiet --example gallery
