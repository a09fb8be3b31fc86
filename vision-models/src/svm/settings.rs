//! What is minimised, and how far.

use crate::Error;

/// The penalty of a sample that is ξ = max(0, 1 − y f(x)) short of its margin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// C ξ: the paper's L1-SVM.
    Hinge,
    /// C ξ²: the paper's L2-SVM.
    SquaredHinge,
}

/// What the bias costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bias {
    /// Nothing, as in the paper.
    Free,
    /// ½ (b / scaling)²: it is the weight of a further feature of this value, as in liblinear.
    Regularised {
        /// The further feature's value; larger ones make the bias cheaper.
        scaling: f64,
    },
}

/// Settings of the training.
///
/// ```
/// use vision_models::{Bias, Loss, SvmSettings};
///
/// // What scikit-learn's LinearSVC minimises.
/// let settings = SvmSettings { bias: Bias::Regularised { scaling: 1.0 }, ..SvmSettings::default() };
/// assert_eq!(settings.loss, Loss::SquaredHinge);
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SvmSettings {
    /// The penalty; squared hinge.
    pub loss: Loss,
    /// What the bias costs; nothing.
    pub bias: Bias,
    /// C, the weight of the penalty against the margin; 1.
    pub cost: f64,
    /// How far a sample may be from its optimality condition at the end, in units of f; 1e-8.
    pub tolerance: f64,
    /// Most steps; 10 million.
    pub max_iterations: usize,
}

impl Default for SvmSettings {
    fn default() -> Self {
        Self {
            loss: Loss::SquaredHinge,
            bias: Bias::Free,
            cost: 1.0,
            tolerance: 1e-8,
            max_iterations: 10_000_000,
        }
    }
}

impl SvmSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Setting`] for a cost, a tolerance or a scaling that is not positive and finite.
    pub fn validate(&self) -> Result<(), Error> {
        let scaling = match self.bias {
            Bias::Free => 1.0,
            Bias::Regularised { scaling } => scaling,
        };
        for (name, value) in
            [("cost", self.cost), ("tolerance", self.tolerance), ("scaling", scaling)]
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::Setting { name, value, expected: "a positive finite number" });
            }
        }
        Ok(())
    }
}
