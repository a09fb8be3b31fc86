//! Clips of a video whose frames are files.

use std::path::PathBuf;

use ndarray::{Array5, Axis};
use vision_models::{Preprocessing, read_image};

use crate::{
    error::Error,
    watch::{Event, Watch},
};

/// Reads the frames of a clip and returns the network's input, crops × 3 × frames × side × side.
///
/// The clip is given by the positions of its frames in the video. Only one original frame is in
/// memory at a time. `None` if the call-back stops the work.
///
/// # Errors
/// Names a frame that cannot be used or has another size than the first one.
pub(crate) fn read_clip(
    preprocessing: &Preprocessing,
    frames: &[PathBuf],
    indices: &[usize],
    watch: &mut Watch<'_>,
) -> Result<Option<Array5<f32>>, Error> {
    let mut clip: Option<(Array5<f32>, (usize, usize, usize))> = None;
    let paths = indices.iter().filter_map(|&index| frames.get(index));
    for (index, path) in paths.enumerate() {
        if watch(Event::Working).is_break() {
            return Ok(None);
        }
        let frame = read_image(path)?;
        let crops = preprocessing.image(frame.view()).map_err(Error::content(path))?;
        let (clip, size) = clip.get_or_insert_with(|| {
            let (count, channels, height, width) = crops.dim();
            let empty = Array5::zeros((count, channels, indices.len(), height, width));
            (empty, frame.dim())
        });
        let ((height, width, _), (own_height, own_width, _)) = (*size, frame.dim());
        if (height, width) != (own_height, own_width) {
            let found = format!(
                "{own_height} × {own_width} pixels, but the clip's first frame has {height} × {width}"
            );
            return Err(Error::at(path.display(), found));
        }
        clip.index_axis_mut(Axis(2), index).assign(&crops);
    }
    Ok(clip.map(|(clip, _)| clip))
}
