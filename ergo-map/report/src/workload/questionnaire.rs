//! One completed NASA-TLX questionnaire (Hart & Staveland 1988).

use crate::error::Error;
use crate::sheets::{Cell, Column, Sheet};

/// Number of choices between two of six scales.
const CHOICES: f64 = 15.0;
/// End of a scale.
const HIGHEST: f64 = 20.0;

/// The six scales, in the order of the paper's figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Pace of the work.
    TemporalDemand,
    /// Amount of thinking.
    MentalDemand,
    /// Effort of the subject.
    Effort,
    /// Amount of physical activity.
    PhysicalDemand,
    /// Performance: 0 is perfect, 20 is failure.
    Performance,
    /// Annoyance of the subject.
    Frustration,
}

impl Scale {
    /// Scales in the order of the paper's figure.
    pub const ALL: [Self; 6] = [
        Self::TemporalDemand,
        Self::MentalDemand,
        Self::Effort,
        Self::PhysicalDemand,
        Self::Performance,
        Self::Frustration,
    ];

    /// Returns the name of the scale's column.
    pub fn name(self) -> &'static str {
        match self {
            Self::TemporalDemand => "temporal_demand",
            Self::MentalDemand => "mental_demand",
            Self::Effort => "effort",
            Self::PhysicalDemand => "physical_demand",
            Self::Performance => "performance",
            Self::Frustration => "frustration",
        }
    }

    /// Returns the two letters in the paper's figure.
    pub fn abbreviation(self) -> &'static str {
        match self {
            Self::TemporalDemand => "TD",
            Self::MentalDemand => "MD",
            Self::Effort => "EF",
            Self::PhysicalDemand => "PD",
            Self::Performance => "PE",
            Self::Frustration => "FR",
        }
    }
}

/// A questionnaire read from a row of a table. It contains ratings from 0 to 20. If the subject
/// compared the scales, it also contains how often each was chosen.
///
/// The table determines how performance is rated. In the column `performance` 0 is perfect and 20
/// is failure, as on NASA's sheet. In `performance_inverted` 20 is perfect, and the rating is
/// inverted when it is read. [`crate::sheets::SheetTable::with_ratings_to_hundred`] reads ratings
/// from 0 to 100.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use ergo_report::sheets::{SheetTable, Unknown};
/// use ergo_report::workload::Questionnaire;
///
/// let table = "subject,temporal_demand,mental_demand,effort,physical_demand,performance_inverted,\
///              frustration\nS1,4,6,8,2,17,1\n";
/// let mut table = SheetTable::<Questionnaire, _>::new(table.as_bytes(), Unknown::Refuse)?;
/// let mut read = Vec::new();
/// let _ = table.score(std::io::sink(), |questionnaire| {
///     read.push(questionnaire.clone());
///     ControlFlow::Continue(())
/// })?;
/// assert_eq!(read[0].ratings()?, [4.0, 6.0, 8.0, 2.0, 3.0, 1.0]);
/// assert_eq!(read[0].raw()?, 4.0);
/// assert_eq!(read[0].weighted()?, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Questionnaire {
    subject: String,
    condition: String,
    /// Ratings in the order of [`Scale::ALL`].
    ratings: [Option<f64>; 6],
    inverted_performance: Option<f64>,
    /// Weights in the order of [`Scale::ALL`].
    weights: [Option<f64>; 6],
}

impl Questionnaire {
    /// The subject who answered.
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// The condition, empty if the table has no such column.
    pub fn condition(&self) -> &str {
        &self.condition
    }

    /// Returns the ratings in the order of [`Scale::ALL`], from 0 to 20. A perfect performance is
    /// 0.
    ///
    /// # Errors
    /// [`Error`] if performance is not rated, or rated twice.
    pub fn ratings(&self) -> Result<[f64; 6], Error> {
        let performance = match (self.ratings[4], self.inverted_performance) {
            (Some(rating), None) => rating,
            (None, Some(inverted)) => HIGHEST - inverted,
            (None, None) => {
                return Err(Error::Questionnaire(
                    "no rating of performance; the table needs a column performance (0 is perfect, 20 is \
                     failure) or performance_inverted (0 is failure, 20 is perfect)"
                        .into(),
                ));
            }
            (Some(_), Some(_)) => {
                let both = "performance and performance_inverted are both given; keep one";
                return Err(Error::Questionnaire(both.into()));
            }
        };
        // A table without one of the other ratings is refused.
        let mut ratings = self.ratings.map(Option::unwrap_or_default);
        ratings[4] = performance;
        Ok(ratings)
    }

    /// Returns raw TLX, the mean of the ratings.
    ///
    /// # Errors
    /// Those of [`Questionnaire::ratings`].
    pub fn raw(&self) -> Result<f64, Error> {
        Ok(self.ratings()?.iter().sum::<f64>() / 6.0)
    }

    /// Returns weighted TLX: the ratings weighted by the number of times that each scale was chosen
    /// in fifteen choices between two. `None` if there are no weights.
    ///
    /// # Errors
    /// Those of [`Questionnaire::ratings`], and an error if weights are incomplete or do not sum to
    /// 15.
    pub fn weighted(&self) -> Result<Option<f64>, Error> {
        let found = self.weights.iter().flatten().count();
        if found == 0 {
            return Ok(None);
        }
        if found < self.weights.len() {
            let problem = format!("weights for {found} of six scales; give all six, or none");
            return Err(Error::Questionnaire(problem));
        }
        let sum: f64 = self.weights.iter().flatten().sum();
        if sum != CHOICES {
            return Err(Error::Questionnaire(format!(
                "the weights add up to {sum}; the fifteen choices between two scales add up to 15"
            )));
        }
        let ratings = self.ratings()?;
        let weighed = self.weights.iter().flatten().zip(ratings).map(|(weight, x)| weight * x);
        Ok(Some(weighed.sum::<f64>() / CHOICES))
    }
}

impl Sheet for Questionnaire {
    type Error = Error;

    const COLUMNS: &'static [Column<Self>] = &[
        Column::name("subject", true, |q, name| name.clone_into(&mut q.subject)),
        Column::name("condition", false, |q, name| name.clone_into(&mut q.condition)),
        Column::needed("temporal_demand", Cell::Rating, |q, x| q.ratings[0] = Some(x)),
        Column::needed("mental_demand", Cell::Rating, |q, x| q.ratings[1] = Some(x)),
        Column::needed("effort", Cell::Rating, |q, x| q.ratings[2] = Some(x)),
        Column::needed("physical_demand", Cell::Rating, |q, x| q.ratings[3] = Some(x)),
        Column::optional("performance", Cell::Rating, |q, x| q.ratings[4] = Some(x)),
        Column::optional("performance_inverted", Cell::Rating, |q, x| {
            q.inverted_performance = Some(x);
        }),
        Column::needed("frustration", Cell::Rating, |q, x| q.ratings[5] = Some(x)),
        Column::optional("weight_temporal_demand", Cell::Tally, |q, x| q.weights[0] = Some(x)),
        Column::optional("weight_mental_demand", Cell::Tally, |q, x| q.weights[1] = Some(x)),
        Column::optional("weight_effort", Cell::Tally, |q, x| q.weights[2] = Some(x)),
        Column::optional("weight_physical_demand", Cell::Tally, |q, x| q.weights[3] = Some(x)),
        Column::optional("weight_performance", Cell::Tally, |q, x| q.weights[4] = Some(x)),
        Column::optional("weight_frustration", Cell::Tally, |q, x| q.weights[5] = Some(x)),
    ];

    const SCORES: &'static [&'static str] = &["raw_tlx", "weighted_tlx"];

    fn scores(&self) -> Result<Vec<String>, Error> {
        let weighted = self.weighted()?.map(|score| score.to_string());
        Ok(vec![self.raw()?.to_string(), weighted.unwrap_or_default()])
    }
}
