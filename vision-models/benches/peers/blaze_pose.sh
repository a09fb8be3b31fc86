#!/bin/bash
# Compares BlazePose with TensorFlow Lite and MediaPipe on film. Prints the figures of the book's page on poses.
# Installs npm and PyPI packages to $PEERS or ./target/peers. Reports and leaves out those that are missing.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../../.."
folder=${PEERS:-target/peers}/blaze_pose
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

missing() {
    echo "left out: $1"
    exit "${2:-0}"
}

if [ ! -d "$folder/package" ]; then
    command -v npm > /dev/null || missing 'npm is missing, which has the package @mediapipe/pose'
    (cd "$folder" && npm pack --silent @mediapipe/pose && tar xf mediapipe-pose-*.tgz) ||
        missing 'npm does not give the package @mediapipe/pose'
fi
if [ ! -d "$folder/films" ]; then
    python3 -m pip download --quiet --no-deps --dest "$folder" pose2sim ||
        missing 'PyPI does not give the package pose2sim'
    python3 -m zipfile -e "$folder"/pose2sim-*.whl "$folder/unpacked"
    mv "$folder/unpacked/Pose2Sim/Demo_SinglePerson/videos" "$folder/films"
    rm -r "$folder/unpacked"
fi
# Each is installed completely or not at all.
environment() {
    [ -f "$folder/$1/whole" ] && return
    python3 -m venv "$folder/$1" && "$folder/$1/bin/pip" install --quiet "${@:2}" && touch "$folder/$1/whole"
}
environment litert ai-edge-litert numpy opencv-python-headless ||
    missing 'PyPI does not give ai-edge-litert, numpy and opencv-python-headless'
# The last versions whose CPU graph gives the regions.
environment mediapipe 'mediapipe==0.10.14' || echo 'left out: MediaPipe 0.10.14 cannot be installed'

cargo build --release --locked --package vision-models --example blaze_pose
cargo build --release --locked --package examples --bin infer
target=${CARGO_TARGET_DIR:-target}/release
"$folder/litert/bin/python" "$here/blaze_pose.py" frames "$folder"
rates=(0 25)
for camera in "$folder"/frames/*/; do
    camera=$(basename "$camera")
    for rate in "${rates[@]}"; do
        "$target/examples/blaze_pose" "$folder/package/pose_solution_packed_assets.data" \
            "$folder/package/pose_landmark_full.tflite" 1 "$rate" "$folder/frames/$camera"/*.png > "$folder/ours_${camera}_$rate.jsonl"
        if [ -f "$folder/mediapipe/whole" ]; then
            "$folder/mediapipe/bin/python" "$here/blaze_pose_mediapipe.py" "$rate" "$folder/theirs_${camera}_$rate.json" \
                "$folder/frames/$camera"/*.png 2> /dev/null
        fi
    done
done
"$folder/litert/bin/python" "$here/blaze_pose.py" compare "$folder" "$target/infer" 2> /dev/null
