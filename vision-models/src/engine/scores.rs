//! What a classifier says.

use ndarray::ArrayView2;

use crate::error::Error;
use crate::labels::ClassNames;
use crate::metrics::{softmax, top_k};

/// What a network says about each input of a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scores<'a> {
    /// N × classes: the scores before any softmax.
    pub logits: ArrayView2<'a, f32>,
    /// N × features: what the linear layer sees.
    pub features: ArrayView2<'a, f32>,
}

/// A class with its probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankedClass<'n> {
    /// Its number, from zero.
    pub class: usize,
    /// Its name.
    pub name: &'n str,
    /// The softmax of its score.
    pub probability: f32,
}

impl Scores<'_> {
    /// The k most probable classes of one input of the batch, the most probable first; of equal ones the first
    /// class comes first.
    ///
    /// # Errors
    /// [`Error::Size`] if there is not a name for every class, [`Error::Value`] for an input that
    /// the batch does not have.
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
