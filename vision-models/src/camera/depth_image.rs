//! An image of depths.

use crate::error::Error;

/// Depths along the optical axis (m), row by row. Pixels without a measurement have none.
///
/// ```
/// use vision_models::DepthImage;
///
/// // Millimetres, as 16-bit depth images hold them; 0 is no measurement.
/// let image = DepthImage::from_units([2, 1], &[1500, 0], 0.001)?;
/// assert!(image.depth(0, 0).is_some_and(|depth| (depth - 1.5).abs() < 1e-6));
/// assert_eq!(image.depth(1, 0), None);
/// assert_eq!(image.depth(2, 0), None);
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DepthImage {
    size: [usize; 2],
    /// 0 where nothing was measured.
    depths: Vec<f32>,
}

impl DepthImage {
    /// Creates an image of width × height `size` from depths in metres. Depths that are NaN,
    /// infinite or not positive count as not measured.
    ///
    /// # Errors
    /// [`Error::Size`] if the number of depths does not match the size.
    pub fn from_metres(size: [usize; 2], mut depths: Vec<f32>) -> Result<Self, Error> {
        check_size(size, depths.len())?;
        for depth in &mut depths {
            if !(*depth > 0.0 && depth.is_finite()) {
                *depth = 0.0;
            }
        }
        Ok(Self { size, depths })
    }

    /// Creates an image from integers in units of `scale` metres. 0 is not measured.
    ///
    /// # Errors
    /// [`Error::Size`] as above. [`Error::Value`] if the scale is outside [1e-6, 1] m.
    pub fn from_units(size: [usize; 2], units: &[u16], scale: f64) -> Result<Self, Error> {
        check_size(size, units.len())?;
        check_scale(scale)?;
        let depths = units.iter().map(|&unit| {
            #[expect(clippy::cast_possible_truncation, reason = "a depth needs no more digits")]
            let depth = (f64::from(unit) * scale) as f32;
            depth
        });
        Ok(Self { size, depths: depths.collect() })
    }

    /// Returns width and height (pixels).
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Returns the depth at a pixel (m), if it is in the image and was measured.
    pub fn depth(&self, column: usize, row: usize) -> Option<f32> {
        let [width, _] = self.size;
        if column >= width {
            return None;
        }
        let depth = self.depths.get(row.checked_mul(width)?.checked_add(column)?)?;
        (*depth > 0.0).then_some(*depth)
    }

    /// Returns the depths (m), row by row. 0 where nothing was measured.
    pub fn depths(&self) -> &[f32] {
        &self.depths
    }
}

/// Checks the size of a unit of depth (m).
pub(super) fn check_scale(scale: f64) -> Result<(), Error> {
    if (1e-6..=1.0).contains(&scale) {
        Ok(())
    } else {
        let expected = "metres a unit, in [1e-6, 1]: 0.001 for millimetres";
        Err(Error::value("depth_scale", scale, expected))
    }
}

fn check_size(size: [usize; 2], found: usize) -> Result<(), Error> {
    let [width, height] = size;
    if width.checked_mul(height) == Some(found) && found > 0 {
        Ok(())
    } else {
        let image = format!("a depth image of {width} × {height} pixels");
        Err(Error::size(&image, &[found], "depths", "one for each pixel"))
    }
}
