//! Selects the frames of a video for a network.

use crate::error::Error;

/// Largest number of frames per clip and of clips per video. No network needs more.
const MOST: usize = 1024;

/// Selection of the frames of a video.
///
/// ```
/// use vision_models::ClipSampling;
///
/// // 8 frames, every fourth, of a video of 60 frames: the clip is in the middle.
/// let sampling = ClipSampling::Mmaction2 { length: 8, interval: 4, clips: 1 };
/// assert_eq!(sampling.indices(60)?, [[15, 19, 23, 27, 31, 35, 39, 43]]);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipSampling {
    /// mmaction2 1.x in test mode: clips spread from the video's start to its end, a single one in
    /// the middle. Indices beyond the end continue at the start.
    Mmaction2 {
        /// Number of frames per clip.
        length: usize,
        /// Distance in the video from one frame of the clip to the next.
        interval: usize,
        /// Number of clips per video, whose scores are averaged.
        clips: usize,
    },
    /// mmaction2 0.x in test mode, most likely the paper's: clips in the middle of equal parts.
    Mmaction2Before1 {
        /// Number of frames per clip.
        length: usize,
        /// Distance in the video from one frame of the clip to the next.
        interval: usize,
        /// Number of clips per video, whose scores are averaged.
        clips: usize,
    },
    /// PyTorchVideo: one clip, spread over the whole video.
    PyTorchVideo {
        /// Number of frames of the clip.
        length: usize,
    },
}

impl ClipSampling {
    /// Returns the frames of each clip of a video of `frames` frames, counted from zero.
    ///
    /// # Errors
    /// - [`Error::NoFrames`] if the video has no frames.
    /// - [`Error::Value`] if a length, an interval or a number of clips is not from 1 to 1,024.
    pub fn indices(self, frames: usize) -> Result<Vec<Vec<usize>>, Error> {
        if frames == 0 {
            return Err(Error::NoFrames);
        }
        match self {
            Self::Mmaction2 { length, interval, clips } => {
                check(length, interval, clips)?;
                let span = (length - 1) * interval + 1;
                Ok(spread(frames.saturating_sub(span), clips)
                    .map(|start| every(start, interval, length, frames))
                    .collect())
            }
            Self::Mmaction2Before1 { length, interval, clips } => {
                check(length, interval, clips)?;
                let span = length * interval;
                Ok(middles(frames.saturating_sub(span - 1), clips)
                    .map(|start| every(start, interval, length, frames))
                    .collect())
            }
            Self::PyTorchVideo { length } => {
                check(length, 1, 1)?;
                Ok(vec![even(frames, length)])
            }
        }
    }
}

fn check(length: usize, interval: usize, clips: usize) -> Result<(), Error> {
    for (name, value) in [("length", length), ("interval", interval), ("clips", clips)] {
        if value == 0 || value > MOST {
            let expected = "from 1 to 1,024";
            return Err(Error::value(name, value, expected));
        }
    }
    Ok(())
}

/// Returns evenly spaced starts from 0 to `last`, rounded half to even. A single one is at half of
/// `last`.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn spread(last: usize, clips: usize) -> impl Iterator<Item = usize> {
    let step = last as f64 / clips.saturating_sub(1).max(1) as f64;
    (0..clips).map(move |clip| {
        if clips == 1 { last / 2 } else { (clip as f64 * step).round_ties_even() as usize }
    })
}

/// Returns starts in the middle of equal parts of `starts` positions, or zero if there are none.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn middles(starts: usize, clips: usize) -> impl Iterator<Item = usize> {
    let part = starts as f64 / clips as f64;
    (0..clips).map(move |clip| (clip as f64 * part + part / 2.0) as usize)
}

fn every(start: usize, interval: usize, length: usize, frames: usize) -> Vec<usize> {
    (0..length).map(|index| start.saturating_add(index * interval) % frames).collect()
}

/// Returns `torch.linspace(0, frames - 1, length)`, floored. PyTorch computes in f32, the second
/// half from the end.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
fn even(frames: usize, length: usize) -> Vec<usize> {
    let last = frames - 1;
    let step = last as f32 / length.saturating_sub(1).max(1) as f32;
    let place = |index: usize| {
        if index < length.div_ceil(2) || length == 1 {
            step * index as f32
        } else {
            last as f32 - step * (length - 1 - index) as f32
        }
    };
    (0..length).map(|index| (place(index).max(0.0) as usize).min(last)).collect()
}
