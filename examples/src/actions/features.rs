//! Features of clips.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, ensure};
use ndarray::{Array2, Axis, s};
use vision_models::Crops;

use super::{
    clips::{LabelledClip, frames_of},
    network::{Views, Window},
};
use crate::{
    learning::{
        backbone::{ClipBackbone, Weights, WeightsIdentity},
        cache::FeatureCache,
        digest::Digest,
    },
    program::{Interrupt, Session},
    vision::clips::read_clip,
};

/// A network's features of clips, from disk where they are known.
#[derive(Debug)]
pub struct ClipFeatures {
    window: Window,
    backbone: ClipBackbone,
    cache: Option<FeatureCache>,
}

impl ClipFeatures {
    /// Of this network. The cache is `NETWORK.features` in a folder.
    ///
    /// # Errors
    /// As of [`FeatureCache::open`].
    pub fn new(
        window: Window,
        (weights, identity): (Weights, &WeightsIdentity),
        folder: Option<&PathBuf>,
        threads: usize,
    ) -> Result<Self> {
        let Window { network, length, interval, side } = &window;
        let key =
            format!("{network}, {length} frames every {interval}, short side {side}, {identity}");
        let open = |folder: &PathBuf| {
            fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
            FeatureCache::open(&folder.join(format!("{network}.features")), &key)
        };
        let cache = folder.map(open).transpose()?;
        let backbone = window.backbone(weights, threads)?;
        Ok(Self { window, backbone, cache })
    }

    /// The features of each clip, a row for each view. Less than all after an interrupt: the features so far are then
    /// in the cache.
    ///
    /// # Errors
    /// With the clip or the frame that cannot be used; of the network and the cache.
    pub fn of_clips(
        &mut self,
        clips: &[LabelledClip],
        views: Views,
        mirrored: bool,
        session: &Session,
    ) -> Result<Vec<Array2<f32>>> {
        let progress = session.progress("features of clips", clips.len() as u64);
        let mut all = Vec::new();
        for (done, clip) in (1..).zip(clips) {
            let Some(rows) = self.of_clip(&clip.folder, views, mirrored, session.interrupt())?
            else {
                if let Some(cache) = &self.cache {
                    let kept = cache.path().display();
                    session.warn(format_args!("the features so far are kept in {kept}"));
                }
                break;
            };
            all.push(rows);
            progress.set(done);
        }
        Ok(all)
    }

    /// The features of a clip, a row for each view; the views of the mirrored frames behind the others. None after an
    /// interrupt.
    ///
    /// # Errors
    /// As of [`Self::of_clips`].
    pub fn of_clip(
        &mut self,
        folder: &Path,
        views: Views,
        mirrored: bool,
        interrupt: &Interrupt,
    ) -> Result<Option<Array2<f32>>> {
        let frames = frames_of(folder, self.window.length)?;
        let crops = match views.crops {
            Crops::Centre => 1,
            Crops::Three => 3,
            Crops::Ten => 10,
        };
        let count = views.clips * crops * if mirrored { 2 } else { 1 };
        let Some(digest) = self.digest(&frames, views, mirrored, interrupt)? else {
            return Ok(None);
        };
        let known = digest.and_then(|digest| self.cache.as_ref().and_then(|c| c.get(&digest)));
        if let Some(features) = known {
            let width = features.len() / count;
            return Ok(Some(Array2::from_shape_vec((count, width), features.to_vec())?));
        }
        let preprocessing = self.window.preprocessing(views.crops)?;
        let mut plain = Vec::new();
        let mut of_mirrored = Vec::new();
        for indices in self.window.sampling(views.clips).indices(frames.len())? {
            let Some(clip) = read_clip(&preprocessing, &frames, &indices, interrupt)? else {
                return Ok(None);
            };
            // One view at a time: memory for one.
            for view in clip.axis_iter(Axis(0)) {
                let view = view.insert_axis(Axis(0));
                plain.extend(self.backbone.features(&view.to_owned())?);
                if mirrored {
                    let view = view.slice(s![.., .., .., .., ..;-1]).to_owned();
                    of_mirrored.extend(self.backbone.features(&view)?);
                }
            }
        }
        plain.extend(of_mirrored);
        if let (Some(cache), Some(digest)) = (&mut self.cache, digest) {
            cache.insert(digest, plain.clone())?;
        }
        ensure!(plain.len() % count == 0, "{}: features are missing", folder.display());
        Ok(Some(Array2::from_shape_vec((count, plain.len() / count), plain)?))
    }

    /// The key of a clip's features: the content of all frames, and which views. None after an interrupt; an empty one
    /// without a cache.
    #[expect(clippy::option_option, reason = "interrupted, or not needed")]
    fn digest(
        &self,
        frames: &[PathBuf],
        views: Views,
        mirrored: bool,
        interrupt: &Interrupt,
    ) -> Result<Option<Option<Digest>>> {
        if self.cache.is_none() {
            return Ok(Some(None));
        }
        let views = format!("{views:?} {mirrored}");
        let mut digests = vec![Digest::of_bytes(views.as_bytes())];
        for frame in frames {
            if interrupt.requested() {
                return Ok(None);
            }
            digests.push(Digest::of_file(frame, interrupt)?);
        }
        Ok(Some(Some(Digest::of_all(digests))))
    }
}
