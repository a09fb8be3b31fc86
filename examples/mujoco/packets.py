"""The packets of docs/src/robot-packets.md, as a robot's side in lockstep sends and takes them."""

import struct

import numpy as np

JOINTS = 10
HEAD = struct.Struct("<4sHBBQQQ")
LENGTH = HEAD.size + 25 * JOINTS
RUNNING, STOPPED = 1, 2  # modes


def measurement(session, counter, position, velocity, torque, mode, took):
    """Returns the bytes of a measurement; `torque` is that of the arm, whose seven joints come last."""
    head = HEAD.pack(b"MOm2", JOINTS, mode, took, *session, counter)
    arm = len(torque)
    numbers = np.concatenate([position, velocity, np.zeros(JOINTS - arm), torque]).astype("<f8")
    return head + numbers.tobytes() + bytes(JOINTS - arm) + b"\1" * arm


def nothing(session, counter):
    """Returns the bytes that say that nothing was measured."""
    return HEAD.pack(b"MOn2", JOINTS, 0, 0, *session, counter) + bytes(25 * JOINTS)


def read(packet):
    """Returns mark, controller's number, counter, and q*, q̇*, τ of a packet to the robot."""
    if len(packet) != LENGTH:
        raise ValueError(f"a packet of {len(packet)} bytes; one of {JOINTS} joints has {LENGTH}")
    mark, joints, _, _, controller, _, counter = HEAD.unpack_from(packet)
    if joints != JOINTS:
        raise ValueError(f"a packet of {joints} joints; the robot has {JOINTS}")
    numbers = np.frombuffer(packet, "<f8", 3 * JOINTS, HEAD.size)
    return mark, controller, counter, numbers.reshape(3, JOINTS)
