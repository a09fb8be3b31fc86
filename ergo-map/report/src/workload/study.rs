//! Questionnaires of a study, grouped by condition and compared.

use std::{collections::HashSet, fmt};

use serde::{Serialize, Serializer};

use super::comparison::Comparison;
use super::condition::{Condition, unweighted};
use super::quartiles::Quartiles;
use super::questionnaire::Questionnaire;
use crate::error::Error;

/// Largest number of subjects. The exact distribution of ranks costs the cube of this number.
const MOST_SUBJECTS: usize = 500;
/// Largest number of conditions. All pairs are compared.
const MOST_CONDITIONS: usize = 8;

/// A study of conditions with the same subjects. Each subject answers a questionnaire under each
/// condition.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkloadStudy {
    conditions: Vec<Condition>,
}

/// Summary of one scale or score under one condition.
#[derive(Serialize)]
struct Summary {
    name: &'static str,
    mean: f64,
    #[serde(flatten)]
    quartiles: Quartiles,
}

#[derive(Serialize)]
struct ConditionSummary<'a> {
    name: &'a str,
    scales: Vec<Summary>,
}

#[derive(Serialize)]
struct StudySummary<'a> {
    subjects: usize,
    conditions: Vec<ConditionSummary<'a>>,
    comparisons: Vec<Comparison>,
}

impl WorkloadStudy {
    /// Groups questionnaires by condition. Conditions and subjects are in the order of their first
    /// appearance.
    ///
    /// # Errors
    /// [`Error`] if there is no questionnaire, one has no score, or there are too many subjects or
    /// conditions. [`Error`] also if a subject answers twice, is missing under a condition, or
    /// alone has no weights.
    pub fn new(questionnaires: &[Questionnaire]) -> Result<Self, Error> {
        if questionnaires.is_empty() {
            return Err(Error::Study("the table has no questionnaire; give one a row".into()));
        }
        let subjects = in_order(questionnaires.iter().map(Questionnaire::subject));
        let names = in_order(questionnaires.iter().map(Questionnaire::condition));
        for (what, found, most) in [
            ("subjects", subjects.len(), MOST_SUBJECTS),
            ("conditions", names.len(), MOST_CONDITIONS),
        ] {
            if found > most {
                return Err(Error::Study(format!(
                    "{found} {what}; at most {most} can be compared exactly"
                )));
            }
        }
        let conditions = names.into_iter().map(|name| {
            let answers = questionnaires.iter().filter(|answer| answer.condition() == name);
            Condition::new(name, &subjects, answers)
        });
        let study = Self { conditions: conditions.collect::<Result<_, _>>()? };
        study.check_weights()?;
        Ok(study)
    }

    /// Checks that all conditions have weights, or none. A weighted score under only one of them
    /// cannot be compared.
    fn check_weights(&self) -> Result<(), Error> {
        let weighed = self.conditions.iter().any(|condition| condition.weighted.is_some());
        let without = self.conditions.iter().find(|condition| condition.weighted.is_none());
        match without {
            Some(condition) if weighed => {
                let subject = condition.subjects.first().map_or("", String::as_str);
                Err(unweighted(subject, &condition.name))
            }
            _ => Ok(()),
        }
    }

    /// The conditions.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// Returns the comparisons of all pairs of conditions.
    pub fn comparisons(&self) -> Vec<Comparison> {
        let pairs = self.conditions.iter().enumerate().flat_map(|(index, first)| {
            self.conditions.iter().skip(index + 1).map(move |second| (first, second))
        });
        pairs.map(|(first, second)| Comparison::of(first, second)).collect()
    }

    fn summary(&self) -> StudySummary<'_> {
        let conditions = self.conditions.iter().map(|condition| ConditionSummary {
            name: &condition.name,
            scales: condition
                .columns()
                .map(|(name, values)| Summary {
                    name,
                    mean: values.iter().sum::<f64>() / values.len() as f64,
                    quartiles: Quartiles::of(&values),
                })
                .collect(),
        });
        StudySummary {
            subjects: self.conditions.first().map_or(0, |condition| condition.subjects.len()),
            conditions: conditions.collect(),
            comparisons: self.comparisons(),
        }
    }
}

impl Serialize for WorkloadStudy {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.summary().serialize(serializer)
    }
}

/// Formats the study as tables: the answers under each condition, and the results of the tests.
impl fmt::Display for WorkloadStudy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for condition in &self.conditions {
            let (title, count) = (condition.title(), condition.subjects.len());
            writeln!(f, "{title} ({count} subjects; 0 to 20, performance: 0 is perfect)")?;
            writeln!(
                f,
                "  {:<16} {:>6} {:>6} {:>6} {:>6}",
                "", "mean", "lower", "median", "upper"
            )?;
            for (name, values) in condition.columns() {
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                let Quartiles { lower, median, upper } = Quartiles::of(&values);
                writeln!(f, "  {name:<16} {mean:>6.2} {lower:>6.2} {median:>6.2} {upper:>6.2}")?;
            }
            writeln!(f)?;
        }
        let comparisons = self.comparisons();
        for Comparison { first, second, tested } in &comparisons {
            writeln!(f, "{second} against {first}")?;
            writeln!(
                f,
                "  {:<16} {:>10} {:>7} {:>7} {:>7} {:>8} {:>8} {:>6}",
                "", "difference", "differ", "W+", "W-", "p", "p Holm", "effect"
            )?;
            for test in tested {
                let corrected = test.p_holm.map(|p| format!("{p:.4}")).unwrap_or_default();
                writeln!(
                    f,
                    "  {:<16} {:>10.2} {:>7} {:>7.1} {:>7.1} {:>8.4} {corrected:>8} {:>6.2}",
                    test.name,
                    test.median_difference,
                    test.differing,
                    test.positive_ranks,
                    test.negative_ranks,
                    test.p,
                    test.effect,
                )?;
            }
            writeln!(f)?;
        }
        if !comparisons.is_empty() {
            writeln!(
                f,
                "Exact two-sided Wilcoxon signed-rank tests, corrected by Holm over the six scales; \
                 effect: rank-biserial correlation.\nThe tests are this program's; the paper reports \
                 a box plot only."
            )?;
        }
        Ok(())
    }
}

/// Returns each text once, in the order of first appearance.
fn in_order<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = HashSet::new();
    texts.filter(|text| seen.insert(*text)).collect()
}
