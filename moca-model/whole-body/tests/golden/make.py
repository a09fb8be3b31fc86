#!/usr/bin/env python3
"""Golden values of kinematics and dynamics, made with Pinocchio, and robots to have them of.

    python3 -m venv venv && venv/bin/pip install pin
    venv/bin/python moca-model/whole-body/tests/golden/make.py

writes the robots as *.urdf and their values in three random states each as *.json beside this
script. Lengths, masses and inertias of the robots are made up here. Values are in the conventions
of whole-body (reference.py), matrices row by row.
"""

import json
import pathlib

import numpy as np

from reference import Robot

HERE = pathlib.Path(__file__).resolve().parent
MOCA = HERE.parents[2] / "urdf" / "moca.urdf"
STATES = 3


class Writer:
    """A URDF, link by link; masses and inertias are those of boxes."""

    def __init__(self, name, root, mass):
        self.lines = [f'<robot name="{name}">']
        self.source = np.random.default_rng(len(name))
        self.link(root, mass)

    def link(self, name, mass, size=(0.1, 0.08, 0.2)):
        if mass == 0.0:
            self.lines.append(f'<link name="{name}"/>')
            return
        a, b, c = (edge**2 * mass / 12.0 for edge in size)
        x, y, z = np.round(self.source.uniform(-0.05, 0.05, 3), 4)
        tilt = " ".join(str(angle) for angle in np.round(self.source.uniform(-1.5, 1.5, 3), 3))
        self.lines.append(
            f'<link name="{name}"><inertial><origin xyz="{x} {y} {z}" rpy="{tilt}"/>'
            f'<mass value="{mass}"/><inertia ixx="{b + c:.6g}" iyy="{a + c:.6g}" '
            f'izz="{a + b:.6g}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        )

    def joint(self, name, parent, child, xyz, axis, kind="revolute", mass=1.0, rpy="0 0 0",
              limits=(-2.5, 2.5), mimic=""):
        self.link(child, mass)
        low, high = limits
        moving = "" if kind == "fixed" else (
            f'<axis xyz="{axis}"/><limit lower="{low}" upper="{high}" velocity="3" effort="80"/>'
        )
        self.lines.append(
            f'<joint name="{name}" type="{kind}"><origin xyz="{xyz}" rpy="{rpy}"/>'
            f'<parent link="{parent}"/><child link="{child}"/>{moving}{mimic}</joint>'
        )

    def chain(self, prefix, parent, parts, mass):
        """Joints one after the other; each part is a name, an origin and an axis."""
        for part, xyz, axis in parts:
            child = f"{prefix}{part}_link"
            self.joint(f"{prefix}{part}", parent, child, xyz, axis, mass=mass)
            parent, mass = child, round(0.8 * mass, 3)
        return parent

    def write(self):
        path = HERE / (self.lines[0].split('"')[1] + ".urdf")
        path.write_text("\n".join(self.lines + ["</robot>", ""]))
        return path


def humanoid():
    """31 joints: legs of 6, a waist of 3, arms of 7, a neck of 2."""
    robot = Writer("humanoid", "pelvis", 9.0)
    for side, y in (("left_", 0.09), ("right_", -0.09)):
        leg = [
            ("hip_yaw", f"0 {y} -0.05", "0 0 1"),
            ("hip_roll", "0 0 -0.06", "1 0 0"),
            ("hip_pitch", "0 0 -0.02", "0 1 0"),
            ("knee", "0.01 0 -0.36", "0 1 0"),
            ("ankle_pitch", "-0.01 0 -0.35", "0 1 0"),
            ("ankle_roll", "0 0 -0.02", "1 0 0"),
        ]
        foot = robot.chain(side, "pelvis", leg, 4.0)
        robot.joint(f"{side}sole_joint", foot, f"{side}sole", "0.03 0 -0.05", "", "fixed", 0.0)
    waist = [
        ("waist_yaw", "0 0 0.08", "0 0 1"),
        ("waist_roll", "0 0 0.03", "1 0 0"),
        ("waist_pitch", "0 0 0.03", "0 1 0"),
    ]
    chest = robot.chain("", "pelvis", waist, 6.0)
    for side, y in (("left_", 1), ("right_", -1)):
        arm = [
            ("shoulder_pitch", f"0 {0.17 * y} 0.28", f"0 0.94 {0.34 * y}"),
            ("shoulder_roll", f"0 {0.05 * y} 0", "1 0 0"),
            ("shoulder_yaw", "0 0 -0.1", "0 0 1"),
            ("elbow", "0.02 0 -0.15", "0 1 0"),
            ("wrist_yaw", "-0.02 0 -0.12", "0 0 1"),
            ("wrist_pitch", "0 0 -0.1", "0 1 0"),
            ("wrist_roll", "0 0 -0.02", "1 0 0"),
        ]
        hand = robot.chain(side, chest, arm, 2.0)
        robot.joint(f"{side}palm_joint", hand, f"{side}palm", "0 0 -0.08", "", "fixed", 0.3)
    robot.chain("", chest, [("neck_yaw", "0 0 0.4", "0 0 1"), ("neck_pitch", "0 0 0.05", "0 -1 0")], 1.5)
    return robot.write()


def two_arms():
    """A cart with a lift, two arms, grippers of which one finger mimics the other, two wheels."""
    robot = Writer("two_arms", "cart", 60.0)
    robot.joint("mast", "cart", "mast_link", "0.1 0 0.4", "", "fixed", 8.0)
    robot.joint("lift", "mast_link", "torso", "0 0 0.3", "0 0 1", "prismatic", 12.0,
                limits=(0.0, 0.4))
    for side, y, roll in (("left_", 1, 0.6), ("right_", -1, -0.6)):
        robot.joint(f"{side}wheel", "cart", f"{side}wheel_link", f"0 {0.25 * y} 0.1", "0 1 0",
                    "continuous", 2.0)
        robot.joint(f"{side}mount", "torso", f"{side}base", f"0.05 {0.15 * y} 0.2", "", "fixed",
                    0.5, f"{roll} 0.2 0.1")
        arm = [
            ("arm1", "0 0 0.1", "0 0 1"),
            ("arm2", "0.03 0 0.1", "0 1 0"),
            ("arm3", "0 0 0.25", "0 0 -1"),
            ("arm4", "-0.03 0 0.1", "0 1 0"),
            ("arm5", "0 0 0.22", "0.6 0 0.8"),
            ("arm6", "0 0.02 0.08", "0 1 0"),
        ]
        hand = robot.chain(side, f"{side}base", arm, 3.0)
        for finger, sign in (("finger1", 1), ("finger2", -1)):
            leads = f"{side}finger1"
            mimic = "" if sign > 0 else f'<mimic joint="{leads}" multiplier="0.9" offset="0.002"/>'
            robot.joint(f"{side}{finger}", hand, f"{side}{finger}_link", f"0 {0.01 * sign} 0.1",
                        f"0 {sign} 0", "prismatic", 0.1, limits=(0.0, 0.05), mimic=mimic)
    return robot.write()


def bush():
    """A random tree with skew axes."""
    robot = Writer("bush", "trunk", 3.0)
    links = ["trunk"]
    source = np.random.default_rng(4)
    for index in range(12):
        parent = links[max(0, len(links) - 1 - int(source.integers(0, 3)))]
        kind = ["revolute", "prismatic", "continuous", "revolute"][int(source.integers(0, 4))]
        numbers = lambda scale: " ".join(str(x) for x in np.round(source.uniform(-scale, scale, 3), 3))
        robot.joint(f"twig{index}", parent, f"leaf{index}", numbers(0.4), numbers(1.0), kind,
                    round(float(source.uniform(0.2, 3.0)), 3), numbers(2.0), (-1.0, 1.5))
        links.append(f"leaf{index}")
    return robot.write()


def plain(value):
    if isinstance(value, np.ndarray):
        return value.flatten().tolist()
    if isinstance(value, list):
        return [{key: plain(own) for key, own in one.items()} for one in value]
    return float(value)


def main():
    source = np.random.default_rng(20240607)
    for urdf, base, frames in [
        (MOCA, "fixed", ["panda_tcp", "panda_link4", "panda_rightfinger"]),
        (humanoid(), "floating", ["pelvis", "left_palm", "right_sole"]),
        (two_arms(), "planar", ["left_finger2_link", "right_arm6_link", "left_wheel_link"]),
        (bush(), "floating", ["leaf11", "leaf7"]),
    ]:
        robot = Robot(urdf, base)
        cases = []
        for _ in range(STATES):
            state = robot.random_state(source)
            values = robot.values(state, frames, robot.joints)
            cases.append({"state": state, **{key: plain(value) for key, value in values.items()}})
        head = {"base": base, "joints": robot.joints, "frames": frames}
        lines = [json.dumps(head)[1:-1]]
        text = "{" + lines[0] + ',\n"cases": [\n' + ",\n".join(map(json.dumps, cases)) + "\n]}\n"
        (HERE / f"{urdf.stem}.json").write_text(text)


if __name__ == "__main__":
    main()
