//! Problems.

use std::ffi::c_char;

use ahqp_core::{CoefficientMatrix, Hierarchy, Level, LevelId, Objective, Rows};

use crate::failure::{AhqpStatus, Failure, Result, call};
use crate::handle::{free, give, read, write};
use crate::views::{AhqpMatrix, AhqpVector, optional_text};

/// A hierarchical quadratic programme: levels of objectives and constraints, highest priority first.
#[derive(Debug, Clone)]
pub struct AhqpHierarchy(pub(crate) Hierarchy);

/// Dense factors of more variables would not fit into memory.
const MOST_VARIABLES: usize = 4096;

/// Makes a hierarchy over so many variables, at most 4096, without bounds and levels.
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

/// Frees a hierarchy. Null is none.
///
/// # Safety
/// `hierarchy` came from `ahqp_hierarchy_new` and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_hierarchy_free(hierarchy: *mut AhqpHierarchy) {
    // SAFETY: the caller's promise.
    unsafe { free(hierarchy) }
}

/// Sets the bounds of the variables, one number each, ±INFINITY where there is none. They hold at every
/// level. A null pointer leaves a side as it is.
///
/// # Safety
/// The handle is valid; the vectors are what they say.
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

/// Adds a level below all present ones: rows lower ≤ A x ≤ upper. Equal bounds make equalities; a null
/// pointer stands for no bounds. `hard` rows must hold from this level down, else their violation is
/// minimised. `name`, null for none, is for errors. `level`, null if it does not matter, is where to put
/// the number of the level.
///
/// # Safety
/// The handle is valid; matrix, vectors and text are what they say; `level` points to room or is null.
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

/// Adds a level that minimises ½ xᵀ H x + gᵀ x, H being n × n, symmetric and positive semidefinite.
///
/// # Safety
/// As of `ahqp_hierarchy_push`.
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

/// Rewrites data of a level of rows, in the same sizes; what is null stays. Allocates nothing, but the
/// first weights of a level do.
///
/// # Safety
/// The handle is valid; matrix and vectors are what they say.
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

/// √(Σ wᵢ dᵢ²) of a level at x, dᵢ being the distance of row i to its range; zero for levels without rows
/// to minimise.
///
/// # Safety
/// The handle is valid; the vector is what it says; `violation` points to room for a number.
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
