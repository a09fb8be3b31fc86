//! Measures a recogniser.

use std::{io::Write, path::PathBuf};

use anyhow::{Result, bail, ensure};
use clap::{Args, ValueEnum};
use moca_model::Intention;
use serde::Serialize;
use vision_models::{Action, ActionGroup, Crops};

use super::{
    clips::{ClipSet, LabelledClip},
    features::ClipFeatures,
    model::{ActionModel, ModelWeights},
    network::Views,
    train::class_names,
};
use crate::{
    learning::{
        confusion_figure::confusion_figure,
        evaluation::{Evaluation, score_table},
        split::Part,
    },
    program::{Ending, Json, OutputFile, Quiet, Session, Threads, check_folder},
};

/// Recognises clips of known classes, and prints top-1, top-5, and a report by class and by the paper's three types of
/// actions.
///
/// With --output, a picture of the confusion matrix, the probabilities of every clip and the result as JSON go into a
/// folder.
#[derive(Args, Debug)]
pub struct Evaluate {
    /// As for `train`.
    folder: PathBuf,
    /// The folder of the trained model.
    #[arg(long, value_name = "FOLDER")]
    model: PathBuf,
    #[command(flatten)]
    weights: ModelWeights,
    /// Take the clips of this list, a name and a class in each line, instead of a part of the folder.
    #[arg(long, value_name = "FILE")]
    list: Option<PathBuf>,
    /// The classes of the list, one a line; HRI30's in alphabetical order if it is not given.
    #[arg(long, value_name = "FILE", requires = "list")]
    names: Option<PathBuf>,
    /// Which clips of the folder: a part of the training's split, or all.
    #[arg(long, default_value = "test", conflicts_with = "list")]
    part: PartOption,
    /// Windows along each clip, 1 to 64; the probabilities are the mean over all.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=64))]
    clips: u16,
    /// The parts of the frames.
    #[arg(long, default_value = "three")]
    crops: CropsOption,
    /// The folder for features, which later runs take from there.
    #[arg(long, value_name = "FOLDER")]
    cache: Option<PathBuf>,
    /// Write picture, probabilities and the result into this folder.
    #[arg(long, short, value_name = "FOLDER")]
    output: Option<PathBuf>,
    #[command(flatten)]
    threads: Threads,
    #[command(flatten)]
    json: Json,
    #[command(flatten)]
    quiet: Quiet,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum PartOption {
    /// What no training has seen.
    Test,
    /// What was trained with.
    Training,
    /// Every clip.
    All,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum CropsOption {
    /// The middle.
    Centre,
    /// Both ends and the middle.
    Three,
}

/// The line of `--json`.
#[derive(Serialize)]
struct Evaluated {
    classes: Vec<String>,
    #[serde(flatten)]
    evaluation: Evaluation,
    /// The share of clips that were given a class of the same intention, where all classes are HRI30's.
    intention_accuracy: Option<f64>,
    by_class: Vec<ClassReport>,
    /// Of the classes that are HRI30's.
    by_group: Vec<GroupReport>,
}

#[derive(Serialize)]
struct ClassReport {
    class: String,
    clips: u64,
    /// The share of its clips that were recognised.
    recall: Option<f64>,
    /// The share of clips that were taken for it that were its own.
    precision: Option<f64>,
}

#[derive(Serialize)]
struct GroupReport {
    group: ActionGroup,
    clips: u64,
    /// The share of clips that were given their class.
    accuracy: Option<f64>,
    /// The share of clips that were given a class of their group.
    group_accuracy: Option<f64>,
}

impl Evaluate {
    /// The option `--quiet`.
    pub fn quiet(&self) -> Quiet {
        self.quiet
    }

    /// Measures the recogniser.
    ///
    /// # Errors
    /// With the folder, the class, the clip or the option that is wrong.
    pub fn run(self, session: &mut Session) -> Result<Ending> {
        self.output.as_deref().map(check_folder).transpose()?;
        let model = ActionModel::read(&self.model)?;
        let mut clips = self.clips(&model)?;
        let weights = model.weights(&self.weights, session.interrupt())?;
        let (threads, window) = (self.threads.count(), model.window.clone());
        let source = (weights, &model.weights);
        let mut source = ClipFeatures::new(window, source, self.cache.as_ref(), threads)?;
        let crops = match self.crops {
            CropsOption::Centre => Crops::Centre,
            CropsOption::Three => Crops::Three,
        };
        let views = Views { clips: self.clips.into(), crops };
        let features = source.of_clips(&clips, views, false, session)?;
        let ending = if features.len() < clips.len() { Ending::Partial } else { Ending::Complete };
        if ending == Ending::Partial {
            session
                .interrupt()
                .check()
                .or_else(|error| if features.is_empty() { Err(error) } else { Ok(()) })?;
            let (done, all) = (features.len(), clips.len());
            session.warn(format_args!("interrupted after {done} of {all} clips"));
            clips.truncate(done);
        }
        let scores = model.of_clips(&features)?;
        let classes = model.head.classes();
        let scored = scores.iter().map(Vec::as_slice);
        let samples = clips.iter().map(|clip| clip.label).zip(scored);
        let evaluation = Evaluation::of(classes.len(), samples)?;
        let report = Evaluated {
            intention_accuracy: intention_accuracy(classes, &evaluation),
            by_class: by_class(classes, &evaluation),
            by_group: by_group(classes, &evaluation),
            classes: classes.to_vec(),
            evaluation,
        };
        report.write(session.output())?;
        if let (Some(folder), Ending::Complete) = (&self.output, ending) {
            std::fs::create_dir_all(folder)?;
            let name = &model.window.network;
            let figure = confusion_figure(name, classes, &report.evaluation.confusion)?;
            OutputFile::write_whole(folder.join("confusion.svg"), figure.as_bytes())?;
            let scored = clips.iter().zip(&scores);
            let samples =
                scored.map(|(clip, scores)| (clip.name.clone(), clip.label, scores.as_slice()));
            let table = score_table("clip", classes, samples);
            OutputFile::write_whole(folder.join("scores.csv"), table.as_bytes())?;
            let json = serde_json::to_string_pretty(&report)? + "\n";
            OutputFile::write_whole(folder.join("evaluation.json"), json.as_bytes())?;
        }
        session.conclude(self.json, &report, ending)
    }

    /// The clips of the list, or of the part that is asked for, with the model's classes.
    fn clips(&self, model: &ActionModel) -> Result<Vec<LabelledClip>> {
        let ClipSet { classes, mut clips } = match &self.list {
            Some(list) => ClipSet::of_list(&self.folder, list, &class_names(self.names.as_ref())?)?,
            None => ClipSet::of_folders(&self.folder)?,
        };
        let own = model.head.classes();
        for clip in &mut clips {
            let name = classes.get(clip.label).map_or("", String::as_str);
            let Some(label) = own.iter().position(|class| class == name) else {
                bail!(
                    "{}: \"{name}\" is no class of {}, whose classes are {}",
                    clip.folder.display(),
                    self.model.display(),
                    own.join(", ")
                );
            };
            clip.label = label;
        }
        let part = match self.part {
            _ if self.list.is_some() => return Ok(clips),
            PartOption::All => return Ok(clips),
            PartOption::Test => Part::Test,
            PartOption::Training => Part::Training,
        };
        clips.retain(|clip| model.parts.get(&clip.name) == Some(&part));
        ensure!(
            !clips.is_empty(),
            "{}: no clip is of this part of the training's split; --part all takes every clip",
            self.folder.display()
        );
        Ok(clips)
    }
}

impl Evaluated {
    fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
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
