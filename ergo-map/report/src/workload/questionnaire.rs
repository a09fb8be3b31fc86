//! One filled-in NASA-TLX questionnaire (Hart & Staveland 1988).

use crate::error::Error;
use crate::sheets::{Cell, Column, Sheet};

/// Choices between two of six scales.
const CHOICES: f64 = 15.0;
/// The end of a scale.
const HIGHEST: f64 = 20.0;

/// The six scales, in the order of the paper's figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// How hurried the pace was.
    TemporalDemand,
    /// How much thinking it took.
    MentalDemand,
    /// How hard the subject had to work.
    Effort,
    /// How much bodily work it took.
    PhysicalDemand,
    /// How well it went: 0 is perfect, 20 is failure.
    Performance,
    /// How annoyed the subject was.
    Frustration,
}

impl Scale {
    /// All, in the order of the paper's figure.
    pub const ALL: [Self; 6] = [
        Self::TemporalDemand,
        Self::MentalDemand,
        Self::Effort,
        Self::PhysicalDemand,
        Self::Performance,
        Self::Frustration,
    ];

    /// The name of its column.
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

    /// The two letters of the paper's figure.
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

/// A questionnaire as it is read from a row of a table: ratings from 0 to 20 and, where the subject
/// compared the scales, how often each was chosen.
///
/// The table says how performance was rated: in the column `performance` 0 is perfect and 20 is
/// failure, as on NASA's sheet; in `performance_inverted` 20 is perfect, and the rating is turned
/// over when it is read. [`crate::sheets::SheetTable::with_ratings_to_hundred`] reads ratings from 0 to
/// 100.
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
    /// By [`Scale::ALL`].
    ratings: [Option<f64>; 6],
    inverted_performance: Option<f64>,
    /// By [`Scale::ALL`].
    weights: [Option<f64>; 6],
}

impl Questionnaire {
    /// Who answered.
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// Under which condition; empty where the table has no such column.
    pub fn condition(&self) -> &str {
        &self.condition
    }

    /// The ratings by [`Scale::ALL`], from 0 to 20; a perfect performance is 0.
    ///
    /// # Errors
    /// [`Error`] where performance is rated not at all or twice.
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
        // A table without one of the others is refused.
        let mut ratings = self.ratings.map(Option::unwrap_or_default);
        ratings[4] = performance;
        Ok(ratings)
    }

    /// Raw TLX: the mean of the ratings.
    ///
    /// # Errors
    /// As for [`Questionnaire::ratings`].
    pub fn raw(&self) -> Result<f64, Error> {
        Ok(self.ratings()?.iter().sum::<f64>() / 6.0)
    }

    /// Weighted TLX: the ratings weighed by how often each scale was chosen in fifteen choices
    /// between two; `None` without weights.
    ///
    /// # Errors
    /// As for [`Questionnaire::ratings`], and weights that are incomplete or do not add up to 15.
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
