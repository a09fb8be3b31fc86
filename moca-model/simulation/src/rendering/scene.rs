//! The scene in front of the camera.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use simulated_people::Joints;
use vision_models::{Action, Body25, Camera, Surface};

use super::{
    appearance::{self, Appearance, Colour},
    body,
    shape::{Capsule, Hit, TexturedBox, plane},
};

/// Walls behind the person, in the world \[m\].
const WALL_PLACES: [(Point3<f64>, Vector3<f64>); 2] = [
    (Point3::new(6.0, 0.0, 0.0), Vector3::new(-1.0, 0.0, 0.0)),
    (Point3::new(0.0, -4.5, 0.0), Vector3::new(0.0, 1.0, 0.0)),
];

/// First place of the grasped object in the world \[m\].
const OBJECT_PLACE: Point3<f64> = Point3::new(0.75, 0.0, 1.05);

/// The state of the simulation at a moment.
#[derive(Clone, Copy, Debug)]
pub struct SceneState<'a> {
    /// The person's joints in the world (m).
    pub joints: &'a Joints,
    /// The person's stature (m).
    pub stature: f64,
    /// The person's action. A tool that is used or picked up is in the right hand; a carried object is in both hands.
    pub action: Action,
    /// The surface of the object.
    pub surface: Surface,
    /// Colours and light.
    pub appearance: &'a Appearance,
}

/// The shapes of a moment in the optical frame of a camera.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(super) capsules: Vec<Capsule>,
    pub(super) boxes: Vec<TexturedBox>,
    planes: Vec<(Point3<f64>, Vector3<f64>, Colour)>,
    /// Direction towards the light.
    pub(super) light: Vector3<f64>,
}

impl Scene {
    /// Creates the scene in front of a camera: the person with what they carry, the grasped object, floor and walls.
    pub fn new(state: &SceneState<'_>, camera: &Camera) -> Self {
        let camera_from_world = camera.world_from_camera().inverse();
        let SceneState { joints, appearance, .. } = *state;
        let seen = |capsule: Capsule| Capsule {
            ends: capsule.ends.map(|end| camera_from_world * end),
            ..capsule
        };
        let in_hands = state.action == Action::WalkingWithObject;
        let object = TexturedBox {
            pose: camera_from_world
                * if in_hands {
                    carried(joints)
                } else {
                    OBJECT_PLACE.coords.into_translation().into()
                },
            half: Vector3::new(0.04, 0.20, 0.15),
            colour: appearance.object,
            perforated: state.surface == Surface::Drilled,
        };
        let tool = state.action.tool().map(|tool| {
            let (colour, half) = appearance::tool(tool);
            let pose = camera_from_world * in_right_hand(joints);
            TexturedBox { pose, half, colour, perforated: false }
        });
        let floor = (Point3::origin(), Vector3::z(), appearance.floor);
        let walls = WALL_PLACES.map(|(place, normal)| (place, normal, appearance.wall));
        let planes = std::iter::once(floor).chain(walls).map(|(place, normal, colour)| {
            (camera_from_world * place, camera_from_world * normal, colour)
        });
        Self {
            capsules: body::capsules(joints, state.stature, appearance).map(seen).collect(),
            boxes: std::iter::once(object).chain(tool).collect(),
            planes: planes.collect(),
            light: appearance.light,
        }
    }

    /// The surface behind everything else.
    pub(super) fn background(&self, ray: &Vector3<f64>) -> Option<Hit> {
        let hits = self
            .planes
            .iter()
            .filter_map(|(place, normal, colour)| plane(ray, place, normal, *colour));
        hits.min_by(|one, other| one.depth.total_cmp(&other.depth))
    }
}

/// The pose of a tool in the right hand, along the forearm.
fn in_right_hand(joints: &Joints) -> Isometry3<f64> {
    let [elbow, wrist] =
        [Body25::RightElbow, Body25::RightWrist].map(|joint| joints[joint.index()]);
    let along = (wrist - elbow).try_normalize(1e-9).unwrap_or(Vector3::x());
    let turn = UnitQuaternion::rotation_between(&Vector3::x(), &along);
    let place = wrist + along * 0.15;
    Isometry3::from_parts(Translation3::from(place.coords), turn.unwrap_or_default())
}

/// The pose of an object in front of both hands, with its face forwards.
fn carried(joints: &Joints) -> Isometry3<f64> {
    use Body25::{LeftShoulder, LeftWrist, RightShoulder, RightWrist};
    let at = |joint: Body25| joints[joint.index()];
    let left = at(LeftShoulder) - at(RightShoulder);
    let forwards = Vector3::new(left.y, -left.x, 0.0).try_normalize(1e-9).unwrap_or(Vector3::x());
    let place = nalgebra::center(&at(LeftWrist), &at(RightWrist)) + forwards * 0.08;
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), forwards.y.atan2(forwards.x));
    Isometry3::from_parts(Translation3::from(place.coords), turn)
}

/// Conversion of a vector to a translation.
trait IntoTranslation {
    fn into_translation(self) -> Translation3<f64>;
}

impl IntoTranslation for Vector3<f64> {
    fn into_translation(self) -> Translation3<f64> {
        Translation3::from(self)
    }
}
