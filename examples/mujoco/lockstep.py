"""Runs `drive --lockstep` as the controller of the robot in MuJoCo, and keeps what truly happened."""

import json
import socket
import subprocess
from dataclasses import dataclass, field

import numpy as np

import packets
from robot import ARM, HOME, Robot

ROBOT_NUMBER = 7  # of each session
PATIENCE = 20.0  # s: for a packet of the controller
AFTER = 300  # ticks that a robot is watched after it was halted


@dataclass(frozen=True)
class Trouble:
    """Trouble from the measurement that is due in a tick on, for so many ticks, or for ever."""

    kind: str  # "silent", "frozen", or "lost" for commands
    begin: int
    ticks: int | None

    def acts(self, tick):
        return tick >= self.begin and (self.ticks is None or tick < self.begin + self.ticks)


@dataclass
class Run:
    """True state at the end of each tick, the commands in it, and the controller's report of the run."""

    position: list = field(default_factory=list)
    velocity: list = field(default_factory=list)
    error: list = field(default_factory=list)  # following error of the arm [rad]
    torque: list = field(default_factory=list)
    gravity: np.ndarray | None = None
    commands: list = field(default_factory=list)  # bytes
    report: dict = field(default_factory=dict)
    refusal: str = ""
    halted: int | None = None

    def first_fault(self, begin, end):
        """Returns the first fault that begins in these ticks: its name, and the tick."""
        for fault in self.report.get("faults", []):
            tick = round(1000 * fault["begin"])
            if begin <= tick < end:
                return fault["fault"], tick
        return None


def play(drive, model, *, recording, ergonomics, seconds, seed, start=HOME, delay=1, every=1, troubles=()):
    """Returns the run of so many seconds, with measurements every so many ticks, so many ticks late."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.bind(("127.0.0.1", 0))
        link.settimeout(PATIENCE)
        address = f"127.0.0.1:{link.getsockname()[1]}"
        command = [drive, "--robot", address, "--lockstep", "--compensation", "nothing", "--quiet", "--json"]
        command += ["--recording", recording, "--map", ergonomics, "--duration", str(seconds)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            run = answer(link, process, Robot(model, start, seed, delay), every, troubles)
            output, refusal = process.communicate(timeout=PATIENCE)
        finally:
            process.kill()
            process.wait()
    if process.returncode and not output.strip():
        run.refusal = refusal.strip()
    else:
        run.report = json.loads(output.strip().splitlines()[-1])
    return run


def answer(link, process, robot, every, troubles):
    """Plays the robot until it is halted or the controller ends."""
    run, heard, sent = Run(), 0, None
    while True:
        try:
            packet, controller = link.recvfrom(4096)
        except TimeoutError:
            if process.poll() is None:
                raise
            return run
        mark, number, counter, (position, velocity, torque) = packets.read(packet)
        tick = len(run.velocity)  # of the measurement that the controller used
        if mark == b"MOx2":
            run.halted = tick
            robot.halt()
            for _ in range(AFTER):
                robot.step()
                run.velocity.append(robot.velocity.copy())
            return run
        if mark == b"MOc2":
            if run.gravity is None:
                run.gravity = robot.data.qfrc_bias[ARM].copy()
            run.commands.append(packet)
            run.torque.append(torque[ARM].copy())
            run.error.append(np.abs(position - robot.position)[ARM].max())
            if any(trouble.kind == "lost" and trouble.acts(tick) for trouble in troubles):
                robot.miss()
            else:
                robot.obey(velocity, torque)
            robot.step()
            run.position.append(robot.position.copy())
            run.velocity.append(robot.velocity.copy())
        heard += 1
        measured = robot.measure()
        tick = len(run.velocity)  # of the measurement that goes out now
        trouble = next((each.kind for each in troubles if each.acts(tick)), None)
        session = (number, ROBOT_NUMBER)
        if heard % every or trouble == "silent":
            answered = packets.nothing(session, counter)
        else:
            if trouble != "frozen" or sent is None:
                mode = packets.STOPPED if robot.stopped else packets.RUNNING
                sent = (*measured, mode, 2 if robot.took else 1)
            answered = packets.measurement(session, counter, *sent)
        link.sendto(answered, controller)
