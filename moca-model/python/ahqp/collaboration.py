"""Ergonomic collaboration with a person: what a camera sees goes in, commands of the robot come out.

>>> from ahqp.collaboration import Controller
>>> from ahqp.ergo import ErgonomicsMap, Person
>>> controller = Controller.moca(ErgonomicsMap(Person(1.75), spacing=0.1))
>>> command = controller.step(controller.position, 0.001)
>>> command.velocity.shape, command.phase
((10,), 'apart')

This is not safety-rated software.
"""

from ._ahqp import MOCA_URDF, Body, Command, Controller, FrameError, GraspedObject, Recording, Scene

__all__ = [
    "Body",
    "Command",
    "Controller",
    "FrameError",
    "GraspedObject",
    "MOCA_URDF",
    "Recording",
    "Scene",
]
