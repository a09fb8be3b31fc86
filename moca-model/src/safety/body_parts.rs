//! The parts of a person's body, as capsules between joints, and how far each reaches.

use hrsw::{BodyRegion, Capsule};
use nalgebra::Vector3;
use vision_models::Body25;

/// How a part of the body moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Limb {
    /// With the pelvis.
    Body,
    /// On its own.
    Arm,
}

/// A joint that a part hangs on, and how far no point of its axis is from that \[m\].
pub(super) type Reach = (Body25, f64);

/// A capsule between two joints, continued past the second by a length \[m\].
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) from: Body25,
    pub(super) to: Body25,
    beyond: f64,
    pub(super) radius: f64,
    pub(super) limb: Limb,
    /// The region of the body of which the limits count.
    pub(super) region: BodyRegion,
    /// Of joints nearer to the trunk, or in it.
    pub(super) reaches: &'static [Reach],
}

const fn part(
    ends: [Body25; 2],
    (beyond, radius): (f64, f64),
    limb: Limb,
    region: BodyRegion,
    reaches: &'static [Reach],
) -> Part {
    let [from, to] = ends;
    Part { from, to, beyond, radius, limb, region, reaches }
}

impl Part {
    /// Between two joints, wider by `growth` \[m\].
    pub(super) fn capsule(
        &self,
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        growth: f64,
    ) -> Option<Capsule> {
        let beyond = (to - from).try_normalize(1e-9).unwrap_or_default() * self.beyond;
        Capsule::new(*from, to + beyond, self.radius + growth).ok()
    }
}

/// Radii and reaches are those of a large adult, 2 m tall, with 3 cm for the noise of the joints; segments as
/// fractions of stature by Drillis and Contini (1966). Hands and feet are the continuation of forearm and
/// shank, and a forearm bears less than its hand.
pub(super) const PARTS: [Part; 12] = {
    use Body25::{
        LeftAnkle, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck, Nose,
        RightAnkle, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
    };
    use Limb::{Arm, Body};
    use hrsw::BodyRegion::{Back, Chest, Face, Forearm, LowerLeg, Pelvis, Thigh, UpperArm};
    const HEAD: &[Reach] = &[(Neck, 0.33), (MidHip, 0.96)];
    const TRUNK: &[Reach] = &[(MidHip, 0.66), (Neck, 0.66)];
    const SHOULDERS: &[Reach] = &[(Neck, 0.3), (MidHip, 0.75)];
    const HIPS: &[Reach] = &[(MidHip, 0.25), (Neck, 0.75)];
    [
        part([Neck, Nose], (0.0, 0.13), Body, Face, HEAD),
        part([Neck, MidHip], (0.0, 0.15), Body, Chest, TRUNK),
        part([LeftShoulder, RightShoulder], (0.0, 0.08), Body, Back, SHOULDERS),
        part([LeftHip, RightHip], (0.0, 0.12), Body, Pelvis, HIPS),
        part(
            [LeftShoulder, LeftElbow],
            (0.0, 0.06),
            Arm,
            UpperArm,
            &[(LeftShoulder, 0.41), (Neck, 0.71)],
        ),
        part(
            [RightShoulder, RightElbow],
            (0.0, 0.06),
            Arm,
            UpperArm,
            &[(RightShoulder, 0.41), (Neck, 0.71)],
        ),
        part(
            [LeftElbow, LeftWrist],
            (0.15, 0.06),
            Arm,
            Forearm,
            &[(LeftElbow, 0.49), (LeftShoulder, 0.9), (Neck, 1.2)],
        ),
        part(
            [RightElbow, RightWrist],
            (0.15, 0.06),
            Arm,
            Forearm,
            &[(RightElbow, 0.49), (RightShoulder, 0.9), (Neck, 1.2)],
        ),
        part([LeftHip, LeftKnee], (0.0, 0.09), Body, Thigh, &[(LeftHip, 0.52), (MidHip, 0.77)]),
        part([RightHip, RightKnee], (0.0, 0.09), Body, Thigh, &[(RightHip, 0.52), (MidHip, 0.77)]),
        part(
            [LeftKnee, LeftAnkle],
            (0.05, 0.08),
            Body,
            LowerLeg,
            &[(LeftKnee, 0.57), (LeftHip, 1.09), (MidHip, 1.34)],
        ),
        part(
            [RightKnee, RightAnkle],
            (0.05, 0.08),
            Body,
            LowerLeg,
            &[(RightKnee, 0.57), (RightHip, 1.09), (MidHip, 1.34)],
        ),
    ]
};
