"""MOCA in MuJoCo: the URDF of moca-model, and nothing else of this project."""

import pathlib
from collections import deque

import mujoco
import numpy as np

URDF = pathlib.Path(__file__).resolve().parents[2] / "moca-model" / "urdf" / "moca.urdf"
PERIOD = 1e-3  # s
SUBSTEPS = 4
BASE, ARM = slice(0, 3), slice(3, 10)
HOME = np.array([0, 0, 0, 0, -np.pi / 4, 0, -3 * np.pi / 4, 0, np.pi / 2, np.pi / 4])
SPEED = np.array([1.5, 1.5, 3.0, 2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61])  # m/s, rad/s: the URDF's
EFFORT = np.array([87.0, 87, 87, 87, 12, 12, 12])  # Nm: the URDF's

# What the controller does not know: friction of the joints [Nm, Nm s/rad], and how the base follows velocities.
ROTOR = 0.1  # kg m², as in MuJoCo Menagerie's Panda
DRY = [0.5, 0.5, 0.4, 0.5, 0.3, 0.2, 0.2]
VISCOUS = [0.8, 0.8, 0.5, 0.5, 0.3, 0.2, 0.2]
LAG = [0.05, 0.05, 0.04]  # s: x, y, yaw
BASE_INERTIA = [173.0, 173.0, 10.0]  # kg, kg m²
BRAKE = 0.05  # s: time constant of a robot that stopped by itself
BRIDGED = 20  # commands lost in a row, after which it does


def compile_model():
    """Returns the model: the arm with motors, the base with velocity servos, the fingers closed, without contacts."""
    spec = mujoco.MjSpec.from_file(str(URDF))
    spec.compiler.fusestatic = False
    spec.compiler.boundmass = 1e-6
    spec.compiler.boundinertia = 1e-9
    for part in [*spec.geoms, *spec.equalities]:
        spec.delete(part)
    for name in ("panda_finger_joint1", "panda_finger_joint2"):
        spec.delete(spec.joint(name))
    for index, joint in enumerate(spec.joints):
        servo = index < 3
        joint.limited = not servo
        actuator = spec.add_actuator(name=joint.name, target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        if servo:
            actuator.set_to_velocity(kv=BASE_INERTIA[index] / LAG[index])
        else:
            actuator.set_to_motor()
    spec.option.timestep = PERIOD / SUBSTEPS
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model = spec.compile()
    model.dof_armature[ARM], model.dof_frictionloss[ARM], model.dof_damping[ARM] = ROTOR, DRY, VISCOUS
    return model


class Robot:
    """Moves by commands, and measures with noise, late; its true state is `position` and `velocity`."""

    def __init__(self, model, start, seed, delay):
        self.model, self.data = model, mujoco.MjData(model)
        self.random = np.random.default_rng(seed)
        self.data.qpos[:] = start
        mujoco.mj_forward(model, self.data)
        self.lost, self.took = 0, True
        self.base, self.change = np.zeros(3), np.zeros(3)
        # Before the first command brakes hold the arm, behind which its sensors measure gravity.
        self.held = self.data.qfrc_bias[ARM].copy()
        self.late = deque(maxlen=delay + 1)

    @property
    def position(self):
        return self.data.qpos

    @property
    def velocity(self):
        return self.data.qvel

    @property
    def stopped(self):
        return self.lost >= BRIDGED

    def obey(self, velocity, torque):
        """Takes a command; a robot that stopped by itself takes none."""
        self.took = not self.stopped
        if self.took:
            self.lost = 0
            self.change, self.base = velocity[BASE] - self.base, velocity[BASE].copy()
            self.data.ctrl[ARM] = np.clip(torque[ARM], -EFFORT, EFFORT)

    def miss(self):
        """Bridges a command that was lost, as robots of Franka do, up to 20 in a row."""
        self.took = False
        self.lost += 1
        self.base = self.base + self.change

    def halt(self):
        """Acts as if no command came any more."""
        self.lost = BRIDGED

    def brake(self):
        """Returns the torques of the arm's own stop, which slows all joints down at one rate by the robot's model."""
        slower, torque = np.zeros((2, self.model.nv))
        slower[ARM] = -self.velocity[ARM] / BRAKE
        mujoco.mj_mulM(self.model, self.data, torque, slower)
        return (self.data.qfrc_bias + torque)[ARM]

    def step(self):
        """Moves for a period."""
        self.held = None
        for _ in range(SUBSTEPS):
            if self.stopped:
                self.base *= 0.995
                self.data.ctrl[ARM] = np.clip(self.brake(), -EFFORT, EFFORT)
            self.data.ctrl[BASE] = self.base
            mujoco.mj_step(self.model, self.data)

    def measure(self):
        """Returns position, velocity and torque behind the gears of the arm, as late as its delay."""
        noise = self.random.standard_normal
        data = self.data
        if self.held is None:
            torque = (data.qfrc_actuator + data.qfrc_passive + data.qfrc_constraint)[ARM] - ROTOR * data.qacc[ARM]
        else:
            torque = self.held
        # An encoder of 19 bit; speeds have the noise of its differences, filtered.
        step = 2 * np.pi / 2**19
        position = np.round((data.qpos + 1e-5 * noise(10)) / step) * step
        self.late.append((position, data.qvel + 3e-3 * noise(10), torque + 0.1 * noise(7)))
        return self.late[0]
