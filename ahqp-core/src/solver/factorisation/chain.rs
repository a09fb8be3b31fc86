//! What has turned the coordinates since the reflections were made.

use std::cell::Cell;
use std::ops::Range;

use crate::linalg::kernels::Rotation;

/// Rotations, by their places in the list of them, or a coordinate that changes its place.
#[derive(Debug, Clone)]
pub(crate) enum Chain {
    /// From neighbours to neighbours, towards the first coordinates.
    Down(Range<usize>),
    /// From neighbours to neighbours, towards the last coordinates.
    Up(Range<usize>),
    /// Of neighbours, one after the other, with one coordinate that is not among them.
    Aside(Range<usize>),
    /// Coordinate `from` comes to stand at `to`; those from there on make room.
    Insert { from: usize, to: usize },
}

impl Chain {
    pub(super) fn apply(&self, rotations: &[Rotation], vector: &mut [f64]) {
        match self {
            Self::Down(chain) => {
                let chain = &rotations[chain.clone()];
                carry_down(touched(vector, chain), chain.iter().map(angle));
            }
            Self::Up(chain) => {
                let chain = &rotations[chain.clone()];
                carry_up(touched(vector, chain), chain.iter().map(angle));
            }
            Self::Aside(chain) => {
                let chain = &rotations[chain.clone()];
                let Some(&Rotation { first, second, .. }) = chain.first() else { return };
                let mut carry = vector[second];
                let entries = vector[first..first + chain.len()].iter_mut();
                carry_aside(entries, &mut carry, chain.iter().map(angle));
                vector[second] = carry;
            }
            &Self::Insert { from, to } => vector[to..=from].rotate_right(1),
        }
    }

    pub(super) fn undo(&self, rotations: &[Rotation], vector: &mut [f64]) {
        // The same the other way round, by the opposite angles.
        match self {
            Self::Down(chain) => {
                let chain = &rotations[chain.clone()];
                carry_up(touched(vector, chain), chain.iter().rev().map(opposite));
            }
            Self::Up(chain) => {
                let chain = &rotations[chain.clone()];
                carry_down(touched(vector, chain), chain.iter().rev().map(opposite));
            }
            Self::Aside(chain) => {
                let chain = &rotations[chain.clone()];
                let Some(&Rotation { first, second, .. }) = chain.first() else { return };
                let mut carry = vector[second];
                let entries = vector[first..first + chain.len()].iter_mut().rev();
                carry_aside(entries, &mut carry, chain.iter().rev().map(opposite));
                vector[second] = carry;
            }
            &Self::Insert { from, to } => vector[to..=from].rotate_left(1),
        }
    }
}

/// The cosine and the sine of a rotation.
pub(super) fn angle(rotation: &Rotation) -> (f64, f64) {
    (rotation.cosine, rotation.sine)
}

fn opposite(rotation: &Rotation) -> (f64, f64) {
    (rotation.cosine, -rotation.sine)
}

/// The entries that a chain of rotations of neighbours touches.
fn touched<'a>(vector: &'a mut [f64], chain: &[Rotation]) -> &'a mut [f64] {
    let (Some(a), Some(b)) = (chain.first(), chain.last()) else { return &mut [] };
    &mut vector[a.first.min(b.first)..=a.second.max(b.second)]
}

/// Rotates neighbours from the last to the first.
fn carry_down(entries: &mut [f64], angles: impl Iterator<Item = (f64, f64)>) {
    let Some(&last) = entries.last() else { return };
    let mut carry = last;
    for (pair, (cosine, sine)) in pairs(entries).rev().zip(angles) {
        let lower = pair[0].get();
        pair[1].set(cosine * carry - sine * lower);
        carry = cosine * lower + sine * carry;
    }
    entries.first_mut().into_iter().for_each(|first| *first = carry);
}

/// Rotates neighbours from the first to the last.
fn carry_up(entries: &mut [f64], angles: impl Iterator<Item = (f64, f64)>) {
    let Some(&first) = entries.first() else { return };
    let mut carry = first;
    for (pair, (cosine, sine)) in pairs(entries).zip(angles) {
        let upper = pair[1].get();
        pair[0].set(cosine * carry + sine * upper);
        carry = cosine * upper - sine * carry;
    }
    entries.last_mut().into_iter().for_each(|last| *last = carry);
}

/// Rotates each entry with `carry`.
pub(super) fn carry_aside<'a>(
    entries: impl Iterator<Item = &'a mut f64>,
    carry: &mut f64,
    angles: impl Iterator<Item = (f64, f64)>,
) {
    for (entry, (cosine, sine)) in entries.zip(angles) {
        let lower = *entry;
        *entry = cosine * lower + sine * *carry;
        *carry = cosine * *carry - sine * lower;
    }
}

/// Neighbouring entries.
fn pairs(entries: &mut [f64]) -> std::slice::Windows<'_, Cell<f64>> {
    Cell::from_mut(entries).as_slice_of_cells().windows(2)
}
