//! Every error is provoked. Its message names the place and the remedy.

use ahqp_core::{
    AugmentedClik, AugmentedState, Error, Hierarchy, Level, Limits, PoseAxes, Rows, Settings,
    Solution, Solver,
};
use nalgebra::{DMatrix, Vector6, dmatrix, dvector};

use crate::support::{expect_words, id};

/// Returns the solution. The check of the data alone must refuse the same data as the solve.
fn solve(hierarchy: &Hierarchy) -> Result<Solution, Error> {
    let result = Solver::new(hierarchy, Settings::default())?.solve(hierarchy).cloned();
    let of_data = result.as_ref().err().filter(|error| {
        matches!(error, Error::Datum { .. } | Error::EmptyRange { .. } | Error::Hessian { .. })
    });
    let checked = Solver::validate(hierarchy).err();
    assert_eq!(checked.map(|error| error.to_string()), of_data.map(ToString::to_string));
    result
}

type Setter = fn(&mut Settings, f64);

/// Returns a valid hierarchy of `x + y = 1` and a range over two variables, for tests to make
/// invalid.
fn sound() -> Hierarchy {
    let mut hierarchy = Hierarchy::new(2).unwrap();
    hierarchy.push(Level::least_squares(equality())).unwrap();
    hierarchy.push(Level::constraints_only(range())).unwrap();
    hierarchy
}

fn equality() -> Rows {
    Rows::equalities(&dmatrix![1.0, 1.0], &dvector![1.0]).unwrap()
}

fn range() -> Rows {
    Rows::ranges(&dmatrix![1.0, -1.0], &dvector![-1.0], &dvector![1.0]).unwrap()
}

const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

#[test]
fn no_variables() {
    let error = Hierarchy::new(0).unwrap_err();
    assert!(matches!(error, Error::Value { .. }), "{error}");
    expect_words(&error, &["no variables", "at least 1"]);
}

#[test]
fn sizes_that_do_not_fit_are_named() {
    let rows = |n| Rows::zeros(1, n);
    let square = |n| DMatrix::identity(n, n);
    let hierarchy = || Hierarchy::new(2).unwrap();
    let cases = [
        (Rows::equalities(&dmatrix![1.0, 1.0], &dvector![1.0, 2.0]).unwrap_err(), "targets"),
        (Rows::ranges(&dmatrix![1.0], &[0.0], &[]).unwrap_err(), "upper bound"),
        (Rows::at_most(&dmatrix![1.0, 1.0], &[1.0, 2.0]).unwrap_err(), "upper bound"),
        (Rows::at_least(&dmatrix![1.0, 1.0], &[]).unwrap_err(), "lower bound"),
        (Rows::from_row_slice(2, 2, &[1.0; 3], &[0.0; 2], &[0.0; 2]).unwrap_err(), "coefficients"),
        (Rows::from_row_slice(2, 2, &[1.0; 4], &[0.0; 3], &[0.0; 2]).unwrap_err(), "lower bound"),
        (rows(3).set_targets(&[]).unwrap_err(), "targets"),
        (rows(3).set_weights(&[1.0, 2.0]).unwrap_err(), "weights"),
        (rows(3).set_row(0, &[1.0], 0.0, 0.0).unwrap_err(), "row"),
        (rows(3).copy_from(&rows(2)).unwrap_err(), "row to copy"),
        (rows(3).copy_from(&Rows::zeros(2, 3)).unwrap_err(), "block to copy"),
        (rows(3).with_names(["a", "b"]).unwrap_err(), "names of the rows"),
        (hierarchy().name_variables(["a"]).unwrap_err(), "names of the variables"),
        (Level::least_squares(rows(3)).violation(&[0.0]).unwrap_err(), "x"),
        (Rows::zeros(2, 3).set_matrix(&dmatrix![1.0, 1.0, 1.0]).unwrap_err(), "rows of A"),
        (Rows::zeros(1, 3).set_matrix(&dmatrix![1.0, 1.0]).unwrap_err(), "columns of A"),
        (rows(3).set_bounds(&dvector![], &dvector![1.0]).unwrap_err(), "lower bound"),
        (rows(3).set_bounds(&dvector![1.0], &dvector![]).unwrap_err(), "upper bound"),
        (Level::quadratic(&DMatrix::zeros(2, 3), &[1.0, 2.0]).unwrap_err(), "Hessian"),
        (Level::quadratic(&square(2), &[1.0]).unwrap_err(), "gradient"),
        (hierarchy().push(Level::least_squares(rows(3))).unwrap_err(), "objective"),
        (hierarchy().push(Level::constraints_only(rows(1))).unwrap_err(), "constraints"),
        (
            hierarchy().push(Level::quadratic(&square(3), &[0.0; 3]).unwrap()).unwrap_err(),
            "gradient",
        ),
        (hierarchy().set_bounds(&dvector![0.0], &dvector![1.0, 1.0]).unwrap_err(), "lower bound"),
        (hierarchy().set_bounds(&dvector![0.0, 0.0], &dvector![1.0]).unwrap_err(), "upper bound"),
        (
            AugmentedClik::new(
                AugmentedState { joints: 7, task: 3, slack: 0 },
                PoseAxes::ALL,
                Vector6::repeat(1.0),
                1e-3,
            )
            .unwrap_err(),
            "task",
        ),
    ];
    for (error, word) in cases {
        let Error::Size { got, wanted, .. } = error else { panic!("{error}") };
        assert_ne!(got, wanted);
        expect_words(&error, &[word, &got.to_string(), &wanted.to_string()]);
    }
}

#[test]
fn a_matrix_that_is_not_finite() {
    for value in NOT_FINITE {
        for (level, constraint) in [(0, false), (1, true)] {
            let mut hierarchy = sound();
            let level_data = hierarchy.level_mut(id(&hierarchy, level)).unwrap();
            let rows = if constraint {
                level_data.constraints_mut()
            } else {
                level_data.rows_mut().unwrap()
            };
            rows.row_mut(0).unwrap()[1] = value;
            let error = solve(&hierarchy).unwrap_err();
            assert!(matches!(error, Error::Datum { entry: Some(1), .. }), "{error}");
            expect_words(&error, &["matrix", "row 0", &format!("level {level}"), "entry 1"]);
        }
    }
}

#[test]
fn numbers_whose_squares_overflow() {
    for value in [1e101, -1e300, f64::MAX] {
        let mut coefficient = sound();
        let rows = coefficient.rows_mut(id(&coefficient, 0)).unwrap();
        rows.row_mut(0).unwrap()[1] = value;
        let mut target = sound();
        let rows = target.rows_mut(id(&target, 0)).unwrap();
        (rows.lower_mut()[0], rows.upper_mut()[0]) = (value, value);
        // A distant bound does not limit anything. A bound that excludes zero does.
        let mut bound = sound();
        let bounds = bound.bounds_mut();
        (bounds.0[1], bounds.1[1]) =
            if value > 0.0 { (value, f64::INFINITY) } else { (f64::NEG_INFINITY, value) };
        let gradient = quadratic(&DMatrix::identity(2, 2), &[0.0, value]);
        let hessian = quadratic(&dmatrix![1.0, 0.0; 0.0, value.abs()], &[0.0; 2]);
        for hierarchy in [coefficient, target, bound, gradient, hessian] {
            let error = solve(&hierarchy).unwrap_err();
            assert!(matches!(error, Error::Datum { entry: None, .. }), "{error}");
            expect_words(&error, &["1e100", "units"]);
        }
    }
}

#[test]
fn a_hard_row_demands_an_overflowing_solution() {
    for coefficient in [1e-120, -3.4e-161, 1e-200, 1e-300] {
        for (lower, upper) in [(1e-3, 1e-3), (1e-3, f64::INFINITY), (f64::NEG_INFINITY, -1e-3)] {
            let mut hierarchy = Hierarchy::new(1).unwrap();
            hierarchy.set_bounds(&[-1.0], &[-1.0]).unwrap();
            let row = Rows::from_row_slice(1, 1, &[coefficient], &[lower], &[upper]).unwrap();
            hierarchy.push(Level::constraints_only(row)).unwrap();
            let error = solve(&hierarchy).unwrap_err();
            assert!(
                matches!(error, Error::Datum { entry: None, .. } | Error::Infeasible { .. }),
                "{error}"
            );
        }
    }
}

#[test]
fn distant_bounds_do_not_loosen_the_near_one() {
    for far in [1e9, 1e30, f64::MAX] {
        let mut hierarchy = Hierarchy::new(1).unwrap();
        hierarchy.set_bounds(&dvector![1.5], &dvector![far]).unwrap();
        let row = Rows::ranges(&dmatrix![-0.0625], &dvector![0.0], &dvector![1.0]).unwrap();
        hierarchy.push(Level::least_squares(row.clone())).unwrap();
        assert_eq!(solve(&hierarchy).unwrap().optimum().unwrap(), [1.5]);
        let mut hard = Hierarchy::new(1).unwrap();
        hard.set_bounds(&dvector![1.5], &dvector![far]).unwrap();
        hard.push(Level::constraints_only(row)).unwrap();
        assert!(matches!(solve(&hard), Err(Error::Infeasible { .. })));
    }
}

#[test]
fn a_solution_that_overflows() {
    let mut hierarchy = Hierarchy::new(1).unwrap();
    let tiny = Level::quadratic(&dmatrix![f64::MIN_POSITIVE], &[1e50]).unwrap();
    hierarchy.push(tiny).unwrap();
    let error = solve(&hierarchy).unwrap_err();
    assert_eq!(error, Error::Overflow);
    expect_words(&error, &["overflows", "comparable sizes"]);
}

#[test]
fn a_certificate_of_nothing() {
    let hierarchy = sound();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let error = solver.certificate(&hierarchy).unwrap_err();
    assert_eq!(error, Error::NotSolved);
    expect_words(&error, &["solve"]);
    let mut broken = hierarchy.clone();
    broken.bounds_mut().0[0] = f64::NAN;
    assert!(solver.solve(&broken).is_err());
    assert_eq!(solver.certificate(&hierarchy).unwrap_err(), Error::NotSolved);
}

#[test]
fn bounds_that_are_not_numbers_or_leave_nothing() {
    let wrong = [
        (f64::NAN, 1.0),
        (-1.0, f64::NAN),
        (2.0, 1.0),
        (f64::INFINITY, f64::INFINITY),
        (f64::NEG_INFINITY, f64::NEG_INFINITY),
    ];
    for (lower, upper) in wrong {
        let mut hierarchy = sound();
        let bounds = hierarchy.bounds_mut();
        (bounds.0[1], bounds.1[1]) = (lower, upper);
        let error = solve(&hierarchy).unwrap_err();
        expect_bounds(&error, "bounds of variable 1", lower, upper);

        for (level, place) in
            [(0, "objective row 0 of level 0"), (1, "constraint row 0 of level 1")]
        {
            let mut hierarchy = sound();
            let data = hierarchy.level_mut(id(&hierarchy, level)).unwrap();
            let rows = match level {
                0 => data.rows_mut().unwrap(),
                _ => data.constraints_mut(),
            };
            (rows.lower_mut()[0], rows.upper_mut()[0]) = (lower, upper);
            let error = solve(&hierarchy).unwrap_err();
            expect_bounds(&error, place, lower, upper);
        }
    }
}

/// Expects that NaN and bounds in the wrong order are reported as such.
fn expect_bounds(error: &Error, place: &str, lower: f64, upper: f64) {
    if lower.is_nan() || upper.is_nan() {
        assert!(matches!(error, Error::Datum { entry: None, .. }), "{error}");
        expect_words(error, &[place, "is NaN", "give a number"]);
    } else {
        assert!(matches!(error, Error::EmptyRange { .. }), "{error}");
        expect_words(error, &[place, "lower", "upper", "order them"]);
    }
}

fn quadratic(hessian: &DMatrix<f64>, gradient: &[f64]) -> Hierarchy {
    let mut hierarchy = sound();
    hierarchy.push(Level::quadratic(hessian, gradient).unwrap()).unwrap();
    hierarchy
}

#[test]
fn a_quadratic_that_is_not_finite() {
    for value in NOT_FINITE {
        let error = solve(&quadratic(&dmatrix![1.0, 0.0; 0.0, value], &[0.0, 0.0])).unwrap_err();
        assert!(matches!(error, Error::Datum { entry: Some(1), .. }), "{error}");
        expect_words(&error, &["Hessian", "level 2"]);
        let error = solve(&quadratic(&DMatrix::identity(2, 2), &[0.0, value])).unwrap_err();
        assert!(matches!(error, Error::Datum { entry: Some(1), .. }), "{error}");
        expect_words(&error, &["gradient", "level 2"]);
    }
}

#[test]
fn an_asymmetric_hessian() {
    let error = solve(&quadratic(&dmatrix![1.0, 0.5; 0.25, 1.0], &[0.0, 0.0])).unwrap_err();
    let Error::Hessian { level, row: 1, column: 0, got, .. } = error else { panic!("{error}") };
    assert_eq!((level.index(), got), (2, 0.25));
    expect_words(&error, &["level 2", "(1, 0)", "(H + Hᵀ)/2"]);
}

#[test]
fn an_indefinite_hessian() {
    for hessian in [
        dmatrix![1.0, 0.0; 0.0, -1.0],
        dmatrix![0.0, 1.0; 1.0, 0.0],
        dmatrix![-1.0, 0.0; 0.0, -1.0],
        dmatrix![1.0, 2.0; 2.0, 1.0],
    ] {
        let error = solve(&quadratic(&hessian, &[0.0, 0.0])).unwrap_err();
        assert!(matches!(error, Error::Hessian { level, .. } if level.index() == 2), "{error}");
        expect_words(&error, &["level 2", "semidefinite", "project"]);
    }
}

#[test]
fn rounding_spoils_no_positive_semidefinite_hessian() {
    let third = 1.0 / 3.0;
    let hessian = dmatrix![third * third, third * 0.1; third * 0.1 + 1e-17, 0.01];
    assert!(solve(&quadratic(&hessian, &[0.0, 0.0])).is_ok());
}

#[test]
fn a_quadratic_without_a_minimum() {
    let mut hierarchy = Hierarchy::new(2).unwrap();
    let falling = Level::quadratic(&dmatrix![1.0, 0.0; 0.0, 0.0], &[0.0, 1.0]).unwrap();
    hierarchy.push(falling).unwrap();
    let error = solve(&hierarchy).unwrap_err();
    assert!(matches!(error, Error::Unbounded { .. }), "{error}");
    expect_words(&error, &["level 0", "add constraints"]);
    // A bound limits it, and so does a level above.
    hierarchy.bounds_mut().0[1] = -3.0;
    assert!((solve(&hierarchy).unwrap().optimum().unwrap()[1] + 3.0).abs() < 1e-12);
}

#[test]
fn a_hierarchy_of_another_shape() {
    let hierarchy = sound();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    solver.solve(&hierarchy).unwrap();
    let mut longer = hierarchy.clone();
    longer.push(Level::least_squares(equality())).unwrap();
    let mut other_rows = Hierarchy::new(2).unwrap();
    other_rows.push(Level::least_squares(Rows::zeros(2, 2))).unwrap();
    other_rows.push(Level::constraints_only(range())).unwrap();
    let mut other_kind = Hierarchy::new(2).unwrap();
    other_kind.push(Level::least_squares(equality())).unwrap();
    let quadratic = Level::quadratic(&DMatrix::identity(2, 2), &[0.0; 2]).unwrap();
    other_kind.push(quadratic.with_constraints(range())).unwrap();
    let mut shorter = Hierarchy::new(2).unwrap();
    shorter.push(Level::least_squares(equality())).unwrap();
    let wider = Hierarchy::new(3).unwrap();
    let cases = [(longer, 2), (other_rows, 0), (other_kind, 1), (shorter, 1), (wider, 0)];
    for (other, level) in cases {
        let error = solver.solve(&other).unwrap_err();
        assert!(matches!(error, Error::ShapeChanged { .. }), "{error}");
        expect_words(&error, &[&format!("level {level}"), "new solver"]);
    }
    // A refused problem leaves the solver usable.
    assert!(solver.solve(&hierarchy).is_ok());
}

#[test]
fn a_hessian_resized_between_two_solves() {
    let mut hierarchy = quadratic(&DMatrix::identity(2, 2), &[0.0; 2]);
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    *hierarchy.quadratic_mut(id(&hierarchy, 2)).unwrap().0 = DMatrix::identity(3, 3);
    let error = solver.solve(&hierarchy).unwrap_err();
    assert!(matches!(error, Error::ShapeChanged { level, .. } if level.index() == 2), "{error}");
}

#[test]
fn rows_of_another_width_put_in_place() {
    let other = Rows::zeros(1, 3);
    let constrained = || {
        let mut hierarchy = sound();
        hierarchy.push(Level::constraints_only(range())).unwrap();
        hierarchy
    };
    let mut solver = Solver::new(&constrained(), Settings::default()).unwrap();
    let replace: [fn(&mut Hierarchy, Rows) -> usize; 3] = [
        |hierarchy, rows| {
            *hierarchy.constraints_mut(id(hierarchy, 2)).unwrap() = rows;
            2
        },
        |hierarchy, rows| {
            *hierarchy.rows_mut(id(hierarchy, 0)).unwrap() = rows;
            0
        },
        |hierarchy, rows| {
            *hierarchy.level_mut(id(hierarchy, 0)).unwrap() = Level::least_squares(rows);
            0
        },
    ];
    for replace in replace {
        let mut hierarchy = constrained();
        let level = replace(&mut hierarchy, other.clone());
        let error = solver.solve(&hierarchy).unwrap_err();
        let Error::ShapeChanged { level: changed, .. } = error else { panic!("{error}") };
        assert_eq!(changed.index(), level);
        assert!(solver.solve(&constrained()).is_ok());
    }
}

#[test]
fn a_level_that_is_not_there() {
    let mut longer = sound();
    let level = longer.push(Level::least_squares(equality())).unwrap();
    let mut hierarchy = sound();
    let expected = Error::NoSuchLevel { level };
    assert_eq!(hierarchy.level(level).unwrap_err(), expected);
    assert_eq!(hierarchy.level_mut(level).unwrap_err(), expected);
    assert_eq!(hierarchy.rows_mut(level).unwrap_err(), expected);
    assert_eq!(hierarchy.constraints_mut(level).unwrap_err(), expected);
    assert_eq!(hierarchy.quadratic_mut(level).unwrap_err(), expected);
    expect_words(&expected, &["no level 2", "push"]);
    let error = Rows::zeros(2, 3).row_mut(2).unwrap_err();
    assert!(matches!(error, Error::Size { got: 2, wanted: 3, .. }), "{error}");
    expect_words(&error, &["the block with the row", "size 2", "3 was expected"]);
    assert_eq!(Rows::zeros(2, 0).row(2), None);
}

#[test]
fn the_error_names_the_other_kind_of_objective() {
    let mut hierarchy = Hierarchy::new(1).unwrap();
    let rows = hierarchy.push(Level::least_squares(Rows::zeros(1, 1)).named("reach")).unwrap();
    let quadratic = Level::quadratic(&DMatrix::identity(1, 1), &[0.0]).unwrap();
    let quadratic = hierarchy.push(quadratic.named("ergonomics")).unwrap();
    let nothing = hierarchy.push(Level::constraints_only(Rows::zeros(1, 1))).unwrap();
    let cases = [
        (
            hierarchy.rows_mut(quadratic).unwrap_err(),
            ["level 1 \"ergonomics\" minimises a quadratic", "not rows"],
        ),
        (
            hierarchy.rows_mut(nothing).unwrap_err(),
            ["level 2 minimises nothing", "constraints_mut"],
        ),
        (
            hierarchy.quadratic_mut(rows).unwrap_err(),
            ["level 0 \"reach\" minimises rows", "not a quadratic"],
        ),
        (
            hierarchy.quadratic_mut(nothing).unwrap_err(),
            ["level 2 minimises nothing", "not a quadratic"],
        ),
        (
            Level::constraints_only(Rows::zeros(1, 1)).named("cap").rows_mut().unwrap_err(),
            ["the level \"cap\" minimises nothing", "not rows"],
        ),
    ];
    for (error, words) in cases {
        assert!(matches!(error, Error::OtherObjective { .. }), "{error}");
        expect_words(&error, &words);
    }
}

#[test]
fn settings_out_of_range() {
    let default = Settings::default();
    let cases: [(&str, Setter); 3] = [
        ("feasibility_tolerance", |s, v| s.feasibility_tolerance = v),
        ("rank_tolerance", |s, v| s.rank_tolerance = v),
        ("optimality_tolerance", |s, v| s.optimality_tolerance = v),
    ];
    for (expected, set) in cases {
        for value in [0.0, -1e-9, 1.1e-4, 0.5, f64::NAN, f64::INFINITY] {
            let mut settings = default;
            set(&mut settings, value);
            let error = Solver::new(&sound(), settings).unwrap_err();
            let Error::Value { what, .. } = error else { panic!("{error}") };
            assert_eq!(what, expected);
            expect_words(&error, &[expected, "above 0 and at most 1e-4"]);
        }
    }
    let error = Solver::new(&sound(), Settings { max_iterations: 0, ..default }).unwrap_err();
    expect_words(&error, &["max_iterations", "at least 1"]);
}

#[test]
fn physical_parameters_out_of_range() {
    let error = Limits::new(0.0, 1.0, -1.0, 1.0).unwrap_err();
    assert!(matches!(error, Error::Value { .. }), "{error}");
    expect_words(&error, &["velocity limit", "-1", "positive and finite"]);
    let state = AugmentedState { joints: 7, task: 6, slack: 0 };
    let error =
        AugmentedClik::new(state, PoseAxes::ALL, Vector6::repeat(1.0), f64::NAN).unwrap_err();
    expect_words(&error, &["control period", "positive and finite"]);
}

#[test]
fn an_empty_hierarchy_takes_the_least_norm() {
    let mut hierarchy = Hierarchy::new(3).unwrap();
    hierarchy.set_bounds(&dvector![-1.0, 2.0, -5.0], &dvector![1.0, 3.0, -4.0]).unwrap();
    assert_eq!(solve(&hierarchy).unwrap().optimum().unwrap(), [0.0, 2.0, -4.0]);
}

#[test]
fn a_failed_solve_does_not_spoil_the_next() {
    let hierarchy = sound();
    let expected = solve(&hierarchy).unwrap();
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let mut broken = hierarchy.clone();
    broken.bounds_mut().0[0] = f64::NAN;
    for _ in 0..3 {
        assert!(solver.solve(&broken).is_err());
        assert_eq!(solver.solve(&hierarchy).unwrap(), &expected);
    }
}
