"""Writes the URDFs of the examples, tests and benchmarks: python3 make.py

panda.urdf     Franka Emika Panda with its hand: kinematics and limits from the maker's
               documentation, inertias from Gaz et al., RA-L 4(4), 2019.
two_arms.urdf  A torso on a lift with two arms of seven joints and a head, in the sizes of service
               robots on wheels. Made up.
humanoid.urdf  A humanoid of 31 joints and 1.6 m. Made up.
"""

from pathlib import Path

HERE = Path(__file__).parent
PI_2 = 1.5707963267948966


def inertial(mass, centre, moments):
    ixx, iyy, izz, ixy, ixz, iyz = moments
    x, y, z = centre
    return (
        f'<inertial><origin xyz="{x} {y} {z}"/><mass value="{mass}"/><inertia ixx="{ixx}" '
        f'iyy="{iyy}" izz="{izz}" ixy="{ixy}" ixz="{ixz}" iyz="{iyz}"/></inertial>'
    )


def box(mass, edges, centre=(0, 0, 0)):
    a, b, c = (edge * edge * mass / 12 for edge in edges)
    return inertial(mass, centre, (round(b + c, 6), round(a + c, 6), round(a + b, 6), 0, 0, 0))


class Robot:
    def __init__(self, name):
        self.lines = [f'<robot name="{name}">']

    def link(self, name, body=""):
        self.lines.append(f'  <link name="{name}">{body}</link>' if body else f'  <link name="{name}"/>')

    def joint(self, name, kind, parent, child, xyz, rpy=(0, 0, 0), axis="z", limit=None):
        axes = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}
        xyz, rpy = (" ".join(str(number) for number in numbers) for numbers in (xyz, rpy))
        text = f'  <joint name="{name}" type="{kind}"><origin xyz="{xyz}" rpy="{rpy}"/>'
        text += f'<parent link="{parent}"/><child link="{child}"/>'
        if kind != "fixed":
            text += f'<axis xyz="{axes[axis]}"/>'
            lower, upper, velocity, acceleration, jerk, effort = limit
            text += f'\n    <limit lower="{lower}" upper="{upper}" velocity="{velocity}" effort="{effort}" '
            text += f'acceleration="{acceleration}" jerk="{jerk}"/>'
        self.lines.append(text + "</joint>")

    def write(self, path):
        path.write_text("\n".join([*self.lines, "</robot>", ""]))


def panda():
    robot = Robot("panda")
    bodies = [
        (0.629769, (-0.041018, -0.00014, 0.049974), (0.00315, 0.00388, 0.004285, 8.2904e-7, 0.00015, 8.2299e-6)),
        (4.970684, (0.003875, 0.002081, -0.04762), (0.70337, 0.70661, 0.009117, -0.000139, 0.006772, 0.019169)),
        (0.646926, (-0.003141, -0.02872, 0.003495), (0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704)),
        (3.228604, (0.027518, 0.039252, -0.066502), (0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805)),
        (3.587895, (-0.05317, 0.104419, 0.027454), (0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641)),
        (1.225946, (-0.011953, 0.041065, -0.038437), (0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229)),
        (1.666555, (0.060149, -0.014117, -0.010517), (0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341)),
        (0.735522, (0.010517, -0.004252, 0.061597), (0.012516, 0.010027, 0.004815, -0.000428, -0.001196, -0.000741)),
    ]
    origins = [
        ((0, 0, 0.333), 0), ((0, 0, 0), -PI_2), ((0, -0.316, 0), PI_2), ((0.0825, 0, 0), PI_2),
        ((-0.0825, 0.384, 0), -PI_2), ((0, 0, 0), PI_2), ((0.088, 0, 0), PI_2),
    ]
    limits = [
        (-2.8973, 2.8973, 2.175, 15, 7500, 87), (-1.7628, 1.7628, 2.175, 7.5, 3750, 87),
        (-2.8973, 2.8973, 2.175, 10, 5000, 87), (-3.0718, -0.0698, 2.175, 12.5, 6250, 87),
        (-2.8973, 2.8973, 2.61, 15, 7500, 12), (-0.0175, 3.7525, 2.61, 20, 10000, 12),
        (-2.8973, 2.8973, 2.61, 20, 10000, 12),
    ]
    for index, body in enumerate(bodies):
        robot.link(f"panda_link{index}", inertial(*body))
    for index, ((xyz, roll), limit) in enumerate(zip(origins, limits), 1):
        parent, child = f"panda_link{index - 1}", f"panda_link{index}"
        robot.joint(f"panda_joint{index}", "revolute", parent, child, xyz, (roll, 0, 0), "z", limit)
    robot.link("panda_hand", inertial(0.73, (-0.01, 0, 0.03), (0.001, 0.0025, 0.0017, 0, 0, 0)))
    robot.joint("panda_hand_joint", "fixed", "panda_link7", "panda_hand", (0, 0, 0.107), (0, 0, -PI_2 / 2))
    robot.link("panda_hand_tcp")
    robot.joint("panda_tcp_joint", "fixed", "panda_hand", "panda_hand_tcp", (0, 0, 0.1034))
    return robot


def arm(robot, side, sign, shoulder, xyz, lengths, mass):
    """Seven joints: shoulder yaw, pitch, roll, elbow, forearm roll, wrist pitch and yaw."""
    upper, fore, hand = lengths
    parts = [
        ("shoulder_yaw", "z", xyz, (-1.5, 1.5)), ("shoulder_pitch", "y", (0, 0.05 * sign, 0), (-2.5, 2.5)),
        ("shoulder_roll", "x", (0, 0.05 * sign, 0), (-1.8, 1.8)), ("elbow", "y", (0, 0, -upper), (-2.4, -0.02)),
        ("forearm", "z", (0, 0, -0.4 * fore), (-2.0, 2.0)), ("wrist_pitch", "y", (0, 0, -0.6 * fore), (-1.4, 1.4)),
        ("wrist_yaw", "x", (0, 0, 0), (-1.4, 1.4)),
    ]
    parent = shoulder
    for name, axis, origin, (lower, upper_limit) in parts:
        child = f"{side}_{name}_link"
        length = upper if name == "shoulder_roll" else 0.4 * fore if name == "elbow" else 0.6 * fore
        robot.link(child, box(mass, (0.08, 0.08, max(length, 0.1)), (0, 0, -0.4 * length)))
        robot.joint(f"{side}_{name}", "revolute", parent, child, origin, (0, 0, 0), axis,
                    (lower, upper_limit, 2.5, 10, 2000, 60))
        parent = child
    robot.link(f"{side}_hand", box(0.6, (0.05, 0.08, 0.1), (0, 0, 0)))
    robot.joint(f"{side}_hand_joint", "fixed", parent, f"{side}_hand", (0, 0, -hand))


def two_arms():
    robot = Robot("two_arms")
    robot.link("base", box(40, (0.5, 0.5, 0.3), (0, 0, 0.15)))
    robot.link("torso", box(15, (0.25, 0.3, 0.6), (0, 0, -0.1)))
    robot.joint("lift", "prismatic", "base", "torso", (-0.06, 0, 0.8), (0, 0, 0), "z", (0, 0.35, 0.07, 0.3, 50, 2000))
    for side, sign in (("left", 1), ("right", -1)):
        arm(robot, side, sign, "torso", (0.1, 0.18 * sign, 0.1), (0.31, 0.31, 0.15), 1.8)
    robot.link("neck", box(0.5, (0.1, 0.1, 0.1)))
    robot.link("head", box(1.5, (0.2, 0.2, 0.2), (0.05, 0, 0.1)))
    robot.joint("neck_yaw", "revolute", "torso", "neck", (0.1, 0, 0.25), (0, 0, 0), "z", (-1.2, 1.2, 2, 10, 2000, 6))
    robot.joint("neck_pitch", "revolute", "neck", "head", (0, 0, 0.05), (0, 0, 0), "y", (-0.9, 0.7, 2, 10, 2000, 6))
    return robot


def humanoid():
    robot = Robot("humanoid")
    robot.link("pelvis", box(10, (0.2, 0.3, 0.2)))
    parent = "pelvis"
    for name, axis, z in (("waist_yaw", "z", 0.1), ("waist_roll", "x", 0.05), ("waist_pitch", "y", 0.05)):
        child = "chest" if name == "waist_pitch" else f"{name}_link"
        robot.link(child, box(12 if child == "chest" else 1, (0.2, 0.3, 0.4), (0, 0, 0.2 if child == "chest" else 0)))
        robot.joint(name, "revolute", parent, child, (0, 0, z), (0, 0, 0), axis, (-0.8, 0.8, 3, 20, 4000, 150))
        parent = child
    for side, sign in (("left", 1), ("right", -1)):
        arm(robot, side, sign, "chest", (0, 0.2 * sign, 0.35), (0.28, 0.26, 0.1), 1.2)
        parent = "pelvis"
        parts = [
            ("hip_yaw", "z", (0, 0.1 * sign, -0.08), (-0.8, 0.8)), ("hip_roll", "x", (0, 0, -0.02), (-0.6, 0.6)),
            ("hip_pitch", "y", (0, 0, 0), (-1.8, 0.6)), ("knee", "y", (0, 0, -0.36), (0.02, 2.3)),
            ("ankle_pitch", "y", (0, 0, -0.36), (-1.0, 0.8)), ("ankle_roll", "x", (0, 0, 0), (-0.6, 0.6)),
        ]
        for name, axis, origin, (lower, upper) in parts:
            child = f"{side}_{name}_link"
            long = name in ("hip_pitch", "knee")
            robot.link(child, box(4 if long else 1, (0.1, 0.1, 0.36 if long else 0.1), (0, 0, -0.18 if long else 0)))
            robot.joint(f"{side}_{name}", "revolute", parent, child, origin, (0, 0, 0), axis,
                        (lower, upper, 6, 40, 8000, 200))
            parent = child
        robot.link(f"{side}_foot", box(1, (0.22, 0.1, 0.04)))
        robot.joint(f"{side}_foot_joint", "fixed", parent, f"{side}_foot", (0.02, 0, -0.06))
    robot.link("neck", box(0.5, (0.1, 0.1, 0.1)))
    robot.link("head", box(3, (0.2, 0.2, 0.25), (0, 0, 0.1)))
    robot.joint("neck_yaw", "revolute", "chest", "neck", (0, 0, 0.45), (0, 0, 0), "z", (-1.2, 1.2, 4, 20, 4000, 10))
    robot.joint("neck_pitch", "revolute", "neck", "head", (0, 0, 0.05), (0, 0, 0), "y", (-0.8, 0.8, 4, 20, 4000, 10))
    return robot


for robot in (panda(), two_arms(), humanoid()):
    name = robot.lines[0].split('"')[1]
    robot.write(HERE / f"{name}.urdf")
