//! Parts of a person's body as capsules between joints, and bounds for the parts that are not seen.

use hrsw::Capsule;
use nalgebra::Vector3;
use vision_models::Body25;

use crate::body_region::BodyRegion;
use crate::measured_velocity::MeasuredVelocity;
use crate::separation::SeparationSettings;

/// Kind of speed that is assumed for a part whose velocity is not measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Limb {
    /// The speed of walking.
    Body,
    /// The speed of reaching.
    Arm,
}

/// Bound of the place of a part that is not seen, relative to joints that are seen \[m\].
#[derive(Debug, Clone, Copy)]
pub(super) enum Reach {
    /// Every point of the axis is within this distance of the joint.
    About(Body25, f64),
    /// Every point of the axis is within this distance of the line between the joints.
    Between(Body25, Body25, f64),
    /// Every point of the axis is within this distance of the joint, and not above it.
    Under(Body25, f64),
    /// Every point of the axis is below the height of the knee, and within this horizontal distance
    /// of the joint. The joint is a hip or the mid hip of a person who stands, walks or sits.
    Below(Body25, f64),
}

/// Height of the knee as a share of that of the hip (Drillis and Contini, 1966).
const KNEE_HEIGHT: f64 = 0.285 / 0.530;

/// Depth of the centre of a bounding shape below the edge that it must reach \[m\]. A larger depth
/// makes the shape wider, and less of it lies above the edge.
const LOWER: f64 = 0.2;

/// A capsule between two joints, extended past the second joint by `beyond` \[m\].
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub(super) from: Body25,
    pub(super) to: Body25,
    beyond: f64,
    pub(super) radius: f64,
    pub(super) limb: Limb,
    /// The region of the body whose contact limits apply.
    pub(super) region: BodyRegion,
    /// Bounds by joints that are nearer to the trunk, or in it.
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

impl Reach {
    /// Returns the joints. A single joint is returned twice.
    pub(super) fn joints(self) -> [Body25; 2] {
        match self {
            Self::About(joint, _) | Self::Under(joint, _) | Self::Below(joint, _) => [joint; 2],
            Self::Between(one, other, _) => [one, other],
        }
    }

    /// Returns how much wider than the part the bounding capsule is \[m\].
    pub(super) fn wider(self) -> f64 {
        // A sphere through a circle that is centred below it also contains what is below the circle
        // and inside its sphere.
        match self {
            Self::About(_, reach) | Self::Between(_, _, reach) => reach,
            Self::Under(_, circle) | Self::Below(_, circle) => circle.hypot(LOWER),
        }
    }

    /// Returns a capsule of this radius that contains the part, for joints at `places` in the world
    /// \[m\]. The radius is that of the part and what it is [wider](Self::wider).
    pub(super) fn capsule(self, places: &[Vector3<f64>; 2], radius: f64) -> Option<Capsule> {
        let [place, other] = places;
        match self {
            Self::About(..) => Capsule::sphere(*place, radius).ok(),
            Self::Between(..) => Capsule::new(*place, *other, radius).ok(),
            Self::Under(..) => Capsule::sphere(place - Vector3::z() * LOWER, radius).ok(),
            Self::Below(..) => {
                let [knee, floor] = [KNEE_HEIGHT * place.z - LOWER, 0.0]
                    .map(|height| Vector3::new(place.x, place.y, height));
                Capsule::new(knee, floor, radius).ok()
            }
        }
    }
}

impl Part {
    /// Returns the capsule between the two joints, with the radius increased by `growth` \[m\].
    pub(super) fn capsule(
        &self,
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        growth: f64,
    ) -> Option<Capsule> {
        let beyond = (to - from).try_normalize(1e-9).unwrap_or_default() * self.beyond;
        Capsule::new(*from, to + beyond, self.radius + growth).ok()
    }

    /// Returns the velocity of the part for joints at `from` and `to` \[m\] with the velocities of
    /// `ends`. It is the mean velocity of both ends of the part, with an uncertainty that covers
    /// all points of the part.
    pub(super) fn velocity(
        &self,
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        (near, far): (MeasuredVelocity, MeasuredVelocity),
    ) -> MeasuredVelocity {
        let length = (to - from).norm();
        let share = if length > 0.0 { self.beyond / length } else { 0.0 };
        let across = (far.mean - near.mean) * (0.5 * (1.0 + share));
        let uncertainty = across.norm() + near.uncertainty.max(far.uncertainty);
        MeasuredVelocity { mean: near.mean + across, uncertainty }
    }

    /// Returns how much less certain the end beyond the second joint is than the joints themselves
    /// \[m\]. The errors of the joints are independent, so they add as a root of squares.
    pub(super) fn uncertainty_beyond(
        &self,
        from: &Vector3<f64>,
        to: &Vector3<f64>,
        separation: &SeparationSettings,
    ) -> f64 {
        let length = (to - from).norm();
        if self.beyond == 0.0 || length == 0.0 {
            return 2.0 * self.beyond;
        }
        let share = self.beyond / length;
        let farther = (1.0 + share).hypot(share) - 1.0;
        (separation.human_uncertainty * farther).min(2.0 * self.beyond)
    }
}

/// Parts of the body. Radii and reaches are those of a large adult, 2 m tall, plus 3 cm for the
/// noise of the joints. Lengths of segments are fractions of the stature by Drillis and Contini
/// (1966). Hands and feet extend forearm and shank. The contact limits of a forearm are lower than
/// those of its hand.
pub(super) const PARTS: [Part; 12] = {
    use crate::body_region::BodyRegion::{
        Back, Chest, Face, Forearm, LowerLeg, Pelvis, Thigh, UpperArm,
    };
    use Body25::{
        LeftAnkle, LeftElbow, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip, Neck, Nose,
        RightAnkle, RightElbow, RightHip, RightKnee, RightShoulder, RightWrist,
    };
    use Limb::{Arm, Body};
    use Reach::{About, Below, Between, Under};
    const HEAD: &[Reach] = &[About(Neck, 0.33), About(MidHip, 0.96)];
    const TRUNK: &[Reach] = &[About(MidHip, 0.66), About(Neck, 0.66)];
    const SHOULDERS: &[Reach] = &[About(Neck, 0.3), About(MidHip, 0.75)];
    const HIPS: &[Reach] = &[About(MidHip, 0.15), About(Neck, 0.75)];
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
            &[About(LeftShoulder, 0.41), About(Neck, 0.71)],
        ),
        part(
            [RightShoulder, RightElbow],
            (0.0, 0.06),
            Arm,
            UpperArm,
            &[About(RightShoulder, 0.41), About(Neck, 0.71)],
        ),
        part(
            [LeftElbow, LeftWrist],
            (0.15, 0.06),
            Arm,
            Forearm,
            &[About(LeftElbow, 0.49), About(LeftShoulder, 0.9), About(Neck, 1.2)],
        ),
        part(
            [RightElbow, RightWrist],
            (0.15, 0.06),
            Arm,
            Forearm,
            &[About(RightElbow, 0.49), About(RightShoulder, 0.9), About(Neck, 1.2)],
        ),
        part(
            [LeftHip, LeftKnee],
            (0.0, 0.09),
            Body,
            Thigh,
            &[Between(MidHip, LeftKnee, 0.15), Under(LeftHip, 0.52), Under(MidHip, 0.67)],
        ),
        part(
            [RightHip, RightKnee],
            (0.0, 0.09),
            Body,
            Thigh,
            &[Between(MidHip, RightKnee, 0.15), Under(RightHip, 0.52), Under(MidHip, 0.67)],
        ),
        part(
            [LeftKnee, LeftAnkle],
            (0.05, 0.08),
            Body,
            LowerLeg,
            &[About(LeftKnee, 0.57), Below(LeftHip, 0.5), Below(MidHip, 0.6)],
        ),
        part(
            [RightKnee, RightAnkle],
            (0.05, 0.08),
            Body,
            LowerLeg,
            &[About(RightKnee, 0.57), Below(RightHip, 0.5), Below(MidHip, 0.6)],
        ),
    ]
};
