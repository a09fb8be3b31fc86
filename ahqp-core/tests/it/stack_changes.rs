//! Effect of each change of a continuous stack, on stacks of one variable.

use ahqp_core::{
    AcceleratedState, ConstraintSource, ContinuousStack, Error, Hierarchy, Level, LevelId, Limits,
    Place, Rows, Settings,
};
use nalgebra::{dmatrix, dvector};

const PERIOD: f64 = 1e-3;

fn near(target: f64) -> Level {
    Level::least_squares(Rows::equalities(&dmatrix![1.0], &dvector![target]).unwrap())
}

/// Returns a stack of one variable that is pulled to zero.
fn line() -> (ContinuousStack, LevelId) {
    let mut hierarchy = Hierarchy::new(1).unwrap();
    hierarchy.set_bounds(&dvector![-5.0], &dvector![5.0]).unwrap();
    hierarchy.push(near(0.0)).unwrap();
    let stack = ContinuousStack::new(&hierarchy, Settings::default()).unwrap();
    let level = stack.ids().next().unwrap();
    (stack, level)
}

fn ticks(stack: &mut ContinuousStack, count: usize) -> f64 {
    let mut x = stack.solution().map_or(0.0, |last| last.best()[0]);
    for _ in 0..count {
        x = stack.solve(PERIOD).unwrap().optimum().unwrap()[0];
    }
    x
}

#[test]
fn a_cancelled_change_returns_from_its_current_state() {
    let (mut stack, zero) = line();
    let one = stack.insert(near(1.0), Place::Above(zero), 0.2).unwrap();
    let half_way = ticks(&mut stack, 100);
    assert!((half_way - 0.5).abs() < 1e-9);
    stack.remove(one, 0.2).unwrap();
    assert!((ticks(&mut stack, 1) - half_way).abs() < 1e-4);
    assert_eq!(stack.ids().collect::<Vec<_>>(), [zero]);
    // A removal can be called off.
    ticks(&mut stack, 99);
    stack.activate(one, 1.0, 0.1).unwrap();
    assert_eq!(ticks(&mut stack, 100), 1.0);
    assert_eq!(stack.ids().collect::<Vec<_>>(), [one, zero]);
    // A swap can be called off.
    stack.swap(one, zero, 0.2).unwrap();
    let near_zero = ticks(&mut stack, 150);
    stack.swap(zero, one, 0.2).unwrap();
    assert!((ticks(&mut stack, 1) - near_zero).abs() < 1e-4);
    assert_eq!(ticks(&mut stack, 200), 1.0);
    assert!(!stack.is_changing() && stack.rate() == 0.0);
}

#[test]
fn a_level_stays_at_its_given_activation() {
    let (mut stack, zero) = line();
    let one = stack.insert(near(1.0), Place::Top, 0.0).unwrap();
    assert_eq!(ticks(&mut stack, 1), 1.0);
    stack.activate(one, 0.25, 0.1).unwrap();
    assert_eq!(ticks(&mut stack, 100), 0.25);
    // Later changes start from there.
    let two = stack.insert(near(2.0), Place::Below(one), 0.1).unwrap();
    assert!((ticks(&mut stack, 1) - 0.25).abs() < 1e-3);
    assert_eq!(ticks(&mut stack, 99), 0.25 * 1.0 + 0.75 * 2.0);
    stack.activate(one, 0.0, 0.0).unwrap();
    assert_eq!(ticks(&mut stack, 1), 2.0);
    assert_eq!(stack.activation(one), Ok(0.0));
    assert_eq!(stack.ids().collect::<Vec<_>>(), [one, two, zero]);
}

#[test]
fn a_removed_level_is_unknown() {
    let (mut stack, zero) = line();
    let one = stack.insert(near(1.0), Place::Bottom, 0.01).unwrap();
    stack.remove(one, 0.05).unwrap();
    assert!(stack.level_mut(one).is_ok());
    ticks(&mut stack, 49);
    assert!(stack.activation(one).is_ok_and(|activation| activation < 0.01));
    ticks(&mut stack, 2);
    let gone = Error::NoSuchLevel { level: one };
    assert_eq!(stack.level(one).unwrap_err(), gone);
    assert_eq!(stack.level_mut(one).unwrap_err(), gone);
    assert_eq!(stack.rows_mut(one).unwrap_err(), gone);
    assert_eq!(stack.constraints_mut(one).unwrap_err(), gone);
    assert_eq!(stack.quadratic_mut(one).unwrap_err(), gone);
    assert_eq!(stack.activation(one), Err(gone.clone()));
    let unknown = Err(gone);
    assert_eq!(stack.remove(one, 0.1), unknown);
    assert_eq!(stack.activate(one, 1.0, 0.1), unknown);
    assert_eq!(stack.swap(zero, one, 0.1), unknown);
    assert_eq!(stack.insert(near(1.0), Place::Above(one), 0.1).map(|_| ()), unknown);
    assert!(stack.insert(near(1.0), Place::Above(zero), 0.1).is_ok_and(|id| id != one));
}

#[test]
fn a_bad_change_changes_nothing() {
    let (mut stack, zero) = line();
    for duration in [-1.0, f64::NAN, f64::INFINITY] {
        let wrong = |result: Result<(), Error>| matches!(result, Err(Error::Value { .. }));
        assert!(wrong(stack.insert(near(1.0), Place::Top, duration).map(|_| ())));
        assert!(wrong(stack.remove(zero, duration)));
        assert!(wrong(stack.activate(zero, 0.5, duration)));
        assert!(wrong(stack.solve(duration).map(|_| ())));
    }
    for activation in [-0.1, 1.1, f64::NAN] {
        assert!(matches!(stack.activate(zero, activation, 0.1), Err(Error::Value { .. })));
    }
    let wide = Level::constraints_only(Rows::zeros(1, 2));
    assert!(matches!(stack.insert(wide, Place::Top, 0.1), Err(Error::Size { .. })));
    assert_eq!((stack.ids().collect::<Vec<_>>(), stack.solution()), (vec![zero], None));
    for _ in 0..ContinuousStack::MAX_CHANGES {
        stack.insert(near(1.0), Place::Top, 0.1).unwrap();
    }
    let is_full = |error: Error| error.to_string().starts_with("the number of changes under way");
    assert!(is_full(stack.insert(near(1.0), Place::Top, 0.1).unwrap_err()));
    assert!(is_full(stack.remove(zero, 0.1).unwrap_err()));
    ticks(&mut stack, 101);
    assert!(stack.remove(zero, 0.1).is_ok());
}

#[test]
fn a_new_constraint_is_violated_less_and_less() {
    let (mut stack, zero) = line();
    let least = Rows::ranges(&dmatrix![1.0], &dvector![2.0], &dvector![f64::INFINITY]).unwrap();
    let constraint = stack.insert(Level::constraints_only(least), Place::Above(zero), 0.1).unwrap();
    for _ in 0..100 {
        let x = ticks(&mut stack, 1);
        let left = 1.0 - stack.activation(constraint).unwrap();
        assert!(2.0 - x <= 2.0 * left + 1e-12);
    }
    assert_eq!(stack.solution().unwrap().optimum().unwrap(), [2.0]);
}

#[test]
fn rows_of_another_width_and_nan_are_refused() {
    let (mut stack, zero) = line();
    *stack.level_mut(zero).unwrap() = Level::least_squares(Rows::zeros(1, 2));
    let error = stack.solve(PERIOD).unwrap_err();
    assert!(matches!(error, Error::ShapeChanged { level, .. } if level == zero), "{error}");
    *stack.level_mut(zero).unwrap() = near(0.0);
    assert!(stack.solve(PERIOD).is_ok());
    let bounds: [fn(&mut ContinuousStack) -> &mut f64; 2] =
        [|stack| &mut stack.output_bounds_mut().0[0], |stack| &mut stack.output_bounds_mut().1[0]];
    for bound in bounds {
        let (mut stack, zero) = line();
        stack.insert(near(1.0), Place::Above(zero), 0.2).unwrap();
        *bound(&mut stack) = f64::NAN;
        assert!(matches!(stack.solve(PERIOD), Err(Error::Datum { .. })));
        *bound(&mut stack) = 0.0;
        assert!(stack.solve(PERIOD).is_ok());
    }
}

#[test]
fn the_hierarchy_without_a_solution_is_named() {
    let (mut stack, zero) = line();
    let most = Rows::ranges(&dmatrix![1.0], &dvector![f64::NEG_INFINITY], &dvector![1.0]).unwrap();
    let least = Rows::ranges(&dmatrix![1.0], &dvector![2.0], &dvector![f64::INFINITY]).unwrap();
    let most = stack.insert(Level::constraints_only(most), Place::Above(zero), 0.0).unwrap();
    let least = stack.insert(Level::constraints_only(least), Place::Below(most), 0.1).unwrap();
    assert!(stack.failed_part().is_none());
    let error = stack.solve(PERIOD).unwrap_err();
    let Error::Infeasible { level, .. } = error else { panic!("{error}") };
    assert_eq!(level, least);
    let part = stack.failed_part().unwrap();
    assert!(part.ids().eq([most, least, zero]));
    let conflict: Vec<_> = part.conflict().filter_map(ConstraintSource::level).collect();
    assert!(conflict.contains(&least) && conflict.contains(&most), "{conflict:?}");
    // The stack works again without that level.
    stack.remove(least, 0.0).unwrap();
    assert_eq!(ticks(&mut stack, 1), 0.0);
    assert!(stack.failed_part().is_none());
}

#[test]
fn output_limits_do_not_delay_an_allowed_change() {
    let limits = Limits::new(-10.0, 10.0, 2.0, 5.0).unwrap().with_jerk(200.0).unwrap();
    let (mut stack, zero) = line();
    stack.insert(near(1.0), Place::Above(zero), 0.5).unwrap();
    let mut state = AcceleratedState::at_rest(0.0);
    for tick in 1..=500 {
        let free = limits.limits().cruising_interval(state.position, PERIOD);
        let (lower, upper) = stack.bounds_mut();
        (lower[0], upper[0]) = (free.lower, free.upper);
        let allowed = limits.velocity_interval(state, PERIOD);
        let (lower, upper) = stack.output_bounds_mut();
        (lower[0], upper[0]) = (allowed.lower, allowed.upper);
        state = state.after(stack.solve(PERIOD).unwrap().optimum().unwrap()[0], PERIOD);
        assert!(limits.admits(state));
        let s = f64::from(tick) / 500.0;
        let ramp = s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
        assert!((state.velocity - ramp).abs() < 1e-9, "{tick}");
    }
}
