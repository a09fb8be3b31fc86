//! Problems.

use std::ffi::c_char;

use ahqp_core::{CoefficientMatrix, Hierarchy, Level, LevelId, Objective, Rows};

use crate::failure::{AhqpStatus, Failure, Result, call};
use crate::handle::{free, give, read, write};
use crate::views::{AhqpMatrix, AhqpVector, optional_text};

/// A hierarchical quadratic program: levels of objectives and constraints, highest priority first.
#[derive(Debug, Clone)]
pub struct AhqpHierarchy(pub(crate) Hierarchy);

/// Largest number of variables. Dense factors of more would not fit into memory.
const MOST_VARIABLES: usize = 4096;

/// Creates a hierarchy over `variables` variables, at most 4096, without bounds and levels.
///
/// # Safety
/// `out` points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_hierarchy_new(
    variables: usize,
    out: *mut *mut AhqpHierarchy,
) -> AhqpStatus {
    call(|| {
        let make = || {
            if variables > MOST_VARIABLES {
                let text =
                    format_args!("{variables} variables; there can be {MOST_VARIABLES} at most");
                return Err(Failure::new(AhqpStatus::BadArgument, &text));
            }
            Ok(AhqpHierarchy(Hierarchy::new(variables)?))
        };
        // SAFETY: the caller's promise.
        unsafe { give(out, make) }
    })
}

/// Frees a hierarchy. A null pointer is allowed.
///
/// # Safety
/// `hierarchy` came from `ahqp_hierarchy_new` and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_hierarchy_free(hierarchy: *mut AhqpHierarchy) {
    // SAFETY: the caller's promise.
    unsafe { free(hierarchy) }
}

/// Sets the bounds of the variables, one number for each, ±INFINITY where there is no bound. They hold at every level.
/// A null pointer leaves the lower or the upper bounds unchanged.
///
/// # Safety
/// The handle is valid; the vectors point to the numbers that they describe.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_hierarchy_set_bounds(
    hierarchy: *mut AhqpHierarchy,
    lower: AhqpVector,
    upper: AhqpVector,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let hierarchy = &mut unsafe { write("the hierarchy", hierarchy) }?.0;
        let n = hierarchy.variables();
        // SAFETY: the caller's promise.
        let new_lower = unsafe { lower.optional("the lower bound", n) }?;
        // SAFETY: the caller's promise.
        let new_upper = unsafe { upper.optional("the upper bound", n) }?;
        let (lower, upper) = hierarchy.bounds_mut();
        copy(lower, new_lower);
        copy(upper, new_upper);
        Ok(AhqpStatus::Ok)
    })
}

/// Adds a level below all present ones: rows lower ≤ A x ≤ upper. Equal bounds make equalities; a null pointer means
/// that there are no bounds.
///
/// `hard` rows must hold on this level and all below. The violation of other rows is minimised. `name` is used in
/// errors and may be null. The number of the level is written to `level`, which may be null.
///
/// # Safety
/// The handle is valid; matrix and vectors point to the numbers that they describe; the text ends with a zero byte;
/// `level` points to room or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_hierarchy_push(
    hierarchy: *mut AhqpHierarchy,
    a: AhqpMatrix,
    lower: AhqpVector,
    upper: AhqpVector,
    hard: bool,
    name: *const c_char,
    level: *mut usize,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let hierarchy = &mut unsafe { write("the hierarchy", hierarchy) }?.0;
        // SAFETY: the caller's promise.
        let (a, name) = unsafe { (a.required("A")?, optional_text("the name", name)?) };
        let count = a.nrows();
        // SAFETY: the caller's promise.
        let lower = unsafe { lower.optional("the lower bound", count) }?;
        // SAFETY: the caller's promise.
        let upper = unsafe { upper.optional("the upper bound", count) }?;
        let mut rows = Rows::at_most(&a, &vec![f64::INFINITY; count])?;
        copy(rows.lower_mut(), lower);
        copy(rows.upper_mut(), upper);
        let new = if hard { Level::constraints_only(rows) } else { Level::least_squares(rows) };
        // SAFETY: the caller's promise.
        unsafe { push(hierarchy, new, name, level) }
    })
}

/// Adds a level that minimises ½ xᵀ H x + gᵀ x. H is n × n, symmetric and positive semidefinite.
///
/// # Safety
/// See `ahqp_hierarchy_push`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_hierarchy_push_quadratic(
    hierarchy: *mut AhqpHierarchy,
    h: AhqpMatrix,
    g: AhqpVector,
    name: *const c_char,
    level: *mut usize,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let hierarchy = &mut unsafe { write("the hierarchy", hierarchy) }?.0;
        // SAFETY: the caller's promise.
        let (h, name) = unsafe { (h.required("H")?, optional_text("the name", name)?) };
        // SAFETY: the caller's promise.
        let g = unsafe { g.required("g", hierarchy.variables()) }?;
        let new = Level::quadratic(&h, g)?;
        // SAFETY: the caller's promise.
        unsafe { push(hierarchy, new, name, level) }
    })
}

/// # Safety
/// `out` points to room or is null.
unsafe fn push(
    hierarchy: &mut Hierarchy,
    level: Level,
    name: Option<&str>,
    out: *mut usize,
) -> Result<AhqpStatus> {
    let level = match name {
        Some(name) => level.named(name),
        None => level,
    };
    let id = hierarchy.push(level)?;
    if !out.is_null() {
        // SAFETY: not null; the caller promises room.
        unsafe { *out = id.index() };
    }
    Ok(AhqpStatus::Ok)
}

/// Replaces data of a level of rows by data of equal sizes. Null pointers leave the data unchanged. Allocates nothing,
/// except for the first weights of a level.
///
/// # Safety
/// The handle is valid; matrix and vectors point to the numbers that they describe.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_hierarchy_update(
    hierarchy: *mut AhqpHierarchy,
    level: usize,
    a: AhqpMatrix,
    lower: AhqpVector,
    upper: AhqpVector,
    weights: AhqpVector,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let hierarchy = &mut unsafe { write("the hierarchy", hierarchy) }?.0;
        let id = id(hierarchy, level)?;
        let only_constrains = matches!(hierarchy.level(id)?.objective(), Objective::None);
        let rows = if only_constrains {
            hierarchy.constraints_mut(id)?
        } else {
            hierarchy.rows_mut(id)?
        };
        let count = rows.len();
        // SAFETY: the caller's promise.
        let a = unsafe { a.optional("A") }?;
        // SAFETY: the caller's promise.
        let lower = unsafe { lower.optional("the lower bound", count) }?;
        // SAFETY: the caller's promise.
        let upper = unsafe { upper.optional("the upper bound", count) }?;
        // SAFETY: the caller's promise.
        let weights = unsafe { weights.optional("the weights", count) }?;
        if let Some(a) = a {
            rows.set_matrix(&a)?;
        }
        if let Some(weights) = weights {
            rows.set_weights(weights)?;
        }
        if lower.is_some() {
            copy(rows.lower_mut(), lower);
        }
        if upper.is_some() {
            copy(rows.upper_mut(), upper);
        }
        Ok(AhqpStatus::Ok)
    })
}

/// Computes the violation √(Σ wᵢ dᵢ²) of a level at x, where dᵢ is the distance of row i to its range. It is zero for
/// levels without rows to minimise.
///
/// # Safety
/// The handle is valid; the vector points to the numbers that it describes; `violation` points to room for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_hierarchy_violation(
    hierarchy: *const AhqpHierarchy,
    level: usize,
    x: AhqpVector,
    violation: *mut f64,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let hierarchy = &unsafe { read("the hierarchy", hierarchy) }?.0;
        // SAFETY: the caller's promise.
        let x = unsafe { x.required("x", hierarchy.variables()) }?;
        // SAFETY: the caller's promise.
        let [out] = unsafe { crate::views::output("where to put the violation", violation, 1, 1) }?
        else {
            return Ok(AhqpStatus::Ok);
        };
        *out = hierarchy.level(id(hierarchy, level)?)?.violation(x)?;
        Ok(AhqpStatus::Ok)
    })
}

fn id(hierarchy: &Hierarchy, level: usize) -> Result<LevelId> {
    hierarchy.ids().nth(level).ok_or_else(|| {
        let levels = hierarchy.levels().len();
        let text = format_args!("there is no level {level}: there are {levels}, counted from 0");
        Failure::new(AhqpStatus::BadArgument, &text)
    })
}

fn copy(to: &mut [f64], from: Option<&[f64]>) {
    to.iter_mut().zip(from.unwrap_or(&[])).for_each(|(to, from)| *to = *from);
}
