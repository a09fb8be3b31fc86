"""Figures of people on film beside pose2sim and a REBA sheet, for film.sh. Ends with 1 where a floor is missed.

python film.py place FOLDER CAMERA     height (m), tilt and field of view (degrees) of a camera
python film.py compare FOLDER
"""

import csv
import importlib.util
import json
import logging
import sys
from pathlib import Path

import numpy as np
import pandas as pd

logging.disable()
# pose2sim's own, so that nothing of ours is judged by itself.
from Pose2Sim.calibration import read_qca
from Pose2Sim.common import compute_height, rotate_cam, world_to_camera_persp
from Pose2Sim.triangulation import triangulation_from_best_cameras

# Metres.
SAME_JOINT, STATURE = 0.020, 0.030
# Of sub-scores that are farther than a degree from a threshold.
SAME_SCORE = 0.99
# Pixels of the film; a network's errors are larger than those of markers.
CONFIG = {"triangulation": {"reproj_error_threshold_triangulation": 30, "min_cameras_for_triangulation": 2}}

# Places in BlazePose, in BODY_25, and names in pose2sim.
JOINTS = {
    "Nose": (0, 0), "LShoulder": (11, 5), "RShoulder": (12, 2), "LElbow": (13, 6), "RElbow": (14, 3), "LWrist": (15, 7),
    "RWrist": (16, 4), "LHip": (23, 12), "RHip": (24, 9), "LKnee": (25, 13), "RKnee": (26, 10), "LAnkle": (27, 14),
    "RAnkle": (28, 11), "LHeel": (29, 21), "RHeel": (30, 24),
}
JUDGED = ["LHip", "RHip", "LKnee", "RKnee", "LShoulder", "RShoulder"]
# Degrees at which sub-scores change.
THRESHOLDS = {
    "s_trunk": ("trunk_flex_deg", (-20, -5, 5, 20, 60)), "s_neck": ("neck_flex_deg", (0, 20)),
    "s_legs": ("knee_flex_deg", (30, 60)), "s_upper_arm": ("upper_arm_flex_deg", (-20, 20, 45, 90)),
    "s_lower_arm": ("lower_arm_flex_deg", (60, 100)), "s_wrist": ("wrist_flex_deg", (-15, 15)),
}


def cameras(folder):
    """Projection matrices in the order of the cameras' names, and what they are made of."""
    _, names, sizes, _, matrices, rotations, places = read_qca(str(folder / "Calib.qca.txt"), 1)
    found = {}
    for name, size, matrix, rotation, place in zip(names, sizes, matrices, rotations, places):
        turned, moved = rotate_cam(*world_to_camera_persp(rotation, place), ang_x=np.pi)
        found[name] = matrix @ np.column_stack([turned, moved]), size, matrix, turned, place
    return found


def place(folder, name):
    _, size, matrix, rotation, where = cameras(folder)[name]
    # The third row is the axis along which the camera looks.
    tilt = -np.degrees(np.arcsin(rotation[2, 2]))
    view = 2 * np.degrees(np.arctan(0.5 * max(size) / matrix[0, 0]))
    print(where[2], tilt, view)


def theirs(folder):
    """pose2sim's points of every joint and image from the landmarks that we find."""
    names = sorted(path.stem.removeprefix("film_") for path in folder.glob("film_cam0?.jsonl"))
    seen = [[json.loads(line) for line in (folder / f"film_{name}.jsonl").read_text().splitlines()] for name in names]
    matrices = [cameras(folder)[name][0] for name in names]
    points = {name: [] for name in JOINTS}
    for images in zip(*seen):
        for name, (index, _) in JOINTS.items():
            marks = np.array([image[0][index] if image else [np.nan] * 8 for image in images])
            marks = np.array([marks[:, 0], marks[:, 1], np.minimum(marks[:, 3], marks[:, 4])])
            points[name].append(triangulation_from_best_cameras(CONFIG, marks, marks.copy(), matrices, None)[0])
    return {name: np.array(part, float) for name, part in points.items()}


def ours(folder, what):
    """The joints of a recording; those that were not seen are NaN."""
    lines = (folder / f"film_{what}_joints.jsonl").read_text().splitlines()[1:]
    frames = [json.loads(line) for line in lines if "keypoints" in line]
    missing = [np.nan] * 3
    pick = lambda frame, index: (frame["keypoints"][index] or missing)[:3]
    return {name: np.array([pick(frame, index) for frame in frames], float) for name, (_, index) in JOINTS.items()}


def rms(one, other, names, centred=False):
    """Root mean square error over joints and images, the median, and the share of known ones; with `centred` about the middle of the hips."""
    errors = []
    for name in names:
        error = one[name] - other[name]
        if centred:
            error = error - 0.5 * (one["LHip"] + one["RHip"] - other["LHip"] - other["RHip"])
        errors.append(np.linalg.norm(error, axis=1))
    errors = np.concatenate(errors)
    known = errors[~np.isnan(errors)]
    return np.sqrt((known**2).mean()), np.median(known), len(known) / len(errors)


def height(points):
    """Stature by pose2sim's rule."""
    columns = [column for name in points for column in [name] * 3]
    return compute_height(pd.DataFrame(np.hstack(list(points.values())), columns=columns))


def sheet():
    """The sheet in Python of ergo-map's golden values."""
    path = Path(__file__).resolve().parents[3] / "ergo-map/tests/golden/make.py"
    spec = importlib.util.spec_from_file_location("golden", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def scores(folder, what, golden):
    """The share of sub-scores that the sheet in Python gives as well, and the REBA scores."""
    same = count = 0
    rebas = []
    with open(folder / f"film_{what}.csv") as file:
        for row in csv.DictReader(file):
            angles = {name: float(row[name]) for name, _ in THRESHOLDS.values()}
            boxes = ["trunk_twist_or_side", "neck_twist_or_side", "arm_abducted_or_rotated", "arm_supported", "wrist_dev_or_twist"]
            filled = {**angles, **{name: int(row[name]) for name in boxes}, "shoulder_raised": 0, "unilateral": 0}
            if int(row["walking"]) or int(row["sitting"]):
                filled["knee_flex_deg"] = 0.0
            names = ["s_neck", "s_trunk", "s_legs", "s_upper_arm", "s_lower_arm", "s_wrist"]
            parts = dict(zip(names, golden.reba_parts(filled)))
            for name, (angle, marks) in THRESHOLDS.items():
                if min(abs(angles[angle] - mark) for mark in marks) > 1:
                    count += 1
                    same += parts[name] == int(row[name])
            rebas.append(int(row["reba"]))
    return same / count, count, np.array(rebas)


def compare(folder):
    held = True
    reference = theirs(folder)
    four = ours(folder, "four")
    error, median, share = rms(four, reference, JUDGED)
    held &= error <= SAME_JOINT
    print(f"four views beside pose2sim: hips, knees, shoulders {1e3 * error:.1f} mm rms, median {1e3 * median:.1f} mm, "
          f"{100 * share:.1f} % of the joints in both")
    error, median, share = rms(four, reference, JOINTS)
    print(f"    all joints {1e3 * error:.1f} mm rms, median {1e3 * median:.1f} mm, {100 * share:.1f} % in both")
    own, other = height(four), height(reference)
    held &= abs(own - other) <= STATURE
    print(f"stature by pose2sim's rule {own:.3f} m of our joints, {other:.3f} m of its own")
    golden = sheet()
    rebas = {}
    for what in ["four", *sorted(path.name for path in (folder / "frames").iterdir())]:
        share, count, rebas[what] = scores(folder, what, golden)
        held &= share >= SAME_SCORE
        print(f"{what}: {100 * share:.2f} % of {count} sub-scores as the sheet in Python has them, REBA {rebas[what].mean():.2f}")
        if what == "four":
            continue
        joints = ours(folder, what)
        # In the camera's world the heading is another: only lengths from the hips and heights can be compared.
        lengths = lambda points: {
            name: np.column_stack([np.linalg.norm((place - 0.5 * (points["LHip"] + points["RHip"]))[:, :2], axis=1),
                                   place[:, 2] - 0.5 * (points["LHip"] + points["RHip"])[:, 2]])
            for name, place in points.items()
        }
        error, median, _ = rms(lengths(joints), lengths(four), JOINTS)
        both = min(len(rebas[what]), len(rebas["four"]))
        off = np.abs(rebas[what][:both] - rebas["four"][:both])
        print(f"    alone beside four views: joints from the hips {1e3 * error:.0f} mm rms, median {1e3 * median:.0f} mm; "
              f"REBA the same in {100 * (off == 0).mean():.0f} %, within one in {100 * (off <= 1).mean():.0f} % of the images")
    print("floors held" if held else "a floor is missed")
    sys.exit(not held)


if __name__ == "__main__":
    folder = Path(sys.argv[2])
    place(folder, sys.argv[3]) if sys.argv[1] == "place" else compare(folder)
