//! Answers of the subjects under one condition.

use std::collections::HashMap;

use super::questionnaire::{Questionnaire, Scale};
use crate::error::Error;

/// Answers under one condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Name of the condition, empty if the table has none.
    pub name: String,
    /// Subjects, in the same order in each condition.
    pub subjects: Vec<String>,
    /// Ratings of each subject in the order of [`Scale::ALL`]. A perfect performance is 0.
    pub ratings: Vec<[f64; 6]>,
    /// Raw TLX of each subject.
    pub raw: Vec<f64>,
    /// Weighted TLX of each subject, if the questionnaires have weights.
    pub weighted: Option<Vec<f64>>,
}

impl Condition {
    pub(super) fn new<'a>(
        name: &str,
        subjects: &[&str],
        answers: impl Iterator<Item = &'a Questionnaire>,
    ) -> Result<Self, Error> {
        let mut of_subject = HashMap::new();
        for answer in answers {
            let subject = answer.subject();
            if of_subject.insert(subject, answer).is_some() {
                return Err(Error::Study(format!(
                    "subject {subject:?} answers twice for the condition {name:?}; keep one row"
                )));
            }
        }
        let mut condition = Self {
            name: name.to_owned(),
            subjects: subjects.iter().map(|subject| (*subject).to_owned()).collect(),
            ratings: Vec::new(),
            raw: Vec::new(),
            weighted: None,
        };
        let mut weighted = Vec::new();
        for subject in subjects {
            let Some(answer) = of_subject.get(subject) else {
                return Err(Error::Study(format!(
                    "subject {subject:?} has no questionnaire for the condition {name:?}; conditions are \
                     compared subject by subject, so give it or leave the subject out"
                )));
            };
            let refused = |source: Error| {
                Error::Study(format!("subject {subject:?}, condition {name:?}: {source}"))
            };
            condition.ratings.push(answer.ratings().map_err(refused)?);
            condition.raw.push(answer.raw().map_err(refused)?);
            weighted.push(answer.weighted().map_err(refused)?);
        }
        if weighted.iter().any(Option::is_some) {
            if let Some(index) = weighted.iter().position(Option::is_none) {
                return Err(unweighted(&condition.subjects[index], name));
            }
            condition.weighted = Some(weighted.into_iter().flatten().collect());
        }
        Ok(condition)
    }

    /// Returns the name, or a replacement if the table has none.
    pub fn title(&self) -> &str {
        if self.name.is_empty() { "all questionnaires" } else { &self.name }
    }

    /// Returns each subject's rating on one of [`Scale::ALL`].
    pub fn scale(&self, index: usize) -> Vec<f64> {
        self.ratings.iter().map(|ratings| ratings[index]).collect()
    }

    /// Iterates over the names and values of the scales and scores.
    pub(super) fn columns(&self) -> impl Iterator<Item = (&'static str, Vec<f64>)> {
        let scales = Scale::ALL.into_iter().enumerate();
        let scores = [("raw_tlx", Some(&self.raw)), ("weighted_tlx", self.weighted.as_ref())];
        scales
            .map(|(index, scale)| (scale.name(), self.scale(index)))
            .chain(scores.into_iter().filter_map(|(name, values)| Some((name, values?.clone()))))
    }
}

/// Creates the error for a subject without weights if others have them.
pub(super) fn unweighted(subject: &str, condition: &str) -> Error {
    Error::Study(format!(
        "subject {subject:?} has no weights for the condition {condition:?} but others have; \
         weigh all questionnaires or none"
    ))
}
