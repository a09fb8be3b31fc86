"""A Panda whose tool follows a circle: position before orientation before posture."""
import math
import pathlib

from ahqp.whole_body import Ik, Model, OrientationTask, PositionTask, PostureTask

urdf = pathlib.Path(__file__).parents[3] / "moca-model/whole-body/examples/urdf/panda.urdf"
tool = "panda_hand_tcp"
q = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
tasks = {"position": PositionTask(tool), "orientation": OrientationTask(tool), "posture": PostureTask()}
ik = Ik(Model.from_file(urdf), tasks, q)  # orientation and posture stay as they are there
start = ik.pose(q, tool)[:3, 3]
for tick in range(8000):
    angle = 1.57e-3 * tick
    shift = [0.0, 0.1 * math.sin(angle), 0.1 * (math.cos(angle) - 1.0)]
    ik.set_target("position", start + shift)
    q = ik.step(q, 1e-3).q  # send step.velocity to a real robot as well
print(q.tolist())
