//! The answers of the subjects under one condition.

use std::collections::HashMap;

use super::error::WorkloadError;
use super::questionnaire::{Questionnaire, Scale};

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
    pub(super) fn new<'a>(
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
    pub(super) fn columns(&self) -> impl Iterator<Item = (&'static str, Vec<f64>)> {
        let scales = Scale::ALL.into_iter().enumerate();
        let scores = [("raw_tlx", Some(&self.raw)), ("weighted_tlx", self.weighted.as_ref())];
        scales
            .map(|(index, scale)| (scale.name(), self.scale(index)))
            .chain(scores.into_iter().filter_map(|(name, values)| Some((name, values?.clone()))))
    }
}
