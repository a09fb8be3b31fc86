//! Random sets of hard rows of small integers, in which rows tie with bounds and with each other.

use ahqp_core::{Hierarchy, Level, Rows};

/// SplitMix64 (Steele, Lea & Flood, "Fast splittable pseudorandom number generators", 2014).
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }

    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((z ^ (z >> 31)) % count as u64).unwrap()
    }

    /// Returns an integer from −`size` to `size`.
    fn whole(&mut self, size: usize) -> f64 {
        self.below(2 * size + 1) as f64 - size as f64
    }

    /// Returns true with a probability of `percent`.
    fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }
}

/// Form in which a set is given to the solver. Either all forms have a solution, or none has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    AsItIs,
    BoundsAsRows,
    /// Shifted by one along each variable.
    Shifted,
}

impl Form {
    pub(super) const ALL: [Self; 3] = [Self::AsItIs, Self::BoundsAsRows, Self::Shifted];
}

/// A row with its lower and upper bound.
type Row = (Vec<f64>, f64, f64);

/// A set lower ≤ x ≤ upper with rows.
#[derive(Debug, Clone)]
pub(super) struct Set {
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    pub(super) rows: Vec<Row>,
}

impl Set {
    /// Creates a set that holds at an integer point, at which many bounds and rows are met with
    /// equality. Its rows are copies and sums of bounds and rows, and others.
    pub(super) fn feasible(random: &mut Random) -> Self {
        let most = if random.chance(20) { 10 } else { 5 };
        let n = 1 + random.below(most);
        let x: Vec<f64> =
            (0..n).map(|_| if random.chance(50) { 0.0 } else { random.whole(3) }).collect();
        let room = |random: &mut Random| {
            if random.chance(60) { 0.0 } else { random.below(4) as f64 }
        };
        let side = |random: &mut Random, percent: usize| {
            if random.chance(percent) { room(random) } else { f64::INFINITY }
        };
        let lower = x.iter().map(|x| x - side(random, 75)).collect();
        let upper = x.iter().map(|x| x + side(random, 35)).collect();
        let mut rows: Vec<Row> = Vec::new();
        for _ in 0..random.below(2 * n + 2) {
            let row: Vec<f64> = match random.below(6) {
                0 => {
                    let variable = random.below(n);
                    let factor = [1.0, -1.0, 2.0, -3.0][random.below(4)];
                    (0..n).map(|i| if i == variable { factor } else { 0.0 }).collect()
                }
                1 => (0..n).map(|_| f64::from(u8::from(random.chance(60)))).collect(),
                2 | 3 if !rows.is_empty() => {
                    let [(one, ..), (other, ..)] =
                        [random.below(rows.len()), random.below(rows.len())].map(|i| &rows[i]);
                    let [p, q] = [random.whole(2), random.whole(2)];
                    one.iter().zip(other).map(|(a, b)| p * a + q * b).collect()
                }
                _ => (0..n).map(|_| random.whole(3)).collect(),
            };
            let value: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
            let (below, above) = match random.below(8) {
                0 | 1 => (0.0, 0.0),
                2..5 => (f64::INFINITY, room(random)),
                5 | 6 => (room(random), f64::INFINITY),
                _ => (room(random), room(random)),
            };
            rows.push((row, value - below, value + above));
        }
        Self { lower, upper, rows }
    }

    /// Adds one more row of integers, which the set may contradict.
    pub(super) fn with_another_bound(mut self, random: &mut Random) -> Self {
        let row: Vec<f64> = (0..self.lower.len()).map(|_| random.whole(2)).collect();
        let bound = random.whole(6);
        self.rows.push(if random.chance(50) {
            (row, bound, f64::INFINITY)
        } else {
            (row, bound, bound)
        });
        self
    }

    /// Returns the bounds as rows.
    fn bounds(&self) -> impl Iterator<Item = Row> {
        let unit = |i: usize| (0..self.lower.len()).map(|j| f64::from(u8::from(i == j))).collect();
        (0..self.lower.len()).map(move |i| (unit(i), self.lower[i], self.upper[i]))
    }

    /// Returns a x ≤ b for all finite bounds.
    pub(super) fn inequalities(&self) -> Vec<(Vec<f64>, f64)> {
        let mut inequalities = Vec::new();
        for (row, lower, upper) in self.bounds().chain(self.rows.iter().cloned()) {
            if lower.is_finite() {
                inequalities.push((row.iter().map(|a| -a).collect(), -lower));
            }
            if upper.is_finite() {
                inequalities.push((row, upper));
            }
        }
        inequalities
    }

    /// Returns the set as a problem of one level.
    pub(super) fn hierarchy(&self, form: Form) -> Hierarchy {
        let n = self.lower.len();
        let shift = if form == Form::Shifted { 1.0 } else { 0.0 };
        let mut rows = self.rows.clone();
        let mut hierarchy = Hierarchy::new(n).unwrap();
        if form == Form::BoundsAsRows {
            rows.extend(self.bounds());
        } else {
            let shifted = |bounds: &[f64]| bounds.iter().map(|x| x + shift).collect::<Vec<_>>();
            hierarchy.set_bounds(&shifted(&self.lower)[..], &shifted(&self.upper)[..]).unwrap();
        }
        let mut constraints = Rows::zeros(rows.len(), n);
        for (i, (row, lower, upper)) in rows.iter().enumerate() {
            let by = shift * row.iter().sum::<f64>();
            constraints.set_row(i, &row[..], lower + by, upper + by).unwrap();
        }
        hierarchy.push(Level::constraints_only(constraints)).unwrap();
        hierarchy
    }

    /// Returns true if all bounds and rows hold at `x`, a solution in this form, within 1e-9 of
    /// their terms.
    pub(super) fn holds(&self, form: Form, x: &[f64]) -> bool {
        let shift = if form == Form::Shifted { 1.0 } else { 0.0 };
        self.inequalities().iter().all(|(row, bound)| {
            let terms = row.iter().zip(x).map(|(a, x)| a * (x - shift));
            let (value, size) =
                terms.fold((0.0, 1.0 + bound.abs()), |(v, s), term| (v + term, s + term.abs()));
            value - bound <= 1e-9 * size
        })
    }
}
