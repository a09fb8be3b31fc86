//! Unrelated random hierarchies, as in the published comparison of hierarchical solvers.

use nalgebra::DVector;

use crate::error::Error;
use crate::problem::hierarchy::Hierarchy;
use crate::problem::level::Level;
use crate::problem::rows::Rows;
use crate::testing::random::Random;

const VARIABLES: usize = 50;
const LEVELS: usize = 10;
const MOST_ROWS: usize = 20;

/// Returns `count` random hierarchies of the kind for which DAQP's hierarchical mode was published
/// (arXiv 2512.18458).
///
/// They have 50 variables without bounds, and 10 levels of 1 to 20 soft rows each. The coefficients
/// of a row are |U(−1, 1)|, scaled to norm 1. Its upper bound is U(0, 1) above its value at a
/// random point of the level, U(−1, 1) in each coordinate. A level consists of equalities with
/// probability `equality_share`. The ranges of other levels have width U(0, 1).
///
/// # Errors
/// Those of [`Hierarchy`]'s constructors, which the sizes here do not cause.
pub fn random_comparison(
    seed: u64,
    equality_share: f64,
    count: usize,
) -> Result<Vec<Hierarchy>, Error> {
    let random = &mut Random::new(seed);
    (0..count).map(|_| random_hierarchy(equality_share, random)).collect()
}

fn random_hierarchy(equality_share: f64, random: &mut Random) -> Result<Hierarchy, Error> {
    let mut hierarchy = Hierarchy::new(VARIABLES)?;
    for _ in 0..LEVELS {
        hierarchy.push(Level::least_squares(random_level(equality_share, random)?))?;
    }
    Ok(hierarchy)
}

fn random_level(equality_share: f64, random: &mut Random) -> Result<Rows, Error> {
    let mut rows = Rows::zeros(1 + random.below(MOST_ROWS), VARIABLES);
    let point = DVector::from_fn(VARIABLES, |_, _| random.uniform(-1.0, 1.0));
    let equalities = random.chance(equality_share);
    for i in 0..rows.len() {
        let row = DVector::from_fn(VARIABLES, |_, _| random.uniform(-1.0, 1.0).abs()).normalize();
        let upper = row.dot(&point) + random.uniform(0.0, 1.0);
        let width = if equalities { 0.0 } else { random.uniform(0.0, 1.0) };
        rows.set_row(i, &row, upper - width, upper)?;
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::level::Objective;

    /// Returns all levels of `count` hierarchies.
    fn levels(seed: u64, equality_share: f64, count: usize) -> Vec<Rows> {
        let hierarchies = random_comparison(seed, equality_share, count).unwrap();
        let objectives = hierarchies.iter().flat_map(Hierarchy::levels).map(Level::objective);
        objectives
            .filter_map(|objective| match objective {
                Objective::LeastSquares(rows) => Some(rows.clone()),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn levels_are_as_published() {
        for (share, expected) in [(0.0, 0.0..=0.0), (0.5, 0.45..=0.55), (1.0, 1.0..=1.0)] {
            let levels = levels(1, share, 100);
            assert_eq!(levels.len(), 1000);
            let mut equalities = 0;
            for rows in &levels {
                assert!((1..=20).contains(&rows.len()));
                let (_, lower, upper) = rows.iter().next().unwrap();
                equalities += usize::from(lower == upper);
                for (a, l, u) in rows.iter() {
                    assert!(a.len() == 50 && a.iter().all(|&entry| entry >= 0.0));
                    let norm = a.iter().map(|entry| entry * entry).sum::<f64>();
                    assert!((norm - 1.0).abs() < 1e-14);
                    assert!((0.0..=1.0).contains(&(u - l)) && (l == u) == (lower == upper));
                }
            }
            assert!(expected.contains(&(equalities as f64 / 1000.0)), "{share}: {equalities}");
            let mean = levels.iter().map(Rows::len).sum::<usize>() as f64 / 1000.0;
            assert!((mean - 10.5).abs() < 0.6, "{mean}");
        }
    }

    #[test]
    fn a_seed_gives_the_same_problems() {
        assert_eq!(levels(3, 0.5, 2), levels(3, 0.5, 2));
        assert_ne!(levels(3, 0.5, 2), levels(4, 0.5, 2));
    }
}
