//! Problems.

use ahqp_core::{Level, LevelId, Rows};
use numpy::{PyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{Matrix, to_vector, vector, vector_of};
use crate::failure::{Failure, Result};
use crate::shared::Shared;

/// Largest number of variables. Dense factors of more would not fit into memory.
const MOST_VARIABLES: usize = 4096;

/// A hierarchical quadratic program over n variables: levels of objectives and constraints, highest
/// priority first.
///
/// It lexicographically minimises the levels' objectives, subject to the bounds of the variables and the hard
/// constraints of a level and of those above it. Directions that no level determines take the least norm.
///
/// >>> import ahqp
/// >>> hierarchy = ahqp.Hierarchy(2)
/// >>> hierarchy.set_bounds([-1.0, -1.0], [1.5, 9.0])
/// >>> total = hierarchy.push([[1.0, 1.0]], [2.0], [2.0], name="total")
/// >>> near = hierarchy.push([[1.0, 0.0]], [5.0], [5.0], name="near")
/// >>> ahqp.Solver(hierarchy).solve(hierarchy).x.round(12).tolist()
/// [1.5, 0.5]
#[pyclass(frozen, module = "ahqp")]
pub(crate) struct Hierarchy(pub(crate) Shared<Problem>);

/// A problem, and the number of its changes.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    pub(crate) hierarchy: ahqp_core::Hierarchy,
    pub(crate) changes: u64,
}

impl Problem {
    /// Returns the problem for changes.
    fn change(&mut self) -> &mut ahqp_core::Hierarchy {
        self.changes += 1;
        &mut self.hierarchy
    }
}

impl Hierarchy {
    pub(crate) fn of(hierarchy: ahqp_core::Hierarchy) -> Self {
        Self(Shared::new("hierarchy", Problem { hierarchy, changes: 0 }))
    }
}

/// Creates a hierarchy without levels.
pub(crate) fn new(variables: usize) -> Result<ahqp_core::Hierarchy> {
    if variables > MOST_VARIABLES {
        return Err(Failure::value(format!(
            "there are {variables} variables; there can be {MOST_VARIABLES} at most"
        )));
    }
    Ok(ahqp_core::Hierarchy::new(variables)?)
}

#[pymethods]
impl Hierarchy {
    #[new]
    fn py_new(variables: usize) -> Result<Self> {
        Ok(Self::of(new(variables)?))
    }

    /// The number n of variables.
    #[getter]
    fn variables(&self) -> Result<usize> {
        Ok(self.0.lock()?.hierarchy.variables())
    }

    /// The names of the levels, highest priority first; None for levels without a name.
    #[getter]
    fn names(&self) -> Result<Vec<Option<String>>> {
        let problem = self.0.lock()?;
        let hierarchy = &problem.hierarchy;
        Ok(hierarchy.levels().iter().map(|level| level.name().map(str::to_owned)).collect())
    }

    /// The number of levels.
    fn __len__(&self) -> Result<usize> {
        Ok(self.0.lock()?.hierarchy.levels().len())
    }

    /// The lower bounds of the variables, shape (n,); -inf where there is no bound.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        Ok(to_vector(py, self.0.lock()?.hierarchy.lower()))
    }

    /// The upper bounds of the variables, shape (n,); inf where there is no bound.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyArray1<f64>>> {
        Ok(to_vector(py, self.0.lock()?.hierarchy.upper()))
    }

    /// Gives every variable a name, for errors and conflicts.
    fn name_variables(&self, names: Vec<String>) -> Result<()> {
        Ok(self.0.lock()?.change().name_variables(names)?)
    }

    /// Sets the bounds of the variables, shape (n,) each; they hold at every level. None means no bounds.
    #[pyo3(signature = (lower=None, upper=None))]
    fn set_bounds(
        &self,
        lower: Option<&Bound<'_, PyAny>>,
        upper: Option<&Bound<'_, PyAny>>,
    ) -> Result<()> {
        set_bounds(self.0.lock()?.change(), ["lower", "upper"], lower, upper)
    }

    /// Adds a level below all present ones: rows lower ≤ A x ≤ upper.
    ///
    /// Parameters
    /// ----------
    /// A : array_like, shape (m, n)
    /// lower, upper : array_like, shape (m,), optional
    ///     Equal for equalities; ±inf, or None for all rows, where there is no bound.
    /// hard : bool
    ///     Whether the rows must hold on this level and all below; else their violation is minimised.
    /// weights : array_like, shape (m,), optional
    ///     Relative weights of the rows: ½ Σ wᵢ dᵢ² is minimised. They have no effect on hard rows.
    /// name : str, optional
    ///     Name of the level in errors and conflicts.
    ///
    /// Returns
    /// -------
    /// int
    ///     The number of the level, for `update`.
    #[pyo3(signature = (A, lower=None, upper=None, *, hard=false, weights=None, name=None))]
    #[allow(non_snake_case)]
    fn push(
        &self,
        A: &Bound<'_, PyAny>,
        lower: Option<&Bound<'_, PyAny>>,
        upper: Option<&Bound<'_, PyAny>>,
        hard: bool,
        weights: Option<&Bound<'_, PyAny>>,
        name: Option<String>,
    ) -> Result<usize> {
        let mut problem = self.0.lock()?;
        let hierarchy = problem.change();
        let matrix = Matrix::read("A", A)?;
        let mut rows = Rows::at_most(&matrix.view(), &free(&matrix))?;
        update_rows(&mut rows, None, lower, upper, weights)?;
        let level = if hard { Level::constraints_only(rows) } else { Level::least_squares(rows) };
        push(hierarchy, level, name)
    }

    /// Adds a level that minimises ½ xᵀ H x + gᵀ x, H of shape (n, n), symmetric and positive
    /// semidefinite, g of shape (n,). Returns the number of the level.
    #[pyo3(signature = (H, g, *, name=None))]
    #[allow(non_snake_case)]
    fn push_quadratic(
        &self,
        H: &Bound<'_, PyAny>,
        g: &Bound<'_, PyAny>,
        name: Option<String>,
    ) -> Result<usize> {
        let mut problem = self.0.lock()?;
        let hierarchy = problem.change();
        let (hessian, gradient) = (Matrix::read("H", H)?, vector("g", g)?);
        push(hierarchy, Level::quadratic(&hessian.view(), gradient.as_array().iter())?, name)
    }

    /// Replaces data of a level that `push` returned, in equal shapes. None leaves data unchanged.
    #[pyo3(signature = (level, *, A=None, lower=None, upper=None, weights=None))]
    #[allow(non_snake_case)]
    fn update(
        &self,
        level: usize,
        A: Option<&Bound<'_, PyAny>>,
        lower: Option<&Bound<'_, PyAny>>,
        upper: Option<&Bound<'_, PyAny>>,
        weights: Option<&Bound<'_, PyAny>>,
    ) -> Result<()> {
        let mut problem = self.0.lock()?;
        let hierarchy = problem.change();
        let id = id(hierarchy, level)?;
        let level = hierarchy.level_mut(id)?;
        let rows = if matches!(level.objective(), ahqp_core::Objective::None) {
            level.constraints_mut()
        } else {
            hierarchy.rows_mut(id)?
        };
        update_rows(rows, A, lower, upper, weights)
    }

    /// Replaces data of a level that `push_quadratic` returned, in equal shapes. None leaves data unchanged.
    #[pyo3(signature = (level, *, H=None, g=None))]
    #[allow(non_snake_case)]
    fn update_quadratic(
        &self,
        level: usize,
        H: Option<&Bound<'_, PyAny>>,
        g: Option<&Bound<'_, PyAny>>,
    ) -> Result<()> {
        let mut problem = self.0.lock()?;
        let hierarchy = problem.change();
        let (id, n) = (id(hierarchy, level)?, hierarchy.variables());
        let (hessian, gradient) = hierarchy.quadratic_mut(id)?;
        let new_hessian = H.map(|matrix| Matrix::read("H", matrix)).transpose()?;
        let new_gradient = g.map(|vector| vector_of("g", vector, n)).transpose()?;
        if let Some(matrix) = new_hessian {
            let matrix = matrix.to_nalgebra();
            if matrix.shape() != (n, n) {
                let text = format!("H has shape {:?}; it must be ({n}, {n})", matrix.shape());
                return Err(Failure::value(text));
            }
            hessian.copy_from(&matrix);
        }
        if let Some(vector) = new_gradient {
            gradient.iter_mut().zip(vector.as_array()).for_each(|(to, from)| *to = *from);
        }
        Ok(())
    }

    fn __copy__(&self) -> Result<Self> {
        Ok(Self::of(self.0.lock()?.hierarchy.clone()))
    }

    fn __repr__(&self) -> Result<String> {
        let problem = self.0.lock()?;
        let hierarchy = &problem.hierarchy;
        let (levels, variables) = (hierarchy.levels().len(), hierarchy.variables());
        Ok(format!("<ahqp.Hierarchy: {variables} variables, {levels} levels>"))
    }
}

/// Sets bounds of the variables, which errors call by these names. `None` means no bounds.
pub(crate) fn set_bounds(
    hierarchy: &mut ahqp_core::Hierarchy,
    names: [&str; 2],
    lower: Option<&Bound<'_, PyAny>>,
    upper: Option<&Bound<'_, PyAny>>,
) -> Result<()> {
    let n = hierarchy.variables();
    let read = |name, bound: Option<&Bound<'_, PyAny>>, none: f64| -> Result<Vec<f64>> {
        let Some(bound) = bound else { return Ok(vec![none; n]) };
        Ok(vector_of(name, bound, n)?.as_array().to_vec())
    };
    let [lower_name, upper_name] = names;
    let lower = read(lower_name, lower, f64::NEG_INFINITY)?;
    let upper = read(upper_name, upper, f64::INFINITY)?;
    Ok(hierarchy.set_bounds(&lower, &upper)?)
}

fn free(matrix: &Matrix<'_>) -> Vec<f64> {
    use ahqp_core::CoefficientMatrix;
    vec![f64::INFINITY; matrix.view().nrows()]
}

fn push(hierarchy: &mut ahqp_core::Hierarchy, level: Level, name: Option<String>) -> Result<usize> {
    let level = match name {
        Some(name) => level.named(name),
        None => level,
    };
    Ok(hierarchy.push(level)?.index())
}

fn id(hierarchy: &ahqp_core::Hierarchy, level: usize) -> Result<LevelId> {
    hierarchy.ids().nth(level).ok_or_else(|| {
        let levels = hierarchy.levels().len();
        Failure::value(format!("there is no level {level}: there are {levels}, counted from 0"))
    })
}

/// Writes the given data.
fn update_rows(
    rows: &mut Rows,
    matrix: Option<&Bound<'_, PyAny>>,
    lower: Option<&Bound<'_, PyAny>>,
    upper: Option<&Bound<'_, PyAny>>,
    weights: Option<&Bound<'_, PyAny>>,
) -> Result<()> {
    // All data are read before anything changes.
    let count = rows.len();
    let matrix = matrix.map(|matrix| Matrix::read("A", matrix)).transpose()?;
    let lower = lower.map(|bound| vector_of("lower", bound, count)).transpose()?;
    let upper = upper.map(|bound| vector_of("upper", bound, count)).transpose()?;
    let weights = weights.map(|weights| vector_of("weights", weights, count)).transpose()?;
    if let Some(weights) = weights {
        rows.set_weights(&weights.as_array().to_vec())?;
    }
    if let Some(matrix) = matrix {
        rows.set_matrix(&matrix.view())?;
    }
    if let Some(bound) = lower {
        write(rows.lower_mut(), &bound);
    }
    if let Some(bound) = upper {
        write(rows.upper_mut(), &bound);
    }
    Ok(())
}

fn write(to: &mut [f64], from: &crate::arrays::Vector<'_>) {
    debug_assert_eq!(to.len(), from.len());
    to.iter_mut().zip(from.as_array()).for_each(|(to, from)| *to = *from);
}
