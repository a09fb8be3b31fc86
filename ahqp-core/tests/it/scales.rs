//! Variables and rows of very different size, and rows that nearly agree.

use ahqp_core::{Error, Hierarchy, Level, Rows, Settings, Solver, Status};
use nalgebra::{DMatrix, DVector, dmatrix, dvector};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, RngSeed, TestRng};

const FREE: f64 = f64::INFINITY;

/// Uses the same cases on every run. `PROPTEST_RNG_SEED` and `AHQP_CASES` select others and more.
fn config() -> ProptestConfig {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        cases: number("AHQP_CASES").map_or(500, |cases| u32::try_from(cases).unwrap()),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn towards(target: &DVector<f64>) -> Level {
    let identity = DMatrix::identity(target.len(), target.len());
    Level::least_squares(Rows::equalities(&identity, target).unwrap())
}

/// Returns a problem in which x₀ becomes large, and the unrelated x₁ must be in a range.
fn beside_a_large_one(size: f64, second: f64, range: (f64, f64)) -> Hierarchy {
    let mut hierarchy = Hierarchy::new(2).unwrap();
    let rows = dmatrix![0.0, 1.0; 0.0, 1.0];
    let rows = Rows::ranges(&rows, &dvector![range.0, -FREE], &dvector![FREE, range.1]).unwrap();
    hierarchy.push(towards(&dvector![size, second]).with_constraints(rows)).unwrap();
    hierarchy
}

#[test]
fn a_large_variable_loosens_no_constraint_of_another() {
    for size in [1e2, 1e4, 1e6, 1e9] {
        let rounding = 1e-13 * size;
        let near = |x: &[f64], expected: f64| (x[1] - expected).abs() <= rounding;
        // Tests a cold start, and a warm one after the bound was inactive.
        for first in [0.9, 1.05] {
            let start = beside_a_large_one(size, first, (-1.0, 1.0));
            let mut solver = Solver::new(&start, Settings::default()).unwrap();
            assert!(near(solver.solve(&start).unwrap().optimum().unwrap(), f64::min(first, 1.0)));
            let next = beside_a_large_one(size, 1.05, (-1.0, 1.0));
            assert!(
                near(solver.solve(&next).unwrap().optimum().unwrap(), 1.0),
                "{size} after {first}"
            );
            let back = beside_a_large_one(size, -1.0 - 1e-3, (-1.0, 1.0));
            assert!(
                near(solver.solve(&back).unwrap().optimum().unwrap(), -1.0),
                "{size} after {first}"
            );
        }
        let gap = 1e4 * rounding;
        let contradiction = beside_a_large_one(size, 0.0, (gap, -gap));
        let error = Solver::new(&contradiction, Settings::default())
            .unwrap()
            .solve(&contradiction)
            .unwrap_err();
        assert!(
            matches!(error, Error::Infeasible { level, .. } if level.index() == 0),
            "{size}: {error}"
        );
    }
}

#[test]
fn a_certificate_sees_small_rows_beside_large_variables() {
    let hierarchy = beside_a_large_one(1e9, 1.05, (-1.0, 1.0));
    let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
    let mut x = solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec();
    let certificate = solver.certificate(&hierarchy).unwrap();
    assert!(certificate.residuals(&hierarchy, &x).unwrap().worst() < 1e-9);
    x[1] = 1.05;
    assert!(certificate.residuals(&hierarchy, &x).unwrap().feasibility > 1e-2);
}

#[test]
fn curvatures_and_slopes_of_very_different_size_count() {
    let quadratic = |hessian: DMatrix<f64>, gradient: DVector<f64>| {
        let mut hierarchy = Hierarchy::new(2).unwrap();
        hierarchy.set_bounds(&dvector![-1e3, -1e3], &dvector![1e3, 1e3]).unwrap();
        hierarchy.push(Level::quadratic(&hessian, &gradient).unwrap()).unwrap();
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        solver.solve(&hierarchy).unwrap().optimum().unwrap().to_vec()
    };
    let near = |x: &[f64], expected: [f64; 2]| {
        assert!(x.iter().zip(expected).all(|(x, e)| (x - e).abs() < 1e-9), "{x:?} {expected:?}");
    };
    near(&quadratic(dmatrix![1e16, 0.0; 0.0, 1.0], dvector![-1e16, -1.0]), [1.0, 1.0]);
    near(&quadratic(dmatrix![1e13, 0.0; 0.0, 1.0], dvector![0.0, -1.0]), [0.0, 1.0]);
    near(&quadratic(dmatrix![1.0, 0.0; 0.0, 0.0], dvector![1.0, 5e-10]), [-1.0, -1e3]);
    // The Hessian is flat along (1, −1), where the gradient has only rounding.
    let flat = quadratic(dmatrix![1.0, 1.0; 1.0, 1.0], dvector![0.3 - 0.1, 0.2]);
    near(&flat, [-0.1, -0.1]);
}

#[derive(Debug, Clone)]
struct Plan {
    variables: usize,
    levels: usize,
    bounded: bool,
    /// Difference of rows derived from others, as a power of ten.
    nearness: f64,
    /// Largest size of the exponents of ten in the units of objective rows. Hard rows are not
    /// weighed against each other, and have six times as many.
    units: f64,
    seed: u64,
}

fn nearly_dependent() -> impl Strategy<Value = Plan> {
    (2..9_usize, 1..6_usize, any::<bool>(), -6.0..-1.0_f64, any::<u64>().no_shrink()).prop_map(
        |(variables, levels, bounded, nearness, seed)| Plan {
            variables,
            levels,
            bounded,
            nearness,
            units: 0.0,
            seed,
        },
    )
}

fn of_many_units() -> impl Strategy<Value = Plan> {
    nearly_dependent().prop_map(|plan| Plan { nearness: f64::NEG_INFINITY, units: 1.0, ..plan })
}

impl Plan {
    fn build(&self) -> Hierarchy {
        let n = self.variables;
        let mut seed = [0; 32];
        seed[..8].copy_from_slice(&self.seed.to_le_bytes());
        let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
        // Hard rows hold here. Objectives do too if nothing bounds the variables. Rows that nearly
        // agree and contradict each other have their optimum at a distance of one over their
        // difference.
        let inner = DVector::from_fn(n, |_, _| sign(&mut random) * random.random::<f64>());
        let mut hierarchy = Hierarchy::new(n).unwrap();
        if self.bounded {
            let size = DVector::from_fn(n, |_, _| random.random_range(1.0..3.0));
            hierarchy.set_bounds(&-&size, &size).unwrap();
        }
        let mut known = Vec::new();
        for _ in 0..self.levels {
            let point = (!self.bounded).then_some(&inner);
            let objective = self.rows(&mut random, &mut known, point, self.units);
            let mut level = Level::least_squares(objective);
            if hierarchy.levels().is_empty() {
                level = level.with_constraints(self.rows(
                    &mut random,
                    &mut known,
                    Some(&inner),
                    6.0 * self.units,
                ));
            }
            hierarchy.push(level).unwrap();
        }
        hierarchy
    }

    /// Returns rows of which some are nearly or exactly among those `known`. If `inner` is given,
    /// they hold there.
    fn rows(
        &self,
        random: &mut TestRng,
        known: &mut Vec<DVector<f64>>,
        inner: Option<&DVector<f64>>,
        units: f64,
    ) -> Rows {
        let count = random.random_range(1..=6_usize);
        let mut matrix = DMatrix::zeros(count, self.variables);
        let (mut lower, mut upper) = (DVector::zeros(count), DVector::zeros(count));
        for i in 0..count {
            let repeated = !known.is_empty() && random.random::<f64>() < 0.35;
            let difference = if repeated {
                if random.random::<f64>() < 0.4 { 0.0 } else { 10_f64.powf(self.nearness) }
            } else {
                1.0
            };
            let mut row = DVector::from_fn(self.variables, |_, _| normal(random) * difference);
            if repeated {
                row += &known[random.random_range(0..known.len())];
            }
            known.push(row.clone());
            let unit = 10_f64.powf(units * random.random_range(-1.0..=1.0));
            let (at, spread) = inner.map_or((normal(random), 0.5), |inner| {
                // The bounds lie at some distance from the point.
                (row.dot(inner) - 0.1, 0.2)
            });
            let (least, greatest) = match random.random_range(0..4) {
                0 if inner.is_none() => (at, at),
                1 => (at, FREE),
                2 => (-FREE, at + spread),
                _ => (at, at + spread),
            };
            (lower[i], upper[i]) = (least * unit, greatest * unit);
            matrix.set_row(i, &(row * unit).transpose());
        }
        Rows::ranges(&matrix, &lower, &upper).unwrap()
    }
}

fn sign(random: &mut TestRng) -> f64 {
    if random.random() { 1.0 } else { -1.0 }
}

/// Returns a random number of variance one.
fn normal(random: &mut TestRng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

fn expect_proof(hierarchy: &Hierarchy) -> Result<(), TestCaseError> {
    let mut solver = Solver::new(hierarchy, Settings::default()).unwrap();
    // First a cold start, then a warm one.
    for _ in 0..2 {
        let solution = solver.solve(hierarchy)?.clone();
        prop_assert_eq!(solution.status(), Status::Solved);
        let certificate = solver.certificate(hierarchy)?;
        let residuals = certificate.residuals(hierarchy, solution.optimum().unwrap())?;
        prop_assert!(residuals.worst() < 1e-8, "{residuals:?}");
    }
    Ok(())
}

/// Returns rows of constraints that only a slack makes feasible, around a tiny range.
fn slackened(variables: usize, range: f64, seed: u64) -> Hierarchy {
    let mut seeds = [0; 32];
    seeds[..8].copy_from_slice(&seed.to_le_bytes());
    let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &seeds);
    let slacks = 3;
    let n = variables + slacks;
    let mut hierarchy = Hierarchy::new(n).unwrap();
    let (lower, upper) = hierarchy.bounds_mut();
    for i in 0..variables {
        let middle = normal(&mut random);
        (lower[i], upper[i]) = (middle - 1e-3, middle + 1e-3);
    }
    let tracking =
        DMatrix::from_fn(2, n, |_, j| if j < variables { normal(&mut random) } else { 0.0 });
    let target = DVector::from_fn(2, |_, _| normal(&mut random));
    hierarchy.push(Level::least_squares(Rows::equalities(&tracking, &target).unwrap())).unwrap();
    let mut rows = DMatrix::zeros(2 * slacks, n);
    let mut greatest = DVector::zeros(2 * slacks);
    for slack in 0..slacks {
        for (row, sign) in [(2 * slack, 1.0), (2 * slack + 1, -1.0)] {
            for j in 0..variables {
                rows[(row, j)] = sign * range * normal(&mut random);
            }
            rows[(row, variables + slack)] = -1.0;
            greatest[row] = -range * random.random::<f64>();
        }
    }
    let least = DVector::repeat(2 * slacks, -FREE);
    let rows = Rows::ranges(&rows, &least, &greatest).unwrap();
    let mut slack = DMatrix::zeros(slacks, n);
    slack.view_mut((0, variables), (slacks, slacks)).fill_with_identity();
    let rest = Rows::equalities(&slack, &DVector::zeros(slacks)).unwrap();
    hierarchy.push(Level::least_squares(rest).with_constraints(rows)).unwrap();
    hierarchy
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn rows_that_nearly_agree_come_out_right(plan in nearly_dependent()) {
        expect_proof(&plan.build())?;
    }

    #[test]
    fn rows_in_different_units_come_out_right(plan in of_many_units()) {
        expect_proof(&plan.build())?;
    }

    /// A constraint with slack is feasible, however small the violation that the slack must
    /// compensate.
    #[test]
    fn slack_makes_the_smallest_ranges_feasible(
        variables in 1..12_usize, range in -15.0..0.0_f64, seed in any::<u64>().no_shrink(),
    ) {
        let hierarchy = slackened(variables, 10_f64.powf(range), seed);
        let mut solver = Solver::new(&hierarchy, Settings::default()).unwrap();
        for _ in 0..2 {
            let solution = solver.solve(&hierarchy)?;
            prop_assert_eq!(solution.status(), Status::Solved);
            let size = 1e-11 * DVector::from_column_slice(solution.optimum().unwrap()).norm();
            for (row, _, upper) in hierarchy.levels()[1].constraints().iter() {
                let value: f64 = row.iter().zip(solution.optimum().unwrap()).map(|(a, x)| a * x).sum();
                prop_assert!(value <= upper + size, "{value} {upper}");
            }
        }
    }
}
