"""Makes the recordings of real people.

python real_people.py walk ../../vision-models/tests/data/real_motion.json > walk.jsonl
python real_people.py film film_four_joints.jsonl > balance.jsonl

The second takes what vision-models/benches/peers/film.sh writes: `reba --video` with four cameras and --recording. Both
people are turned towards the robot and moved in front of it. README.md says whose data they are.
"""

import json
import sys

# Steps that follow each other, and where the person begins (m).
CYCLES, BEGIN = 3, 5.0
# Every image of so many is kept.
EVERY = 2
# Where the film's origin comes to lie (m).
AHEAD = 1.5


def placed(x, y, z, ahead):
    return [round(ahead - x, 4), round(-y, 4), round(z, 4)]


def walk(text):
    clip = json.loads(text)["walk"]
    frames, period = clip["frames"], clip["period"]
    hip = 8
    turn = frames[-1][hip][0] - frames[0][hip][0]
    images = []
    for cycle in range(CYCLES):
        for frame in frames[bool(cycle):]:
            images.append([[*placed(1e-3 * (x + cycle * turn), 1e-3 * y, 1e-3 * z, BEGIN), 1.0] for x, y, z in frame])
    return {"rate": round(1 / period, 3), "stature": 1.62}, [(round(at * period, 6), image) for at, image in enumerate(images)]


def film(text):
    header, *lines = map(json.loads, text.splitlines())
    images = [line for line in lines if "keypoints" in line][::EVERY]
    moved = lambda point: [*placed(*point[:3], AHEAD), round(point[3], 3)] if point else None
    return ({"rate": header["rate"] / EVERY, "stature": header["stature"] and round(header["stature"], 2)},
            [(image["time"], [moved(point) for point in image["keypoints"]]) for image in images])


header, images = {"walk": walk, "film": film}[sys.argv[1]](open(sys.argv[2]).read())
line = lambda value: print(json.dumps(value, separators=(",", ":")))
line({"format": "moca-recording", "version": 2, "frame": "world", **header})
for time, points in images:
    line({"time": time, "keypoints": points, "action": None, "surface": None})
line({"end": {"frames": len(images), "complete": True}})
