"""Strict priorities: hierarchical quadratic programs, their proofs, and limits of joints.

`ahqp.whole_body` has robots and their inverse kinematics, `ahqp.ergo` the ergonomics of people. SI units
and radians throughout. Arrays may be anything that numpy takes for an array of real numbers; arrays of
doubles are read in place, whatever their strides.

>>> import ahqp
>>> ahqp.solve([[1.0, 1.0], [1.0, 0.0]], [2.0, 5.0], [2.0, 5.0], [1, 2]).x.round(12).tolist()
[5.0, -3.0]
"""

from ._ahqp import (
    Certificate,
    Error,
    Hierarchy,
    InfeasibleError,
    Limits,
    Residuals,
    Row,
    Solution,
    Solver,
    UnfinishedError,
    solve,
)

__all__ = [
    "Certificate",
    "Error",
    "Hierarchy",
    "InfeasibleError",
    "Limits",
    "Residuals",
    "Row",
    "Solution",
    "Solver",
    "UnfinishedError",
    "solve",
]
