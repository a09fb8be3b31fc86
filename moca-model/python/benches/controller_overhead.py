"""Time of a controller step from Python beyond the step in Rust: MOCA beside somebody who works.

    python benches/controller_overhead.py [steps]
"""

import statistics
import sys
import time

from ahqp.collaboration import Body, Controller, GraspedObject, Scene
from ahqp.ergo import Person


def overhead(steps):
    """Medians over the steps [µs]: what they took within Rust, and what calls took beyond that, with the velocities."""
    person = Person(1.75)
    controller = Controller.moca(person)
    controller.grasp(GraspedObject())
    scene = Scene(Body.standing(person, [1.7, 0.0], 3.14159), action="Using The Drill")
    q, inside, beyond = controller.position, [], []
    for tick in range(steps):
        if tick % 50 == 0:
            controller.observe(scene)
        start = time.perf_counter_ns()
        command = controller.step(q, 1e-3)
        velocity = command.velocity
        whole = time.perf_counter_ns() - start
        inside.append(1e6 * command.duration)
        beyond.append(1e-3 * whole - 1e6 * command.duration)
        q = q + velocity * 1e-3
    return statistics.median(inside), statistics.median(beyond)


if __name__ == "__main__":
    inside, beyond = overhead(int(sys.argv[1]) if len(sys.argv) > 1 else 3000)
    print(f"step {inside:.2f} µs, beyond it {beyond:.2f} µs")
