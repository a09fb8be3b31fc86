#!/usr/bin/env python3
"""Golden values for MOCA's kinematics and gravity, made with Pinocchio.

    python3 -m venv venv && venv/bin/pip install pin
    venv/bin/python moca-model/tests/golden/make_golden.py

writes moca.json beside this script. Each case is a configuration q (base x, y,
yaw, seven arm joints), the pose of panda_tcp in the world (position, rotation by
rows), its Jacobian (linear then angular, world-aligned axes, by rows) and the
gravity torques, fingers closed, 9.81 m/s2 downwards.
"""

import json
import math
import pathlib
import random

import numpy
import pinocchio

HERE = pathlib.Path(__file__).resolve().parent
URDF = HERE.parents[1] / "urdf" / "moca.urdf"
CASES = 50

full = pinocchio.buildModelFromUrdf(str(URDF))
fingers = [full.getJointId(f"panda_finger_joint{i}") for i in (1, 2)]
model = pinocchio.buildReducedModel(full, fingers, pinocchio.neutral(full))
model.gravity.linear = numpy.array([0.0, 0.0, -9.81])
data = model.createData()
tool = model.getFrameId("panda_tcp")

LOWER = model.lowerPositionLimit[-7:]
UPPER = model.upperPositionLimit[-7:]
HOME = [0, 0, 0, 0, -math.pi / 4, 0, -3 * math.pi / 4, 0, math.pi / 2, math.pi / 4]


def case(q):
    # Pinocchio writes a continuous joint as cosine and sine.
    configuration = numpy.array([q[0], q[1], math.cos(q[2]), math.sin(q[2]), *q[3:]])
    pinocchio.framesForwardKinematics(model, data, configuration)
    pose = data.oMf[tool]
    jacobian = pinocchio.computeFrameJacobian(
        model, data, configuration, tool, pinocchio.LOCAL_WORLD_ALIGNED
    )
    gravity = pinocchio.computeGeneralizedGravity(model, data, configuration)
    return {
        "q": list(q),
        "position": pose.translation.tolist(),
        "rotation": pose.rotation.flatten().tolist(),
        "jacobian": jacobian.flatten().tolist(),
        "gravity": gravity.tolist(),
    }


def random_configuration(source):
    base = [source.uniform(-5, 5), source.uniform(-5, 5), source.uniform(-10, 10)]
    return base + [source.uniform(low, high) for low, high in zip(LOWER, UPPER)]


source = random.Random(20240607)
cases = [case(HOME)] + [case(random_configuration(source)) for _ in range(CASES - 1)]
lines = ",\n".join(json.dumps(one) for one in cases)
(HERE / "moca.json").write_text(
    '{"pinocchio": "%s",\n"cases": [\n%s\n]}\n' % (pinocchio.__version__, lines)
)
