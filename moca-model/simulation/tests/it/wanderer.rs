//! The person who behaves unexpectedly, and the transport of frames to the controller.

use moca_simulation::people::{
    CameraSettings, FRAME_RATE, Joints, Perception, Person, Transport, Wanderer,
};
use nalgebra::{Point3, Vector2};
use proptest::prelude::*;
use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use vision_models::{Body25, Percept, PersonId, Tool};

const ID: PersonId = PersonId::new(0);

const PERIOD: f64 = 0.001;

fn draw(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// The object that they work on.
const OBJECT: Point3<f64> = Point3::new(1.0, 0.0, 1.0);

/// Twelve seconds of a wanderer around an object, tick by tick.
fn wander(seed: u64, mut each: impl FnMut(f64, &Wanderer)) {
    let mut wanderer = Wanderer::new(draw(seed), OBJECT.coords.xy());
    for tick in 0..12_000 {
        let time = f64::from(tick) * PERIOD;
        wanderer.advance(time, PERIOD, &OBJECT);
        each(time, &wanderer);
    }
}

#[test]
fn only_arms_exceed_the_assumed_speed() {
    use Body25::{LeftElbow, LeftWrist, RightElbow, RightWrist};
    for seed in 0..40 {
        let mut before: Option<Joints> = None;
        wander(seed, |time, wanderer| {
            let joints = wanderer.person().joints();
            if let Some(before) = before.filter(|_| !wanderer.jumped()) {
                for (joint, (now, before)) in joints.iter().zip(&before).enumerate() {
                    let speed = (now - before).norm() / PERIOD;
                    let name = Body25::ALL[joint].name();
                    let arms = [LeftElbow, LeftWrist, RightElbow, RightWrist];
                    let most = if arms.contains(&Body25::ALL[joint]) { 8.0 } else { 1.6 };
                    assert!(speed <= most, "seed {seed}, {time} s: {name} at {speed} m/s");
                }
            }
            before = Some(joints);
        });
    }
}

/// A soak needs all of this to happen: walks up to the tool, work, jumps, losses and long absences.
#[test]
fn people_do_what_nobody_expects() {
    let (mut near, mut together, mut jumps, mut unseen, mut absent) = (0, 0, 0, 0, 0);
    for seed in 0..40 {
        let mut first_seen = None;
        wander(seed, |time, wanderer| {
            let person = wanderer.person();
            near += u32::from((person.floor().coords - Vector2::new(1.0, 0.0)).norm() < 0.3);
            together += u32::from(person.action().is_collaborative());
            jumps += u32::from(wanderer.jumped());
            unseen += u32::from(!wanderer.is_in_view());
            if wanderer.is_in_view() {
                first_seen.get_or_insert(time);
            }
            assert!((1.5..2.0).contains(&person.stature()));
        });
        absent += u32::from(first_seen.unwrap() > 5.0);
    }
    assert!(near > 1000 && together > 40_000 && unseen > 40_000, "{near} {together} {unseen}");
    assert!(jumps > 20 && absent >= 2, "{jumps} {absent}");
}

/// Frames of a wanderer through a camera with these settings: the true person and the percept.
fn frames(settings: CameraSettings, seed: u64) -> Vec<(Person, Option<Percept>)> {
    let mut perception =
        Perception::new(ID, settings, 12.0, Tool::Drill, [draw(seed), draw(!seed)]);
    let mut frames = Vec::new();
    let mut next = 0.0;
    wander(seed, |time, wanderer| {
        if time >= next {
            next += 1.0 / FRAME_RATE;
            let percept = perception.look(time, wanderer.person(), wanderer.is_in_view());
            frames.push((wanderer.person().clone(), percept));
        }
    });
    frames
}

#[test]
fn joint_errors_stay_below_the_largest() {
    for (largest, noise) in [(0.02, 1.0), (0.02, 5.0), (0.0, 1.0)] {
        let settings = CameraSettings {
            noise,
            largest_error: largest,
            drop: 0.3,
            ..CameraSettings::default()
        };
        let mut greatest = 0.0_f64;
        for (person, percept) in frames(settings, 5) {
            let Some(body) = percept.and_then(|percept| percept.body) else { continue };
            let joints = person.joints();
            for (joint, seen) in body.iter() {
                greatest = greatest.max((seen.position - joints[joint.index()]).norm());
            }
        }
        assert!(greatest <= largest + 1e-12, "{greatest} m");
        assert!(greatest >= 0.99 * largest, "it is reached: {greatest} m");
    }
}

#[test]
fn nobody_out_of_view_is_seen() {
    let mut perception =
        Perception::new(ID, CameraSettings::PERFECT, 1.0, Tool::Drill, [draw(1), draw(2)]);
    wander(3, |time, wanderer| {
        let percept = perception.look(time, wanderer.person(), wanderer.is_in_view()).unwrap();
        assert_eq!(percept.body.is_some(), wanderer.is_in_view());
        assert!(percept.action.is_none() || percept.body.is_some());
    });
}

proptest! {
    /// Every frame that was sent arrives once, in order, 20 to 90 ms late or together with the one before.
    #[test]
    fn frames_arrive_late_and_in_order(
        seed in any::<u64>(), sent in prop::collection::vec((0.001..0.2_f64, any::<bool>()), 1..60),
    ) {
        let mut transport = Transport::new(draw(seed));
        let mut time = 0.0;
        let mut schedule = Vec::new();
        for (pause, lost) in sent {
            time += pause;
            schedule.push((time, lost));
        }
        let taken: Vec<f64> =
            schedule.iter().filter(|(_, lost)| !lost).map(|(time, _)| *time).collect();
        let mut to_send = schedule.into_iter().peekable();
        let mut arrived: Vec<f64> = Vec::new();
        let mut now = 0.0;
        while now < time + 0.2 {
            while let Some((time, lost)) = to_send.next_if(|(time, _)| *time <= now) {
                let percept = Percept { time, body: None, action: None, surface: None };
                transport.send((!lost).then_some((percept, Vec::new())), 0.0);
            }
            while let Some((percept, _)) = transport.arrived(now) {
                let late = now - percept.time;
                prop_assert!((0.02..=0.09 + PERIOD).contains(&late), "{late} s");
                arrived.push(percept.time);
            }
            now += PERIOD;
        }
        prop_assert_eq!(arrived, taken);
    }
}
