//! A camera whose place is not known yet.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Point2, Point3};
use vision_models::Intrinsics;

use super::format::{CAMERA, CameraFile};
use super::reader::{camera_file, depth_image, unfit_camera};
use crate::error::Error;

/// Half the side of the square of pixels in which depths are looked up (pixels).
const AROUND: usize = 2;

/// A folder of frames whose camera is to be placed in the world. The place in its `camera.json`
/// does not count.
#[derive(Debug)]
pub struct CameraToPlace {
    folder: PathBuf,
    file: CameraFile,
    intrinsics: Intrinsics,
}

impl CameraToPlace {
    /// Reads the file `camera.json` of a folder.
    ///
    /// # Errors
    /// Names the file, and the expected form.
    pub fn read(folder: &Path) -> Result<Self, Error> {
        let path = folder.join(CAMERA);
        let file = camera_file(&path)?;
        let intrinsics = file.intrinsics().map_err(unfit_camera(&path))?;
        Ok(Self { folder: folder.to_owned(), file, intrinsics })
    }

    /// Returns the point at a depth (m) that is seen at a pixel, in the optical frame.
    ///
    /// # Errors
    /// A pixel outside the image, and a depth that is not positive.
    pub fn point(&self, pixel: [f64; 2], depth: f64) -> Result<Point3<f64>, Error> {
        let [width, height] = self.intrinsics.size().map(|side| side as f64);
        let is_inside = |value: f64, side: f64| value >= 0.0 && value <= side - 1.0;
        if !(is_inside(pixel[0], width) && is_inside(pixel[1], height)) {
            let found = format!("the pixel {}, {} is outside the image", pixel[0], pixel[1]);
            let wanted = format!("give column and row in an image of {width} × {height}");
            return Err(Error::unfit(self.folder.display(), found, wanted));
        }
        if !(depth > 0.0 && depth.is_finite()) {
            let found = format!("the depth is {depth}");
            return Err(Error::unfit(self.folder.display(), found, "give it in metres"));
        }
        Ok(self.intrinsics.back_project(&Point2::from(pixel), depth))
    }

    /// Returns the depth at a pixel of a frame's depth image (m): the median of those measured in
    /// 5 × 5 pixels.
    ///
    /// # Errors
    /// A depth image that cannot be read, and one without a measurement there.
    pub fn depth(&self, frame: u64, pixel: [f64; 2]) -> Result<f64, Error> {
        let path = self.folder.join("depth").join(format!("{frame:06}.png"));
        let image = depth_image(&path, self.file.depth_scale)?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let [column, row] = pixel.map(|value| value.round() as usize);
        let around = |middle: usize| middle.saturating_sub(AROUND)..=middle.saturating_add(AROUND);
        let pixels = around(row).flat_map(|row| around(column).map(move |column| (column, row)));
        let mut depths: Vec<f32> =
            pixels.filter_map(|(column, row)| image.depth(column, row)).collect();
        depths.sort_by(f32::total_cmp);
        depths.get(depths.len() / 2).map(|depth| f64::from(*depth)).ok_or_else(|| {
            let found = format!("no depth is measured around the pixel {}, {}", pixel[0], pixel[1]);
            Error::unfit(path.display(), found, "give a pixel on a surface that the camera sees")
        })
    }

    /// Returns the text of a `camera.json` with this place.
    ///
    /// # Errors
    /// A place that contradicts the gravity in the file, or turns the image upside down.
    pub fn placed(&mut self, world_from_camera: &Isometry3<f64>) -> Result<String, Error> {
        let path = self.folder.join(CAMERA);
        self.file.place(world_from_camera);
        self.file.camera().map_err(unfit_camera(&path))?;
        let text = serde_json::to_string(&self.file);
        text.map_err(|error| Error::at(path.display(), error))
    }
}
