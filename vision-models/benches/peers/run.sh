#!/bin/bash
# Builds `infer`, installs the peers from PyPI, exports the same random weights to all, and compares.
# Arguments go to compare.py. The folder is $PEERS or ./target/peers.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../../.."
folder=${PEERS:-target/peers}
mkdir -p "$folder"
cargo build --release --package examples --bin infer
if [ ! -d "$folder/venv" ]; then
    python3 -m venv "$folder/venv"
    "$folder/venv/bin/pip" install -r "$here/requirements.txt"
fi
[ -f "$folder/simple_baseline.pt" ] || "$folder/venv/bin/python" "$here/export.py" "$folder"
"$folder/venv/bin/python" "$here/compare.py" "$folder" "${CARGO_TARGET_DIR:-target}/release/infer" "$@"
