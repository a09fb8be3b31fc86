#!/bin/bash
# Holds people on film, by four cameras and by each alone, against pose2sim's triangulation and a REBA sheet in Python, and
# prints the figures of the book's page on people on film. What it needs comes as films.sh says.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/films.sh"
packages=(numpy scipy pandas opencv-python-headless matplotlib rtoml c3d anytree tqdm lxml)
environment pose2sim "${packages[@]}" && "$folder/pose2sim/bin/pip" install --quiet --no-deps "$folder"/pose2sim-*.whl 2> /dev/null ||
    missing "PyPI does not give pose2sim with ${packages[*]}"

cargo build --release --locked --package vision-models --example blaze_pose
cargo build --release --locked --package examples --bin reba
target=${CARGO_TARGET_DIR:-target}/release
python=$folder/pose2sim/bin/python
rate=60
"$python" "$here/blaze_pose.py" frames "$folder"
networks=("$folder/package/pose_solution_packed_assets.data" "$folder/package/pose_landmark_full.tflite")
for camera in "$folder"/frames/*/; do
    camera=$(basename "$camera")
    "$target/examples/blaze_pose" "${networks[@]}" 1 "$rate" "$folder/frames/$camera"/*.png > "$folder/film_$camera.jsonl"
done
outputs() { echo "--rate $rate --output $folder/film_$1.csv --recording $folder/film_$1_joints.jsonl --picture $folder/film_$1.svg --quiet"; }
# shellcheck disable=SC2046
"$target/reba" --video "$folder"/frames/* --pose "${networks[1]}" --calibration "$folder/Calib.qca.txt" $(outputs four)
for camera in "$folder"/frames/*/; do
    camera=$(basename "$camera")
    read -r height tilt view < <("$python" -W ignore "$here/film.py" place "$folder" "$camera")
    # shellcheck disable=SC2046
    "$target/reba" --video "$folder/frames/$camera" --pose "${networks[1]}" --camera-height "$height" --camera-tilt "$tilt" \
        --field-of-view "$view" $(outputs "$camera")
done
"$python" "$here/film_pictures.py" "$folder" cam01 "$folder/film-people.jpg"
echo "pictures of the film with the skeleton: $folder/film-people.jpg"
"$python" -W ignore "$here/film.py" compare "$folder"
