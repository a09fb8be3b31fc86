//! Velocities of a person's joints, from their positions in camera frames alone.

use nalgebra::{Matrix3, Vector3};
use vision_models::{Body, Body25, Freshness};

use crate::measured_velocity::MeasuredVelocity;

/// Correlation time of the errors of joints with known covariances \[s\].
const CORRELATION_TIME: f64 = 0.05;

/// Factors of the acceleration of a joint that surely moves: on its speed \[1/s\], and on the
/// acceleration so far.
const SPEED_CHANGE: f64 = 6.0;
const ACCELERATION_CHANGE: f64 = 2.0;
/// A speed or an acceleration is certain beyond this many standard deviations.
const SURE: f64 = 2.5;
/// Factors on the acceleration of trunk and head, for elbows and wrists, and for knees and ankles.
const ARM: f64 = 5.0;
const LEG: f64 = 2.0;

/// Time constant with which an acceleration fades \[s\].
const LASTS: f64 = 0.3;

/// Largest motion of a joint relative to the trunk from frame to frame \[m\]. A joint that moved
/// farther counts as missing unless the next frame shows it there again.
pub(crate) const LIMB_GATE: f64 = 0.3;
/// Largest speed of a hand that one frame can show \[m/s\]. Swung hands reach 2 to 4 m/s.
const FASTEST_HAND: f64 = 4.0;
/// Largest speed from frame to frame \[m/s\]: that of a person who walks (ISO 13855). A person who
/// moves faster has jumped, and velocities are measured again.
pub(crate) const JUMP_SPEED: f64 = 1.6;
/// Time for which a joint must have been seen before its velocity counts \[s\].
const SETTLING: f64 = 0.3;
/// Standard deviation of the acceleration of a person who stands and may begin to lean or walk
/// \[m/s²\].
const ACCELERATION: f64 = 1.6;
/// Standard deviation of the acceleration of the trunk of a person who works with the robot
/// \[m/s²\]. A part moves like the trunk until its own joints show otherwise, where contacts are
/// concerned.
const WORKING_ACCELERATION: f64 = 0.4;
/// Number of standard deviations by which a part may be faster than measured.
const DEVIATIONS: f64 = 3.0;
/// Growth of a velocity's uncertainty with the time since it was seen \[m/s²\].
const ONSET: f64 = 1.0;

/// Largest acceleration of a joint \[m/s²\].
const MOST: f64 = 25.0;

/// Joints that move alike. The velocity that is asked for is that of the first one.
#[derive(Debug, Clone)]
struct Group {
    joints: &'static [Body25],
    kind: Kind,
    /// Expected place of each joint \[m\].
    places: [Option<Vector3<f64>>; LARGEST],
    /// Common state of the joints \[m/s, m/s²\].
    velocity: Vector3<f64>,
    acceleration: Vector3<f64>,
    /// Covariance of place, velocity and acceleration, the same for each axis.
    covariance: Matrix3<f64>,
    /// Times of the first and the last observation without a gap \[s\].
    seen: Option<Span>,
    /// Apparent speed of the jump before them, zero if there was none \[m/s\].
    jumped: f64,
}

/// Model of the accelerations of joints.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// A person who may do anything. The factor is relative to trunk and head.
    Any(f64),
    /// The steady trunk of a person who works.
    Even,
}

#[derive(Debug, Clone, Copy)]
struct Span {
    since: f64,
    last: f64,
}

/// Largest number of joints of a group.
const LARGEST: usize = 6;

/// Joints of the trunk, which move alike while a person stands or walks upright.
const TRUNK: &[Body25] = {
    use Body25::{LeftHip, LeftShoulder, MidHip, Neck, RightHip, RightShoulder};
    &[Neck, MidHip, LeftShoulder, RightShoulder, LeftHip, RightHip]
};

/// Groups of joints that move alike. Eyes and ears move like the nose except for turns of the head.
/// The neck moves like the mean of the shoulders, and the mid hip like the mean of the hips.
const GROUPS: [&[Body25]; 15] = {
    use Body25::{
        LeftAnkle, LeftEar, LeftElbow, LeftEye, LeftHip, LeftKnee, LeftShoulder, LeftWrist, MidHip,
        Neck, Nose, RightAnkle, RightEar, RightElbow, RightEye, RightHip, RightKnee, RightShoulder,
        RightWrist,
    };
    [
        &[Nose, LeftEye, RightEye, LeftEar, RightEar],
        &[Neck, LeftShoulder, RightShoulder],
        &[MidHip, LeftHip, RightHip],
        &[LeftShoulder],
        &[RightShoulder],
        &[LeftHip],
        &[RightHip],
        &[LeftElbow],
        &[RightElbow],
        &[LeftWrist],
        &[RightWrist],
        &[LeftKnee],
        &[RightKnee],
        &[LeftAnkle],
        &[RightAnkle],
    ]
};

/// Velocities of a person's joints, by a Kalman filter for each group of joints that move alike.
///
/// The state is place, velocity and acceleration, which fades within [`LASTS`] (Singer, 1970). The
/// standard deviation of the acceleration is √((f a₀)² + (6 v / s)² + (2 a)²), at most [`MOST`].
/// Here a₀ is 1.6 m/s² and f is the factor of the limb. v and a are the filtered values
/// less what noise explains. A person who stands may begin to move, and a person who moves may stop
/// or turn back. A single joint has its own innovation. The innovation of a group is the mean over
/// its joints that are seen.
#[derive(Debug, Clone)]
pub(super) struct JointVelocities {
    groups: [Group; GROUPS.len()],
    trunk: Group,
}

impl JointVelocities {
    pub(super) fn new() -> Self {
        Self {
            groups: GROUPS.map(Group::new),
            trunk: Group { kind: Kind::Even, ..Group::new(TRUNK) },
        }
    }

    /// Forgets all velocities.
    pub(super) fn forget(&mut self) {
        self.groups.iter_mut().chain([&mut self.trunk]).for_each(|group| group.seen = None);
    }

    /// Takes a frame. `place` gives the position of a joint that is seen and believed \[m\]. `sigma`
    /// is its standard deviation for each axis if the frame contains no covariance \[m\].
    pub(super) fn observe(
        &mut self,
        time: f64,
        body: &Body,
        place: impl Fn(Body25) -> Option<Vector3<f64>>,
        sigma: f64,
    ) {
        for group in self.groups.iter_mut().chain([&mut self.trunk]) {
            group.observe(time, body, &place, sigma);
        }
    }

    /// Returns the velocity of a joint at the time `now`, if it is measured. The joint must have
    /// been followed for long enough and seen recently. The uncertainty must be below the `assumed`
    /// speed of an unknown joint \[m/s\].
    pub(super) fn of(&self, joint: Body25, now: f64, assumed: f64) -> Option<MeasuredVelocity> {
        let group = self.groups.iter().find(|group| group.joints.first() == Some(&joint))?;
        group.velocity(now).filter(|velocity| velocity.uncertainty < assumed)
    }

    /// Returns the speed that a joint without a measured velocity may have, at least `assumed`
    /// \[m/s\]. A joint that has jumped may be as fast as it seemed to be.
    pub(super) fn assumed_after_jump(&self, joint: Body25, assumed: f64) -> f64 {
        let group = self.groups.iter().find(|group| group.joints.first() == Some(&joint));
        let jumped = group.map_or(0.0, |group| group.jumped);
        assumed.max(jumped.min(FASTEST_HAND))
    }

    /// Returns the velocity of a part that counts for contacts \[m/s\]. It is the velocity of the
    /// trunk. If the part's `own` velocity is measured, it is the nearest to the trunk's that the
    /// part may have. The trunk has more joints than a part, so its velocity is more certain.
    pub(super) fn for_contact(
        &self,
        own: Option<MeasuredVelocity>,
        now: f64,
    ) -> Option<MeasuredVelocity> {
        let mut trunk = self.trunk.velocity(now)?;
        trunk.uncertainty = DEVIATIONS * self.trunk.deviation();
        let Some(own) = own else { return Some(trunk) };
        let away = (trunk.mean - own.mean).cap_magnitude(own.uncertainty);
        Some(MeasuredVelocity { mean: own.mean + away, ..trunk })
    }
}

impl Group {
    fn new(joints: &'static [Body25]) -> Self {
        use Body25::{
            LeftAnkle, LeftElbow, LeftKnee, LeftWrist, RightAnkle, RightElbow, RightKnee,
            RightWrist,
        };
        Self {
            joints,
            kind: Kind::Any(match joints.first() {
                Some(LeftElbow | RightElbow | LeftWrist | RightWrist) => ARM,
                Some(LeftKnee | RightKnee | LeftAnkle | RightAnkle) => LEG,
                _ => 1.0,
            }),
            places: [None; LARGEST],
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
            covariance: Matrix3::zeros(),
            seen: None,
            jumped: 0.0,
        }
    }

    fn observe(
        &mut self,
        time: f64,
        body: &Body,
        place: &impl Fn(Body25) -> Option<Vector3<f64>>,
        sigma: f64,
    ) {
        let elapsed = self.seen.map(|seen| time - seen.last);
        if elapsed.is_none_or(|elapsed| !Freshness::at(elapsed).is_usable()) {
            self.begin(sigma);
        } else if let Some(elapsed) = elapsed.filter(|elapsed| *elapsed > 0.0) {
            self.predict(elapsed);
        }
        let interval = elapsed.unwrap_or(f64::INFINITY);
        let (mut innovation, mut variance, mut count) = (Vector3::zeros(), 0.0, 0.0);
        let mut sees = false;
        for (&joint, expected) in self.joints.iter().zip(&mut self.places) {
            let Some(seen) = place(joint) else { continue };
            sees = true;
            if let Some(expected) = expected {
                innovation += seen - *expected;
                variance += noise(body, joint, interval, sigma);
                count += 1.0;
            } else {
                *expected = Some(seen);
            }
        }
        if !sees {
            return;
        }
        let since = self.seen.map_or(time, |seen| seen.since);
        self.seen = Some(Span { since, last: time });
        if count == 0.0 {
            return;
        }
        let (innovation, variance) = (innovation / count, variance / (count * count));
        if innovation.norm() > LIMB_GATE {
            // Such a jump is no motion, or one that lost frames have hidden.
            self.begin(sigma);
            self.jumped = innovation.norm() / interval;
            for (&joint, expected) in self.joints.iter().zip(&mut self.places) {
                *expected = place(joint);
            }
            self.seen = Some(Span { since: time, last: time });
            return;
        }
        let first = self.covariance.column(0).into_owned();
        let gain = first / (first.x + variance);
        self.covariance -= gain * first.transpose();
        self.velocity += innovation * gain.y;
        self.acceleration += innovation * gain.z;
        for (&joint, expected) in self.joints.iter().zip(&mut self.places) {
            let Some(expected) = expected else { continue };
            // Each joint keeps its own place in the group, which more frames show more exactly.
            let own = place(joint).map_or(innovation, |seen| seen - *expected);
            *expected += own * gain.x;
        }
    }

    /// Resets the filter to joints of which only the places are known.
    fn begin(&mut self, sigma: f64) {
        self.places = [None; LARGEST];
        self.velocity = Vector3::zeros();
        self.acceleration = Vector3::zeros();
        let sigmas = Vector3::new(sigma, JUMP_SPEED, ACCELERATION);
        self.covariance = Matrix3::from_diagonal(&sigmas.map(|sigma| sigma * sigma));
        self.seen = None;
        self.jumped = 0.0;
    }

    /// Predicts the state after a time \[s\].
    fn predict(&mut self, elapsed: f64) {
        let Transition { state, noise } = Transition::over(elapsed);
        let moved = self.velocity * elapsed + self.acceleration * state[(0, 2)];
        for place in self.places.iter_mut().flatten() {
            *place += moved;
        }
        let sure = |value: &Vector3<f64>, variance: f64| {
            (value.norm() - SURE * variance.max(0.0).sqrt()).max(0.0)
        };
        let spread = match self.kind {
            Kind::Even => WORKING_ACCELERATION.powi(2),
            Kind::Any(share) => {
                let moves = SPEED_CHANGE * sure(&self.velocity, self.covariance[(1, 1)]);
                let changes =
                    ACCELERATION_CHANGE * sure(&self.acceleration, self.covariance[(2, 2)]);
                (share * ACCELERATION).powi(2) + moves.powi(2) + changes.powi(2)
            }
        };
        self.velocity += self.acceleration * state[(1, 2)];
        self.acceleration *= state[(2, 2)];
        self.covariance =
            state * self.covariance * state.transpose() + noise * spread.min(MOST * MOST);
    }

    fn velocity(&self, now: f64) -> Option<MeasuredVelocity> {
        let seen = self.seen?;
        let age = (now - seen.last).max(0.0);
        let is_measured = Freshness::at(age).is_usable() && seen.last - seen.since >= SETTLING;
        let uncertainty = DEVIATIONS * self.deviation() + ONSET * age;
        is_measured.then_some(MeasuredVelocity { mean: self.velocity, uncertainty })
    }

    /// Returns the standard deviation of the velocity for each axis \[m/s\].
    fn deviation(&self) -> f64 {
        self.covariance[(1, 1)].max(0.0).sqrt()
    }
}

/// Returns the variance of the measured place of a joint for each axis \[m²\].
fn noise(body: &Body, joint: Body25, interval: f64, sigma: f64) -> f64 {
    let assumed = sigma * sigma;
    let Some(covariance) = body.covariance(joint) else { return assumed };
    let correlation = (-interval / CORRELATION_TIME).exp();
    let largest = covariance.symmetric_eigenvalues().max();
    let variance = largest * (1.0 + correlation) / (1.0 - correlation);
    if variance.is_finite() && variance > 0.0 { variance } else { assumed }
}

/// Transition of place, velocity and acceleration over a time. `noise` is the covariance that
/// fading accelerations of unit variance add.
struct Transition {
    state: Matrix3<f64>,
    noise: Matrix3<f64>,
}

impl Transition {
    /// Uses the equations of Singer, "Estimating optimal tracking filter performance for manned
    /// maneuvering targets" (1970). White noise of density 2/τ drives the acceleration.
    fn over(elapsed: f64) -> Self {
        let (t, tau) = (elapsed, LASTS);
        let x = t / tau;
        let (fades, twice) = ((-x).exp(), (-2.0 * x).exp());
        let state = Matrix3::new(
            1.0,
            t,
            tau * tau * (x - 1.0 + fades),
            0.0,
            1.0,
            tau * (1.0 - fades),
            0.0,
            0.0,
            fades,
        );
        let place = tau.powi(4)
            * (1.0 - twice + 2.0 * x + 2.0 * x.powi(3) / 3.0 - 2.0 * x * x - 4.0 * x * fades);
        let place_velocity =
            tau.powi(3) * (twice + 1.0 - 2.0 * fades + 2.0 * x * fades - 2.0 * x + x * x);
        let place_acceleration = tau.powi(2) * (1.0 - twice - 2.0 * x * fades);
        let velocity = tau.powi(2) * (4.0 * fades - 3.0 - twice + 2.0 * x);
        let velocity_acceleration = tau * (twice + 1.0 - 2.0 * fades);
        let acceleration = 1.0 - twice;
        let noise = Matrix3::new(
            place,
            place_velocity,
            place_acceleration,
            place_velocity,
            velocity,
            velocity_acceleration,
            place_acceleration,
            velocity_acceleration,
            acceleration,
        );
        Self { state, noise }
    }
}

#[cfg(test)]
mod tests {
    use rand::Rng;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    use super::*;

    const FRAME: f64 = 0.05;

    /// Returns an approximately normal number of deviation 1: the sum of twelve uniform ones.
    fn normal(draw: &mut ChaCha8Rng) -> f64 {
        (0..12).map(|_| draw.random_range(-0.5..0.5_f64)).sum()
    }

    /// Returns place and velocity along x for each frame \[m, m/s\]. The person stands, moves with
    /// the least jerk and stands again, with at most the given acceleration.
    fn bows(most: f64, draw: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
        let (mut frames, mut begin, mut from, mut side) = (Vec::new(), 1.0, 0.0, 1.0);
        while frames.len() < 400 {
            let time: f64 = draw.random_range(0.6..1.4);
            // The largest acceleration of the motion with the least jerk is 10/√3 D/T².
            let way =
                side * most * draw.random_range(0.3..1.0) * time * time * 3.0_f64.sqrt() / 10.0;
            let end = begin + time + draw.random_range(0.3..2.0);
            while FRAME * (frames.len() as f64) < end {
                let s = ((FRAME * (frames.len() as f64) - begin) / time).clamp(0.0, 1.0);
                let place = from + way * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
                frames.push((place, way / time * 30.0 * (s * (1.0 - s)).powi(2)));
            }
            (from, begin, side) = (from + way, end, -side);
        }
        frames
    }

    /// Returns the share of frames in which the uncertainty of the head holds, and the mean
    /// uncertainty \[m/s\].
    fn holds(most: f64, sigma: f64) -> (f64, f64) {
        let mut draw = ChaCha8Rng::seed_from_u64(7);
        let (mut kept, mut frames, mut sum) = (0.0, 0.0, 0.0);
        for _ in 0..20 {
            let mut velocities = JointVelocities::new();
            for (frame, (place, speed)) in bows(most, &mut draw).into_iter().enumerate() {
                let time = FRAME * (frame as f64);
                let noisy = Vector3::from_fn(|_, _| sigma * normal(&mut draw));
                let place = Vector3::new(place, 0.0, 1.6) + noisy;
                velocities.observe(
                    time,
                    &Body::default(),
                    |joint| (joint == Body25::Nose).then_some(place),
                    0.02,
                );
                let Some(known) = velocities.of(Body25::Nose, time, 9.0) else {
                    continue;
                };
                frames += 1.0;
                sum += known.uncertainty;
                kept += f64::from(u8::from((known.mean.x - speed).abs() <= known.uncertainty));
            }
        }
        (kept / frames, sum / frames)
    }

    #[test]
    fn a_standing_persons_velocity_uncertainty_is_small() {
        let (kept, uncertainty) = holds(0.0, 0.02);
        assert!(kept > 0.998 && uncertainty < 0.55, "{kept} {uncertainty}");
    }

    #[test]
    fn the_velocity_uncertainty_of_a_leaning_head_holds() {
        for most in [1.0, 3.0, 4.5] {
            let (kept, _) = holds(most, 0.02);
            assert!(kept >= 0.995, "{kept} at {most} m/s²");
        }
        let (kept, _) = holds(6.0, 0.02);
        assert!(kept >= 0.98, "{kept} at 6 m/s²");
    }

    #[test]
    fn jumped_hand_counts_with_its_apparent_speed() {
        let mut velocities = JointVelocities::new();
        let mut jumps = 0;
        for frame in (0..400_u32).filter(|frame| frame % 7 < 5) {
            let time = FRAME * f64::from(frame);
            // 3 m/s at most.
            let place = Vector3::new(0.4 * (7.5 * time).sin(), 0.0, 1.2);
            let seen = |joint| (joint == Body25::LeftWrist).then_some(place);
            velocities.observe(time, &Body::default(), seen, 0.02);
            let assumed = velocities.assumed_after_jump(Body25::LeftWrist, 2.0);
            // It is a mean over the lost frames, and so below the swing's largest speed.
            assert!(assumed <= 3.0, "{assumed} m/s");
            jumps += u32::from(assumed > 2.0);
        }
        assert!(jumps > 20, "{jumps}");
        assert_eq!(velocities.assumed_after_jump(Body25::LeftElbow, 2.0), 2.0);
    }

    #[test]
    fn only_recently_followed_joints_have_a_measured_velocity() {
        let mut velocities = JointVelocities::new();
        for frame in 0..20_u32 {
            let time = FRAME * f64::from(frame);
            let place = Vector3::new(0.5 * time, 0.0, 1.6);
            let seen = |joint| (joint == Body25::Nose).then_some(place);
            velocities.observe(time, &Body::default(), seen, 0.02);
            let known = velocities.of(Body25::Nose, time, 9.0);
            assert_eq!(known.is_some(), time >= SETTLING - 1e-9, "{time} s");
        }
        let of = |now| velocities.of(Body25::Nose, now, 9.0);
        let (fresh, old) = (of(0.95).unwrap(), of(1.4).unwrap());
        assert!((fresh.mean.x - 0.5).abs() < 0.02 && old.mean == fresh.mean);
        assert!(old.uncertainty >= fresh.uncertainty + 0.44 * ONSET);
        assert_eq!(of(1.5), None);
        assert_eq!(velocities.of(Body25::Nose, 0.95, 0.1), None);
        assert_eq!(velocities.of(Body25::Neck, 0.95, 9.0), None);
    }
}
