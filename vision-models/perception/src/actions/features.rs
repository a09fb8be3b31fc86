//! Features of clips.

use std::path::{Path, PathBuf};

use ndarray::{Array2, Axis, s};
use vision_models::Crops;

use super::{
    clips::{LabelledClip, frames_of},
    window::{Views, Window},
};
use crate::{
    error::Error,
    file::make_folder,
    learning::{
        backbone::{ClipBackbone, Weights, WeightsIdentity},
        cache::FeatureCache,
        digest::Digest,
    },
    networks::clips::read_clip,
    watch::{Event, Watch},
};

/// A network's features of clips, read from disk if they are known.
#[derive(Debug)]
pub struct ClipFeatures {
    window: Window,
    backbone: ClipBackbone,
    cache: Option<FeatureCache>,
}

impl ClipFeatures {
    /// Creates the source for this network. The cache is `NETWORK.features` in a folder.
    ///
    /// # Errors
    /// Those of [`FeatureCache::open`].
    pub fn new(
        window: Window,
        (weights, identity): (Weights, &WeightsIdentity),
        folder: Option<&PathBuf>,
        threads: usize,
    ) -> Result<Self, Error> {
        let Window { network, length, interval, side } = &window;
        let key =
            format!("{network}, {length} frames every {interval}, short side {side}, {identity}");
        let open = |folder: &PathBuf| {
            make_folder(folder)?;
            FeatureCache::open(&folder.join(format!("{network}.features")), &key)
        };
        let cache = folder.map(open).transpose()?;
        let backbone = window.backbone(weights, threads)?;
        Ok(Self { window, backbone, cache })
    }

    /// Returns the network's input.
    pub fn window(&self) -> &Window {
        &self.window
    }

    /// Returns the features of each clip, one row per view. If the call-back stops the work, only
    /// the features so far are returned. They are in the cache.
    ///
    /// # Errors
    /// Names the clip or the frame that cannot be used, or returns an error of the network or the
    /// cache.
    pub fn of_clips(
        &mut self,
        clips: &[LabelledClip],
        views: Views,
        mirrored: bool,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<Array2<f32>>, Error> {
        let (what, count) = ("features of clips", clips.len() as u64);
        let mut all = Vec::new();
        for (done, clip) in (0..).zip(clips) {
            let _ = watch(Event::Progress { what, done, all: count });
            let Some(rows) = self.of_clip(&clip.folder, views, mirrored, watch)? else {
                if let Some(cache) = &self.cache {
                    cache.tell_kept(watch);
                }
                break;
            };
            all.push(rows);
        }
        let _ = watch(Event::Progress { what, done: count, all: count });
        Ok(all)
    }

    /// Returns the features of a clip, one row per view. The views of the mirrored frames come
    /// last. None if the call-back stops the work.
    ///
    /// # Errors
    /// Those of [`Self::of_clips`].
    pub fn of_clip(
        &mut self,
        folder: &Path,
        views: Views,
        mirrored: bool,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Array2<f32>>, Error> {
        let frames = match frames_of(folder, self.window.length, watch) {
            Err(Error::Stopped) => return Ok(None),
            frames => frames?,
        };
        let crops = match views.crops {
            Crops::Centre => 1,
            Crops::Three => 3,
            Crops::Ten => 10,
        };
        let count = views.clips * crops * if mirrored { 2 } else { 1 };
        let Some(digest) = self.digest(&frames, views, mirrored, watch)? else {
            return Ok(None);
        };
        let known = digest.and_then(|digest| self.cache.as_ref().and_then(|c| c.get(&digest)));
        if let Some(features) = known {
            let width = features.len() / count;
            let rows = Array2::from_shape_vec((count, width), features.to_vec());
            return Ok(Some(rows.map_err(|error| Error::at(folder.display(), error))?));
        }
        let preprocessing = self.window.preprocessing(views.crops)?;
        let mut plain = Vec::new();
        let mut of_mirrored = Vec::new();
        for indices in self.window.sampling(views.clips).indices(frames.len())? {
            let Some(clip) = read_clip(&preprocessing, &frames, &indices, watch)? else {
                return Ok(None);
            };
            // One view at a time, to save memory.
            for view in clip.axis_iter(Axis(0)) {
                let view = view.insert_axis(Axis(0));
                plain.extend(self.backbone.features(&view.to_owned(), watch)?);
                if mirrored {
                    let view = view.slice(s![.., .., .., .., ..;-1]).to_owned();
                    of_mirrored.extend(self.backbone.features(&view, watch)?);
                }
            }
        }
        plain.extend(of_mirrored);
        if let (Some(cache), Some(digest)) = (&mut self.cache, digest) {
            cache.insert(digest, plain.clone())?;
        }
        let rows = Array2::from_shape_vec((count, plain.len() / count), plain);
        let missing = |_| Error::at(folder.display(), "features are missing");
        Ok(Some(rows.map_err(missing)?))
    }

    /// Returns the key of a clip's features: the content of all frames, and the selected views.
    /// None if the call-back stops the work. Empty if there is no cache.
    #[expect(clippy::option_option, reason = "interrupted, or not needed")]
    fn digest(
        &self,
        frames: &[PathBuf],
        views: Views,
        mirrored: bool,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Option<Digest>>, Error> {
        if self.cache.is_none() {
            return Ok(Some(None));
        }
        let views = format!("{views:?} {mirrored}");
        let mut digests = vec![Digest::of_bytes(views.as_bytes())];
        for frame in frames {
            if watch(Event::Working).is_break() {
                return Ok(None);
            }
            digests.push(Digest::of_file(frame, watch)?);
        }
        Ok(Some(Some(Digest::of_all(digests))))
    }
}
