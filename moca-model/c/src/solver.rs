//! The solver.

use std::ffi::c_char;
use std::fmt::Write;
use std::time::Duration;

use ahqp_core::{Budget, Settings, Solver, WarmStart};

use crate::failure::{AhqpStatus, Failure, call, status};
use crate::handle::{free, give, read, write};
use crate::hierarchy::AhqpHierarchy;
use crate::views::output;

/// Solver for hierarchies of one shape. Each solve starts from the result of the one before.
#[derive(Debug)]
pub struct AhqpSolver {
    solver: Solver,
    iterations: usize,
}

/// Settings of the solver. `ahqp_settings_default` returns the default values.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct AhqpSettings {
    /// Largest number of iterations of one solve, at least 1.
    pub max_iterations: usize,
    /// Violation below which a constraint holds, relative to its terms.
    pub feasibility_tolerance: f64,
    /// Fraction of a row's norm. A row depends on others if the part that they do not span is smaller.
    pub rank_tolerance: f64,
    /// Size beyond which a multiplier of the wrong sign frees its row.
    pub optimality_tolerance: f64,
    /// True if a solve starts from the active set of the one before.
    pub warm_start: bool,
}

/// Returns the default settings.
#[unsafe(no_mangle)]
pub extern "C" fn ahqp_settings_default() -> AhqpSettings {
    let settings = Settings::default();
    AhqpSettings {
        max_iterations: settings.max_iterations,
        feasibility_tolerance: settings.feasibility_tolerance,
        rank_tolerance: settings.rank_tolerance,
        optimality_tolerance: settings.optimality_tolerance,
        warm_start: settings.warm_start == WarmStart::PreviousActiveSet,
    }
}

/// Creates a solver for hierarchies with the shape of this one. Null settings are the default ones.
///
/// # Safety
/// The hierarchy is valid; `settings` points to settings or is null; `out` points to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_solver_new(
    hierarchy: *const AhqpHierarchy,
    settings: *const AhqpSettings,
    out: *mut *mut AhqpSolver,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (hierarchy, settings) =
            unsafe { (read("the hierarchy", hierarchy)?, settings.as_ref()) };
        let settings = settings.copied().unwrap_or_else(|| ahqp_settings_default());
        let settings = Settings {
            max_iterations: settings.max_iterations,
            feasibility_tolerance: settings.feasibility_tolerance,
            rank_tolerance: settings.rank_tolerance,
            optimality_tolerance: settings.optimality_tolerance,
            warm_start: if settings.warm_start {
                WarmStart::PreviousActiveSet
            } else {
                WarmStart::Cold
            },
            ..Settings::default()
        };
        let make =
            || Ok(AhqpSolver { solver: Solver::new(&hierarchy.0, settings)?, iterations: 0 });
        // SAFETY: the caller's promise.
        unsafe { give(out, make) }
    })
}

/// Frees a solver. A null pointer is allowed.
///
/// # Safety
/// `solver` came from `ahqp_solver_new` and is not used again.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_solver_free(solver: *mut AhqpSolver) {
    // SAFETY: the caller's promise.
    unsafe { free(solver) }
}

/// Solves a hierarchy of the shape that the solver was made for, and writes x. `iterations` limits the iterations (0:
/// the limit of the settings) and `time` the time \[s\] (0: no limit). Allocates nothing, unless it returns an error.
///
/// Returns `AHQP_STATUS_OK` at the optimum, or `…_LIMIT` with the best x so far.
///
/// # Safety
/// The handles are valid; `x` points to `size` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_solver_solve(
    solver: *mut AhqpSolver,
    hierarchy: *const AhqpHierarchy,
    iterations: usize,
    time: f64,
    x: *mut f64,
    size: usize,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (solver, hierarchy) =
            unsafe { (write("the solver", solver)?, &read("the hierarchy", hierarchy)?.0) };
        // SAFETY: the caller's promise.
        let x = unsafe { output("x", x, size, hierarchy.variables()) }?;
        let time = Duration::try_from_secs_f64(time).map_err(|_| {
            let text = format_args!("time is {time} s; it must be finite and not negative");
            Failure::new(AhqpStatus::BadArgument, &text)
        })?;
        let budget = Budget {
            iterations: (iterations > 0).then_some(iterations),
            time: (!time.is_zero()).then_some(time),
        };
        let solution = solver.solver.solve_within(hierarchy, budget)?;
        solver.iterations = solution.iterations();
        // A solver that was made for this shape has as many variables.
        x.iter_mut().zip(solution.best()).for_each(|(to, from)| *to = *from);
        Ok(status(solution.status()))
    })
}

/// Returns the number of iterations of the last solve; 0 for null.
///
/// # Safety
/// The handle is valid or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_solver_iterations(solver: *const AhqpSolver) -> usize {
    // SAFETY: the caller's promise.
    unsafe { solver.as_ref() }.map_or(0, |solver| solver.iterations)
}

/// Returns the number of rows that cannot hold together, after a solve that returned `AHQP_STATUS_INFEASIBLE`; else 0.
///
/// # Safety
/// The handle is valid or null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_solver_conflict_count(solver: *const AhqpSolver) -> usize {
    // SAFETY: the caller's promise.
    unsafe { solver.as_ref() }.map_or(0, |solver| solver.solver.conflict().len())
}

/// Describes one of these rows in words: UTF-8 with a zero byte at its end, cut if it does not fit.
///
/// # Safety
/// The handles are valid; `text` points to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ahqp_solver_conflict_row(
    solver: *const AhqpSolver,
    hierarchy: *const AhqpHierarchy,
    index: usize,
    text: *mut c_char,
    size: usize,
) -> AhqpStatus {
    call(|| {
        // SAFETY: the caller's promise.
        let (solver, hierarchy) =
            unsafe { (read("the solver", solver)?, &read("the hierarchy", hierarchy)?.0) };
        if text.is_null() {
            return Err(Failure::null("the buffer"));
        }
        let rows = solver.solver.conflict();
        let Some(row) = rows.get(index) else {
            return Err(Failure::size("the list of rows that conflict", rows.len(), index + 1));
        };
        let mut words = String::new();
        // Writing into a string does not fail.
        let _ = write!(words, "{}", hierarchy.describe(*row));
        let Some(room) = size.checked_sub(1) else { return Err(Failure::size("the buffer", 0, 1)) };
        let end = (0..=words.len().min(room)).rev().find(|&end| words.is_char_boundary(end));
        let end = end.unwrap_or(0);
        // SAFETY: the caller promises `size` bytes, and end < size; the two do not overlap.
        unsafe {
            std::ptr::copy_nonoverlapping(words.as_ptr(), text.cast(), end);
            *text.add(end) = 0;
        }
        Ok(AhqpStatus::Ok)
    })
}
