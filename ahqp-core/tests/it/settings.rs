//! Settings other than the default ones.

use ahqp_core::{Hierarchy, Level, Rows, Settings, Solver, WarmStart};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// Two rows of one level, and a level below that pulls towards a target. The second row differs
/// from the first by `part` of it in an independent direction.
#[derive(Debug, Clone)]
struct NearlyParallel {
    rows: [[f64; 4]; 2],
    is_hard: bool,
    bounded: bool,
}

impl NearlyParallel {
    fn at(&self, [first, second]: [f64; 2], target: &[f64; 4]) -> Hierarchy {
        let mut hierarchy = Hierarchy::new(4).unwrap();
        if self.bounded {
            let (lower, upper) = hierarchy.bounds_mut();
            lower.fill(-1.0);
            upper.fill(1.0);
        }
        let matrix = DMatrix::from_fn(2, 4, |i, j| self.rows[i][j]);
        let rows = if self.is_hard {
            // Zero satisfies both.
            let upper = DVector::from_vec(vec![first.abs(), second.abs()]);
            let lower = DVector::from_vec(vec![-second.abs(), -first.abs()]);
            Level::constraints_only(Rows::ranges(&matrix, &lower, &upper).unwrap())
        } else {
            let targets = DVector::from_vec(vec![first, second]);
            Level::least_squares(Rows::equalities(&matrix, &targets).unwrap())
        };
        hierarchy.push(rows).unwrap();
        let target = DVector::from_row_slice(target);
        let posture = Rows::equalities(&DMatrix::identity(4, 4), &target).unwrap();
        hierarchy.push(Level::least_squares(posture)).unwrap();
        hierarchy
    }
}

fn nearly_parallel(rank_tolerance: f64) -> impl Strategy<Value = NearlyParallel> {
    let entries = prop::array::uniform4(-1.0..1.0_f64);
    let parts = prop::sample::select(vec![0.03, 0.1, 0.5, 2.0, 30.0, 1e3]);
    (entries, prop::array::uniform4(-1.0..1.0_f64), parts, any::<bool>(), any::<bool>()).prop_map(
        move |(row, other, part, is_hard, bounded)| {
            let step = part * rank_tolerance;
            let near = std::array::from_fn(|j| row[j] + step * other[j]);
            NearlyParallel { rows: [row, near], is_hard, bounded }
        },
    )
}

fn ticks() -> impl Strategy<Value = Vec<([f64; 2], [f64; 4])>> {
    let tick = (prop::array::uniform2(-1.0..1.0_f64), prop::array::uniform4(-2.0..2.0_f64));
    prop::collection::vec(tick, 4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(
        std::env::var("AHQP_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(100)
    ))]

    #[test]
    fn warm_and_cold_agree_for_every_rank_tolerance(
        (tolerance, problem) in prop::sample::select(vec![1e-4, 1e-5, 1e-6])
            .prop_flat_map(|tolerance| (Just(tolerance), nearly_parallel(tolerance))),
        ticks in ticks(),
    ) {
        let warm = Settings { rank_tolerance: tolerance, ..Settings::default() };
        let cold = Settings { warm_start: WarmStart::Cold, ..warm };
        let first = problem.at(ticks[0].0, &ticks[0].1);
        let mut solvers = [warm, cold].map(|settings| Solver::new(&first, settings).unwrap());
        for (bounds, target) in &ticks {
            let hierarchy = problem.at(*bounds, target);
            let [warm, cold] = solvers.each_mut().map(|solver| {
                solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec()
            });
            for (a, b) in warm.iter().zip(&cold) {
                prop_assert!((a - b).abs() <= 1e-7 * (1.0 + b.abs()), "{warm:?} {cold:?}");
            }
        }
    }
}
