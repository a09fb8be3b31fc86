# Gets BlazePose from npm and films of one person by four cameras from PyPI, for the scripts beside it, which read this file.
# What is missing it says, and ends the script.
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
if [ ! -f "$folder/Calib.qca.txt" ]; then
    python3 -m pip download --quiet --no-deps --dest "$folder" pose2sim ||
        missing 'PyPI does not give the package pose2sim'
    python3 -m zipfile -e "$folder"/pose2sim-*.whl "$folder/unpacked"
    [ -d "$folder/films" ] || mv "$folder/unpacked/Pose2Sim/Demo_SinglePerson/videos" "$folder/films"
    mv "$folder/unpacked/Pose2Sim/Demo_SinglePerson/calibration/Calib.qca.txt" "$folder"
    rm -r "$folder/unpacked"
fi
# Each is installed whole or not at all.
environment() {
    [ -f "$folder/$1/whole" ] && return
    python3 -m venv "$folder/$1" && "$folder/$1/bin/pip" install --quiet "${@:2}" && touch "$folder/$1/whole"
}
