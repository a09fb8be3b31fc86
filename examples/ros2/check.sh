#!/usr/bin/env bash
# Checks `drive --ros2` and `perceive --live --ros2` against Cyclone DDS on this machine: check.sh [SECONDS [OPTIONS OF loopback.py]], 60 s without.
# It takes Python with venv, the Rust toolchain and PyPI, and two processors that have nothing else to do; else
# `check.sh 60 --priority 10` gives it what a robot's machine would, if the system permits that.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
target=${CARGO_TARGET_DIR:-$root/target}
cargo build --manifest-path "$root/Cargo.toml" --release --locked -p examples --features ros2 --bin drive --bin perceive --bin record

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check --requirement "$here/requirements.txt"
python=$folder/venv/bin/python

# A domain of its own.
export ROS_DOMAIN_ID=${ROS_DOMAIN_ID:-97}
printf '== messages in bytes\n'
diff <("$python" "$here/golden.py") "$here/golden.txt"
printf '== what is refused\n'
"$python" "$here/refusals.py" --drive "$target/release/drive"
printf '== a camera at 20 Hz\n'
"$target/release/record" --quiet --frames "$folder/walk" --walk --duration 20 --drop 0
"$python" "$here/camera.py" --perceive "$target/release/perceive" --images "$folder/walk/colour" --duration 15 \
    -- --skeletons "$folder/walk/skeletons"
printf '== %s s at 1 kHz\n' "${1:-60}"
"$python" "$here/loopback.py" --drive "$target/release/drive" --duration "${1:-60}" "${@:2}"
