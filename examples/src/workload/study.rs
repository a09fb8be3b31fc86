//! The questionnaires of a study: by condition, and compared.

use std::{
    collections::{HashMap, HashSet},
    fmt,
};

use serde::{Serialize, Serializer};

use super::{Comparison, Quartiles, Questionnaire, Scale, WorkloadError};

/// The exact distribution of ranks takes the cube of this.
const MOST_SUBJECTS: usize = 500;
/// Every two are compared.
const MOST_CONDITIONS: usize = 8;

/// The answers under one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Its name; empty where the table does not name any.
    pub name: String,
    /// The subjects, in the same order in each condition.
    pub subjects: Vec<String>,
    /// Each subject's ratings by [`Scale::ALL`]; a perfect performance is 0.
    pub ratings: Vec<[f64; 6]>,
    /// Each subject's raw TLX.
    pub raw: Vec<f64>,
    /// Each subject's weighted TLX, where the questionnaires have weights.
    pub weighted: Option<Vec<f64>>,
}

impl Condition {
    fn new<'a>(
        name: &str,
        subjects: &[&str],
        answers: impl Iterator<Item = &'a Questionnaire>,
    ) -> Result<Self, WorkloadError> {
        let (as_subject, as_condition) = (|subject: &str| subject.to_owned(), || name.to_owned());
        let mut of_subject = HashMap::new();
        for answer in answers {
            let subject = answer.subject();
            if of_subject.insert(subject, answer).is_some() {
                let (subject, condition) = (as_subject(subject), as_condition());
                return Err(WorkloadError::Repeated { subject, condition });
            }
        }
        let mut condition = Self {
            name: as_condition(),
            subjects: subjects.iter().map(|subject| as_subject(subject)).collect(),
            ratings: Vec::new(),
            raw: Vec::new(),
            weighted: None,
        };
        let mut weighted = Vec::new();
        for subject in subjects {
            let place = || (as_subject(subject), as_condition());
            let Some(answer) = of_subject.get(subject) else {
                let (subject, condition) = place();
                return Err(WorkloadError::Unpaired { subject, condition });
            };
            let refused = |source| {
                let (subject, condition) = place();
                WorkloadError::Questionnaire { subject, condition, source }
            };
            condition.ratings.push(answer.ratings().map_err(refused)?);
            condition.raw.push(answer.raw().map_err(refused)?);
            weighted.push(answer.weighted().map_err(refused)?);
        }
        if weighted.iter().any(Option::is_some) {
            if let Some(index) = weighted.iter().position(Option::is_none) {
                let (subject, condition) = (condition.subjects.swap_remove(index), as_condition());
                return Err(WorkloadError::Unweighted { subject, condition });
            }
            condition.weighted = Some(weighted.into_iter().flatten().collect());
        }
        Ok(condition)
    }

    /// Its name, or what stands for it where the table does not name any.
    pub fn title(&self) -> &str {
        if self.name.is_empty() { "all questionnaires" } else { &self.name }
    }

    /// Each subject's rating on one of [`Scale::ALL`].
    pub fn scale(&self, index: usize) -> Vec<f64> {
        self.ratings.iter().map(|ratings| ratings[index]).collect()
    }

    /// Names and values of the scales and scores.
    fn columns(&self) -> impl Iterator<Item = (&'static str, Vec<f64>)> {
        let scales = Scale::ALL.into_iter().enumerate();
        let scores = [("raw_tlx", Some(&self.raw)), ("weighted_tlx", self.weighted.as_ref())];
        scales
            .map(|(index, scale)| (scale.name(), self.scale(index)))
            .chain(scores.into_iter().filter_map(|(name, values)| Some((name, values?.clone()))))
    }
}

/// A study: conditions under which the same subjects worked, each answered by a questionnaire.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkloadStudy {
    conditions: Vec<Condition>,
}

/// The summary of one scale or score under one condition.
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
    /// Puts questionnaires together by condition, conditions and subjects in the order in which
    /// they first appear.
    ///
    /// # Errors
    /// [`WorkloadError`] for no questionnaire, one without a score, too many subjects or conditions,
    /// and a subject who answers twice, not under each condition, or alone without weights.
    pub fn new(questionnaires: &[Questionnaire]) -> Result<Self, WorkloadError> {
        if questionnaires.is_empty() {
            return Err(WorkloadError::Empty);
        }
        let subjects = in_order(questionnaires.iter().map(Questionnaire::subject));
        let names = in_order(questionnaires.iter().map(Questionnaire::condition));
        for (what, found, most) in [
            ("subjects", subjects.len(), MOST_SUBJECTS),
            ("conditions", names.len(), MOST_CONDITIONS),
        ] {
            if found > most {
                return Err(WorkloadError::TooMany { what, found, most });
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

    /// Whole conditions may not differ in whether they are weighed: a weighted score that is there
    /// under one of them only compares nothing.
    fn check_weights(&self) -> Result<(), WorkloadError> {
        let weighed = self.conditions.iter().any(|condition| condition.weighted.is_some());
        let without = self.conditions.iter().find(|condition| condition.weighted.is_none());
        match without {
            Some(condition) if weighed => Err(WorkloadError::Unweighted {
                subject: condition.subjects.first().cloned().unwrap_or_default(),
                condition: condition.name.clone(),
            }),
            _ => Ok(()),
        }
    }

    /// The conditions.
    pub fn conditions(&self) -> &[Condition] {
        &self.conditions
    }

    /// Every two conditions compared.
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

/// The study as tables: the answers under each condition, and what the tests say.
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

/// Each text once, in the order in which they come.
fn in_order<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = HashSet::new();
    texts.filter(|text| seen.insert(*text)).collect()
}
