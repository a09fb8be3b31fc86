"""MOCA meets a person who stands and uses a drill: the twin of moca-model's example of this name."""

from ahqp.collaboration import Body, Controller, Scene
from ahqp.ergo import ErgonomicsMap, Person

controller = Controller.moca(ErgonomicsMap(Person(1.75), spacing=0.08))
q = controller.position
# The person stands 1.7 m ahead, and faces the robot.
joints = {"left shoulder": [1.7, -0.2, 1.4], "right shoulder": [1.7, 0.2, 1.4], "mid hip": [1.7, 0.0, 0.9]}
scene = Scene(Body(joints, 0.9), action=("Using The Drill", 0.9))
for tick in range(1, 2001):
    if tick % 50 == 0:
        controller.observe(scene, now=1e-3 * tick)
    command = controller.step(q, 1e-3)
    q = q + command.velocity * 1e-3  # on a real robot, command.base_twist and command.position
x, y, z = controller.hand[:3, 3]
print(f"the tool at {x:.3f} {y:.3f} {z:.3f} m")
