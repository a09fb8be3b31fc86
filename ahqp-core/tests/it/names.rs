//! Names of levels, rows and variables in errors and conflicts.

use ahqp_core::{
    ConstraintSource, Error, Hierarchy, Level, Rows, Settings, Solver, solve_reference,
};
use nalgebra::{DMatrix, dmatrix};

/// Returns a named problem with every kind of row.
fn named() -> Hierarchy {
    let mut hierarchy = Hierarchy::new(2).unwrap();
    hierarchy.set_bounds(&[-1.0, -1.0], &[1.0, 1.0]).unwrap();
    hierarchy.name_variables(["shoulder", "elbow"]).unwrap();
    let reach = Rows::equalities(&dmatrix![1.0, 0.0; 0.0, 1.0], &[0.5, 0.5]).unwrap();
    let limit = Rows::at_most(&dmatrix![1.0, 1.0], &[1.0]).unwrap();
    let reach = Level::least_squares(reach.with_names(["x", "y"]).unwrap()).named("reach");
    hierarchy.push(reach.with_constraints(limit.with_names(["wall"]).unwrap())).unwrap();
    let ergonomics = Level::quadratic(&DMatrix::identity(2, 2), &[0.0, 0.0]).unwrap();
    hierarchy.push(ergonomics.named("ergonomics")).unwrap();
    hierarchy
}

type Spoil = fn(&mut Hierarchy) -> Result<(), Error>;

#[test]
fn errors_name_what_they_speak_of() {
    let cases: [(Spoil, &str); 9] = [
        (
            |problem| {
                problem.bounds_mut().0[1] = f64::NAN;
                Ok(())
            },
            "the bounds of variable 1 \"elbow\": the lower bound is NaN",
        ),
        (
            |problem| {
                problem.bounds_mut().0[0] = 2.0;
                Ok(())
            },
            "the bounds of variable 0 \"shoulder\": lower bound 2 and upper bound 1",
        ),
        (
            |problem| {
                problem.rows_mut(first(problem))?.row_mut(1)?[0] = f64::NAN;
                Ok(())
            },
            "objective row 1 \"y\" of level 0 \"reach\", entry 0: the matrix is NaN",
        ),
        (
            |problem| problem.rows_mut(first(problem))?.set_targets(&[0.0, 1e200]),
            "objective row 1 \"y\" of level 0 \"reach\": its largest number is 1e200",
        ),
        (
            |problem| {
                problem.constraints_mut(first(problem))?.upper_mut()[0] = f64::NAN;
                Ok(())
            },
            "constraint row 0 \"wall\" of level 0 \"reach\": the upper bound is NaN",
        ),
        (
            |problem| {
                problem.constraints_mut(first(problem))?.upper_mut()[0] = -7.0;
                Ok(())
            },
            "the hard constraints of level 0 \"reach\" cannot hold together with those above it: \
             constraint row 0 \"wall\" of level 0 \"reach\"",
        ),
        (
            |problem| {
                problem.quadratic_mut(last(problem))?.0[(0, 0)] = -1.0;
                Ok(())
            },
            "the Hessian of level 1 \"ergonomics\" is not positive semidefinite",
        ),
        (
            |problem| {
                problem.quadratic_mut(last(problem))?.0[(0, 1)] = 0.5;
                Ok(())
            },
            "the Hessian of level 1 \"ergonomics\" is not symmetric",
        ),
        (
            |problem| {
                *problem.rows_mut(first(problem))? = Rows::zeros(1, 2);
                Ok(())
            },
            "level 0 \"reach\" has another shape",
        ),
    ];
    for (spoil, words) in cases {
        let mut problem = named();
        let mut solver = Solver::new(&problem, Settings::default()).unwrap();
        spoil(&mut problem).unwrap();
        let error = solver.solve(&problem).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        // Names are part of the error.
        let error_in_full = format!("{error:?}");
        if !matches!(error, Error::Infeasible { .. } | Error::ShapeChanged { .. }) {
            assert_eq!(format!("{:?}", solve_reference(&problem).unwrap_err()), error_in_full);
        }
    }
    let mut falling = Hierarchy::new(1).unwrap();
    let level = Level::quadratic(&dmatrix![0.0], &[1.0]).unwrap().named("fall");
    falling.push(level).unwrap();
    let error = Solver::new(&falling, Settings::default()).unwrap().solve(&falling).unwrap_err();
    assert!(error.to_string().contains("level 0 \"fall\" decreases without bound"), "{error}");
}

fn first(problem: &Hierarchy) -> ahqp_core::LevelId {
    problem.ids().next().unwrap()
}

fn last(problem: &Hierarchy) -> ahqp_core::LevelId {
    problem.ids().last().unwrap()
}

#[test]
fn conflicts_are_described_by_name() {
    let mut problem = named();
    let wall = problem.constraints_mut(first(&problem)).unwrap();
    wall.upper_mut()[0] = -7.0;
    let mut solver = Solver::new(&problem, Settings::default()).unwrap();
    assert!(solver.solve(&problem).is_err());
    let words = |row: &ConstraintSource| problem.describe(*row).to_string();
    let conflict: Vec<String> = solver.conflict().iter().map(words).collect();
    assert_eq!(
        conflict,
        [
            "constraint row 0 \"wall\" of level 0 \"reach\"",
            "the bounds of variable 0 \"shoulder\"",
            "the bounds of variable 1 \"elbow\"",
        ]
    );
    // A row without a name has a number.
    let mut plain = Hierarchy::new(2).unwrap();
    let level = plain.push(Level::constraints_only(Rows::zeros(1, 2))).unwrap();
    let row = ConstraintSource::Constraint { level, row: 0 };
    assert_eq!(plain.describe(row).to_string(), "constraint row 0 of level 0");
    assert_eq!(row.to_string(), "constraint row 0 of level 0");
}
