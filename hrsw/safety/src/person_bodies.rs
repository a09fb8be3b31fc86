//! The person's capsules, from the keypoints that the camera sees.

use hrsw::Capsule;
use nalgebra::Vector3;
use vision_models::{Body, Body25, Percept};

use crate::age::Age;
use crate::approach::PersonBody;
use crate::body_parts::{Limb, PARTS, Part};
use crate::body_region::ContactLimits;
use crate::contact::{Contact, ContactLimit};
use crate::joint_velocity::JointVelocities;
use crate::separation::SeparationSettings;
use crate::settings::PersonBodySettings;

/// How far a standing trunk may seem to move from frame to frame, all of its joints alike \[m\].
const NOISE: f64 = 0.03;
/// How much farther at most where its joints disagree, and by how many standard deviations \[m\].
const MOST_SPREAD: f64 = 0.15;
const DEVIATIONS: f64 = 3.0;
/// Faster than anybody ran \[m/s\]: 12.4 m/s over 20 m of the world record of 100 m, Berlin 2009 (IAAF's analysis).
const FASTEST: f64 = 12.5;
/// Of a median of n values with the median absolute deviation 1 from it, the standard deviation is this over
/// √n: 1.4826 makes a standard deviation of that of a normal distribution, √(π/2) that of its median.
const MEDIAN_DEVIATION: f64 = 1.4826 * 1.2533;

/// Joints that move with the pelvis.
const ROOT: [Body25; 6] = {
    use Body25::{LeftHip, LeftShoulder, MidHip, Neck, RightHip, RightShoulder};
    [Neck, MidHip, LeftShoulder, RightShoulder, LeftHip, RightHip]
};

/// Where the joints are, as far as they were seen \[m\].
type Places = [Option<Vector3<f64>>; Body25::COUNT];

/// A joint where it was seen last, and when \[m, s\].
#[derive(Debug, Clone, Copy)]
struct Seen {
    place: Vector3<f64>,
    /// Where the frame before that one showed it, moved along with the trunk.
    before: Vector3<f64>,
    time: f64,
    /// How far it may be from where it was seen, where a frame tells \[m\].
    spread: f64,
    /// Where it was seen in the newest frame, too far away to believe at once.
    doubtful: Option<Vector3<f64>>,
}

impl Seen {
    /// A joint that was not seen before.
    fn first(place: Vector3<f64>, time: f64, spread: f64) -> Self {
        Self { place, before: place, time, spread, doubtful: None }
    }

    /// Takes where the joint is in a frame, if it is there; `moved` is how far the trunk moved
    /// since the frame before. A joint that is missing or doubted moves along with the trunk.
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

/// The person's capsules, and what is known of their motion.
#[derive(Debug, Clone)]
pub(super) struct PersonBodies {
    settings: PersonBodySettings,
    joints: [Option<Seen>; Body25::COUNT],
    velocities: JointVelocities,
    /// Somebody who was seen where nobody can have gone since the frame before: not believed alone, but there
    /// may be somebody.
    doubtful: Option<Sighting>,
    newest: f64,
    /// When the newest frame was taken that shows nobody, or somebody who can have come there \[s\].
    plausible: f64,
    /// What a contact with each part may do.
    contacts: [Option<ContactLimit>; PARTS.len()],
    bodies: Vec<PersonBody>,
}

impl PersonBodies {
    /// Bodies of one person at most: each part as believed, as the frame before showed it, and as doubted.
    pub(super) const ROOM: usize = 3 * PARTS.len();

    pub(super) fn new(settings: PersonBodySettings, limits: &ContactLimits) -> Self {
        Self {
            settings,
            contacts: PARTS.map(|part| limits.of(part.region)),
            joints: [None; Body25::COUNT],
            velocities: JointVelocities::new(),
            doubtful: None,
            newest: f64::NEG_INFINITY,
            plausible: f64::NEG_INFINITY,
            bodies: Vec::with_capacity(Self::ROOM),
        }
    }

    /// Forgets what was seen, and when.
    pub(super) fn forget(&mut self) {
        self.joints = [None; Body25::COUNT];
        self.velocities.forget();
        self.doubtful = None;
        self.newest = f64::NEG_INFINITY;
        self.plausible = f64::NEG_INFINITY;
        self.bodies.clear();
    }

    /// How long ago the newest plausible frame was taken: in which nobody is seen, or a person who is where
    /// somebody can have gone since the frame before.
    pub(super) fn age(&self, now: f64) -> Age {
        Age::new((now - self.plausible).max(0.0)).unwrap_or(Age::NEVER)
    }

    /// Takes a camera frame. Returns the least speed \[m/s\] that would have brought the person where it shows
    /// them, if nobody is that fast.
    pub(super) fn observe(&mut self, percept: &Percept) -> Option<f64> {
        let Some(body) = &percept.body else {
            // A frame without anybody says nothing of who was seen before.
            self.plausible = percept.time;
            return None;
        };
        self.see(percept.time, body)
    }

    /// Whether nobody is known here.
    pub(super) fn is_empty(&self) -> bool {
        self.joints.iter().all(Option::is_none)
    }

    /// How far a body of a frame of this time is from where the person was seen last, if they can have gone
    /// there \[m\].
    pub(super) fn way_to(&self, time: f64, body: &Body) -> Option<f64> {
        let (places, least) = (self.places(), self.settings.least_confidence);
        // By the trunk, or by what else is seen.
        let by = |joints: &[Body25]| Displacement::of(joints, body, &places, least);
        let moved = by(&ROOT).or_else(|| by(&Body25::ALL))?;
        moved.is_within(self.reach(time - self.newest)).then(|| moved.median.norm())
    }

    /// Returns true if a body of a frame of this time is where the person was seen last.
    pub(super) fn is_where(&self, time: f64, body: &Body) -> bool {
        self.way_to(time, body).is_some_and(|way| way <= self.settings.agreement)
    }

    /// How far a person may go in this time [s] \[m\].
    fn reach(&self, elapsed: f64) -> f64 {
        self.settings.jump_speed * elapsed
    }

    /// Takes the body of a frame. Joints that it misses move along with the trunk. Returns the least speed \[m/s\]
    /// that would have brought it there, if nobody is that fast: it is then doubted.
    pub(super) fn see(&mut self, time: f64, body: &Body) -> Option<f64> {
        let doubtful = self.doubtful.take();
        let least = self.settings.least_confidence;
        let displacement =
            |from: &Places| Displacement::of(&ROOT, body, from, least).unwrap_or_default();
        let (displaced, elapsed) = (displacement(&self.places()), time - self.newest);
        let moved = displaced.median;
        let jumped = !displaced.is_within(self.reach(elapsed));
        if jumped {
            let is_again = doubtful.is_some_and(|seen| {
                displacement(&seen.joints).is_within(self.reach(time - seen.time))
            });
            if !is_again {
                let joints = Body25::ALL.map(|joint| place(body, joint, least));
                self.doubtful = Some(Sighting { joints, time });
                self.velocities.forget();
                let speed = displaced.beyond_noise() / elapsed;
                return (speed > FASTEST).then_some(speed);
            }
            self.velocities.forget();
        }
        self.plausible = time;
        for (joint, seen) in Body25::ALL.into_iter().zip(&mut self.joints) {
            let place = place(body, joint, self.settings.least_confidence);
            let spread = spread(body, joint);
            match seen {
                Some(seen) => seen.update(place, (time, spread), &moved, self.settings.limb_gate),
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
        self.velocities.observe(time, body, believed, &self.settings);
        None
    }

    /// The capsules at the time `now`; at `contact_speed` they may be touched where their region allows
    /// it, never at the head.
    pub(super) fn place(
        &mut self,
        now: f64,
        separation: &SeparationSettings,
        contact_speed: f64,
    ) -> &[PersonBody] {
        self.bodies.clear();
        let is_old = |time: f64| now - time > self.settings.forget_after;
        if is_old(self.newest) {
            self.joints = [None; Body25::COUNT];
        }
        self.doubtful = self.doubtful.take().filter(|seen| !is_old(seen.time));
        self.place_believed(now, separation, contact_speed);
        self.place_doubtful(now, separation);
        &self.bodies
    }

    fn place_believed(&mut self, now: f64, separation: &SeparationSettings, contact_speed: f64) {
        for (part, limit) in PARTS.iter().zip(&self.contacts) {
            let ends = (self.joints[part.from as usize], self.joints[part.to as usize]);
            let (Some(from), Some(to)) = ends else { continue };
            let assumed = assumed_speed(part, separation);
            let of = |joint| self.velocities.of(joint, now, assumed, &self.settings);
            let velocity = of(part.from).zip(of(part.to));
            let velocity = velocity.map(|ends| part.velocity(&from.place, &to.place, ends));
            let touched = self.velocities.for_contact(velocity, now, &self.settings);
            let fastest = velocity.map_or(assumed, |v| v.mean.norm() + v.uncertainty);
            // Z_d stands for what frames do not tell.
            let growth = |seen: &Seen| {
                let untold = (seen.spread - separation.human_uncertainty).max(0.0);
                fastest * beyond_reaction(now - seen.time, separation) + untold
            };
            let beyond = part.uncertainty_beyond(&from.place, &to.place, separation);
            let grown =
                part.capsule(&from.place, &to.place, growth(&from).max(growth(&to)) + beyond);
            let within = self.within_reach(part, growth);
            let smaller = within
                .filter(|reach| grown.is_none_or(|capsule| reach.radius() < capsule.radius()));
            // Of what may not be touched one frame alone is not believed: it may show it too far away.
            let before = part
                .capsule(&from.before, &to.before, growth(&from).max(growth(&to)) + beyond)
                .filter(|_| limit.is_none() && smaller.is_none());
            for capsule in smaller.or(grown).into_iter().chain(before) {
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

    /// The thinnest capsule about joints within which a part is that hangs on them.
    fn within_reach(&self, part: &Part, growth: impl Fn(&Seen) -> f64) -> Option<Capsule> {
        let capsules = part.reaches.iter().filter_map(|&reach| {
            let [one, other] = reach.joints().map(|joint| self.joints[joint as usize]);
            let [one, other] = [one?, other?];
            let growth = growth(&one).max(growth(&other));
            reach.capsule(&[one.place, other.place], part.radius + growth)
        });
        capsules.min_by(|a, b| a.radius().total_cmp(&b.radius()))
    }

    /// The capsules of who was seen where nobody can have gone: nobody may touch them.
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

    /// As placed last.
    pub(super) fn placed(&self) -> &[PersonBody] {
        &self.bodies
    }

    /// Where it is measured, the velocity of the pelvis along the floor \[m/s\]; else zero.
    pub(super) fn velocity(&self, now: f64, separation: &SeparationSettings) -> Vector3<f64> {
        let pelvis =
            self.velocities.of(Body25::MidHip, now, separation.human_speed, &self.settings);
        pelvis.map_or(Vector3::zeros(), |velocity| velocity.mean.xy().push(0.0))
    }

    /// Where the joints were seen last.
    fn places(&self) -> Places {
        self.joints.map(|seen| seen.map(|seen| seen.place))
    }
}

/// How fast a part may be of which no velocity is measured \[m/s\].
fn assumed_speed(part: &Part, separation: &SeparationSettings) -> f64 {
    match part.limb {
        Limb::Body => separation.human_speed,
        Limb::Arm => separation.arm_speed,
    }
}

/// Where a joint is seen, if it is seen well enough.
fn place(body: &Body, joint: Body25, least_confidence: f64) -> Option<Vector3<f64>> {
    let keypoint = body.get(joint)?;
    let place = keypoint.position.coords;
    let good = keypoint.confidence.value() >= least_confidence
        && place.iter().all(|coordinate| coordinate.is_finite());
    good.then_some(place)
}

/// How far a joint may be from where a frame shows it, where the frame tells its covariance; else zero \[m\].
fn spread(body: &Body, joint: Body25) -> f64 {
    let variance = body.covariance(joint).map_or(0.0, |known| known.symmetric_eigenvalues().max());
    DEVIATIONS * variance.max(0.0).sqrt()
}

/// Where a person was seen in one frame, and when \[m, s\].
#[derive(Debug, Clone, Copy)]
struct Sighting {
    joints: Places,
    time: f64,
}

/// The age of what was seen, beyond what the reaction time covers: it may be anywhere near.
fn beyond_reaction(age: f64, separation: &SeparationSettings) -> f64 {
    (age - separation.reaction_time).max(0.0)
}

/// The age of what was seen, as far as the reaction time covers it.
fn covered_by_reaction(age: f64, separation: &SeparationSettings) -> f64 {
    age.clamp(0.0, separation.reaction_time)
}

/// How far a body is from where it was before.
#[derive(Debug, Clone, Copy, Default)]
struct Displacement {
    /// The median of the joints seen both times, by axis, so that one that is misplaced does not count.
    median: Vector3<f64>,
    /// What the camera's noise may make of it, as far as the joints disagree.
    noise: f64,
}

impl Displacement {
    /// How far `joints` of a body are from where they were `before`.
    fn of(joints: &[Body25], body: &Body, before: &Places, least_confidence: f64) -> Option<Self> {
        let mut moved = [Vector3::zeros(); Body25::COUNT];
        let mut count = 0;
        for &joint in joints {
            let now = place(body, joint, least_confidence);
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

    /// Returns true if somebody who moves by no more than `way` \[m\] may be seen so far from where they were.
    fn is_within(&self, way: f64) -> bool {
        self.beyond_noise() <= way
    }

    /// How far they must have moved at least \[m\].
    fn beyond_noise(&self) -> f64 {
        self.median.norm() - NOISE - self.noise
    }
}
