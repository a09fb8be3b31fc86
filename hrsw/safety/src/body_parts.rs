//! The parts of a person's body, as capsules between joints, and how far each reaches.

use hrsw::Capsule;
use nalgebra::Vector3;
use vision_models::Body25;

use crate::body_region::BodyRegion;
use crate::measured_velocity::MeasuredVelocity;
use crate::separation::SeparationSettings;

/// What kind of speed is assumed of a part where none is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Limb {
    /// That of walking.
    Body,
    /// That of reaching.
    Arm,
}

/// Where a part is that is not seen, by joints that are \[m\].
#[derive(Debug, Clone, Copy)]
pub(super) enum Reach {
    /// No point of its axis is farther from the joint.
    About(Body25, f64),
    /// No point of its axis is farther from the line between the joints.
    Between(Body25, Body25, f64),
    /// No point of its axis is farther from the joint, or above it.
    Under(Body25, f64),
    /// The joint is a hip, or between them, of somebody who stands, walks or sits: below the height of the knee,
    /// and no farther aside.
    Below(Body25, f64),
}

/// The height of the knee over that of the hip (Drillis and Contini, 1966).
const KNEE_HEIGHT: f64 = 0.285 / 0.530;

/// How much lower than its edge the middle is of what holds everything below a height \[m\]: the lower, the less of it
/// is above that height, and the wider it is.
const LOWER: f64 = 0.2;

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

impl Reach {
    /// The joints, the same twice if it is one.
    pub(super) fn joints(self) -> [Body25; 2] {
        match self {
            Self::About(joint, _) | Self::Under(joint, _) | Self::Below(joint, _) => [joint; 2],
            Self::Between(one, other, _) => [one, other],
        }
    }

    /// What holds the part, of this radius, if the joints are at `places` in the world \[m\].
    pub(super) fn capsule(self, places: &[Vector3<f64>; 2], radius: f64) -> Option<Capsule> {
        let [place, other] = places;
        // A circle, and what is within its sphere and below it, is within any sphere through it that is centred lower.
        let through = |circle: f64| radius + circle.hypot(LOWER);
        match self {
            Self::About(_, reach) => Capsule::sphere(*place, radius + reach).ok(),
            Self::Between(_, _, aside) => Capsule::new(*place, *other, radius + aside).ok(),
            Self::Under(_, reach) => {
                Capsule::sphere(place - Vector3::z() * LOWER, through(reach)).ok()
            }
            Self::Below(_, aside) => {
                let [knee, floor] = [KNEE_HEIGHT * place.z - LOWER, 0.0]
                    .map(|height| Vector3::new(place.x, place.y, height));
                Capsule::new(knee, floor, through(aside)).ok()
            }
        }
    }
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

    /// Its velocity, with joints at `from` and `to` \[m\] that have the velocities `ends`: the mean of both of its
    /// ends, with an uncertainty that holds for all of its points.
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

    /// How much less is known of its end beyond the second joint than of the joints \[m\]: in the root mean square it
    /// is as far off as both make it, each with an error of its own.
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

/// Radii and reaches are those of a large adult, 2 m tall, with 3 cm for the noise of the joints; segments as
/// fractions of stature by Drillis and Contini (1966). Hands and feet are the continuation of forearm and
/// shank, and a forearm bears less than its hand.
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
