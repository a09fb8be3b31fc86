//! Numbers of samples, group by group, in bounded memory.

/// Encoding of a group in a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// 32-bit floats.
    Exact,
    /// 65535 steps between the least and the greatest value of each column, for values that are only displayed.
    Steps,
}

/// Columns that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name of the group.
    pub name: &'static str,
    /// Names of its columns.
    pub columns: Vec<String>,
    /// Numbers per column: 1, 3 for a point, 7 for a pose.
    pub size: usize,
    /// Encoding in a page.
    pub encoding: Encoding,
}

impl Group {
    /// Creates a group of columns with `size` numbers each.
    pub fn new(name: &'static str, columns: &[&str], size: usize, encoding: Encoding) -> Self {
        let columns = columns.iter().map(|&column| column.to_owned()).collect();
        Self { name, columns, size, encoding }
    }

    /// Returns the number of values that the group has in a row.
    pub fn width(&self) -> usize {
        self.columns.len() * self.size
    }
}

/// A row of numbers for each sample. NaN marks unknown values.
///
/// A table has at most [`Table::MOST`] rows. When it is full, every second row is removed, and later samples are
/// thinned out equally. Memory is thus at most `MOST` rows of 4 bytes a number.
///
/// ```
/// use moca_replay::recorded::{Encoding, Group, Table};
///
/// let mut table = Table::new(vec![Group::new("series", &["score"], 1, Encoding::Exact)]);
/// for tick in 0..20_000_u16 {
///     table.push(f64::from(tick), &[f32::from(tick)]);
/// }
/// assert!(table.len() <= Table::MOST && table.len() > Table::MOST / 2);
/// assert_eq!(table.times()[1], f64::from(table.row(1)[0]));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    groups: Vec<Group>,
    width: usize,
    times: Vec<f64>,
    values: Vec<f32>,
    /// Number of samples of which one is kept.
    stride: usize,
    /// Number of samples to leave out before the next one that is kept.
    left_out: usize,
}

impl Table {
    /// Largest number of rows: two minutes at 50 samples a second.
    pub const MOST: usize = 6000;

    /// Creates a table without rows.
    pub fn new(groups: Vec<Group>) -> Self {
        let width = groups.iter().map(Group::width).sum();
        Self { groups, width, times: Vec::new(), values: Vec::new(), stride: 1, left_out: 0 }
    }

    /// Adds a sample: its time \[s\] and the numbers of all columns. Missing numbers count as unknown.
    pub fn push(&mut self, time: f64, row: &[f32]) {
        if self.left_out > 0 {
            self.left_out -= 1;
            return;
        }
        if self.times.len() == Self::MOST {
            self.halve();
        }
        self.left_out = self.stride - 1;
        self.times.push(time);
        let missing = std::iter::repeat(&f32::NAN);
        self.values.extend(row.iter().chain(missing).take(self.width));
    }

    fn halve(&mut self) {
        let width = self.width;
        let kept = self.times.len().div_ceil(2);
        for index in 1..kept {
            self.times.swap(index, 2 * index);
            self.values.copy_within(2 * index * width..(2 * index + 1) * width, index * width);
        }
        self.times.truncate(kept);
        self.values.truncate(kept * width);
        self.stride *= 2;
    }

    /// Adds a group to a table that may have rows. `value` returns the group's numbers in a row.
    pub(super) fn add_group(&mut self, group: Group, value: impl Fn(usize, &[f32]) -> Vec<f32>) {
        let added = group.width();
        let mut values = Vec::with_capacity(self.len() * (self.width + added));
        for index in 0..self.len() {
            let row = self.row(index);
            values.extend_from_slice(row);
            let missing = std::iter::repeat(f32::NAN);
            values.extend(value(index, row).into_iter().chain(missing).take(added));
        }
        self.values = values;
        self.width += added;
        self.groups.push(group);
    }

    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Returns true if there is no row.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Returns the time of each row \[s\].
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the groups, in the order of their columns.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// Returns a row; empty after the last one.
    pub fn row(&self, index: usize) -> &[f32] {
        self.values.get(index * self.width..(index + 1) * self.width).unwrap_or_default()
    }

    /// Returns each group with the place of its first column in a row.
    pub(crate) fn group_places(&self) -> impl Iterator<Item = (usize, &Group)> {
        self.groups.iter().scan(0, |place, group| {
            let begin = *place;
            *place += group.width();
            Some((begin, group))
        })
    }

    /// Returns the place of a column in a row; `None` if there is no such column.
    pub fn place(&self, group: &str, column: &str) -> Option<usize> {
        let (begin, group) = self.group_places().find(|(_, known)| known.name == group)?;
        let index = group.columns.iter().position(|known| known == column)?;
        Some(begin + index * group.size)
    }
}
