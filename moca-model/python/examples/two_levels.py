"""First x + y = 2, then x as near to 5 as its bounds and the first level allow."""
import ahqp

hierarchy = ahqp.Hierarchy(2)
hierarchy.set_bounds([-1.0, -1.0], [1.5, 9.0])
hierarchy.push([[1.0, 1.0]], [2.0], [2.0], name="sum")
near = hierarchy.push([[1.0, 0.0]], [5.0], [5.0], name="near")
solver = ahqp.Solver(hierarchy)
print(solver.solve(hierarchy).x.tolist())
hierarchy.update(near, lower=[-5.0], upper=[-5.0])  # the next tick: other data, the same solver
solution = solver.solve(hierarchy)
print(solution.x.tolist(), solution.violations.tolist())
