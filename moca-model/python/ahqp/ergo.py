"""Ergonomics of a person: REBA and RULA, predicted postures, maps of what a hand can reach.

The tables are tested against independent implementations. Postures and scores have not been validated on
people.
"""

from ._ahqp import (
    ErgonomicsMap,
    FitReport,
    Person,
    Posture,
    Quadratic,
    Reba,
    Rula,
    RulaWorksheet,
    Worksheet,
    ergonomics_score,
)
from .pictures import draw_map, draw_person

__all__ = [
    "ErgonomicsMap",
    "FitReport",
    "Person",
    "Posture",
    "Quadratic",
    "Reba",
    "Rula",
    "RulaWorksheet",
    "Worksheet",
    "draw_map",
    "draw_person",
    "ergonomics_score",
]
