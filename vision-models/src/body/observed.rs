//! A person as a pose network tells them: in the image, and in metres where it says so.

use nalgebra::Point3;

use super::{body_25::Body25, image_body::ImageBody};

/// A person's joints in metres from the middle of their hips, as a network sees them in an image: x to the right,
/// y downwards, z away from the camera. The default has none.
///
/// ```
/// use nalgebra::Point3;
/// use vision_models::{Body25, MetricBody};
///
/// let mut body = MetricBody::default();
/// body.set(Body25::LeftHip, Some(Point3::new(0.1, 0.0, 0.0)));
/// assert_eq!(body.iter().count(), 1);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MetricBody {
    points: [Option<Point3<f64>>; Body25::COUNT],
}

impl MetricBody {
    /// Returns the joint's position (m), if the network gave it.
    pub fn get(&self, joint: Body25) -> Option<Point3<f64>> {
        self.points[joint.index()]
    }

    /// Sets a joint, or removes it.
    pub fn set(&mut self, joint: Body25, point: Option<Point3<f64>>) {
        self.points[joint.index()] = point;
    }

    /// Returns the joints that the network gave, with their positions (m).
    pub fn iter(&self) -> impl Iterator<Item = (Body25, Point3<f64>)> + '_ {
        Body25::ALL.into_iter().zip(self.points).filter_map(|(joint, point)| Some((joint, point?)))
    }
}

/// Person in an image as a pose network finds them, with metric joints if the network gives them.
///
/// ```
/// use vision_models::{ImageBody, ObservedBody};
///
/// let nobody = ObservedBody::default();
/// assert!(nobody.metric.is_none() && nobody.image == ImageBody::default());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObservedBody {
    /// The joints in the image (pixels).
    pub image: ImageBody,
    /// The joints in metres.
    pub metric: Option<MetricBody>,
}
