//! A convex quadratic that approximates the score in a quadratic program.

mod admm;
mod boxed;
mod fit;
mod report;
mod scored_point;

use nalgebra::{Matrix3, Vector3};

use crate::error::{Error, Result, within};
use crate::person_frame::PersonFrame;
pub use fit::FitOptions;
pub(crate) use fit::{FitInput, fit_weighted};
pub use report::{FitReport, Regret};
pub(crate) use report::{correlation, ranks};
pub use scored_point::ScoredPoint;

/// The quadratic e(x) = ½ xᵀ H x + gᵀ x + c with H symmetric and positive semidefinite. x is a hand
/// position \[m\] in the person's frame or, once [`placed`](ErgonomicsQuadratic::placed), in the
/// world.
///
/// ```
/// use ergo_map::{ErgonomicsMap, FitOptions, MapOptions, Person, PersonFrame};
/// use nalgebra::Vector3;
/// let options = MapOptions { spacing: 0.08, ..Default::default() };
/// let map = ErgonomicsMap::build(&Person::average(), &options, None)?;
/// let (quadratic, report) = map.fit(&FitOptions::default())?;
/// assert!(report.r_squared > 0.8);
///
/// let person = PersonFrame::new(Vector3::new(2.0, 1.0, 0.0), core::f64::consts::PI)?;
/// let terms = quadratic.placed(&person).task_terms(&Vector3::new(1.5, 1.0, 1.0), 0.2)?;
/// assert!(terms.hessian.symmetric_eigenvalues().min() > 0.0);
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErgonomicsQuadratic {
    hessian: Matrix3<f64>,
    gradient: Vector3<f64>,
    constant: f64,
}

/// The score as a function of the desired hand velocity v \[m/s\] (the paper's `ẋ_d`): ½ vᵀ hessian
/// v + gradientᵀ v plus a constant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TaskTerms {
    /// Hessian τ² H.
    pub hessian: Matrix3<f64>,
    /// Gradient τ (H x + g), where x is the desired position of the last tick.
    pub gradient: Vector3<f64>,
}

impl ErgonomicsQuadratic {
    /// Creates the quadratic with these coefficients.
    ///
    /// # Errors
    /// [`Error::Value`] if a coefficient is not finite, or the Hessian is not symmetric or not
    /// convex.
    ///
    /// Entry (i, j) is compared with √(Hᵢᵢ Hⱼⱼ), its largest size in a convex quadratic. The units
    /// of the axes therefore do not matter. Deviations of up to 1e-9 of it count as rounding.
    pub fn new(hessian: Matrix3<f64>, gradient: Vector3<f64>, constant: f64) -> Result<Self> {
        // The limit is far beyond any score, and keeps squares finite.
        let most = [-1e100, 1e100];
        hessian.iter().try_for_each(|h| within("hessian", *h, most, "1/m²").map(drop))?;
        gradient.iter().try_for_each(|g| within("gradient", *g, most, "1/m").map(drop))?;
        within("constant", constant, most, "(score)")?;
        expect_symmetric(&hessian)?;
        let hessian = (hessian + hessian.transpose()) * 0.5;
        expect_convex(&hessian)?;
        Ok(Self { hessian, gradient, constant })
    }

    /// Hessian H \[1/m²\].
    pub fn hessian(&self) -> &Matrix3<f64> {
        &self.hessian
    }

    /// Gradient g at zero \[1/m\].
    pub fn gradient(&self) -> &Vector3<f64> {
        &self.gradient
    }

    /// Constant c, in the unit of the score.
    pub fn constant(&self) -> f64 {
        self.constant
    }

    /// Returns e at a hand position x \[m\], in the unit of the score.
    #[inline]
    pub fn value(&self, x: &Vector3<f64>) -> f64 {
        x.dot(&(self.hessian * x * 0.5 + self.gradient)) + self.constant
    }

    /// Returns the derivative of e at x \[1/m\].
    #[inline]
    pub fn gradient_at(&self, x: &Vector3<f64>) -> Vector3<f64> {
        self.hessian * x + self.gradient
    }

    /// Returns the hand position \[m\] at which e is smallest. `None` if H is singular.
    pub fn minimiser(&self) -> Option<Vector3<f64>> {
        self.hessian.cholesky().map(|factor| -factor.solve(&self.gradient))
    }

    /// Returns the quadratic as a function of world positions: `H_w` = R H Rᵀ, `g_w` = R g - `H_w`
    /// p. The person is at p, turned by R.
    #[must_use]
    pub fn placed(&self, person: &PersonFrame) -> Self {
        let rotation = person.rotation();
        // A root of H is rotated, so that small curvature stays positive in spite of rounding.
        let turned_root = rotation * root(&self.hessian);
        let hessian = turned_root * turned_root.transpose();
        let turned = rotation * self.gradient;
        let p = person.position();
        Self {
            hessian,
            gradient: turned - hessian * p,
            constant: self.constant + 0.5 * p.dot(&(hessian * p)) - turned.dot(p),
        }
    }

    /// Returns the quadratic for a body `ratio` times as large and of the same proportions: e(x /
    /// ratio). [`ErgonomicsMap::for_stature`](crate::ErgonomicsMap::for_stature) does the same with
    /// a map.
    ///
    /// ```
    /// use ergo_map::ErgonomicsQuadratic;
    /// use nalgebra::{Matrix3, Vector3};
    /// let average = ErgonomicsQuadratic::new(Matrix3::identity(), Vector3::new(-0.4, 0.1, -1.1), 0.8)?;
    /// let tall = average.resized(1.94 / 1.75)?;
    /// let hand = Vector3::new(0.4, -0.1, 1.0);
    /// assert!((tall.value(&(hand * 1.94 / 1.75)) - average.value(&hand)).abs() < 1e-12);
    /// # Ok::<(), ergo_map::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Value`] if the ratio is not from 0.1 to 10.
    pub fn resized(&self, ratio: f64) -> Result<Self> {
        let ratio = within("ratio of sizes", ratio, [0.1, 10.0], "(ratio)")?;
        let (hessian, gradient) = (self.hessian / (ratio * ratio), self.gradient / ratio);
        Ok(Self { hessian, gradient, constant: self.constant })
    }

    /// Returns the quadratic at `x_previous` + τ v as a function of the velocity v. Its Hessian is
    /// τ² H, and its gradient τ (H `x_previous` + g). The frame of the quadratic is that of
    /// `x_previous`.
    ///
    /// The paper uses τ = Δt. A longer horizon makes the hand approach the optimum with the time
    /// constant τ instead of within one tick.
    ///
    /// # Errors
    /// [`Error::Value`] if the horizon τ \[s\] is not positive and at most 60 s.
    pub fn task_terms(&self, x_previous: &Vector3<f64>, horizon: f64) -> Result<TaskTerms> {
        let horizon = within("horizon", horizon, [1e-6, 60.0], "s")?;
        Ok(TaskTerms {
            hessian: self.hessian * (horizon * horizon),
            gradient: self.gradient_at(x_previous) * horizon,
        })
    }
}

/// Asymmetry and negative curvature of up to this part of √(Hᵢᵢ Hⱼⱼ) are rounding. There is a
/// margin for matrices that are products of others, or were written with ten digits.
const ROUNDING: f64 = 1e-9;

/// Returns the roots of the diagonal, zero for negative entries.
fn roots(hessian: &Matrix3<f64>) -> Vector3<f64> {
    hessian.diagonal().map(|entry| entry.max(0.0).sqrt())
}

fn expect_symmetric(hessian: &Matrix3<f64>) -> Result<()> {
    let roots = roots(hessian);
    for (i, j) in [(1, 0), (2, 0), (2, 1)] {
        let asymmetry = (hessian[(i, j)] - hessian[(j, i)]).abs();
        if asymmetry > ROUNDING * roots[i] * roots[j] {
            return Err(Error::Value {
                what: "the difference between the Hessian and its transpose",
                got: asymmetry,
                unit: "1/m²",
                wanted: "be 0: symmetrise the Hessian".into(),
            });
        }
    }
    Ok(())
}

fn expect_convex(hessian: &Matrix3<f64>) -> Result<()> {
    let roots = roots(hessian);
    // An axis without curvature can have none with another axis either. The quotient is infinite if
    // it has.
    let scaled =
        hessian.map_with_location(
            |i, j, entry| {
                if entry == 0.0 { 0.0 } else { entry / roots[i] / roots[j] }
            },
        );
    let eigenvalue = if scaled.iter().all(|entry| entry.is_finite()) {
        scaled.symmetric_eigenvalues().min()
    } else {
        f64::NEG_INFINITY
    };
    if eigenvalue >= -ROUNDING {
        return Ok(());
    }
    Err(Error::Value {
        what: "the smallest eigenvalue of the Hessian",
        got: eigenvalue,
        unit: "",
        wanted: "be at least 0, once the Hessian has ones on its diagonal".into(),
    })
}

/// Returns R with R Rᵀ = H, by Cholesky factorisation with pivoting.
fn root(hessian: &Matrix3<f64>) -> Matrix3<f64> {
    // A smaller part of a diagonal entry is rounding.
    const NOTHING: f64 = 4.0 * f64::EPSILON;
    let mut rest = *hessian;
    let mut root = Matrix3::zeros();
    for step in 0..3 {
        let share = |i: usize| rest[(i, i)] / hessian[(i, i)];
        let pivot = (0..3)
            .filter(|&i| rest[(i, i)] > 0.0 && share(i) > NOTHING)
            .max_by(|&i, &j| share(i).total_cmp(&share(j)));
        let Some(pivot) = pivot else { break };
        let column = rest.column(pivot) / rest[(pivot, pivot)].sqrt();
        root.set_column(step, &column);
        rest -= column * column.transpose();
        rest.fill_row(pivot, 0.0);
        rest.fill_column(pivot, 0.0);
    }
    root
}
