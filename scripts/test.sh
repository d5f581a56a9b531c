#!/usr/bin/env bash
# Every test, with the Vulkan validation layer. What `make test` runs.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh test
cargo test --all-features
cargo test -p xtask
