//! The scores of a classifier.

use ndarray::ArrayView2;

use crate::error::Error;
use crate::labels::ClassNames;
use crate::metrics::{softmax, top_k};

/// The scores and features of each input of a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores<'a> {
    /// Scores before any softmax, N × classes.
    pub logits: ArrayView2<'a, f32>,
    /// Features, the input of the linear layer, N × features.
    pub features: ArrayView2<'a, f32>,
}

/// A class with its probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankedClass<'n> {
    /// The class's number, from zero.
    pub class: usize,
    /// The class's name.
    pub name: &'n str,
    /// The softmax of the class's score.
    pub probability: f32,
}

impl Scores<'_> {
    /// Returns the k most probable classes of one input of the batch, in falling order of
    /// probability. Equal classes are in the order of their numbers.
    ///
    /// # Errors
    /// - [`Error::Size`] if the number of names is not the number of classes.
    /// - [`Error::Value`] if the batch does not have this input.
    ///
    /// ```
    /// use ndarray::array;
    /// use vision_models::{ClassNames, Scores};
    ///
    /// let names: ClassNames = "smooth\ndrilled\nother".parse()?;
    /// let (logits, features) = (array![[0.5, 2.0, -1.0]], array![[1.0]]);
    /// let scores = Scores { logits: logits.view(), features: features.view() };
    /// let best = scores.top_k(0, 2, &names)?;
    /// assert_eq!((best[0].name, best[1].name), ("drilled", "smooth"));
    /// # Ok::<(), vision_models::Error>(())
    /// ```
    pub fn top_k<'n>(
        &self,
        input: usize,
        k: usize,
        names: &'n ClassNames,
    ) -> Result<Vec<RankedClass<'n>>, Error> {
        let (inputs, classes) = self.logits.dim();
        if names.names().len() != classes {
            let wanted = format!("{classes}, one for each class");
            return Err(Error::size(
                "the list of class names",
                &[names.names().len()],
                "names",
                &wanted,
            ));
        }
        if input >= inputs {
            return Err(Error::value("the input", input, &format!("an index below {inputs}")));
        }
        let probabilities = softmax(&self.logits.row(input).to_vec());
        let ranked = top_k(&probabilities, k).into_iter().filter_map(|class| {
            let (name, &probability) = (names.names().get(class)?, probabilities.get(class)?);
            Some(RankedClass { class, name, probability })
        });
        Ok(ranked.collect())
    }
}
