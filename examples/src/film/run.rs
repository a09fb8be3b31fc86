//! Scores a film image by image.

use std::{io::Write, path::PathBuf};

use anyhow::{Result, bail};
use clap::Args;
use ergo_map::{ActionLevel, LegSupport, Side, Worksheet};
use ergo_report::sheets::Sheet;
use human_perception::film::{FilmedPosture, score_figure};
use percept_recording::{Header, Timing, Writer};
use serde::Serialize;
use vision_models::Percept;

use super::options::FilmOptions;
use crate::program::{Ending, OutputFile, Session};

/// Files that are written beside what is printed.
#[derive(Args, Debug)]
pub struct Outputs {
    /// Write a picture of a film's scores along time (SVG).
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Write the joints of a film in the world as a recording, which `follow` plays (JSON Lines).
    #[arg(long, value_name = "FILE")]
    recording: Option<PathBuf>,
}

/// The line of `--json`.
#[derive(Debug, Serialize)]
pub struct FilmReport {
    images: u64,
    /// Images in which the person was seen.
    seen: u64,
    scored: u64,
    reba_mean: f64,
    reba_max: u8,
    rula_mean: f64,
    rula_max: u8,
    /// Shares of the scored time at each of REBA's action levels.
    action_levels: [f64; 5],
    /// Follows from the lengths of limbs (m).
    stature: Option<f64>,
    stature_sigma: Option<f64>,
}

/// The columns before the scores.
const COLUMNS: [&str; 16] = [
    "time_s",
    "image",
    "side",
    "walking",
    "sitting",
    "trunk_flex_deg",
    "neck_flex_deg",
    "knee_flex_deg",
    "upper_arm_flex_deg",
    "lower_arm_flex_deg",
    "wrist_flex_deg",
    "trunk_twist_or_side",
    "neck_twist_or_side",
    "arm_abducted_or_rotated",
    "arm_supported",
    "wrist_dev_or_twist",
];

/// Scores a film, prints the scores along time, and writes table, picture and recording where they are asked for.
///
/// # Errors
/// Films, networks and calibrations that cannot be used, and films without a person.
pub fn score(
    options: &FilmOptions,
    outputs: &Outputs,
    table: Option<OutputFile>,
    session: &mut Session,
) -> Result<(FilmReport, Ending)> {
    let picture = outputs.picture.as_ref().map(OutputFile::create).transpose()?;
    let recording = outputs.recording.as_ref().map(OutputFile::create).transpose()?;
    let mut film = options.open()?;
    let progress = session.open_progress("scored images");
    let mut postures: Vec<FilmedPosture> = Vec::new();
    let mut ending = Ending::Complete;
    while let Some(posture) = film.next_posture()? {
        postures.push(posture);
        progress.set(postures.len() as u64);
        if session.interrupt().requested() {
            ending = Ending::Partial;
            break;
        }
    }
    progress.finish();
    let stature = film.stature();
    let report = report(&postures, stature);
    if report.scored == 0 {
        bail!("{}: nobody whose trunk was seen", options.title());
    }
    print(&report, &postures, session)?;
    let keep = |file: OutputFile| match ending {
        Ending::Partial => file.keep_partial().map(drop),
        _ => file.keep(),
    };
    if let Some(mut file) = table {
        write_table(&mut file, &postures)?;
        keep(file)?;
    }
    if let Some(mut file) = picture {
        file.push(score_figure(&options.title(), &postures)?.as_bytes())?;
        keep(file)?;
    }
    if let Some(file) = recording {
        let stature = stature.map(|[stature, _]| (stature * 1e3).round() / 1e3);
        let mut writer =
            Writer::new(file, &Header { rate: options.rate(), stature, ..Header::default() })?;
        for FilmedPosture { time, body, .. } in &postures {
            let percept = Percept { time: *time, body: body.clone(), action: None, surface: None };
            writer.write_people(&percept, &[], &Timing::default())?;
        }
        keep(if ending == Ending::Partial {
            writer.finish_partial()?
        } else {
            writer.finish()?
        })?;
    }
    Ok((report, ending))
}

fn report(postures: &[FilmedPosture], stature: Option<[f64; 2]>) -> FilmReport {
    let mut report = FilmReport {
        images: postures.len() as u64,
        seen: postures.iter().filter(|posture| posture.body.is_some()).count() as u64,
        scored: 0,
        reba_mean: 0.0,
        reba_max: 0,
        rula_mean: 0.0,
        rula_max: 0,
        action_levels: [0.0; 5],
        stature: stature.map(|[stature, _]| stature),
        stature_sigma: stature.map(|[_, sigma]| sigma),
    };
    for (scores, _) in postures.iter().filter_map(|posture| posture.scores) {
        report.scored += 1;
        let weight = 1.0 / report.scored as f64;
        report.reba_mean += weight * (f64::from(scores.reba.reba) - report.reba_mean);
        report.rula_mean += weight * (f64::from(scores.rula.rula) - report.rula_mean);
        report.reba_max = report.reba_max.max(scores.reba.reba);
        report.rula_max = report.rula_max.max(scores.rula.rula);
        report.action_levels[usize::from(scores.reba.action_level.number())] += 1.0;
    }
    let scored = report.scored.max(1) as f64;
    report.action_levels.iter_mut().for_each(|share| *share /= scored);
    report
}

fn print(report: &FilmReport, postures: &[FilmedPosture], session: &mut Session) -> Result<()> {
    let out = session.output();
    writeln!(out, "  time  REBA  RULA   (the worst of each second)")?;
    let mut second: Option<(f64, u8, u8)> = None;
    let line = |out: &mut dyn Write, second: Option<(f64, u8, u8)>| match second {
        Some((time, reba, rula)) => writeln!(out, "{time:4.0} s  {reba:4}  {rula:4}"),
        None => Ok(()),
    };
    for posture in postures {
        let Some((scores, _)) = posture.scores else { continue };
        let (time, reba, rula) = (posture.time.floor(), scores.reba.reba, scores.rula.rula);
        second = match second {
            Some((begun, worst, also)) if begun == time => {
                Some((time, worst.max(reba), also.max(rula)))
            }
            before => {
                line(out, before)?;
                Some((time, reba, rula))
            }
        };
    }
    line(out, second)?;
    let FilmReport { images, seen, reba_mean, reba_max, rula_mean, rula_max, .. } = report;
    writeln!(out, "{images} images, the person in {seen}")?;
    writeln!(
        out,
        "REBA {reba_mean:.1}, {reba_max} at most; RULA {rula_mean:.1}, {rula_max} at most"
    )?;
    let levels = [
        ActionLevel::None,
        ActionLevel::MayBeNecessary,
        ActionLevel::Necessary,
        ActionLevel::NecessarySoon,
        ActionLevel::NecessaryNow,
    ];
    let asked =
        ["nothing", "a change may be necessary", "necessary", "necessary soon", "necessary now"];
    for ((level, asked), share) in levels.iter().zip(asked).zip(report.action_levels) {
        if share > 0.0 {
            writeln!(
                out,
                "  action level {} ({asked}): {:.0} % of the time",
                level.number(),
                100.0 * share
            )?;
        }
    }
    if let Some((stature, sigma)) = report.stature.zip(report.stature_sigma) {
        writeln!(
            out,
            "stature by the lengths of limbs {stature:.2} m, standard deviation {sigma:.2} m"
        )?;
    }
    Ok(())
}

/// A row for each image with scores. The first columns are a table of sheets.
fn write_table(out: &mut impl Write, postures: &[FilmedPosture]) -> Result<()> {
    writeln!(out, "{},{},rula", COLUMNS.join(","), Worksheet::SCORES.join(","))?;
    for posture in postures {
        let Some((scores, sheet)) = posture.scores else { continue };
        let angles = [
            sheet.trunk_flexion,
            sheet.neck_flexion,
            sheet.knee_flexion,
            sheet.upper_arm_flexion,
            sheet.elbow_flexion,
            sheet.wrist_flexion,
        ];
        let boxes = [
            sheet.trunk_twisted_or_bent,
            sheet.neck_twisted_or_bent,
            sheet.arm_abducted_or_rotated,
            sheet.conditions.arm_supported,
            sheet.wrist_deviated_or_twisted,
        ];
        let support = sheet.conditions.support;
        let mut cells = vec![
            format!("{:.3}", posture.time),
            posture.number.to_string(),
            if scores.side == Side::Left { "left" } else { "right" }.to_owned(),
            u8::from(support == LegSupport::Walking).to_string(),
            u8::from(support == LegSupport::Sitting).to_string(),
        ];
        cells.extend(angles.map(|angle| format!("{:.2}", angle.to_degrees())));
        cells.extend(boxes.map(|ticked| u8::from(ticked).to_string()));
        cells.extend(sheet.scores()?);
        cells.push(scores.rula.rula.to_string());
        writeln!(out, "{}", cells.join(","))?;
    }
    Ok(())
}
