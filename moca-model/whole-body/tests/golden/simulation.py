#!/usr/bin/env python3
"""A Panda under random torques for a second, by Pinocchio.

    python3 -m venv venv && venv/bin/pip install pin
    venv/bin/python moca-model/whole-body/tests/golden/simulation.py

writes simulation.json beside this script. The arm of ../../urdf/moca.urdf stands on the ground, its
fingers held. Torques are those of gravity at the start and random ones that change every 20 ms. The
motion is that of Pinocchio's articulated-body algorithm, integrated by the Runge-Kutta method of fourth
order in steps of 0.1 ms; the script says how much that differs from steps of 0.05 ms. The first case
has neither friction nor rotors, the second rotors, the third both: rotors by Pinocchio's armature, friction by the model of Gaz et
al. (RA-L 2019) with the figures of their paper.
"""

import json
import pathlib

import numpy as np
import pinocchio as pin

HERE = pathlib.Path(__file__).resolve().parent
URDF = HERE.parents[2] / "urdf" / "moca.urdf"
HOLD = 0.02  # s, how long torques hold
SIZE = np.array([10.0, 15.0, 8.0, 8.0, 1.0, 1.0, 0.2])  # Nm
ROTORS = np.array([0.3, 0.3, 0.2, 0.2, 0.1, 0.1, 0.1])  # kg m2, made up
PHI = np.array([
    [0.54615, 0.87224, 0.64068, 1.2794, 0.83904, 0.30301, 0.56489],
    [5.1181, 9.0657, 10.136, 5.5903, 8.3469, 17.133, 10.336],
    [0.039533, 0.025882, -0.04607, 0.036194, 0.026226, -0.021047, 0.0035526],
])

full = pin.buildModelFromUrdf(str(URDF))
locked = [index for index, name in enumerate(full.names)
          if index and not name.startswith("panda_joint")]
model = pin.buildReducedModel(full, locked, pin.neutral(full))
model.gravity.linear = np.array([0.0, 0.0, -9.81])
data = model.createData()


def friction(v):
    sigmoid = lambda v: 1.0 / (1.0 + np.exp(-PHI[1] * (v + PHI[2])))
    return PHI[0] * (sigmoid(v) - sigmoid(0.0))


def simulate(q, torques, step, has_friction):
    """States after each time that torques hold."""
    v = np.zeros(7)
    rates = lambda q, v, tau: pin.aba(model, data, q, v, tau - has_friction * friction(v)).copy()
    states = []
    for tau in torques:
        for _ in range(round(HOLD / step)):
            a1 = rates(q, v, tau)
            a2 = rates(q + 0.5 * step * v, v + 0.5 * step * a1, tau)
            a3 = rates(q + 0.5 * step * (v + 0.5 * step * a1), v + 0.5 * step * a2, tau)
            a4 = rates(q + step * (v + 0.5 * step * a2), v + step * a3, tau)
            q = q + step * (v + step / 6.0 * (a1 + a2 + a3))
            v = v + step / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        states.append((q, v))
    return states


def main():
    source = np.random.default_rng(20261122)
    cases = []
    for rotors, real in ((False, False), (True, False), (True, True)):
        model.armature = ROTORS * rotors
        q = source.uniform(0.5 * model.lowerPositionLimit, 0.5 * model.upperPositionLimit)
        gravity = pin.computeGeneralizedGravity(model, data, q).copy()
        torques = gravity + source.uniform(-1.0, 1.0, (round(1.0 / HOLD), 7)) * SIZE
        states = simulate(q, torques, 1e-4, real)
        finer = simulate(q, torques, 5e-5, real)
        print("steps of half the size differ by", np.abs(states[-1][0] - finer[-1][0]).max(), "rad,",
              "fastest", max(np.abs(v).max() for _, v in states), "rad/s")
        cases.append({
            "rotors": (ROTORS * rotors).tolist(), "friction": real, "start": q.tolist(),
            "torques": torques.tolist(),
            "positions": [q.tolist() for q, _ in states],
            "velocity": states[-1][1].tolist(),
        })
    lines = ",\n".join(map(json.dumps, cases))
    head = f'{{"pinocchio": "{pin.__version__}", "hold_ms": {round(1e3 * HOLD)},\n"cases": [\n'
    (HERE / "simulation.json").write_text(head + lines + "\n]}\n")


if __name__ == "__main__":
    main()
