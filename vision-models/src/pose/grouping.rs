//! Groups joints to people from maps of joints and fields of limbs.
//!
//! Z. Cao, T. Simon, S.-E. Wei and Y. Sheikh, "Realtime multi-person 2D pose estimation using part affinity
//! fields", CVPR 2017, Sec. 2.3 and 2.4.

mod assembly;
mod limbs;
mod peaks;

use ndarray::ArrayView3;

use crate::body::ImageKeypoint;
use crate::error::Error;

/// The eighteen joints of OpenPose's COCO model. Each is known if it was seen.
pub type Coco18 = [Option<ImageKeypoint>; 18];

/// Settings for grouping joints to people. The defaults are OpenPose's.
///
/// ```
/// use vision_models::GroupingSettings;
///
/// let strict = GroupingSettings { least_joints: 8, ..GroupingSettings::default() };
/// assert!(strict.validate().is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupingSettings {
    /// Smallest height of a joint's maximum.
    pub peak: f64,
    /// Smallest component of a limb's field along the line between two joints, at a sample of the
    /// line.
    pub field: f64,
    /// Smallest share of such samples.
    pub along: f64,
    /// Smallest number of joints of a person, from 1 to 18.
    pub least_joints: usize,
    /// Smallest score of a person. It is the sum of the maxima of the joints and of the means along
    /// the limbs, divided by the number of joints.
    pub score: f64,
}

impl Default for GroupingSettings {
    fn default() -> Self {
        Self { peak: 0.1, field: 0.05, along: 0.8, least_joints: 4, score: 0.4 }
    }
}

impl GroupingSettings {
    /// Checks every setting.
    ///
    /// # Errors
    /// [`Error::Value`] names the first setting that is out of range.
    pub fn validate(&self) -> Result<(), Error> {
        let Self { peak, field, along, least_joints, score } = *self;
        let refuse = |name, value, expected| Err(Error::value(name, value, expected));
        for (name, value) in [("peak", peak), ("field", field), ("along", along)] {
            if !(0.0..=1.0).contains(&value) {
                return refuse(name, value, "a number from 0 to 1");
            }
        }
        if !(1..=18).contains(&least_joints) {
            return refuse("least_joints", least_joints as f64, "a number from 1 to 18");
        }
        if !(score.is_finite() && score >= 0.0) {
            return refuse("score", score, "a finite number, zero or more");
        }
        Ok(())
    }
}

/// Groups the joints of all people in an image.
///
/// `joints` are eighteen maps (and OpenPose's nineteenth, which is not read). `limbs` are
/// thirty-eight maps: the x and y components of the fields of nineteen limbs. Both are maps × rows
/// × columns.
///
/// Positions are returned in cells, the centre of the first at 0, 0, best people first. The 64
/// highest maxima of each joint are considered.
///
/// # Errors
/// - [`Error::Size`] if maps have other shapes.
/// - [`Error::Value`] if a value is NaN or infinite, or a setting is out of range.
///
/// ```
/// use ndarray::Array3;
/// use vision_models::{GroupingSettings, group_parts};
///
/// let (joints, limbs) = (Array3::zeros((19, 46, 62)), Array3::zeros((38, 46, 62)));
/// let people = group_parts(joints.view(), limbs.view(), &GroupingSettings::default())?;
/// assert!(people.is_empty());
/// # Ok::<(), vision_models::Error>(())
/// ```
pub fn group_parts(
    joints: ArrayView3<'_, f32>,
    limbs: ArrayView3<'_, f32>,
    settings: &GroupingSettings,
) -> Result<Vec<Coco18>, Error> {
    settings.validate()?;
    let ((joint_maps, rows, columns), (limb_maps, ..)) = (joints.dim(), limbs.dim());
    let is_one_size = joints.shape()[1..] == limbs.shape()[1..] && rows > 0 && columns > 0;
    if !(18..=19).contains(&joint_maps) || limb_maps != 38 || !is_one_size {
        let maps = format!("the array of joints, beside one of {:?} for limbs,", limbs.shape());
        let wanted = "19 (or 18) maps of joints and 38 of limbs, of one size";
        return Err(Error::size(&maps, joints.shape(), "values", wanted));
    }
    for maps in [&joints, &limbs] {
        if let Some(((map, row, column), &value)) =
            maps.indexed_iter().find(|(_, value)| !value.is_finite())
        {
            let place = format!("map {map}, row {row}, column {column}");
            return Err(Error::value(&place, value, "finite numbers"));
        }
    }
    let peaks = peaks::find(&joints, settings.peak);
    let connections = limbs::connect(&peaks, &limbs, settings);
    Ok(assembly::assemble(&peaks, connections, settings))
}
