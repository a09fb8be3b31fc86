//! Accuracy of the tracker on the motion of real people, and its steadiness for a standing person.
//!
//! The joints are from motion capture and film, with the errors of a real detector and of the
//! shipped camera. The truth is the whole record, smoothed. It does not depend on the tracker. The
//! densities in the settings were chosen on these records too, because there are no others.

use std::collections::HashMap;
use std::f64::consts::TAU;

use nalgebra::{Matrix3, Point3, SMatrix, SVector, Vector2, Vector3, vector};
use vision_models::{
    Body, Body25, BodyTracker, Confidence, DepthNoise, Keypoint, People, PeopleSettings, Percept,
    TrackedPerson, TrackerSettings,
};

const FRAME: f64 = 0.05;

/// Speeds of the gait that are tested (m/s).
const KEPT: [f64; 4] = [0.5, 0.85, 1.06, 1.4];

/// A joint's position and velocity (m, m/s).
type Joint = (Vector3<f64>, Vector3<f64>);
type Joints = [Joint; Body25::COUNT];

#[derive(serde::Deserialize)]
struct Clip {
    period: f64,
    frames: Vec<Vec<[f64; 3]>>,
}

/// The joints of a person at any time.
struct Motion {
    clip: Clip,
    /// Offset from one cycle to the next (m), for a motion that is repeated without end.
    turn: Option<Vector3<f64>>,
    pace: f64,
}

impl Motion {
    fn of(name: &str) -> Self {
        let text = include_str!("../data/real_motion.json");
        let clip =
            serde_json::from_str::<HashMap<String, Clip>>(text).unwrap().remove(name).unwrap();
        Self { clip, turn: None, pace: 1.0 }
    }

    /// Returns the gait at a speed (m/s), repeated without end.
    fn walking(speed: f64) -> Self {
        let mut walk = Self::of("walk");
        let hip = |frame: &Vec<[f64; 3]>| Vector3::from(frame[Body25::MidHip.index()]) * 1e-3;
        let (first, last) = (walk.clip.frames.first().unwrap(), walk.clip.frames.last().unwrap());
        let mut turn = hip(last) - hip(first);
        turn.z = 0.0;
        walk.pace = speed / (turn.norm() / walk.length());
        walk.turn = Some(turn);
        walk
    }

    fn length(&self) -> f64 {
        self.clip.period * (self.clip.frames.len() - 1) as f64
    }

    fn duration(&self) -> f64 {
        if self.turn.is_some() { 15.0 } else { self.length() }
    }

    fn place(&self, frame: i64, joint: usize) -> Vector3<f64> {
        let last = i64::try_from(self.clip.frames.len()).unwrap() - 1;
        let (turns, frame) = match self.turn {
            Some(_) => (frame.div_euclid(last), frame.rem_euclid(last)),
            None => (0, frame.clamp(0, last)),
        };
        let place = Vector3::from(self.clip.frames[usize::try_from(frame).unwrap()][joint]) * 1e-3;
        place + self.turn.unwrap_or_default() * turns as f64
    }

    /// Interpolates by a Catmull-Rom spline.
    #[allow(clippy::cast_possible_truncation)]
    fn at(&self, time: f64) -> Joints {
        let frame = time * self.pace / self.clip.period;
        let (first, s) = (frame.floor() as i64, frame - frame.floor());
        std::array::from_fn(|joint| {
            let [a, b, c, d] = [-1, 0, 1, 2].map(|k| self.place(first + k, joint));
            let (one, two, three) =
                ((c - a) * 0.5, a - b * 2.5 + c * 2.0 - d * 0.5, (b - c) * 1.5 + (d - a) * 0.5);
            let place = b + (one + (two + three * s) * s) * s;
            let velocity =
                (one + (two * 2.0 + three * (3.0 * s)) * s) * (self.pace / self.clip.period);
            (place, velocity)
        })
    }
}

/// Returns a person who stands as in the first frame of the gait, with a common motion of all
/// joints added.
fn moved(by: impl Fn(f64) -> Joint) -> impl Fn(f64) -> Joints {
    let stance = Motion::walking(1.0).at(0.0);
    move |time| {
        let (way, velocity) = by(time);
        stance.map(|(place, _)| (place + way, velocity))
    }
}

/// Returns a sway of 20 mm/s rms, as of a person who works standing.
fn sways(time: f64) -> Joint {
    let one = |frequency: f64, phase: f64| {
        let (angle, rate) = (TAU * frequency * time + phase, TAU * frequency);
        (0.02 * angle.sin() / rate, 0.02 * angle.cos())
    };
    let ((x, vx), (y, vy)) = (one(0.25, 0.3), one(0.35, 1.9));
    (vector![x, y, 0.0], vector![vx, vy, 0.0])
}

/// Returns a motion that accelerates to 1 m/s after 4 s. `acceleration` is in m/s².
fn begins(acceleration: f64) -> impl Fn(f64) -> Joint {
    move |time| {
        let (since, rise) = ((time - 4.0).max(0.0), 1.0 / acceleration);
        let way =
            if since < rise { 0.5 * acceleration * since * since } else { since - 0.5 * rise };
        (Vector3::x() * way, Vector3::x() * (acceleration * since).min(1.0))
    }
}

/// The measurement errors between a joint and its measured position.
#[derive(Clone, Copy)]
struct Sight {
    /// Distance from the person (m).
    distance: f64,
    /// Correlation time of the errors (s).
    lasts: f64,
    /// True if covariances are known.
    tells: bool,
}

/// Real detectors: lasting errors of 2.5 pixels and of a D435i's depth. The reported covariances
/// are those of 3 pixels.
const REAL: Sight = Sight { distance: 2.5, lasts: 0.16, tells: true };
/// The shipped recording's camera: errors of 1.5 pixels, independent in each frame, without
/// covariances.
const SHIPPED: Sight = Sight { distance: 2.5, lasts: 0.0, tells: false };
/// Real detectors whose covariances are not known.
const UNTOLD: Sight = Sight { tells: false, ..REAL };

struct Detector {
    sight: Sight,
    state: u64,
    errors: [Vector3<f64>; Body25::COUNT],
    seen: bool,
}

impl Detector {
    fn new(sight: Sight, seed: u64) -> Self {
        let state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        Self { sight, state, errors: [Vector3::zeros(); Body25::COUNT], seen: false }
    }

    /// Returns a number in (0, 1) (Knuth's generator, the upper half of its state).
    fn uniform(&mut self) -> f64 {
        self.state = self
            .state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((self.state >> 33) as f64 + 0.5) / f64::from(1_u32 << 31)
    }

    fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
    }

    fn see(&mut self, joints: &Joints) -> Body {
        let Sight { distance, lasts, tells } = self.sight;
        let correlation = if lasts > 0.0 && self.seen { (-FRAME / lasts).exp() } else { 0.0 };
        self.seen = true;
        let ray = vector![0.8, -0.5, -0.3].normalize();
        let (pixels, told) = if tells { (2.5, 3.0) } else { (1.5, 1.5) };
        let [across, told] = [pixels, told].map(|pixels| pixels * distance / 615.0);
        let depth = DepthNoise::D435I.sigma(distance);
        let mut body = Body::default();
        for (joint, (place, _)) in Body25::ALL.into_iter().zip(joints) {
            let fresh = Vector3::from_fn(|_, _| self.normal());
            let error = &mut self.errors[joint.index()];
            *error = *error * correlation + fresh * (1.0 - correlation * correlation).sqrt();
            let aside = (*error - ray * ray.dot(error)) * across + ray * (ray.dot(error) * depth);
            let covariance = (Matrix3::identity() - ray * ray.transpose()) * told.powi(2)
                + ray * ray.transpose() * depth.powi(2);
            let confidence = Confidence::new(0.9).unwrap();
            let keypoint = Keypoint { position: Point3::from(place + aside), confidence };
            if tells {
                body.set_measured(joint, keypoint, covariance);
            } else {
                body.set(joint, Some(keypoint));
            }
        }
        body
    }
}

/// Comparison of the claimed uncertainties with the true errors.
#[derive(Clone, Copy, Debug, Default)]
struct Claim {
    frames: f64,
    beyond: f64,
    errors: f64,
    variances: f64,
}

impl Claim {
    fn take<const D: usize>(&mut self, error: SVector<f64, D>, covariance: &SMatrix<f64, D, D>) {
        let largest = largest(covariance);
        self.frames += 1.0;
        self.beyond += f64::from(u8::from(error.norm_squared() > 9.0 * largest));
        self.errors += error.norm_squared();
        self.variances += covariance.trace();
    }

    /// Returns the share of frames in which the error is beyond three standard deviations.
    fn beyond(&self) -> f64 {
        self.beyond / self.frames
    }

    /// Returns the ratio of standard deviation to error, both root mean square.
    fn ratio(&self) -> f64 {
        (self.variances / self.errors).sqrt()
    }

    fn error(&self) -> f64 {
        (self.errors / self.frames).sqrt()
    }

    #[allow(clippy::print_stdout)] // Figures of the tests.
    fn say(&self, what: &str) {
        let (beyond, ratio) = (100.0 * self.beyond(), self.ratio());
        println!(
            "{what}: {beyond:.2} % beyond 3 σ, σ {ratio:.2} × the error of {:.4}",
            self.error()
        );
    }
}

/// Returns the largest eigenvalue of a positive definite matrix by power iteration.
fn largest<const D: usize>(matrix: &SMatrix<f64, D, D>) -> f64 {
    let mut direction = SVector::<f64, D>::from_fn(|row, _| 1.0 + 0.1 * row as f64);
    for _ in 0..40 {
        direction = (matrix * direction).try_normalize(0.0).unwrap();
    }
    direction.dot(&(matrix * direction))
}

/// Runs the tracker frame by frame. `tell` gets the time, the person, and the true floor position
/// and velocity.
fn follow(
    motion: impl Fn(f64) -> Joints,
    duration: f64,
    sight: Sight,
    seed: u64,
    mut tell: impl FnMut(f64, &TrackedPerson, Vector2<f64>, Vector2<f64>),
) {
    let mut detector = Detector::new(sight, seed);
    let settings = TrackerSettings { position_sigma: 0.02, ..TrackerSettings::default() };
    let mut tracker = BodyTracker::new(settings).unwrap();
    for frame in 0.. {
        let time = FRAME * f64::from(frame);
        if time >= duration {
            break;
        }
        let joints = motion(time);
        let body = Some(detector.see(&joints));
        tracker.update(&Percept { time, body, action: None, surface: None }).unwrap();
        let (place, velocity) = joints[Body25::MidHip.index()];
        if let Some(person) = tracker.predict(time) {
            tell(time, &person, place.xy(), velocity.xy());
        }
    }
}

/// Returns the claims for the pelvis's velocity and position, from `settled` on (s).
fn claims(motion: &Motion, sight: Sight, seeds: u64, settled: f64) -> [Claim; 2] {
    let mut claims = [Claim::default(); 2];
    for seed in 1..=seeds {
        follow(
            |time| motion.at(time),
            motion.duration(),
            sight,
            seed,
            |time, person, place, velocity| {
                if time >= settled {
                    claims[0].take(person.velocity - velocity, &person.velocity_covariance);
                    claims[1].take(person.floor.coords - place, &person.floor_covariance);
                }
            },
        );
    }
    claims
}

/// Checks that at most a hundredth of the velocity errors is beyond three standard deviations.
fn check(claim: &Claim, what: &str) {
    claim.say(what);
    assert!(claim.beyond() <= 0.01, "{what}: {claim:?}");
}

#[test]
fn body_velocities_are_as_certain_as_claimed() {
    for (name, sight) in [("real", REAL), ("shipped", SHIPPED)] {
        let mut all = Vec::new();
        for speed in KEPT {
            all.push(claims(&Motion::walking(speed), sight, 20, 1.5));
            check(&all.last().unwrap()[0], &format!("{name}, velocity at {speed} m/s"));
        }
        all.push(claims(&Motion::of("balance"), sight, 100, 0.3));
        check(&all.last().unwrap()[0], &format!("{name}, velocity on the beam"));
        let mean = |of: fn(&Claim) -> f64| all.iter().map(|claims| of(&claims[0])).sum::<f64>();
        let ratio =
            mean(|claim| claim.variances / claim.frames) / mean(|claim| claim.error().powi(2));
        println!("{name}: σ {:.2} × the error", ratio.sqrt());
        assert!(ratio.sqrt() <= 1.55, "{name}: {}", ratio.sqrt());
        for claims in &all {
            claims[1].say(&format!("{name}, place"));
        }
    }
}

/// Tests head and trunk, arms, and legs.
#[test]
fn joint_velocities_are_as_certain_as_claimed() {
    let groups: [&[usize]; 3] = [&[0, 1, 2, 5, 8, 9, 12], &[3, 4, 6, 7], &[10, 11, 13, 14]];
    for (name, sight) in [("real", REAL), ("shipped", SHIPPED), ("untold", UNTOLD)] {
        let mut all = [[Claim::default(); 2]; 3];
        let settings = TrackerSettings { position_sigma: 0.03, ..TrackerSettings::default() };
        for speed in KEPT.map(Some).into_iter().chain([None; 4]) {
            let motion = speed.map_or_else(|| Motion::of("balance"), Motion::walking);
            let (seeds, settled) = if speed.is_some() { (4, 1.5) } else { (10, 0.3) };
            for seed in 1..=seeds {
                let mut detector = Detector::new(sight, seed);
                let mut people = People::new(PeopleSettings::default(), settings.clone()).unwrap();
                for frame in 0.. {
                    let time = FRAME * f64::from(frame);
                    if time >= motion.duration() {
                        break;
                    }
                    let joints = motion.at(time);
                    people.update(time, &[detector.see(&joints)]).unwrap();
                    let [person] = people.tracks() else { panic!("one person") };
                    for (group, claims) in groups.iter().zip(&mut all) {
                        for &joint in group.iter().filter(|_| time >= settled) {
                            let ((place, velocity), joint) = (joints[joint], Body25::ALL[joint]);
                            let known = person.velocity(joint, time).unwrap();
                            claims[0].take(known.mean - velocity, &known.covariance);
                            if let Some(covariance) = person.body().covariance(joint) {
                                let seen = person.body().get(joint).unwrap().position.coords;
                                claims[1].take(seen - place, &covariance);
                            }
                        }
                    }
                }
            }
        }
        for (part, claims) in ["trunk", "arms", "legs"].into_iter().zip(&all) {
            check(&claims[0], &format!("{name}, velocity of the {part}"));
            assert!(claims[0].ratio() < 2.5, "{name}, {part}: {claims:?}");
            claims[1].say(&format!("{name}, place of the {part}"));
            // Joints without covariances are returned as measured.
            assert_eq!(claims[1].frames > 0.0, sight.tells);
            assert!(!sight.tells || claims[1].beyond() <= 0.02, "{claims:?}");
        }
    }
}

#[test]
fn standing_people_stand_still() {
    for (name, sight) in [("real", REAL), ("shipped", SHIPPED)] {
        let (mut speed, mut way, mut rate, mut count) = (0.0, 0.0, 0.0, 0.0);
        for seed in 1..=10 {
            let mut before: Option<TrackedPerson> = None;
            follow(moved(sways), 60.0, sight, seed, |time, person, _, _| {
                if let Some(before) = before.replace(*person).filter(|_| time > 5.0) {
                    speed += person.velocity.norm_squared();
                    way += (person.floor - before.floor).norm_squared() / FRAME.powi(2);
                    rate += (person.heading - before.heading).powi(2) / FRAME.powi(2);
                    count += 1.0;
                }
            });
        }
        let [speed, way, rate] = [speed, way, rate].map(|sum| f64::sqrt(sum / count));
        println!("{name}: {speed:.4} m/s, from frame to frame {way:.4} m/s and {rate:.4} rad/s");
        assert!(speed < 0.01 && way < 0.02 && rate < 0.08, "{speed} m/s, {way} m/s, {rate} rad/s");
    }
}

#[test]
fn starting_walkers_are_followed_at_once() {
    for (name, sight) in [("real", REAL), ("shipped", SHIPPED)] {
        let (mut lags, mut claim) = ([0.0_f64; 2], Claim::default());
        for seed in 1..=20 {
            let mut at = [0.0; 2];
            follow(moved(begins(1.5)), 8.0, sight, seed, |time, person, place, velocity| {
                let lag = (person.floor.coords - place).norm();
                let since = time - 4.0;
                if (since - 1.0 / 1.5).abs() < 0.5 * FRAME {
                    at[0] = lag;
                }
                if (since - 1.0 / 1.5 - 1.0).abs() < 0.5 * FRAME {
                    at[1] = lag;
                }
                if since > -1.0 {
                    claim.take(person.velocity - velocity, &person.velocity_covariance);
                }
            });
            lags = [lags[0].max(at[0]), lags[1].max(at[1])];
        }
        println!("{name}: lags by {:.3} m at 1 m/s, by {:.3} m a second later", lags[0], lags[1]);
        check(&claim, &format!("{name}, velocity of who begins"));
        assert!(lags[0] < 0.25 && lags[1] < 0.1, "{lags:?} m");
    }
}
