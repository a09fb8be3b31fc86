#!/usr/bin/env bash
# Checks `drive --ros2` and `perceive --live --ros2` against Cyclone DDS on this machine, and Experiment 3 between two
# nodes: check.sh [SECONDS [OPTIONS OF ALL OF THEM]], 60 s without. It takes Python with venv, the Rust toolchain and PyPI,
# and two processors that have nothing else to do; else `check.sh 60 --priority 10` gives it what a robot's machine would,
# if the system permits that. PROGRAMS=FOLDER takes the programs that are built there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
programs=${PROGRAMS:-${CARGO_TARGET_DIR:-$root/target}/release}
if [ -z "${PROGRAMS:-}" ]; then
    cargo build --manifest-path "$root/Cargo.toml" --release --locked -p examples --features ros2 --bin drive --bin perceive --bin record
fi

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
"$python" "$here/refusals.py" --drive "$programs/drive"
printf '== a camera at 20 Hz\n'
"$programs/record" --quiet --frames "$folder/walk" --walk --duration 20 --drop 0
"$python" "$here/camera.py" --perceive "$programs/perceive" --images "$folder/walk/colour" --duration 15 "${@:2}" \
    -- --skeletons "$folder/walk/skeletons"
printf '== %s s at 1 kHz\n' "${1:-60}"
"$python" "$here/loopback.py" --drive "$programs/drive" --duration "${1:-60}" "${@:2}"
printf '== Experiment 3\n'
"$programs/record" --quiet --output "$folder/offer.jsonl" --offer 10 --tool polisher --path 1.4,0 --duration 24
"$python" "$here/experiment3.py" --drive "$programs/drive" --recording "$folder/offer.jsonl" "${@:2}"
