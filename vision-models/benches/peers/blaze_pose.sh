#!/bin/bash
# Holds BlazePose against TensorFlow Lite and MediaPipe on film, and prints the figures of the book's page on poses.
# What it needs comes from npm and PyPI to $PEERS or ./target/peers (films.sh); what is missing it says, and leaves out.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/films.sh"
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
    if [ -f "$folder/mediapipe/whole" ]; then
        "$target/examples/blaze_pose" "$folder/package/pose_solution_packed_assets.data" "$folder/package/pose_landmark_full.tflite" \
            "$folder/theirs_${camera}_25.regions.json" "$folder/frames/$camera"/*.png > "$folder/ours_${camera}_step.jsonl"
        "$folder/mediapipe/bin/python" "$here/blaze_pose_mediapipe.py" 25 "$folder/changed_$camera.json" --changed \
            "$folder/frames/$camera"/*.png 2> /dev/null
    fi
done
# TensorFlow Lite says a lot there.
"$folder/litert/bin/python" "$here/blaze_pose.py" compare "$folder" "$target/infer" 2> "$folder/errors" ||
    { status=$?; tail -n 3 "$folder/errors" >&2; exit "$status"; }
