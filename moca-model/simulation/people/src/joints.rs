//! The joints of a simulated person.

use nalgebra::Point3;
use vision_models::Body25;

/// The joints of `BODY_25` in the world (m).
pub type Joints = [Point3<f64>; Body25::COUNT];
