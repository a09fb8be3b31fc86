"""Map of a person by their stature: a convex quadratic of places where their hand works well, and a picture."""
import sys

from ahqp.ergo import ErgonomicsMap, Person, draw_map, draw_person

person = Person(1.68)
ergonomics_map = ErgonomicsMap(person, spacing=0.08)
quadratic, report = ergonomics_map.fit()
print(quadratic.minimiser().tolist(), report.rmse)
if len(sys.argv) > 1:
    axes = draw_map(ergonomics_map)
    draw_person(person, report.optimum, axes)
    axes.figure.savefig(sys.argv[1])
