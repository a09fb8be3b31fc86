//! Lower bounds of distances that are carried from tick to tick, so that few distances are
//! computed.

use hrsw::Capsule;

/// Largest effect of rounding on a bound in a tick \[m\].
const ROUNDING: f64 = 1e-12;

/// Lower bounds of the distances of all pairs of capsules of two lists.
///
/// A distance falls by no more than its capsules move. A capsule moves by no more than its ends
/// move and its radius grows. A distance that was computed once therefore bounds the distances of
/// later ticks. This holds even if an index refers to another body later.
#[derive(Debug, Clone)]
pub(crate) struct DistanceBounds {
    first: Capsules,
    second: Capsules,
    /// True if both lists were the same in the tick before.
    is_own: bool,
    /// A row for each capsule of the first list, with room for the second list.
    bounds: Vec<f64>,
}

/// The last capsules of a list, and the displacement of each since then.
#[derive(Debug, Clone)]
struct Capsules {
    room: usize,
    last: Vec<Capsule>,
    moved: Vec<f64>,
}

impl Capsules {
    fn new(room: usize) -> Self {
        Self { room, last: Vec::with_capacity(room), moved: Vec::with_capacity(room) }
    }

    fn advance<'a>(&mut self, now: impl Iterator<Item = &'a Capsule>) {
        self.moved.clear();
        let mut count = 0;
        for capsule in now.take(self.room) {
            if let Some(last) = self.last.get_mut(count) {
                self.moved.push(displacement(last, capsule) + ROUNDING);
                *last = *capsule;
            } else {
                self.moved.push(f64::INFINITY);
                self.last.push(*capsule);
            }
            count += 1;
        }
        self.last.truncate(count);
    }

    fn copy_from(&mut self, other: &Self) {
        let count = other.last.len().min(self.room);
        self.last.clear();
        self.last.extend(other.last.iter().take(count));
        self.moved.clear();
        self.moved.extend(other.moved.iter().take(count));
    }
}

impl DistanceBounds {
    /// Creates bounds for this many capsules of each list. Nothing is known of further capsules.
    pub(crate) fn new(first: usize, second: usize) -> Self {
        Self {
            first: Capsules::new(first),
            second: Capsules::new(second),
            is_own: false,
            bounds: vec![f64::NEG_INFINITY; first * second],
        }
    }

    /// Moves the bounds on to the capsules of a tick. Allocates nothing.
    pub(crate) fn advance<'a>(
        &mut self,
        first: impl Iterator<Item = &'a Capsule>,
        second: impl Iterator<Item = &'a Capsule>,
    ) {
        self.first.advance(first);
        self.second.advance(second);
        self.is_own = false;
        self.lower();
    }

    /// Moves the bounds on if both lists are the same. Allocates nothing.
    pub(crate) fn advance_own<'a>(&mut self, own: impl Iterator<Item = &'a Capsule> + Clone) {
        self.first.advance(own.clone());
        if self.is_own {
            self.second.copy_from(&self.first);
        } else {
            self.second.advance(own);
            self.is_own = true;
        }
        self.lower();
    }

    /// Lowers all bounds by the displacements of the capsules.
    fn lower(&mut self) {
        let rows = self.bounds.chunks_exact_mut(self.second.room.max(1));
        for (row, of_first) in rows.zip(&self.first.moved) {
            for (bound, of_second) in row.iter_mut().zip(&self.second.moved) {
                *bound -= of_first + of_second;
            }
        }
    }

    /// Returns the bounds of one capsule of the first list to the remembered capsules of the second
    /// list \[m\].
    pub(crate) fn of(&self, first: usize) -> &[f64] {
        let start = first * self.second.room;
        let count = if first < self.first.moved.len() { self.second.moved.len() } else { 0 };
        self.bounds.get(start..start + count).unwrap_or_default()
    }

    /// Returns the bound of a pair \[m\].
    pub(crate) fn get(&self, first: usize, second: usize) -> f64 {
        let index = self.index(first, second);
        index.and_then(|index| self.bounds.get(index)).copied().unwrap_or(f64::NEG_INFINITY)
    }

    /// Sets the bound of a pair to its distance in this tick \[m\].
    pub(crate) fn set(&mut self, first: usize, second: usize, distance: f64) {
        if let Some(bound) = self.index(first, second).and_then(|index| self.bounds.get_mut(index))
        {
            *bound = distance;
        }
    }

    fn index(&self, first: usize, second: usize) -> Option<usize> {
        let known = first < self.first.moved.len() && second < self.second.moved.len();
        known.then_some(first * self.second.room + second)
    }
}

/// Returns an upper bound of the displacement of every point of a capsule.
fn displacement(last: &Capsule, now: &Capsule) -> f64 {
    let start = (now.start() - last.start()).norm_squared();
    let end = (now.end() - last.end()).norm_squared();
    start.max(end).sqrt() + (now.radius() - last.radius()).max(0.0)
}
