//! Settings of the objective and the training.

use crate::error::Error;
use crate::samples::misfit;

/// The penalty of a sample whose margin is too small by ξ = max(0, 1 − y f(x)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loss {
    /// C ξ: the paper's L1-SVM.
    Hinge,
    /// C ξ²: the paper's L2-SVM.
    SquaredHinge,
}

/// The cost of the bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bias {
    /// Bias without a cost, as in the paper.
    Free,
    /// ½ (b / scaling)². The bias is the weight of an additional feature of this value, as in
    /// liblinear.
    Regularised {
        /// Value of the additional feature. Larger values make the bias cheaper.
        scaling: f64,
    },
}

/// The weights of the classes in the penalty.
#[derive(Clone, Debug, PartialEq)]
pub enum ClassWeights {
    /// Equal weights.
    Equal,
    /// Weights in inverse proportion to the class's samples: samples / (classes × samples of the
    /// class). Each class then has the same total weight, as in scikit-learn.
    Balanced,
    /// Given weights, one per class.
    Given(Vec<f64>),
}

/// Settings of the training.
///
/// ```
/// use vision_models::{Bias, ClassWeights, SvmSettings};
///
/// // What scikit-learn's LinearSVC minimises.
/// let settings = SvmSettings { bias: Bias::Regularised { scaling: 1.0 }, ..SvmSettings::default() };
/// assert!(settings.validate().is_ok());
/// let wrong = SvmSettings { class_weights: ClassWeights::Given(vec![1.0, 0.0]), ..settings };
/// assert!(wrong.validate().is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SvmSettings {
    /// Penalty. Default squared hinge.
    pub loss: Loss,
    /// Cost of the bias. Default free.
    pub bias: Bias,
    /// C, the weight of the penalty relative to the margin. Default 1.
    pub cost: f64,
    /// Factor of C for the samples of each class. Default equal.
    pub class_weights: ClassWeights,
    /// Relative duality gap at which the training ends. Default 1e-9.
    pub tolerance: f64,
    /// Largest number of Newton steps. Default 2000. Most trainings need 10 to 100.
    pub max_iterations: usize,
}

impl Default for SvmSettings {
    fn default() -> Self {
        Self {
            loss: Loss::SquaredHinge,
            bias: Bias::Free,
            cost: 1.0,
            class_weights: ClassWeights::Equal,
            tolerance: 1e-9,
            max_iterations: 2000,
        }
    }
}

impl SvmSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Value`] if a cost, a tolerance, a scaling or a weight is not positive and finite.
    pub fn validate(&self) -> Result<(), Error> {
        let scaling = match self.bias {
            Bias::Free => 1.0,
            Bias::Regularised { scaling } => scaling,
        };
        let weights = match &self.class_weights {
            ClassWeights::Given(weights) => weights.as_slice(),
            ClassWeights::Equal | ClassWeights::Balanced => &[],
        };
        let named = [("cost", self.cost), ("tolerance", self.tolerance), ("scaling", scaling)];
        let weights = weights.iter().map(|&weight| ("class_weights", weight));
        for (name, value) in named.into_iter().chain(weights) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(Error::value(name, value, "a positive finite number"));
            }
        }
        Ok(())
    }

    /// Returns C for the samples of each class.
    pub(super) fn costs(&self, labels: &[usize], classes: usize) -> Result<Vec<f64>, Error> {
        let weights = match &self.class_weights {
            ClassWeights::Equal => vec![1.0; classes],
            ClassWeights::Balanced => {
                let mut counts = vec![0_usize; classes];
                for &label in labels {
                    counts.get_mut(label).into_iter().for_each(|count| *count += 1);
                }
                let weight = |count| labels.len() as f64 / (classes as f64 * f64::from(count));
                let count = |count| u32::try_from(count).unwrap_or(u32::MAX).max(1);
                counts.into_iter().map(count).map(weight).collect()
            }
            ClassWeights::Given(weights) if weights.len() == classes => weights.clone(),
            ClassWeights::Given(weights) => {
                let problem =
                    format!("{} class weights for {classes} classes: give one each", weights.len());
                return Err(misfit(problem));
            }
        };
        Ok(weights.into_iter().map(|weight| weight * self.cost).collect())
    }
}
