//! Ticks of a control loop near a point where hard rows and bounds nearly meet and nearly depend on each other.

use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver, Status, WarmStart, solve_reference};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// Ticks of one loop.
const TICKS: usize = 40;

/// A loop whose hard rows are nearly parallel.
#[derive(Debug, Clone)]
struct Loop {
    variables: usize,
    /// Number of hard rows.
    rows: usize,
    /// Decimal exponent of the difference of directions of rows.
    apart: f64,
    /// Decimal exponent of the room that the point has in a tick.
    room: f64,
    /// Numbers from −1 to 1 that everything is made of.
    numbers: Vec<f64>,
}

fn loops() -> impl Strategy<Value = Loop> {
    (3..7_usize, 2..6_usize, -4.0..-2.0_f64, -8.0..-3.0_f64).prop_flat_map(
        |(variables, rows, apart, room)| {
            let count = 64 + TICKS;
            prop::collection::vec(-1.0..1.0_f64, count).prop_map(move |numbers| Loop {
                variables,
                rows,
                apart,
                room,
                numbers,
            })
        },
    )
}

impl Loop {
    /// A number that changes smoothly from tick to tick.
    fn number(&self, index: usize, tick: usize) -> f64 {
        let pick = |i: usize| self.numbers[i * 7919 % self.numbers.len()];
        let phase = 3.0 * pick(index + 1) + 0.02 * pick(index + 2) * tick as f64;
        0.7 * pick(index) + 0.3 * phase.sin()
    }

    /// The problem of a tick. The point that is feasible moves by about a hundredth.
    fn problem(&self, tick: usize) -> Hierarchy {
        let n = self.variables;
        let (apart, room) = (10.0_f64.powf(self.apart), 10.0_f64.powf(self.room));
        let at = |index| self.number(index, tick);
        let point = DVector::from_fn(n, |i, _| at(i));
        let mut problem = Hierarchy::new(n).unwrap();
        let (lower, upper) = problem.bounds_mut();
        for i in 0..n {
            lower[i] = point[i] - room * at(20 + i).abs() - if i % 2 == 0 { 0.0 } else { 0.5 };
            upper[i] = point[i] + room * at(30 + i).abs();
        }
        // One direction of few variables, and its neighbours.
        let matrix = DMatrix::from_fn(self.rows, n, |i, j| {
            let common = if j < 2 { at(40 + j) } else { 0.0 };
            common + apart * at(50 + 10 * i + j)
        });
        let values = &matrix * &point;
        let below = DVector::repeat(self.rows, f64::NEG_INFINITY);
        let above = DVector::from_fn(self.rows, |i, _| values[i] + room * apart * at(90 + i).abs());
        let objective = DMatrix::from_fn(3.min(n), n, |i, j| at(110 + 10 * i + j));
        let pull = DVector::from_fn(3.min(n), |i, _| 2.0 * at(150 + i));
        let hard = Rows::ranges(&matrix, &below, &above).unwrap();
        let level = Level::least_squares(Rows::equalities(&objective, &pull).unwrap());
        problem.push(level.with_constraints(hard)).unwrap();
        problem
    }
}

/// Half the square of the violation of the objective.
fn objective(problem: &Hierarchy, x: &[f64]) -> f64 {
    let level = problem.levels().first().unwrap();
    let ahqp_core::Objective::LeastSquares(rows) = level.objective() else { unreachable!() };
    let residual = |(row, target, _): (&[f64], f64, f64)| {
        row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - target
    };
    0.5 * rows.iter().map(|row| residual(row).powi(2)).sum::<f64>()
}

fn cold(problem: &Hierarchy) -> Vec<f64> {
    let settings = Settings { warm_start: WarmStart::Cold, ..Settings::default() };
    let mut solver = Solver::new(problem, settings).unwrap();
    let solution = solver.solve(problem).unwrap();
    assert_eq!(solution.status(), Status::Solved);
    solution.optimum().unwrap().to_vec()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Rows hold to 1e-10. Over their difference, that is how far the point is known.
    #[test]
    fn every_tick_near_a_vertex_is_solved(of in loops()) {
        let known = 1e-9 / 10.0_f64.powf(of.apart);
        let mut solver = Solver::new(&of.problem(0), Settings::default()).unwrap();
        for tick in 0..TICKS {
            let problem = of.problem(tick);
            let solution = solver.solve(&problem);
            prop_assert!(solution.is_ok(), "tick {}: {}", tick, solution.unwrap_err());
            let solution = solution.unwrap();
            prop_assert_eq!(solution.status(), Status::Solved);
            let x = solution.optimum().unwrap().to_vec();
            for (row, _, upper) in problem.levels()[0].constraints().iter() {
                let value: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
                prop_assert!(value <= upper + 1e-9);
            }
            let (got, least) = (objective(&problem, &x), objective(&problem, &cold(&problem)));
            prop_assert!((got - least).abs() < known, "tick {}: {:e}, not {:e}", tick, got, least);
            // Another method finds nothing better but by what it lets rows pass. The certificate knows.
            if tick % 10 == 0
                && let Ok(other) = solve_reference(&problem)
                && got >= objective(&problem, other.as_slice()) + known
            {
                let residuals = solver.certificate(&problem)?.residuals(&problem, &x)?;
                prop_assert!(residuals.worst() < 1e-8, "tick {tick}: {residuals:?}");
            }
        }
    }
}
