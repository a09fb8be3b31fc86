//! Cuts clips of each class from frames whose truth is known.

use std::path::PathBuf;

use crate::{frames::truth::TrueFilm, learning::cutting::Sample};

/// Settings for cutting clips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClipCut {
    /// Number of frames of a clip.
    pub length: usize,
    /// Number of frames from the beginning of a clip to that of the next.
    pub every: usize,
    /// Number of frames at the end of a clip in which its action must not change.
    pub settled: usize,
}

impl ClipCut {
    /// Returns the clips of a film. A clip has the action of its last frame, since a recogniser
    /// sees the frames up to the newest one. No clip contains a gap of lost frames.
    pub fn clips_of(self, film: &TrueFilm) -> Vec<Sample> {
        let Self { length, every, settled } = self;
        let mut clips = Vec::new();
        for frames in film.frames.windows(length.max(1)).step_by(every.max(1)) {
            let (Some((first, _)), Some((last, truth))) = (frames.first(), frames.last()) else {
                continue;
            };
            let action = truth.action.map(|seen| seen.action);
            let whole = last.frame - first.frame + 1 == frames.len() as u64;
            let mut at_end = frames.iter().rev().take(settled);
            let same = at_end.all(|(_, truth)| truth.action.map(|seen| seen.action) == action);
            if let Some(action) = action.filter(|_| whole && same) {
                let clip = PathBuf::from(format!("{}-{:06}", film.name, first.frame));
                let file = |(place, (entry, _)): (usize, &(_, _))| {
                    let from = film.reader().colour(entry);
                    let extension = from.extension().unwrap_or_default().to_string_lossy();
                    let to = clip.join(format!("{place:05}.{extension}"));
                    (from, to)
                };
                let files = frames.iter().enumerate().map(file).collect();
                clips.push(Sample { class: action.name().to_owned(), files });
            }
        }
        clips
    }
}
