//! Fraction-free Gauss-Jordan elimination (Bareiss, Mathematics of Computation 22, 1968).

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};

use super::Exact;

/// Returns a solution of a linear system, with undetermined unknowns set to zero. None if the
/// equations contradict each other. An equation is its coefficients followed by its right-hand
/// side.
pub(super) fn solve(equations: &[Vec<Exact>]) -> Option<Vec<Exact>> {
    let unknowns = equations.first()?.len() - 1;
    let mut rows: Vec<Vec<BigInt>> = equations.iter().map(|row| integers(row)).collect();
    let mut divisor = BigInt::one();
    let mut pivots = Vec::new();
    for column in 0..unknowns {
        let rank = pivots.len();
        let Some(pivot_row) = (rank..rows.len()).find(|&i| !rows[i][column].is_zero()) else {
            continue;
        };
        rows.swap(rank, pivot_row);
        let pivot_row = rows[rank].clone();
        let pivot = &pivot_row[column];
        for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != rank) {
            let factor = row[column].clone();
            // Completed columns contain only their own pivot.
            for (j, entry) in row.iter_mut().enumerate() {
                let done = j < column && i < rank && pivots[i] != j;
                if done || (j < column && i > rank) {
                    continue;
                }
                *entry = (pivot * &*entry - &factor * &pivot_row[j]) / &divisor;
            }
        }
        divisor.clone_from(pivot);
        pivots.push(column);
    }
    if rows[pivots.len()..].iter().any(|row| !row[unknowns].is_zero()) {
        return None;
    }
    let mut solution = vec![Exact::zero(); unknowns];
    for (row, &column) in rows.iter().zip(&pivots) {
        solution[column] = BigRational::new(row[unknowns].clone(), row[column].clone());
    }
    Some(solution)
}

/// Returns which of `candidates` are independent of `given` and of earlier candidates.
pub(super) fn independent(given: &[&[Exact]], candidates: &[&[Exact]]) -> Vec<bool> {
    // Rows in echelon form, each with its pivot.
    let mut echelon: Vec<(usize, Vec<BigInt>)> = Vec::new();
    let mut add = |row: &[Exact]| {
        let mut row = integers(row);
        for (pivot, above) in &echelon {
            if !row[*pivot].is_zero() {
                let (a, b) = (above[*pivot].clone(), row[*pivot].clone());
                for (entry, above) in row.iter_mut().zip(above) {
                    *entry = &a * &*entry - &b * above;
                }
                shorten(&mut row);
            }
        }
        let pivot = row.iter().position(|entry| !entry.is_zero());
        if let Some(pivot) = pivot {
            echelon.push((pivot, row));
        }
        pivot.is_some()
    };
    for row in given {
        add(row);
    }
    candidates.iter().map(|row| add(row)).collect()
}

/// Multiplies the row by the least common multiple of its denominators, and divides by the common
/// factor.
fn integers(row: &[Exact]) -> Vec<BigInt> {
    let common = row.iter().fold(BigInt::one(), |common, entry| common.lcm(entry.denom()));
    let mut row: Vec<_> =
        row.iter().map(|entry| entry.numer() * (&common / entry.denom())).collect();
    shorten(&mut row);
    row
}

fn shorten(row: &mut [BigInt]) {
    let shared = row.iter().fold(BigInt::zero(), |shared, entry| shared.gcd(entry));
    if shared > BigInt::one() {
        for entry in row {
            *entry /= &shared;
        }
    }
    debug_assert!(!shared.is_negative());
}
