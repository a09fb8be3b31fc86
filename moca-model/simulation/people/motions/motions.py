"""Makes the motions of real people: python motions.py mocap_body25.npz single_3d.npz, in this folder.

The first file has joints of motion capture from pybullet_data/data/motions/humanoid3d_*.txt, on a body of 1.62 m. The
second has joints of a film, triangulated and smoothed at 6 Hz. README.md says whose data they are.
"""

import json
import sys

import numpy as np
from scipy.ndimage import gaussian_filter1d

# Names, clips, and the frames of a clip from one that is kept to the next.
CAPTURED = {"walk": ("humanoid3d_walk", 1), "punch": ("humanoid3d_punch", 1), "dance": ("humanoid3d_dance_a", 2),
            "get-up": ("humanoid3d_getup_faceup", 2)}
PELVIS, SHOULDERS, HIPS = 8, (5, 2), (12, 9)


def facing_robot(places):
    """The mean place of the pelvis at (1.5, 0), the mean heading along -x, the lowest joint on the floor."""
    left = sum(places[:, a] - places[:, b] for a, b in (SHOULDERS, HIPS)).mean(0)[:2]
    angle = np.pi - np.arctan2(-left[0], left[1])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    places[..., :2] = places[..., :2] @ turn.T
    places[..., :2] += [1.5, 0] - places[:, PELVIS, :2].mean(0)
    places[..., 2] -= places[..., 2].min()
    return places


def write(name, places, period, stature):
    with open(name + ".jsonl", "w") as file:
        line = lambda value: print(json.dumps(value, separators=(",", ":")), file=file)
        line({"format": "moca-recording", "version": 2, "frame": "world", "rate": round(1 / period, 3), "stature": stature})
        for at, joints in enumerate(facing_robot(places).round(3).tolist()):
            points = [[*joint, 1.0] for joint in joints]
            line({"time": round(at * period, 6), "keypoints": points, "action": None, "surface": None})
        line({"end": {"frames": len(places), "complete": True}})


mocap, film = np.load(sys.argv[1]), np.load(sys.argv[2])
for name, (clip, every) in CAPTURED.items():
    # The noise of single frames is not motion.
    places = gaussian_filter1d(mocap[clip].astype(float), 1, axis=0, mode="nearest")[::every]
    write(name, places, float(mocap[clip + "_dt"]) * every, 1.62)
write("balance", film["body25"][::2].astype(float), 2 / 60, 1.7)
