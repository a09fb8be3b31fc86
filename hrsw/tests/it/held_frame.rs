//! A frame that is held while a person stands.

use hrsw::{FloorMotion, FrameFollower, HeldFrame};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector2, Vector3, Vector6};
use proptest::prelude::*;

const PERIOD: f64 = 1e-3;

/// A held frame with its follower.
struct Held {
    frame: HeldFrame,
    follower: FrameFollower,
}

impl Held {
    fn at(start: FloorMotion) -> Self {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), start.heading);
        let pose = Isometry3::from_parts(Translation3::from(start.position.push(0.0)), turn);
        Self { frame: HeldFrame::following(), follower: FrameFollower::new(pose).unwrap() }
    }

    fn step(&mut self, seen: FloorMotion, rate: FloorMotion) {
        let stops = floor(&self.follower.stopping_pose());
        let (target, rate) = self.frame.advance(seen, rate, stops, PERIOD);
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), target.heading);
        let pose = Isometry3::from_parts(Translation3::from(target.position.push(0.0)), turn);
        let v = rate.position;
        let twist = Vector6::new(v.x, v.y, 0.0, 0.0, 0.0, rate.heading);
        self.follower.retarget(pose, twist).unwrap();
        self.follower.advance(PERIOD);
    }

    fn speed(&self) -> f64 {
        self.follower.twist().norm()
    }
}

fn floor(pose: &Isometry3<f64>) -> FloorMotion {
    let forward = pose.rotation * Vector3::x();
    FloorMotion { position: pose.translation.vector.xy(), heading: forward.y.atan2(forward.x) }
}

fn at(x: f64, y: f64, heading: f64) -> FloorMotion {
    FloorMotion { position: Vector2::new(x, y), heading }
}

const REST: FloorMotion = FloorMotion { position: Vector2::new(0.0, 0.0), heading: 0.0 };

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, ..ProptestConfig::default() })]

    /// A person who sways by a few centimetres and degrees does not move it, in any branch of the
    /// heading.
    #[test]
    fn swaying_does_not_move_it(
        heading in -3.2..3.2_f64, sway in 0.0..0.05_f64, turn in 0.0..0.09_f64, rate in 0.2..2.0_f64,
    ) {
        let mut held = Held::at(at(1.0, 0.5, heading));
        for tick in 0..8000 {
            let time = f64::from(tick) * PERIOD;
            let (sine, cosine) = (rate * time).sin_cos();
            let seen = at(1.0 + sway * sine, 0.5, heading + turn * sine);
            let moves = at(sway * rate * cosine, 0.0, turn * rate * cosine);
            held.step(seen, moves);
            if tick > 4000 {
                prop_assert!(held.frame.is_held());
                prop_assert!(held.speed() < 1e-9, "{} at {time} s", held.speed());
            }
        }
    }

    /// It follows a person who walks, and is at rest soon after they stop. It is never farther away
    /// than the zone.
    #[test]
    fn it_follows_a_walking_person(direction in -3.1..3.1_f64, speed in 0.3..0.9_f64) {
        let mut held = Held::at(REST);
        let way = Vector2::new(direction.cos(), direction.sin());
        let mut place = Vector2::zeros();
        for tick in 0..9000 {
            let time = f64::from(tick) * PERIOD;
            let walks = (2.0..5.0).contains(&time);
            let velocity = if walks { way * speed } else { Vector2::zeros() };
            place += velocity * PERIOD;
            let rate = FloorMotion { position: velocity, heading: 0.0 };
            held.step(FloorMotion { position: place, heading: 0.0 }, rate);
            let off = (floor(held.follower.pose()).position - place).norm();
            if (4.0..5.0).contains(&time) {
                prop_assert!(off < 0.03, "{off} m behind at {time} s");
            }
            if time > 6.5 {
                prop_assert!(held.frame.is_held() && held.speed() < 0.06, "{}", held.speed());
                prop_assert!(off < HeldFrame::POSITION + 0.01, "{off} m off");
            }
        }
    }
}

/// A person who moves away slowly is followed slowly.
#[test]
fn it_moves_when_the_mean_leaves_the_zone() {
    let mut held = Held::at(REST);
    let mut fastest = 0.0_f64;
    for tick in 0..20_000 {
        let time = f64::from(tick) * PERIOD;
        let x = (0.02 * (time - 2.0)).clamp(0.0, 0.15);
        let rate = if x > 0.0 && x < 0.15 { 0.02 } else { 0.0 };
        held.step(at(x, 0.0, 0.0), at(rate, 0.0, 0.0));
        fastest = fastest.max(held.speed());
    }
    let off = (floor(held.follower.pose()).position.x - 0.15).abs();
    assert!(off <= HeldFrame::POSITION, "{off} m off");
    assert!(fastest <= 0.05 + 0.03, "{fastest} m/s");
}

/// The place changes by a zone in a tick. The target's speed and jerk are those of three lags of 0.4 s, here for a step
/// of up to 1.1 zones.
#[test]
fn a_new_place_is_approached_smoothly() {
    let mut frame = HeldFrame::following();
    let mut rates = Vec::new();
    for tick in 0..12_000 {
        let x = (0.02 * (f64::from(tick) * PERIOD - 4.0)).clamp(0.0, 0.09);
        let (_, rate) = frame.advance(at(x, 0.0, 0.0), REST, REST, PERIOD);
        if frame.is_held() {
            rates.push(rate.position.x / HeldFrame::POSITION);
        }
    }
    let fastest = rates.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
    assert!((0.5..0.75).contains(&fastest), "{fastest} zones/s");
    let bends = rates.windows(3).map(|r| (r[2] - 2.0 * r[1] + r[0]).abs() / (PERIOD * PERIOD));
    let jerk = bends.fold(0.0, f64::max);
    assert!((10.0..1.1 / 0.4_f64.powi(3)).contains(&jerk), "{jerk} zones/s³");
}

/// A frame that is held off the person moves to them, slowly.
#[test]
fn a_recentred_frame_moves_to_the_mean() {
    let mut held = Held::at(REST);
    let stands = at(0.05, -0.02, 0.1);
    for _tick in 0..4000 {
        held.step(REST, REST);
    }
    for _tick in 0..4000 {
        held.step(stands, REST);
    }
    let off = |held: &Held| {
        let frame = floor(held.follower.pose());
        ((frame.position - stands.position).norm(), (frame.heading - stands.heading).abs())
    };
    let (place, heading) = off(&held);
    assert!(place > 0.04 && heading > 0.08, "a small step moves nothing: {place} m, {heading} rad");
    let mut fastest = 0.0_f64;
    for _tick in 0..4000 {
        held.frame.recentre();
        held.step(stands, REST);
        fastest = fastest.max(held.speed());
    }
    let (place, heading) = off(&held);
    assert!(place < 1e-3 && heading < 1e-3, "{place} m, {heading} rad");
    assert!(held.frame.is_held() && fastest < 0.15, "{fastest}");
}

/// Two frames show a person who stands elsewhere and moves.
#[test]
fn two_wrong_frames_do_not_move_it() {
    let mut held = Held::at(REST);
    for tick in 0..4000 {
        let wrong = (2000..2100).contains(&tick);
        let (seen, rate) =
            if wrong { (at(0.05, 0.03, 0.1), at(0.25, -0.15, 0.5)) } else { (REST, REST) };
        held.step(seen, rate);
        assert!(tick < 1000 || held.frame.is_held() && held.speed() < 1e-9, "{tick}");
    }
}
