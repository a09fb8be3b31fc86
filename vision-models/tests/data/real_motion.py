"""Joints of real people for tests/it/real_motion.rs.

python real_motion.py mocap_body25.npz single_3d.npz > real_motion.json

walk: motion capture, humanoid3d_walk of PyPI pybullet (zlib licence; pybullet_data), one cycle of a gait, whose last
frame is the first moved on. balance: a man on a balance beam, film of PyPI pose2sim (BSD 3-Clause), four views through
BlazePose, triangulated and smoothed at 6 Hz. Both: BODY_25 joints, z up, in millimetres.
"""

import json
import sys

import numpy as np
from scipy.ndimage import gaussian_filter1d

mocap, film = np.load(sys.argv[1]), np.load(sys.argv[2])
walk = mocap["humanoid3d_walk"].astype(float)
shift = (walk[-1, 8] - walk[0, 8]) * [1, 1, 0]
along = np.linspace(0, 1, len(walk))[:-1, None, None] * shift
# Smooths, because the noise of single frames is not motion.
walk = gaussian_filter1d(walk[:-1] - along, 1, axis=0, mode="wrap") + along
walk = np.concatenate([walk, walk[:1] + shift])
clips = {"walk": (walk, float(mocap["humanoid3d_walk_dt"])), "balance": (film["body25"][::2], 2 / 60)}
out = {name: {"period": dt, "frames": (1e3 * places).round().astype(int).tolist()} for name, (places, dt) in clips.items()}
json.dump(out, sys.stdout, separators=(",", ":"))
print()
