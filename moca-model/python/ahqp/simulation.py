"""Simulated people, to try a robot beside them: they do as told, and a camera with noise sees them.

>>> from ahqp.simulation import SimulatedPerson
>>> person = SimulatedPerson(1.75, [1.7, 0.0])
>>> person.use_tool("drill")
>>> person.advance(1.0, object=[1.2, 0.0, 1.1])
>>> person.action
'Using The Drill'
"""

from ._ahqp import SimulatedPerson

__all__ = ["SimulatedPerson"]
