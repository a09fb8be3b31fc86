//! Conversion of people to messages.

use nalgebra::Point3;
use vision_models::{Body, Body25};

use super::messages::{
    Float64MultiArray, Header, MultiArrayDimension, MultiArrayLayout, Pose, PoseArray, Time,
    Vector3,
};

/// Numbers of the covariance of a position: xx, xy, xz, yy, yz, zz.
pub(super) const COVARIANCE: usize = 6;

/// Messages about the joints of everybody in a frame.
pub(super) struct BodyMessages {
    pub(super) confidences: Float64MultiArray,
    pub(super) covariances: Float64MultiArray,
    pub(super) joints: PoseArray,
}

/// Returns the messages about a person, or nobody, and others, whose joints are in this frame.
pub(super) fn body_messages(
    stamp: Time,
    frame: &str,
    person: Option<&Body>,
    others: &[Body],
) -> BodyMessages {
    let nobody = Body::default();
    let people: Vec<&Body> = std::iter::once(person.unwrap_or(&nobody)).chain(others).collect();
    let joints =
        || people.iter().flat_map(|body| Body25::ALL.into_iter().map(move |joint| (*body, joint)));
    let unseen = Vector3 { x: f64::NAN, y: f64::NAN, z: f64::NAN };
    let place = |at: Point3<f64>| Vector3 { x: at.x, y: at.y, z: at.z };
    let poses = joints().map(|(body, joint)| {
        let position = body.get(joint).map_or(unseen, |keypoint| place(keypoint.position));
        Pose { position, ..Pose::default() }
    });
    let confidences = joints()
        .map(|(body, joint)| body.get(joint).map_or(0.0, |keypoint| keypoint.confidence.value()));
    let covariances = joints().flat_map(|(body, joint)| {
        body.covariance(joint)
            .map_or([f64::NAN; COVARIANCE], |of| [of.m11, of.m12, of.m13, of.m22, of.m23, of.m33])
    });
    // Ids follow the confidences if the source tracks people.
    let is_tracked = people.iter().any(|body| body.id().is_some());
    #[expect(clippy::cast_precision_loss, reason = "ids count people")]
    let ids = people.iter().map(|body| body.id().map_or(f64::NAN, |id| id.number() as f64));
    let confidences = confidences.chain(ids.filter(|_| is_tracked));
    BodyMessages {
        confidences: stamped(stamp, ("joint", 1), confidences),
        covariances: stamped(stamp, ("joint", COVARIANCE), covariances),
        joints: PoseArray {
            header: Header { stamp, frame_id: frame.to_owned() },
            poses: poses.collect(),
        },
    }
}

/// Returns rows of numbers behind the stamp that they belong to: its seconds and its nanoseconds. A row has this name and
/// this length.
pub(super) fn stamped(
    stamp: Time,
    (label, length): (&str, usize),
    numbers: impl IntoIterator<Item = f64>,
) -> Float64MultiArray {
    let head = [f64::from(stamp.sec), f64::from(stamp.nanosec)];
    let data: Vec<_> = head.into_iter().chain(numbers).collect();
    let rows = data.len().saturating_sub(head.len()).checked_div(length).unwrap_or_default();
    let [size, stride] = [rows, length].map(|count| u32::try_from(count).unwrap_or(u32::MAX));
    let dim = vec![MultiArrayDimension { label: label.to_owned(), size, stride }];
    Float64MultiArray { layout: MultiArrayLayout { dim, data_offset: 2 }, data }
}
