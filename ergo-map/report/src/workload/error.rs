//! What can be wrong with questionnaires.

/// Why one questionnaire has no score.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QuestionnaireError {
    /// No rating of performance.
    #[error(
        "no rating of performance; the table needs a column performance (0 is perfect, 20 is \
         failure) or performance_inverted (0 is failure, 20 is perfect)"
    )]
    NoPerformance,
    /// Performance is rated on both scales.
    #[error("performance and performance_inverted are both given; keep one")]
    TwoPerformances,
    /// Some weights, but not all six.
    #[error("weights for {found} of six scales; give all six, or none")]
    MissingWeights {
        /// How many there are.
        found: usize,
    },
    /// Weights that fifteen choices cannot give.
    #[error("the weights add up to {sum}; the fifteen choices between two scales add up to 15")]
    WeightSum {
        /// What they add up to.
        sum: f64,
    },
}

/// Why questionnaires cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorkloadError {
    /// There are none.
    #[error("the table has no questionnaire; give one a row")]
    Empty,
    /// A questionnaire without a score.
    #[error("subject {subject:?}, condition {condition:?}: {source}")]
    Questionnaire {
        /// Who answered.
        subject: String,
        /// Under which condition.
        condition: String,
        /// What is wrong.
        source: QuestionnaireError,
    },
    /// More subjects or conditions than any study has: the exact tests would take long.
    #[error("{found} {what}; at most {most} can be compared exactly")]
    TooMany {
        /// Subjects or conditions.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// The most that is taken.
        most: usize,
    },
    /// Two questionnaires of one subject under one condition.
    #[error("subject {subject:?} answers twice for the condition {condition:?}; keep one row")]
    Repeated {
        /// The subject.
        subject: String,
        /// The condition.
        condition: String,
    },
    /// A subject who did not work under each condition.
    #[error(
        "subject {subject:?} has no questionnaire for the condition {condition:?}; conditions are \
         compared subject by subject, so give it or leave the subject out"
    )]
    Unpaired {
        /// The subject.
        subject: String,
        /// The condition without an answer.
        condition: String,
    },
    /// Weights in some questionnaires only.
    #[error(
        "subject {subject:?} has no weights for the condition {condition:?} but others have; \
         weigh all questionnaires or none"
    )]
    Unweighted {
        /// The subject.
        subject: String,
        /// The condition.
        condition: String,
    },
    /// The figure cannot be drawn.
    #[error("cannot draw the figure: {0}")]
    Figure(String),
}
