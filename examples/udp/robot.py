"""A robot's side of `drive --robot HOST:PORT --lockstep --compensation franka`, in Python alone: robot.py HOST:PORT

The book describes the packets. Put your simulator in place of Robot.
"""
import math, socket, struct, sys

JOINTS, ARM = 10, 7  # the arm's joints come last
INERTIA = [1.2, 1.2, 0.8, 0.8, 0.1, 0.1, 0.05]  # kg m², of each joint of the arm
HOME = [0.0, 0.0, 0.0, 0.0, -math.pi / 4, 0.0, -3 * math.pi / 4, 0.0, math.pi / 2, math.pi / 4]  # m, rad
HEAD = struct.Struct("<4sHBBQQQ")  # mark, joints, mode, answer, controller's number, robot's number, counter
NUMBERS = struct.Struct(f"<{3 * JOINTS}d{JOINTS}s")  # positions, velocities, torques; which torques are measured
PERIOD, RUNNING, TAKEN, OWN_NUMBER = 1e-3, 1, 2, 7


class Robot:
    """A base that follows velocities, and a flywheel for each joint of an arm that carries itself; feels nothing."""

    def __init__(self):
        self.position, self.velocity = list(HOME), [0.0] * JOINTS

    def move(self, position, velocity, torque):
        turned = [v + PERIOD * t / i for v, t, i in zip(self.velocity[-ARM:], torque[-ARM:], INERTIA)]
        self.velocity = list(velocity[:-ARM]) + turned
        self.position = [q + PERIOD * v for q, v in zip(self.position, self.velocity)]


def serve(link, robot):
    """Answers every packet of the controller with one measurement until it halts; returns the commands' number."""
    commands = 0
    while True:
        packet, controller = link.recvfrom(4096)
        mark, joints, _, _, number, _, counter = HEAD.unpack_from(packet)
        if joints != JOINTS or len(packet) != HEAD.size + NUMBERS.size:
            sys.exit(f"a packet of {len(packet)} bytes for {joints} joints; this robot has {JOINTS}")
        if mark == b"MOx2":
            return commands
        if mark == b"MOc2":
            *numbers, _ = NUMBERS.unpack_from(packet, HEAD.size)
            robot.move(numbers[:JOINTS], numbers[JOINTS:2 * JOINTS], numbers[2 * JOINTS:])
            commands += 1
        head = HEAD.pack(b"MOm2", JOINTS, RUNNING, TAKEN, number, OWN_NUMBER, counter)
        link.sendto(head + NUMBERS.pack(*robot.position, *robot.velocity, *[0.0] * JOINTS, bytes(JOINTS)), controller)


if __name__ == "__main__":
    host, port = sys.argv[1].rsplit(":", 1)
    link, robot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), Robot()
    link.bind((host, int(port)))
    print("a robot at {}:{}".format(*link.getsockname()), flush=True)
    print(serve(link, robot), "commands; joints at", *robot.position, flush=True)
