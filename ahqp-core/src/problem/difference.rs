//! What differs between two hierarchies of the same shape.

use super::hierarchy::Hierarchy;
use super::ids::LevelId;
use super::level::{Level, Objective};
use super::rows::Rows;
use super::source::{ConstraintSource, Names};
use crate::error::Error;

/// An error that names the first difference of two hierarchies unless both hold the same numbers.
pub(crate) fn expect_equal(hierarchy: &Hierarchy, other: &Hierarchy) -> Result<(), Error> {
    let (levels, others) = (hierarchy.levels(), other.levels());
    if hierarchy.variables() != other.variables() || levels.len() != others.len() {
        return Err(shape_changed(LevelId::new(levels.len().min(others.len()))));
    }
    let bounds = |hierarchy: &Hierarchy, i: usize| (hierarchy.lower()[i], hierarchy.upper()[i]);
    let variables = 0..hierarchy.variables();
    if let Some(variable) =
        variables.into_iter().find(|&i| bounds(hierarchy, i) != bounds(other, i))
    {
        return Err(data_changed(ConstraintSource::Bound { variable }));
    }
    let pairs = levels.iter().zip(others).enumerate();
    pairs.into_iter().try_for_each(|(index, (level, other))| {
        expect_equal_levels(level, other, LevelId::new(index))
    })
}

fn expect_equal_levels(data: &Level, other: &Level, level: LevelId) -> Result<(), Error> {
    if let Some(row) = difference(data.constraints(), other.constraints(), level)? {
        return Err(data_changed(ConstraintSource::Constraint { level, row }));
    }
    let changed = match (data.objective(), other.objective()) {
        (Objective::None, Objective::None) => None,
        (Objective::LeastSquares(rows), Objective::LeastSquares(others)) => {
            difference(rows, others, level)?
        }
        (
            Objective::Quadratic { hessian: h, gradient: g },
            Objective::Quadratic { hessian: others_h, gradient: others_g },
        ) if h.shape() == others_h.shape() && g.len() == others_g.len() => {
            (0..g.len()).find(|&i| h.row(i) != others_h.row(i) || g[i] != others_g[i])
        }
        _ => return Err(shape_changed(level)),
    };
    changed.map_or(Ok(()), |row| Err(data_changed(ConstraintSource::Objective { level, row })))
}

/// The first row that differs, of blocks of the same shape.
fn difference(rows: &Rows, others: &Rows, level: LevelId) -> Result<Option<usize>, Error> {
    if (rows.len(), rows.columns()) != (others.len(), others.columns()) {
        return Err(shape_changed(level));
    }
    let differs = |&i: &usize| {
        rows.row(i) != others.row(i)
            || (rows.lower()[i], rows.upper()[i]) != (others.lower()[i], others.upper()[i])
            || rows.weight(i) != others.weight(i)
    };
    Ok((0..rows.len()).find(differs))
}

fn shape_changed(level: LevelId) -> Error {
    Error::ShapeChanged { level, names: Names::default() }
}

fn data_changed(source_of_row: ConstraintSource) -> Error {
    Error::DataChanged { source_of_row, names: Names::default() }
}
