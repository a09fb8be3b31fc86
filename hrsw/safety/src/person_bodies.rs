//! The person's capsules, from the keypoints of camera frames.

use hrsw::Capsule;
use nalgebra::Vector3;
use vision_models::{Body, Body25, PersonId};

use crate::approach::PersonBody;
use crate::body_parts::{Limb, PARTS, Part};
use crate::body_region::ContactLimits;
use crate::contact::{Contact, ContactLimit};
use crate::joint_velocity::{JUMP_SPEED, JointVelocities, LIMB_GATE};
use crate::separation::SeparationSettings;

/// Smallest confidence of a keypoint that counts as seen for safety \[-\]: below half, a detector
/// rather guesses.
pub const LEAST_CONFIDENCE: f64 = 0.5;
/// Time without being seen after which a person is assumed to have left \[s\]: at walking speed they
/// are 16 m away by then. Until then unseen parts grow at the speed at which a person may approach.
pub const FORGET_AFTER: f64 = 10.0;
/// Largest apparent motion of a standing trunk from frame to frame, common to all its joints \[m\].
const NOISE: f64 = 0.03;
/// Largest additional motion if the joints disagree \[m\], and the number of their standard
/// deviations that count.
const MOST_SPREAD: f64 = 0.15;
const DEVIATIONS: f64 = 3.0;
/// Speed that nobody reaches \[m/s\]: 12.4 m/s over 20 m of the world record of 100 m, Berlin 2009
/// (IAAF's analysis).
const FASTEST: f64 = 12.5;
/// Standard deviation of a median of n values with median absolute deviation 1, times √n. The
/// factor 1.4826 turns it into the standard deviation of a normal distribution, and √(π/2) into
/// that of the median.
const MEDIAN_DEVIATION: f64 = 1.4826 * 1.2533;

/// Joints that move with the pelvis.
const ROOT: [Body25; 6] = {
    use Body25::{LeftHip, LeftShoulder, MidHip, Neck, RightHip, RightShoulder};
    [Neck, MidHip, LeftShoulder, RightShoulder, LeftHip, RightHip]
};

/// Places of the joints that were seen \[m\].
type Places = [Option<Vector3<f64>>; Body25::COUNT];

/// Last place of a joint and its time \[m, s\].
#[derive(Debug, Clone, Copy)]
struct Seen {
    place: Vector3<f64>,
    /// Place in the frame before, moved along with the trunk.
    before: Vector3<f64>,
    time: f64,
    /// Largest error of the place, if the frame contains a covariance \[m\].
    spread: f64,
    /// Place in the newest frame, if it is too far away to be believed at once.
    doubtful: Option<Vector3<f64>>,
}

impl Seen {
    /// Creates a joint that is seen for the first time.
    fn first(place: Vector3<f64>, time: f64, spread: f64) -> Self {
        Self { place, before: place, time, spread, doubtful: None }
    }

    /// Takes the place of the joint in a frame, if it is seen there. `moved` is the motion of the
    /// trunk since the frame before. A joint that is missing or doubted moves along with the trunk.
    fn update(
        &mut self,
        place: Option<Vector3<f64>>,
        (time, spread): (f64, f64),
        moved: &Vector3<f64>,
        gate: f64,
    ) {
        self.place += moved;
        self.before += moved;
        let expected = self.doubtful.take().map(|doubtful| doubtful + moved);
        let Some(place) = place else { return };
        let near = |other: &Vector3<f64>| (place - other).norm() <= gate;
        if near(&self.place) || expected.as_ref().is_some_and(near) {
            *self = Self { place, before: self.place, time, spread, doubtful: None };
        } else {
            self.doubtful = Some(place);
        }
    }
}

/// The person's capsules and their velocities.
#[derive(Debug, Clone)]
pub(super) struct PersonBodies {
    id: Option<PersonId>,
    position_sigma: f64,
    joints: [Option<Seen>; Body25::COUNT],
    velocities: JointVelocities,
    /// A person seen at a place that nobody can have reached since the frame before. One frame
    /// alone is not believed, but a person may be there.
    doubtful: Option<Sighting>,
    newest: f64,
    /// Time of the newest frame that shows the person at a place that they can have reached \[s\].
    plausible: f64,
    /// Contact limits of each part.
    contacts: [Option<ContactLimit>; PARTS.len()],
    bodies: Vec<PersonBody>,
}

impl PersonBodies {
    /// Largest number of capsules of one person. Each part may be believed, as in the frame before,
    /// and doubted.
    pub(super) const ROOM: usize = 3 * PARTS.len();

    pub(super) fn new(position_sigma: f64, limits: &ContactLimits) -> Self {
        Self {
            id: None,
            position_sigma,
            contacts: PARTS.map(|part| limits.of(part.region)),
            joints: [None; Body25::COUNT],
            velocities: JointVelocities::new(),
            doubtful: None,
            newest: f64::NEG_INFINITY,
            plausible: f64::NEG_INFINITY,
            bodies: Vec::with_capacity(Self::ROOM),
        }
    }

    /// Forgets all observations.
    pub(super) fn forget(&mut self) {
        self.joints = [None; Body25::COUNT];
        self.velocities.forget();
        self.doubtful = None;
        self.newest = f64::NEG_INFINITY;
        self.plausible = f64::NEG_INFINITY;
        self.bodies.clear();
    }

    /// Returns the id of the person in the newest frame.
    pub(super) fn id(&self) -> Option<PersonId> {
        self.id
    }

    /// Returns the time of the newest frame that shows the person at a place that they can have
    /// reached since the frame before \[s\].
    pub(super) fn plausible(&self) -> f64 {
        self.plausible
    }

    /// Returns true if no person is known here.
    pub(super) fn is_empty(&self) -> bool {
        self.doubtful.is_none() && self.joints.iter().all(Option::is_none)
    }

    /// Takes the body of a frame. Joints that are missing move along with the trunk. If nobody is
    /// fast enough to have reached its place, the body is doubted, and the smallest speed that
    /// explains it \[m/s\] is returned.
    pub(super) fn see(&mut self, time: f64, body: &Body) -> Option<f64> {
        self.id = body.id();
        let doubtful = self.doubtful.take();
        let displacement = |from: &Places| Displacement::of(body, from).unwrap_or_default();
        let places = self.joints.map(|seen| seen.map(|seen| seen.place));
        let (displaced, elapsed) = (displacement(&places), time - self.newest);
        let moved = displaced.median;
        let jumped = !displaced.is_within(JUMP_SPEED * elapsed);
        if jumped {
            let is_again = doubtful.is_some_and(|seen| {
                displacement(&seen.joints).is_within(JUMP_SPEED * (time - seen.time))
            });
            if !is_again {
                let joints = Body25::ALL.map(|joint| place(body, joint));
                self.doubtful = Some(Sighting { joints, time });
                self.velocities.forget();
                let speed = displaced.beyond_noise() / elapsed;
                return (speed > FASTEST).then_some(speed);
            }
            self.velocities.forget();
        }
        self.plausible = time;
        for (joint, seen) in Body25::ALL.into_iter().zip(&mut self.joints) {
            let place = place(body, joint);
            let spread = spread(body, joint);
            match seen {
                Some(seen) => seen.update(place, (time, spread), &moved, LIMB_GATE),
                None => *seen = place.map(|place| Seen::first(place, time, spread)),
            }
            if seen.is_some_and(|seen| seen.time == time) {
                self.newest = time;
            }
        }
        let joints = &self.joints;
        let believed = |joint: Body25| {
            let seen = joints[joint as usize]?;
            (seen.time == time).then_some(seen.place)
        };
        self.velocities.observe(time, body, believed, self.position_sigma);
        None
    }

    /// Computes the capsules at the time `now`. If `contact_speed` is positive, they may be touched
    /// where their region allows it, but never at the head.
    pub(super) fn place(
        &mut self,
        now: f64,
        separation: &SeparationSettings,
        contact_speed: f64,
    ) -> &[PersonBody] {
        self.bodies.clear();
        let is_old = |time: f64| now - time > FORGET_AFTER;
        if is_old(self.newest) {
            self.joints = [None; Body25::COUNT];
        }
        if self.doubtful.as_ref().is_some_and(|seen| is_old(seen.time)) {
            self.doubtful = None;
        }
        self.place_believed(now, separation, contact_speed);
        self.place_doubtful(now, separation);
        &self.bodies
    }

    fn place_believed(&mut self, now: f64, separation: &SeparationSettings, contact_speed: f64) {
        for (part, limit) in PARTS.iter().zip(&self.contacts) {
            let [from, to] = [part.from, part.to].map(|joint| &self.joints[joint as usize]);
            let (Some(from), Some(to)) = (from, to) else { continue };
            let mut assumed = assumed_speed(part, separation);
            if part.limb == Limb::Arm {
                for joint in [part.from, part.to] {
                    assumed = self.velocities.assumed_after_jump(joint, assumed);
                }
            }
            let of = |joint| self.velocities.of(joint, now, assumed);
            let velocity = of(part.from).zip(of(part.to));
            let velocity = velocity.map(|ends| part.velocity(&from.place, &to.place, ends));
            let touched = self.velocities.for_contact(velocity, now);
            let fastest = velocity.map_or(assumed, |v| v.mean.norm() + v.uncertainty);
            // Z_d covers what frames without covariances do not show.
            let growth = |seen: &Seen| {
                let untold = (seen.spread - separation.human_uncertainty).max(0.0);
                fastest * beyond_reaction(now - seen.time, separation) + untold
            };
            let growth_between = growth(from).max(growth(to))
                + part.uncertainty_beyond(&from.place, &to.place, separation);
            let grown = part.capsule(&from.place, &to.place, growth_between);
            let radius = grown.map_or(f64::INFINITY, |capsule| capsule.radius());
            let smaller = self.within_reach(part, radius, growth);
            // One frame alone is not believed for a part that must not be touched. It may show the
            // part too far away.
            let before = (limit.is_none() && smaller.is_none())
                .then(|| part.capsule(&from.before, &to.before, growth_between));
            for capsule in smaller.or(grown).into_iter().chain(before.flatten()) {
                let contact = limit.filter(|_| contact_speed > 0.0).map(|limit| Contact {
                    limit,
                    fastest: contact_speed,
                    velocity: touched,
                });
                let age = covered_by_reaction(now - from.time.min(to.time), separation);
                let uncertainty = capsule.radius() - part.radius;
                let assumed_speed = assumed;
                let part =
                    PersonBody { capsule, velocity, assumed_speed, age, uncertainty, contact };
                self.bodies.push(part);
            }
        }
    }

    /// Returns the thinnest capsule around visible joints that contains a part attached to them, if
    /// it is thinner than `radius` \[m\].
    fn within_reach(
        &self,
        part: &Part,
        radius: f64,
        growth: impl Fn(&Seen) -> f64,
    ) -> Option<Capsule> {
        let mut thinnest = (radius, None);
        for reach in part.reaches {
            let [one, other] = reach.joints().map(|joint| &self.joints[joint as usize]);
            let (Some(one), Some(other)) = (one, other) else { continue };
            let growth = growth(one).max(growth(other));
            let radius = part.radius + growth + reach.wider();
            if radius < thinnest.0 {
                thinnest = (radius, Some((reach, [one.place, other.place])));
            }
        }
        let (radius, (reach, places)) = (thinnest.0, thinnest.1?);
        reach.capsule(&places, radius)
    }

    /// Adds the capsules of a person at a place that nobody can have reached. They must not be
    /// touched.
    fn place_doubtful(&mut self, now: f64, separation: &SeparationSettings) {
        let Some(seen) = &self.doubtful else { return };
        let elapsed = now - seen.time;
        let age = covered_by_reaction(elapsed, separation);
        for part in &PARTS {
            let ends = (seen.joints[part.from as usize], seen.joints[part.to as usize]);
            let (Some(from), Some(to)) = ends else { continue };
            let assumed_speed = assumed_speed(part, separation);
            let growth = assumed_speed * beyond_reaction(elapsed, separation)
                + part.uncertainty_beyond(&from, &to, separation);
            if let Some(capsule) = part.capsule(&from, &to, growth) {
                self.bodies.push(PersonBody {
                    capsule,
                    velocity: None,
                    assumed_speed,
                    age,
                    uncertainty: growth,
                    contact: None,
                });
            }
        }
    }

    /// Returns the capsules computed last.
    pub(super) fn placed(&self) -> &[PersonBody] {
        &self.bodies
    }

    /// Returns the velocity of the pelvis along the floor \[m/s\], zero if it is not measured.
    pub(super) fn velocity(&self, now: f64, separation: &SeparationSettings) -> Vector3<f64> {
        let pelvis = self.velocities.of(Body25::MidHip, now, separation.human_speed);
        pelvis.map_or(Vector3::zeros(), |velocity| velocity.mean.xy().push(0.0))
    }
}

/// Returns the largest speed of a part whose velocity is not measured \[m/s\].
fn assumed_speed(part: &Part, separation: &SeparationSettings) -> f64 {
    match part.limb {
        Limb::Body => separation.human_speed,
        Limb::Arm => separation.arm_speed,
    }
}

/// Returns the place of a joint, if its confidence is sufficient.
fn place(body: &Body, joint: Body25) -> Option<Vector3<f64>> {
    let keypoint = body.get(joint)?;
    let place = keypoint.position.coords;
    let good = keypoint.confidence.value() >= LEAST_CONFIDENCE
        && place.iter().all(|coordinate| coordinate.is_finite());
    good.then_some(place)
}

/// Returns the largest error of a joint's place \[m\], zero if the frame has no covariance.
fn spread(body: &Body, joint: Body25) -> f64 {
    let variance = body.covariance(joint).map_or(0.0, |known| known.symmetric_eigenvalues().max());
    DEVIATIONS * variance.max(0.0).sqrt()
}

/// Places of a person in one frame, and its time \[m, s\].
#[derive(Debug, Clone, Copy)]
struct Sighting {
    joints: Places,
    time: f64,
}

/// Returns the part of an age that the reaction time does not cover. In that time the person may
/// have moved anywhere near.
fn beyond_reaction(age: f64, separation: &SeparationSettings) -> f64 {
    (age - separation.reaction_time).max(0.0)
}

/// Returns the part of an age that the reaction time covers.
fn covered_by_reaction(age: f64, separation: &SeparationSettings) -> f64 {
    age.clamp(0.0, separation.reaction_time)
}

/// Displacement of a body between two frames.
#[derive(Debug, Clone, Copy, Default)]
struct Displacement {
    /// Median over the joints seen both times, for each axis. A single misplaced joint does not
    /// change it.
    median: Vector3<f64>,
    /// Largest effect of the camera's noise, by the disagreement of the joints.
    noise: f64,
}

impl Displacement {
    /// Computes the displacement of the trunk of a body from its places `before`.
    fn of(body: &Body, before: &Places) -> Option<Self> {
        let mut moved = [Vector3::zeros(); ROOT.len()];
        let mut count = 0;
        for joint in ROOT {
            let now = place(body, joint);
            if let (Some(now), Some(before)) = (now, before[joint as usize])
                && let Some(slot) = moved.get_mut(count)
            {
                *slot = now - before;
                count += 1;
            }
        }
        let moved = moved.get_mut(..count).filter(|moved| !moved.is_empty())?;
        let median = |moved: &mut [Vector3<f64>]| {
            Vector3::from_fn(|axis, _| {
                moved.sort_unstable_by(|a, b| a[axis].total_cmp(&b[axis]));
                moved[moved.len() / 2][axis]
            })
        };
        let middle = median(moved);
        for displacement in moved.iter_mut() {
            *displacement = (*displacement - middle).abs();
        }
        #[expect(clippy::cast_precision_loss, reason = "a body has few joints")]
        let deviation = median(moved).norm() * MEDIAN_DEVIATION / (count as f64).sqrt();
        Some(Self { median: middle, noise: (DEVIATIONS * deviation).min(MOST_SPREAD) })
    }

    /// Returns true if the displacement can belong to a person who moves by `way` \[m\] at most.
    fn is_within(&self, way: f64) -> bool {
        self.beyond_noise() <= way
    }

    /// Returns the smallest motion that explains the displacement \[m\].
    fn beyond_noise(&self) -> f64 {
        self.median.norm() - NOISE - self.noise
    }
}
