use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::error::Result;
use crate::joints::JointAngles;
use crate::kinematics::{Body, Pose};
use crate::person::Person;
use crate::side::Side;

/// Places of the parts of the body \[m\], in the person's frame H. The origin of H is on the floor
/// below the pelvis of the person standing upright. x points forward, y left, and z up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmarks {
    /// Ankles (both, projected on the midplane).
    pub ankle: Vector3<f64>,
    /// Knees (both, projected on the midplane).
    pub knee: Vector3<f64>,
    /// Hips (both, projected on the midplane): the pelvis.
    pub hip: Vector3<f64>,
    /// Lumbar joint.
    pub lumbar: Vector3<f64>,
    /// Neck joint.
    pub neck: Vector3<f64>,
    /// Midpoint of the eyes.
    pub eyes: Vector3<f64>,
    /// Shoulder of the working arm.
    pub shoulder: Vector3<f64>,
    /// Shoulder of the other arm.
    pub other_shoulder: Vector3<f64>,
    /// Elbow of the working arm.
    pub elbow: Vector3<f64>,
    /// Wrist of the working arm.
    pub wrist: Vector3<f64>,
    /// Centre of the grip of the working hand.
    pub hand: Vector3<f64>,
    /// Axes of the hand: x along the fingers, z out of the back of the hand.
    pub hand_orientation: Rotation3<f64>,
    /// Centre of mass of the whole body.
    pub centre_of_mass: Vector3<f64>,
}

/// The skeleton of one person with one working arm.
///
/// ```
/// use ergo_map::{JointAngles, Person, Side, Skeleton};
/// let skeleton = Skeleton::new(&Person::average(), Side::Right);
/// let upright = skeleton.landmarks(&JointAngles::default())?;
/// assert!((upright.shoulder.z - 0.818 * 1.75).abs() < 1e-12);
/// # Ok::<(), ergo_map::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Skeleton {
    body: Body,
    stature: f64,
    side: Side,
}

impl Skeleton {
    /// Creates the skeleton of a person.
    pub fn new(person: &Person, side: Side) -> Self {
        Self { body: Body::new(person.proportions(), 0.0), stature: person.stature(), side }
    }

    /// Computes the forward kinematics.
    ///
    /// # Errors
    /// [`crate::Error::Value`] if a joint angle is invalid.
    pub fn landmarks(&self, angles: &JointAngles) -> Result<Landmarks> {
        angles.validate()?;
        let chain = match self.side {
            Side::Right => *angles,
            Side::Left => angles.mirrored(),
        };
        let pose = Pose::new(&self.body, &chain.to_array());
        let place = |p: Vector3<f64>| match self.side {
            Side::Right => p * self.stature,
            Side::Left => Vector3::new(p.x, -p.y, p.z) * self.stature,
        };
        let hand = Rotation3::from_matrix_unchecked(hand_axes(&pose.palm));
        Ok(Landmarks {
            ankle: place(pose.origin[0]),
            knee: place(pose.knee),
            hip: place(pose.hip),
            lumbar: place(pose.lumbar),
            neck: place(pose.neck),
            eyes: place(pose.eye),
            shoulder: place(pose.shoulder),
            other_shoulder: place(pose.other_shoulder),
            elbow: place(pose.elbow),
            wrist: place(pose.wrist),
            hand: place(pose.hand),
            hand_orientation: match self.side {
                Side::Right => hand,
                Side::Left => mirror_rotation(&hand),
            },
            centre_of_mass: place(pose.total.1 / pose.total.0),
        })
    }
}

/// Returns the axes of the right hand (x fingers, z back of the hand) from the chain's (fingers -z,
/// palm +y).
pub(crate) fn hand_axes(palm: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_columns(&[-palm.column(2), palm.column(0).into_owned(), -palm.column(1)])
}

/// Mirrors a rotation in the body's midplane.
pub(crate) fn mirror_rotation(rotation: &Rotation3<f64>) -> Rotation3<f64> {
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
    Rotation3::from_matrix_unchecked(mirror * rotation.matrix() * mirror)
}
