//! Sparse tensors: the file holds only the elements that are not zero. `DENSIFY` expands them.
//!
//! Each axis, in the order of traversal, is dense or lists the positions of its elements. The
//! elements of the i-th entry of the previous axis are from `segments[i]` to `segments[i + 1]` in
//! `indices`.

use planus::Vector;

use crate::error::Error;

use super::schema::Table;

/// An axis in the order of traversal.
enum Axis<'a> {
    Dense(usize),
    Sparse { segments: Indices<'a>, indices: Indices<'a> },
}

/// An axis with its position in the dense tensor.
struct Level<'a> {
    axis: Axis<'a>,
    length: usize,
    stride: usize,
}

/// Numbers of one, two or four bytes.
enum Indices<'a> {
    Bytes(&'a [u8]),
    Shorts(Vector<'a, u16>),
    Words(Vector<'a, i32>),
}

impl<'a> Indices<'a> {
    /// Reads the union of index vectors whose type and value are in these fields.
    fn of(table: &Table<'a>, field: usize) -> Result<Self, String> {
        let text = |error: Error| error.to_string();
        let name = "indices of a sparse axis";
        let kind: u8 = table.number(field, name).map_err(text)?;
        let values = table.table(field + 1, name).map_err(text)?;
        let values = values.ok_or("a sparse axis without indices")?;
        match kind {
            1 => values.numbers(0, name).map(Self::Words).map_err(text),
            2 => values.numbers(0, name).map(Self::Shorts).map_err(text),
            3 => values.bytes(0, name).map(Self::Bytes).map_err(text),
            kind => Err(format!("indices of a sparse axis are of type {kind}")),
        }
    }

    fn get(&self, index: usize) -> Option<usize> {
        match self {
            Self::Bytes(values) => values.get(index).map(|&value| value.into()),
            Self::Shorts(values) => values.get(index).map(usize::from),
            Self::Words(values) => values.get(index).and_then(|value| value.try_into().ok()),
        }
    }
}

/// Returns the number of stored elements of a sparse tensor of this shape, at most one more than
/// `stored`. The error says what is wrong with their positions.
pub(super) fn check(table: &Table<'_>, shape: &[usize], stored: usize) -> Result<usize, String> {
    let mut count = 0;
    let mut visit = |_| {
        count += 1;
        if count > stored { Err(format!("more places than its {stored} elements")) } else { Ok(()) }
    };
    walk(&levels(table, shape)?, [0, 0], &mut visit)?;
    Ok(count)
}

/// Returns the dense tensor.
pub(super) fn spread(
    table: &Table<'_>,
    shape: &[usize],
    stored: &[f32],
) -> Result<Vec<f32>, String> {
    let mut dense = vec![0.0; shape.iter().product()];
    let mut values = stored.iter();
    let mut visit = |place: usize| {
        let (Some(target), Some(&value)) = (dense.get_mut(place), values.next()) else {
            return Err("more places than elements".into());
        };
        *target = value;
        Ok(())
    };
    walk(&levels(table, shape)?, [0, 0], &mut visit)?;
    Ok(dense)
}

fn levels<'a>(table: &Table<'a>, shape: &[usize]) -> Result<Vec<Level<'a>>, String> {
    let text = |error: Error| error.to_string();
    let order = table.numbers::<i32>(0, "traversal order").map_err(text)?;
    let blocks = table.numbers::<i32>(1, "block map").map_err(text)?;
    let axes = table.tables(2, "axes of a sparse tensor").map_err(text)?;
    if !blocks.is_empty() {
        return Err("it is sparse in blocks: only single elements are read".into());
    }
    let mut left: Vec<_> = shape.iter().copied().map(Some).collect();
    if order.len() != shape.len() || axes.len() != shape.len() {
        return Err(format!("it is sparse along {} of {} axes", axes.len(), shape.len()));
    }
    let mut levels = Vec::with_capacity(axes.len());
    for (index, axis) in order.iter().enumerate() {
        let axis = usize::try_from(axis).unwrap_or(usize::MAX);
        let length = left.get_mut(axis).and_then(Option::take);
        let length = length.ok_or_else(|| format!("axis {axis} is traversed twice or is none"))?;
        let stride = shape[axis + 1..].iter().product();
        let axis = axes.get(index, "axis of a sparse tensor").map_err(text)?;
        let axis = match axis.number::<i8>(0, "format of an axis").map_err(text)? {
            0 => {
                let size: i32 = axis.number(1, "size of an axis").map_err(text)?;
                if usize::try_from(size).ok() != Some(length) {
                    return Err(format!("an axis of {size} is traversed where there are {length}"));
                }
                Axis::Dense(length)
            }
            1 => Axis::Sparse { segments: Indices::of(&axis, 2)?, indices: Indices::of(&axis, 4)? },
            format => return Err(format!("an axis is of format {format}")),
        };
        levels.push(Level { axis, length, stride });
    }
    Ok(levels)
}

/// Visits the position of every stored element, in order, below an entry of the previous axis and
/// its position.
fn walk(
    levels: &[Level<'_>],
    [entry, place]: [usize; 2],
    visit: &mut dyn FnMut(usize) -> Result<(), String>,
) -> Result<(), String> {
    let Some((level, rest)) = levels.split_first() else { return visit(place) };
    match &level.axis {
        Axis::Dense(length) => (0..*length).try_for_each(|index| {
            walk(rest, [entry * length + index, place + index * level.stride], visit)
        }),
        Axis::Sparse { segments, indices } => {
            let (Some(start), Some(end)) = (segments.get(entry), segments.get(entry + 1)) else {
                return Err(format!("segment {entry} of a sparse axis is not there"));
            };
            (start..end).try_for_each(|entry| {
                let index = indices.get(entry).filter(|&index| index < level.length);
                let outside = || format!("index {entry} of a sparse axis is not there, or outside");
                let index = index.ok_or_else(outside)?;
                walk(rest, [entry, place + index * level.stride], visit)
            })
        }
    }
}
