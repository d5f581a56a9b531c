#!/usr/bin/env bash
# Renders the figures into docs/figures/, measures docs/results.md and checks docs/conformance.md. What `make figures` runs.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh run
cargo run --release --quiet --example figures

# What this device conforms to, between the fences of the document.
document=docs/conformance.md
# (It says which checks fail by its exit status, too.)
report=$(cargo run --release --quiet -- conformance) || true
case ${report##*$'\n'} in
*"checks passed"* | *"checks failed"*) ;;
*)
    echo "no report of conformance; $document stays as it was" >&2
    exit 1
    ;;
esac
written=$(mktemp)
trap 'rm -f "$written"' EXIT
REPORT=$report awk '/^```text$/ { print; print ENVIRON["REPORT"]; skip = 1 } /^```$/ { skip = 0 } !skip' "$document" > "$written"
cat "$written" > "$document"
