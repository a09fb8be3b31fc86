//! Functions that run in a control loop do not allocate.

use ahqp_core::testing::{Sizes, hierarchy_sequences};
use ahqp_core::{
    AugmentedClik, AugmentedState, Budget, Clik, Error, Hierarchy, Level, Limits, MotionState,
    PoseAxes, Rows, Settings, Solver, Status, WarmStart, integrate_pose, pose_error,
};
use nalgebra::{DMatrix, Isometry3, Vector3, Vector6, dmatrix, dvector};
use proptest::prelude::*;

/// Counts the calls of the allocator in `work`.
fn allocations<T>(work: impl FnOnce() -> T) -> (u64, T) {
    let mut result = None;
    let calls = allocation_counter::measure(|| result = Some(work()));
    // Freeing earlier allocations counts too.
    let count = calls.count_total + calls.count_current.unsigned_abs();
    (count, result.unwrap())
}

#[test]
fn the_counter_counts() {
    let (calls, _) = allocations(|| std::hint::black_box(vec![1.0_f64; 8]));
    assert!(calls > 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn solving_does_not_allocate(
        sequence in hierarchy_sequences(Sizes::default(), 3),
        warm in any::<bool>(),
        max_iterations in prop_oneof![Just(1000_usize), 1..30_usize],
    ) {
        let warm_start = if warm { WarmStart::PreviousActiveSet } else { WarmStart::Cold };
        let settings = Settings { warm_start, max_iterations, ..Settings::default() };
        let new = Solver::new(&sequence[0], settings).unwrap();
        let clone = new.clone();
        for mut solver in [new, clone] {
            for hierarchy in &sequence {
                let (calls, solved) = allocations(|| solver.solve(hierarchy).is_ok());
                prop_assert!(solved);
                prop_assert_eq!(calls, 0);
            }
        }
    }
}

#[test]
fn refusing_a_problem_does_not_allocate() {
    let mut hierarchy = Hierarchy::new(3).unwrap();
    hierarchy.set_bounds(&dvector![-1.0, -1.0, -1.0], &dvector![1.0, 1.0, 1.0]).unwrap();
    let sum = dmatrix![1.0, 1.0, 1.0; 1.0, -1.0, 0.0];
    let rows = Rows::ranges(&sum, &dvector![9.0, 0.0], &dvector![f64::INFINITY, 0.0]).unwrap();
    let flat = Level::quadratic(&DMatrix::zeros(3, 3), &[0.0; 3]).unwrap();
    let rows = rows.with_names(["sum", "difference"]).unwrap();
    let level = hierarchy.push(flat.with_constraints(rows).named("flat")).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let fail = |solver: &mut Solver, hierarchy: &Hierarchy| {
        let (calls, result) = allocations(|| solver.solve(hierarchy).map(|_| ()));
        assert_eq!(calls, 0);
        result.unwrap_err()
    };
    assert!(matches!(fail(&mut solver, &hierarchy), Error::Infeasible { .. }));
    assert!(!solver.conflict().is_empty());

    hierarchy.constraints_mut(level).unwrap().lower_mut()[0] = f64::NEG_INFINITY;
    hierarchy.quadratic_mut(level).unwrap().1[2] = 1.0;
    hierarchy.bounds_mut().0[2] = f64::NEG_INFINITY;
    assert!(matches!(fail(&mut solver, &hierarchy), Error::Unbounded { .. }));

    hierarchy.quadratic_mut(level).unwrap().0[(0, 0)] = -1.0;
    assert!(matches!(fail(&mut solver, &hierarchy), Error::Hessian { .. }));

    hierarchy.bounds_mut().0[0] = f64::NAN;
    assert!(matches!(fail(&mut solver, &hierarchy), Error::Datum { .. }));
    assert!(matches!(fail(&mut solver, &Hierarchy::new(3).unwrap()), Error::ShapeChanged { .. }));
}

#[test]
fn a_control_tick_does_not_allocate() {
    let state = AugmentedState { joints: 7, task: 6, slack: 0 };
    let clik = AugmentedClik::new(state, PoseAxes::ALL, Vector6::repeat(40.0), 1e-3).unwrap();
    let limits = Limits::new(-2.0, 2.0, 1.0, 5.0).unwrap();
    let jacobian = DMatrix::from_fn(6, 7, |i, j| ((3 * i + 7 * j) as f64).sin());
    let mut hierarchy = Hierarchy::new(state.len()).unwrap();
    let track = hierarchy.push(Level::least_squares(clik.rows())).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let desired = Isometry3::new(Vector3::new(0.1, 0.0, 0.2), Vector3::new(0.0, 0.3, 0.0));
    let mut actual = Isometry3::identity();
    let mut motion = [MotionState { position: 0.0, velocity: 0.0 }; 7];
    let (calls, ()) = allocations(|| {
        for _ in 0..20 {
            let error = pose_error(&desired, &actual);
            clik.write(&jacobian, &error, hierarchy.rows_mut(track).unwrap()).unwrap();
            let (lower, upper) = hierarchy.bounds_mut();
            for (i, motion) in motion.iter().enumerate() {
                let interval = limits.velocity_interval(*motion, 1e-3);
                (lower[i], upper[i]) = (interval.lower, interval.upper);
            }
            let solution = solver.solve(&hierarchy).unwrap();
            assert_eq!(solution.status(), Status::Solved);
            for (motion, &velocity) in motion.iter_mut().zip(solution.optimum().unwrap()) {
                *motion = MotionState { position: motion.position + 1e-3 * velocity, velocity };
            }
            actual = integrate_pose(&actual, &error, 1e-3);
        }
    });
    assert_eq!(calls, 0);
}

#[test]
fn rewriting_rows_allocates_the_first_time_at_most() {
    let near = dmatrix![1.0, 0.0, 0.0; 1.0, 1e-3, 0.0];
    let axes = PoseAxes::new(&[0, 1]).unwrap();
    let clik = Clik::new(3, axes, Vector6::repeat(40.0), 1e-3).unwrap();
    let mut hierarchy = Hierarchy::new(3).unwrap();
    let rows = clik.rows().with_names(["x", "y"]).unwrap();
    let level = hierarchy.push(Level::least_squares(rows).named("reach")).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let mut other = Rows::equalities(&near, &[1.0, 2.0]).unwrap();
    let jacobian = DMatrix::from_fn(6, 3, |i, j| ((3 * i + 7 * j) as f64).sin());
    let budget = Budget { iterations: Some(100), time: Some(std::time::Duration::from_secs(3600)) };
    let mut tick = |weight: f64| {
        let zero = Vector6::zeros();
        let rows = hierarchy.rows_mut(level).unwrap();
        clik.write(&jacobian, &Vector6::repeat(0.1), &zero, rows).unwrap();
        other.set_weights(&[weight, 1.0]).unwrap();
        rows.copy_from(&other).unwrap();
        rows.set_bounds(&[-1.0; 2], &[1.0; 2]).unwrap();
        rows.set_row(0, &[1.0, 2.0, 3.0], 0.0, 0.0).unwrap();
        rows.copy_from(&other).unwrap();
        let solution = solver.solve_within(&hierarchy, budget).unwrap();
        solution.optimum().unwrap()[0]
    };
    tick(1.0);
    for weight in [2.0, 0.0, 1.0] {
        assert_eq!(allocations(|| tick(weight)).0, 0);
    }
}
