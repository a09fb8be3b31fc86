//! Quality of a recogniser, from the scores of clips.

use std::{io::Write, path::Path};

use serde::{Deserialize, Serialize};
use vision_models::{Action, ActionGroup, Intention};

use super::window::Window;
use crate::{
    error::Error,
    file::{make_folder, write_whole},
    learning::{
        backbone::WeightsIdentity,
        confusion_figure::confusion_figure,
        description,
        evaluation::{Evaluation, score_table},
    },
};

/// The settings that all shards of an evaluation share.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EvaluationJob {
    /// Names of the classes.
    pub classes: Vec<String>,
    /// The network's input.
    pub window: Window,
    /// The network's weights.
    pub weights: WeightsIdentity,
    /// Number of windows along each clip.
    pub windows: usize,
    /// The crops of the frames.
    pub crops: String,
    /// The selected clips of the folder.
    pub clips: String,
}

/// A clip with its class and the recogniser's scores.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScoredClip {
    /// Name of the clip.
    pub name: String,
    /// Index of the class.
    pub label: usize,
    /// Probability of each class.
    pub scores: Vec<f32>,
}

/// Quality of a recogniser, by class and by type of action. It is written as one line of JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Evaluated {
    classes: Vec<String>,
    #[serde(flatten)]
    evaluation: Evaluation,
    /// Share of clips that were given a class of the same intention, if all classes are HRI30's.
    intention_accuracy: Option<f64>,
    by_class: Vec<ClassReport>,
    /// Results by type of action, for the classes that are HRI30's.
    by_group: Vec<GroupReport>,
}

#[derive(Clone, Debug, Serialize)]
struct ClassReport {
    class: String,
    clips: u64,
    /// Share of the class's clips that were recognised.
    recall: Option<f64>,
    /// Share of true clips among those that were given the class.
    precision: Option<f64>,
}

#[derive(Clone, Debug, Serialize)]
struct GroupReport {
    group: ActionGroup,
    clips: u64,
    /// Share of clips that were given their class.
    accuracy: Option<f64>,
    /// Share of clips that were given a class of their group.
    group_accuracy: Option<f64>,
}

impl Evaluated {
    /// Evaluates the clips of a run, in their order.
    ///
    /// # Errors
    /// Names a clip of a class that the run does not have.
    pub fn of(job: &EvaluationJob, clips: &[ScoredClip]) -> Result<Self, Error> {
        let classes = job.classes.as_slice();
        let samples = clips.iter().map(|clip| (clip.label, clip.scores.as_slice()));
        let evaluation = Evaluation::of(classes.len(), samples)?;
        Ok(Self {
            intention_accuracy: intention_accuracy(classes, &evaluation),
            by_class: by_class(classes, &evaluation),
            by_group: by_group(classes, &evaluation),
            classes: classes.to_vec(),
            evaluation,
        })
    }

    /// Writes the figure of the confusion matrix, the probabilities of every clip and the result as
    /// JSON into a folder.
    ///
    /// # Errors
    /// Names the place that cannot be written.
    pub fn write_folder(
        &self,
        folder: &Path,
        job: &EvaluationJob,
        clips: &[ScoredClip],
    ) -> Result<(), Error> {
        let classes = job.classes.as_slice();
        make_folder(folder)?;
        let figure = confusion_figure(&job.window.network, classes, &self.evaluation.confusion)?;
        write_whole(&folder.join("confusion.svg"), figure.as_bytes())?;
        let samples =
            clips.iter().map(|clip| (clip.name.clone(), clip.label, clip.scores.as_slice()));
        let table = score_table("clip", classes, samples);
        write_whole(&folder.join("scores.csv"), table.as_bytes())?;
        description::write(&folder.join("evaluation.json"), self)
    }

    /// Writes the tables.
    ///
    /// # Errors
    /// The system's error.
    pub fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let percent = |share: Option<f64>| 100.0 * share.unwrap_or(f64::NAN);
        let width = self.classes.iter().map(|name| name.chars().count()).max().unwrap_or(0).max(25);
        writeln!(out, "{:<width$}   clips   recall, %   precision, %", "class")?;
        for ClassReport { class, clips, recall, precision } in &self.by_class {
            let (recall, precision) = (percent(*recall), percent(*precision));
            writeln!(out, "{class:<width$} {clips:7}     {recall:7.2}        {precision:7.2}")?;
        }
        if !self.by_group.is_empty() {
            writeln!(out, "\n{:<width$}   clips    top-1, %   right type, %", "type")?;
        }
        for GroupReport { group, clips, accuracy, group_accuracy } in &self.by_group {
            let (accuracy, of_group) = (percent(*accuracy), percent(*group_accuracy));
            writeln!(out, "{group:<width$} {clips:7}     {accuracy:7.2}         {of_group:7.2}")?;
        }
        let Evaluation { samples, accuracy, top5, .. } = &self.evaluation;
        let (top1, top5) = (percent(*accuracy), percent(*top5));
        write!(out, "\n{samples} clips: top-1 {top1:.2} %, top-5 {top5:.2} %")?;
        if self.intention_accuracy.is_some() {
            write!(out, ", right intention {:.2} %", percent(self.intention_accuracy))?;
        }
        writeln!(out)
    }
}

fn share(part: u64, whole: u64) -> Option<f64> {
    (whole > 0).then(|| part as f64 / whole as f64)
}

fn intention_accuracy(classes: &[String], evaluation: &Evaluation) -> Option<f64> {
    let of_label = |class: &String| {
        Some(Intention::from(Action::from_label(class).ok()?).regardless_of_tool())
    };
    let intentions: Vec<Intention> = classes.iter().map(of_label).collect::<Option<_>>()?;
    let (mut right, mut all) = (0, 0);
    for (row, own) in evaluation.confusion.iter().zip(&intentions) {
        for (count, given) in row.iter().zip(&intentions) {
            all += count;
            right += if own == given { *count } else { 0 };
        }
    }
    share(right, all)
}

fn by_class(classes: &[String], evaluation: &Evaluation) -> Vec<ClassReport> {
    let confusion = &evaluation.confusion;
    let of = |(label, class): (usize, &String)| {
        let (own, row) = (confusion[label][label], confusion[label].iter().sum());
        let column = confusion.iter().map(|row| row[label]).sum();
        let class = class.clone();
        ClassReport { class, clips: row, recall: share(own, row), precision: share(own, column) }
    };
    classes.iter().enumerate().map(of).collect()
}

fn by_group(classes: &[String], evaluation: &Evaluation) -> Vec<GroupReport> {
    let groups: Vec<Option<ActionGroup>> =
        classes.iter().map(|class| Action::from_label(class).ok().map(Action::group)).collect();
    let known = ActionGroup::ALL.into_iter().filter(|group| groups.contains(&Some(*group)));
    let report = |group| {
        let (mut clips, mut right, mut within) = (0, 0, 0);
        let rows = evaluation.confusion.iter().enumerate();
        for (label, row) in rows.filter(|(label, _)| groups[*label] == Some(group)) {
            clips += row.iter().sum::<u64>();
            right += row[label];
            let own = row.iter().zip(&groups).filter(|(_, other)| **other == Some(group));
            within += own.map(|(count, _)| count).sum::<u64>();
        }
        let (accuracy, group_accuracy) = (share(right, clips), share(within, clips));
        GroupReport { group, clips, accuracy, group_accuracy }
    };
    known.map(report).collect()
}
