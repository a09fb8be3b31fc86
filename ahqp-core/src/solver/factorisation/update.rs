//! Updates of a factorisation after changes of the active set.
//!
//! A row that comes or goes moves the pivots below it by one coordinate. A chain of plane rotations
//! does this (Gill, Golub, Murray, Saunders, Mathematics of Computation 28, 1974). L stays
//! triangular level by level. A level gains or loses a pivot where a direction has become free or
//! has been used up. A bound that becomes active is a row of the first group. A bound that was
//! active from the start and is dropped makes its variable free.
//!
//! Ranks are updated only where they are beyond doubt. Otherwise the caller factors again, with
//! pivoting.

use std::ops::Range;

use super::{Factorisation, Group, Purpose};
use crate::linalg::kernels::{Rotation, rows_mut};
use crate::linalg::vector::{length, norm};
use crate::solver::activity::Activity;
use crate::solver::data::{Coefficients, ProblemData, active_bound};
use crate::solver::factorisation::rank_tolerances::RankTolerances;
use crate::solver::tolerances::HEAVIER;

/// Error of a change that would leave a rank in doubt.
#[derive(Debug)]
pub(crate) struct RankInDoubt;

impl RankTolerances {
    /// Returns true if a part of a row, relative to the row, is nonzero.
    fn is_there(self, part: f64) -> Result<bool, RankInDoubt> {
        if part >= self.clear {
            Ok(true)
        } else if part <= self.nothing {
            Ok(false)
        } else {
            Err(RankInDoubt)
        }
    }
}

impl Factorisation {
    /// Adds or removes the rows in `changed`, which are hard rows and rows of objectives, in the
    /// groups of their levels. Returns false if a rank is in doubt. [`factorise`](Self::factorise)
    /// must then be called.
    pub(crate) fn update(
        &mut self,
        data: &ProblemData,
        activity: &[Activity],
        changed: &[usize],
    ) -> bool {
        changed.iter().filter(|&&id| data.norm(id) > 0.0).all(|&id| {
            let done = if activity[id].is_active() {
                self.group_of(data, id)
                    .ok_or(RankInDoubt)
                    .and_then(|group| self.insert(data, activity, id, group))
            } else {
                self.remove(data, id)
            };
            done.is_ok()
        })
    }

    /// Adds an active row to a group. If a rank is in doubt, factors all rows again with pivoting.
    pub(crate) fn add(
        &mut self,
        data: &ProblemData,
        activity: &[Activity],
        id: usize,
        group: usize,
    ) {
        if data.norm(id) > 0.0 && self.insert(data, activity, id, group).is_err() {
            let end = self.groups[group].end;
            self.open(end, group);
            self.stacked[end] = id;
            self.eliminate_again(data, activity);
        }
    }

    /// Removes a row that has become inactive. If a rank is in doubt, factors all rows again with
    /// pivoting.
    pub(crate) fn take_out(&mut self, data: &ProblemData, activity: &[Activity], id: usize) {
        if data.norm(id) > 0.0 && self.remove(data, id).is_err() {
            self.eliminate_again(data, activity);
        }
    }

    /// Inserts a row after the pivots of a group, as one of them if it is independent.
    fn insert(
        &mut self,
        data: &ProblemData,
        activity: &[Activity],
        id: usize,
        group: usize,
    ) -> Result<(), RankInDoubt> {
        self.expect_whole_rows()?;
        self.orthogonal.multiply_out();
        let (n, k) = (self.stride, self.free.len());
        self.rotations.clear();
        self.invalidate_from(group);
        let mut row = std::mem::take(&mut self.turned);
        self.turn_row(data, id, &mut row);
        let target = active_bound(data, activity, id) - self.known[id];
        let at = self.make_room(data, group, &mut row[..k], data.norm(id));
        if let Ok(at) = at {
            self.rows[at * n..at * n + k].copy_from_slice(&row[..k]);
            self.target[at] = target;
            self.stacked[at] = id;
        }
        self.turned = row;
        at.map(|_| ())
    }

    /// Removes a row from the stack, or frees a variable that was removed as a column.
    fn remove(&mut self, data: &ProblemData, id: usize) -> Result<(), RankInDoubt> {
        self.orthogonal.multiply_out();
        self.rotations.clear();
        match self.stacked.iter().position(|&row| row == id) {
            Some(at) => self.unstack(data, at),
            None => self.free_variable(data, id),
        }
    }

    /// Returns an error if the rank neglects parts of rows that may matter for other active rows.
    fn expect_whole_rows(&self) -> Result<(), RankInDoubt> {
        if self.leaves_parts_out { Err(RankInDoubt) } else { Ok(()) }
    }

    /// Rotates the coordinates so that a row, given in them, is triangular after the pivots of
    /// `group`. Returns its place in the stack, which is left open.
    fn make_room(
        &mut self,
        data: &ProblemData,
        group: usize,
        row: &mut [f64],
        size: f64,
    ) -> Result<usize, RankInDoubt> {
        let Group { start, end, rank, first_pivot, .. } = self.groups[group];
        let (place, decided) = (first_pivot + rank, self.pivots.len());
        if !self.tolerances.is_there(norm(&row[place..]) / size)? {
            self.expect_heavy_pivots(data, start..start + rank, size)?;
            self.open(end, group);
            self.renumber();
            return Ok(end);
        }
        let last = if self.tolerances.is_there(norm(&row[decided..]) / size)? {
            self.orthogonal.reflect_free(row, decided);
            decided
        } else {
            let parts = row[place..decided].iter().map(|entry| entry.abs() / size);
            let (last, part) = parts
                .enumerate()
                .rfind(|&(_, part)| part > self.tolerances.nothing)
                .ok_or(RankInDoubt)?;
            self.tolerances.is_there(part)?;
            place + last
        };
        let next = self.pivots.get(place).copied().unwrap_or(self.stacked.len());
        self.turn_towards(row, place..last);
        self.orthogonal.rotate(&self.rotations);
        self.shift_pivots(data, place..last)?;
        if last < decided {
            self.demote(data, last)?;
        }
        // Dependent rows up to the next pivot have no entry along the coordinate that the group
        // gains.
        for at in start + rank..next {
            self.rows[at * self.stride + place] = 0.0;
        }
        self.open(start + rank, group);
        self.groups[group].rank += 1;
        self.renumber();
        Ok(start + rank)
    }

    /// Rotates neighbouring coordinates, from the last to the first. The entries of `row` in
    /// `planes` and the next entry move into the first entry.
    fn turn_towards(&mut self, row: &mut [f64], planes: Range<usize>) {
        let (mut square, mut behind) = (row[planes.end].powi(2), row[planes.end]);
        for first in planes.clone().rev() {
            square += row[first].powi(2);
            let radius = square.sqrt();
            let (cosine, sine) =
                if radius > 0.0 { (row[first] / radius, behind / radius) } else { (1.0, 0.0) };
            self.rotations.push(Rotation { first, second: first + 1, cosine, sine });
            behind = radius;
        }
        if !planes.is_empty() {
            row[planes.start] = behind;
            row[planes.start + 1..=planes.end].fill(0.0);
        }
    }

    /// Applies the current rotations to the rows whose pivots are in `planes` and to all later
    /// rows. The rotations are in these planes from the last to the first. The pivots move up by
    /// one coordinate.
    fn shift_pivots(
        &mut self,
        data: &ProblemData,
        planes: Range<usize>,
    ) -> Result<(), RankInDoubt> {
        let n = self.stride;
        let mut behind = self.pivots.get(planes.end).copied().unwrap_or(self.stacked.len());
        for (index, plane) in planes.rev().enumerate() {
            let at = self.pivots[plane];
            // Rows up to the next pivot have no entry there.
            self.rows[at * n..behind * n].iter_mut().skip(plane + 1).step_by(n).for_each(zero);
            self.rotate_entries(at, self.rotations[index]);
            let pivot = self.rows[at * n + plane + 1].abs();
            if !self.tolerances.is_there(pivot / data.norm(self.stacked[at]))? {
                return Err(RankInDoubt);
            }
            behind = at;
        }
        Ok(())
    }

    /// Rotates two coordinates of the stacked rows from `at` on.
    fn rotate_entries(&mut self, at: usize, rotation: Rotation) {
        let Rotation { first, cosine, sine, .. } = rotation;
        let rows = &mut self.rows[at * self.stride..self.stacked.len() * self.stride];
        for row in rows_mut(rows, self.stride) {
            if let [a, b] = &mut row[first..first + 2] {
                (*a, *b) = (cosine * *a + sine * *b, cosine * *b - sine * *a);
            }
        }
    }

    /// Returns an error if a dependent row of this size is much heavier than one of the pivots
    /// beside it. A heavy row's residual is all rounding where it must balance the residual of a
    /// light pivot.
    fn expect_heavy_pivots(
        &self,
        data: &ProblemData,
        mut pivots: Range<usize>,
        size: f64,
    ) -> Result<(), RankInDoubt> {
        let is_light = |at: usize| size > HEAVIER * data.norm(self.stacked[at]);
        if pivots.any(is_light) { Err(RankInDoubt) } else { Ok(()) }
    }

    /// Moves the row whose pivot is `coordinate` to the dependent rows of its group.
    fn demote(&mut self, data: &ProblemData, coordinate: usize) -> Result<(), RankInDoubt> {
        let (n, at) = (self.stride, self.pivots[coordinate]);
        let index = self.groups.iter().position(|g| (g.start..g.end).contains(&at));
        let index = index.ok_or(RankInDoubt)?;
        let Group { start, rank, purpose, .. } = self.groups[index];
        if purpose == Purpose::Minimised {
            self.expect_heavy_pivots(data, start..start + rank, data.norm(self.stacked[at]))?;
        }
        let group = &mut self.groups[index];
        let pivots = at..group.start + group.rank;
        // Entries after a pivot were never set to zero.
        self.rows[at * n + coordinate + 1..at * n + group.first_pivot + group.rank].fill(0.0);
        group.rank -= 1;
        self.rows[pivots.start * n..pivots.end * n].rotate_left(n);
        self.target[pivots.clone()].rotate_left(1);
        self.stacked[pivots].rotate_left(1);
        Ok(())
    }

    /// Removes a row from the stack.
    fn unstack(&mut self, data: &ProblemData, at: usize) -> Result<(), RankInDoubt> {
        let group =
            self.groups.iter().position(|g| (g.start..g.end).contains(&at)).ok_or(RankInDoubt)?;
        self.invalidate_from(group);
        let Group { start, rank, first_pivot, .. } = self.groups[group];
        let (is_pivot, coordinate) = (at < start + rank, first_pivot + at - start);
        self.close(at, group);
        if is_pivot {
            self.groups[group].rank -= 1;
            self.move_down(data, group, at, coordinate)?;
        }
        self.renumber();
        Ok(())
    }

    /// Rotates the rows from `at` on, whose pivots move down by one coordinate. Coordinate `free`
    /// has no pivot at the start. It ends where a dependent row takes over the free coordinate.
    fn move_down(
        &mut self,
        data: &ProblemData,
        group: usize,
        at: usize,
        free: usize,
    ) -> Result<(), RankInDoubt> {
        let (n, mut at, mut free) = (self.stride, at, free);
        for group in group..self.groups.len() {
            let Group { start, end, rank, .. } = self.groups[group];
            for at in at..start + rank {
                let entry = at * n + free;
                let (a, b) = (self.rows[entry], self.rows[entry + 1]);
                let radius = length(a, b);
                let (first, second) = (free, free + 1);
                let rotation = Rotation { first, second, cosine: a / radius, sine: b / radius };
                self.rotate_entries(at, rotation);
                self.rotations.push(rotation);
                free += 1;
            }
            if self.adopt(data, group, free)? {
                break;
            }
            at = end;
        }
        self.orthogonal.rotate(&self.rotations);
        Ok(())
    }

    /// Makes a dependent row of `group` the pivot of a coordinate without one, if there is such a
    /// row.
    fn adopt(
        &mut self,
        data: &ProblemData,
        group: usize,
        coordinate: usize,
    ) -> Result<bool, RankInDoubt> {
        let (n, Group { start, end, rank, .. }) = (self.stride, self.groups[group].clone());
        let (mut best, mut largest, mut any) = (start + rank, 0.0, false);
        for at in start + rank..end {
            let entry = self.rows[at * n + coordinate].abs();
            if self.tolerances.is_there(entry / data.norm(self.stacked[at]))? {
                any = true;
                if entry > largest {
                    (best, largest) = (at, entry);
                }
            }
        }
        if !any {
            return Ok(false);
        }
        self.swap(start + rank, best);
        self.groups[group].rank += 1;
        Ok(true)
    }

    /// Frees a variable that was at a bound from the start, which adds a coordinate.
    fn free_variable(&mut self, data: &ProblemData, variable: usize) -> Result<(), RankInDoubt> {
        let place = self.bounded.iter().position(|&i| i == variable).ok_or(RankInDoubt)?;
        self.bounded.remove(place);
        let (n, carried) = (self.stride, self.free.len());
        self.free.push(variable);
        self.moved.push((carried, variable));
        self.orthogonal.grow();
        self.invalidate_from(0);
        for (known, id) in self.known.iter_mut().zip(0..data.len()).skip(self.n) {
            *known -= data.coefficients(id)[variable] * self.x[variable];
        }
        let mut adopted = None;
        for group in 0..self.groups.len() {
            let Group { start, end, rank, first_pivot, .. } = self.groups[group];
            for at in start..end {
                let id = self.stacked[at];
                let coefficient = if id < self.n { 0.0 } else { data.coefficients(id)[variable] };
                self.target[at] += coefficient * self.x[variable];
                let width = self.groups[group].width(at);
                let row = &mut self.rows[at * n..(at + 1) * n];
                let mut carry = coefficient;
                // One rotation for each pivot, from the first on.
                for (entry, &Rotation { cosine, sine, .. }) in row.iter_mut().zip(&self.rotations) {
                    (*entry, carry) =
                        (cosine * *entry + sine * carry, cosine * carry - sine * *entry);
                }
                if let Some(place) = adopted {
                    row.copy_within(place..width, place + 1);
                    row[place] = carry;
                } else if at < start + rank {
                    let first = width - 1;
                    let radius = length(row[first], carry);
                    let (cosine, sine) = (row[first] / radius, carry / radius);
                    self.rotations.push(Rotation { first, second: carried, cosine, sine });
                    row[first] = radius;
                } else {
                    row[first_pivot + rank] = carry;
                }
            }
            let place = first_pivot + rank;
            if adopted.is_none() && self.adopt(data, group, place)? {
                adopted = Some(place);
            }
        }
        self.orthogonal.rotate(&self.rotations);
        if let Some(place) = adopted {
            self.orthogonal.move_last(place);
        }
        self.renumber();
        Ok(())
    }

    /// Returns the group to which an active row belongs.
    fn group_of(&self, data: &ProblemData, id: usize) -> Option<usize> {
        if id < self.n {
            return (!self.groups.is_empty()).then_some(0);
        }
        self.groups.iter().position(|group| {
            let rows = &data.levels[group.level];
            match group.purpose {
                Purpose::Held => rows.constraints.contains(&id),
                Purpose::Minimised => rows.objective.contains(&id),
            }
        })
    }

    /// Transforms a row into the coordinates.
    fn turn_row(&mut self, data: &ProblemData, id: usize, row: &mut [f64]) {
        row.fill(0.0);
        match data.row(id).coefficients() {
            Coefficients::Unit(variable) => {
                if let Some(place) = self.free.iter().position(|&free| free == variable) {
                    self.orthogonal.turn_unit(row, place);
                }
            }
            Coefficients::Dense(coefficients) => {
                for (entry, &variable) in row.iter_mut().zip(&self.free) {
                    *entry = coefficients[variable];
                }
                self.orthogonal.turn_rows(row);
            }
        }
    }

    /// Inserts a place into the stack, in `group`. The pivots must be renumbered afterwards.
    fn open(&mut self, at: usize, group: usize) {
        let (n, count) = (self.stride, self.stacked.len());
        self.stacked.insert(at, 0);
        self.rows.copy_within(at * n..count * n, (at + 1) * n);
        self.target.copy_within(at..count, at + 1);
        self.groups[group].end += 1;
        for later in &mut self.groups[group + 1..] {
            later.start += 1;
            later.end += 1;
        }
    }

    /// Removes a place from the stack, in `group`. The pivots must be renumbered afterwards.
    fn close(&mut self, at: usize, group: usize) {
        let (n, count) = (self.stride, self.stacked.len());
        self.stacked.remove(at);
        self.rows.copy_within((at + 1) * n..count * n, at * n);
        self.target.copy_within(at + 1..count, at);
        self.groups[group].end -= 1;
        for later in &mut self.groups[group + 1..] {
            later.start -= 1;
            later.end -= 1;
        }
    }

    /// Recomputes the places of the pivots from the ranks of the groups.
    fn renumber(&mut self) {
        self.pivots.clear();
        for group in &mut self.groups {
            group.first_pivot = self.pivots.len();
            self.pivots.extend(group.start..group.start + group.rank);
        }
    }
}

fn zero(entry: &mut f64) {
    *entry = 0.0;
}

impl Group {
    /// Number of coordinates along which stacked row `at` of the group has entries.
    fn width(&self, at: usize) -> usize {
        self.first_pivot + self.rank.min(at + 1 - self.start)
    }
}
