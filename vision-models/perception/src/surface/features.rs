//! Features of images in folders.

use std::path::{Path, PathBuf};

use ndarray::{Array2, Array4, s};
use vision_models::{
    Error as VisionError, Preprocessing, ResNetDepth, decode_image, file::read_bytes,
};

use crate::{
    error::Error,
    file::make_folder,
    learning::{
        backbone::{ImageBackbone, Weights, WeightsIdentity},
        cache::FeatureCache,
        digest::Digest,
    },
    networks::folders::{LabelledImage, Unreadable},
    watch::{Event, Watch},
};

/// The paper's preprocessing: 255 × 255, centre crop 224 × 224.
pub const PREPROCESSING: Preprocessing = Preprocessing::SURFACE;

/// Largest image file that is read (bytes).
const MOST: u64 = 256 << 20;

/// A network's features of images, read from disk if they are known.
#[derive(Debug)]
pub struct FeatureSource {
    name: String,
    backbone: ImageBackbone,
    cache: Option<FeatureCache>,
}

/// The mirrored versions of images.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flips {
    /// Only the plain images.
    None,
    /// Both: each image gives two samples.
    Horizontal,
}

/// Features of images with their classes.
#[derive(Clone, Debug)]
pub struct Features {
    /// Samples × features.
    pub rows: Array2<f32>,
    /// Class of each sample.
    pub labels: Vec<usize>,
    /// Image of each sample.
    pub paths: Vec<PathBuf>,
}

/// Returns the name of a ResNet in files and messages.
pub fn name_of(depth: ResNetDepth) -> String {
    format!("resnet{}", depth.layers())
}

impl FeatureSource {
    /// Creates the source for this network. The cache is `NAME.features` in a folder.
    ///
    /// # Errors
    /// Those of [`FeatureCache::open`].
    pub fn new(
        depth: ResNetDepth,
        (weights, identity): (Weights, &WeightsIdentity),
        folder: Option<&PathBuf>,
        threads: usize,
    ) -> Result<Self, Error> {
        let name = name_of(depth);
        let key = format!("{name}, 255 x 255, crop 224, {identity}");
        let open = |folder: &PathBuf| {
            make_folder(folder)?;
            FeatureCache::open(&folder.join(format!("{name}.features")), &key)
        };
        let cache = folder.map(open).transpose()?;
        let backbone = ImageBackbone::new(weights, depth, PREPROCESSING.crop, threads);
        Ok(Self { name, backbone, cache })
    }

    /// Returns the features of images. Images that cannot be read are left out. None if the
    /// call-back stops the work. The features so far are then in the cache.
    ///
    /// # Errors
    /// Those of [`Unreadable::leave_out`], of the network and of the cache.
    pub fn of_images(
        &mut self,
        images: &[LabelledImage],
        flips: Flips,
        unreadable: &mut Unreadable,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Features>, Error> {
        let (what, all) = (format!("features of {}", self.name), images.len() as u64);
        let mut rows = Vec::new();
        let (mut labels, mut paths, mut width) = (Vec::new(), Vec::new(), 0);
        for (done, LabelledImage { path, label }) in (0..).zip(images) {
            if watch(Event::Progress { what: &what, done, all }).is_break() {
                if let Some(cache) = &self.cache {
                    cache.tell_kept(watch);
                }
                return Ok(None);
            }
            match read(path) {
                Ok(bytes) => match self.of_image(&bytes, flips, watch) {
                    Ok(own) => {
                        for row in own {
                            width = row.len();
                            rows.extend(row);
                            labels.push(*label);
                            paths.push(path.clone());
                        }
                    }
                    Err(Error::Vision(VisionError::Image { reason, .. })) => {
                        let path = path.display().to_string();
                        unreadable.leave_out(VisionError::Image { path, reason }.into(), watch)?;
                    }
                    Err(error) => return Err(error),
                },
                Err(error) => unreadable.leave_out(error.into(), watch)?,
            }
        }
        let _ = watch(Event::Progress { what: &what, done: all, all });
        let rows = Array2::from_shape_vec((labels.len(), width), rows)
            .map_err(|error| Error::at(what, error))?;
        Ok(Some(Features { rows, labels, paths }))
    }

    /// Returns one row of features, or two.
    fn of_image(
        &mut self,
        bytes: &[u8],
        flips: Flips,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<Vec<f32>>, Error> {
        let plain = Digest::of_bytes(bytes);
        let mirrored = Digest::of_all([plain, Digest::of_bytes(b"mirrored")]);
        let mut rows = Vec::new();
        // The image is decoded once at most.
        let mut image: Option<Array4<f32>> = None;
        let views = if flips == Flips::None { 1 } else { 2 };
        for (digest, flip) in [(plain, false), (mirrored, true)].into_iter().take(views) {
            let known = self.cache.as_ref().and_then(|cache| cache.get(&digest));
            if let Some(features) = known {
                rows.push(features.to_vec());
                continue;
            }
            let image = match &mut image {
                Some(image) => image,
                none => none.insert(PREPROCESSING.image(decode_image(bytes)?.view())?),
            };
            // The crop is central up to half a pixel, so mirroring it equals mirroring the image.
            let features = if flip {
                self.backbone.features(&image.slice(s![.., .., .., ..;-1]).to_owned(), watch)?
            } else {
                self.backbone.features(image, watch)?
            };
            if let Some(cache) = &mut self.cache {
                cache.insert(digest, features.clone())?;
            }
            rows.push(features);
        }
        Ok(rows)
    }
}

/// Reads a file within the size limit of images.
fn read(path: &Path) -> Result<Vec<u8>, VisionError> {
    let refuse = |reason: String| VisionError::File { path: path.display().to_string(), reason };
    read_bytes(path, MOST).map_err(|error| refuse(error.to_string()))
}

/// Returns CLASS/FILE, by which a model identifies an image.
pub fn path_within(folder: &Path, path: &Path) -> String {
    path.strip_prefix(folder).unwrap_or(path).display().to_string()
}
