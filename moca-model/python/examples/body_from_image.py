"""A person in an image and its depth image becomes a body, then a scene, then a command of MOCA.

body_from_image.py FOLDER COLOUR DEPTH: FOLDER has MediaPipe's networks, the images are of one size, and DEPTH is a PNG of
16 bits in millimetres.
"""

import argparse
import pathlib

from ahqp.collaboration import Controller, FrameError, Scene
from ahqp.vision import BlazePose, Camera, Lifter, People, read_depth, read_image

NETWORKS = ("pose_solution_packed_assets.data", "pose_landmark_full.tflite")

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("folder", type=pathlib.Path)
parser.add_argument("colour")
parser.add_argument("depth")
parser.add_argument("--focal", type=float, help="focal length of your camera [pixels]")
options = parser.parse_args()
files = [options.folder / name for name in NETWORKS]
if missing := [file.name for file in files if not file.exists()]:
    parser.error(f"no {missing[0]} in {options.folder}: `npm pack @mediapipe/pose` has it, in its folder package")

image, depth = read_image(options.colour), read_depth(options.depth)
height, width, _ = image.shape
focal = options.focal or 0.96 * width  # about that of a RealSense D435i
matrix = [[focal, 0.0, (width - 1) / 2], [0.0, focal, (height - 1) / 2], [0.0, 0.0, 1.0]]
camera = Camera.looking_at(width, height, matrix, [0.0, 0.0, 1.5], [2.5, 0.0, 1.2])
network, lifter, people = BlazePose(*files), Lifter(camera), People()
controller, problem = Controller.moca(), None
q = controller.position
for frame in range(10):  # a camera has a new image each time
    time = 0.05 * frame
    bodies = []
    for person in network.estimate(image, time):
        bodies.append(lifter.lift(person.body, depth, heading=lambda body: people.heading_near(body, time)))
    people.update(time, bodies)
    try:
        controller.observe(Scene(people.body, others=people.others, time=time))
    except FrameError as error:  # the controller goes on, and stops the robot if this lasts
        problem = error
    for _ in range(50):
        command = controller.step(q, 1e-3)
        q = q + command.velocity * 1e-3  # on a real robot, command.base_twist and command.position
for person in people.tracks:
    print(f"person {person.id}: {len(person.measured.seen)} joints")
    for name, (x, y, z) in zip(person.measured.JOINTS, person.measured.joints):
        if name in person.measured.seen:
            print(f"  {name}: {x:.3f} {y:.3f} {z:.3f} m")
if problem:
    print(f"no data: {problem}")
print(f"the robot: {command.phase}, {command.safety}")
