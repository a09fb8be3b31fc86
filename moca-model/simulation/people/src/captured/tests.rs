use percept_recording::{Header, Writer};
use vision_models::Body25::{LeftKnee, LeftWrist};
use vision_models::{Confidence, Keypoint, Percept};

use super::*;

fn motions() -> impl Iterator<Item = CapturedMotion> {
    CapturedMotion::NAMES.into_iter().map(|name| CapturedMotion::named(name).unwrap())
}

/// A recording of these frames, which are 0.1 s apart.
fn recording(frames: &[Option<Body>], stature: Option<f64>) -> Recording {
    let mut writer = Writer::new(Vec::new(), &Header { stature, ..Header::default() }).unwrap();
    for (frame, body) in (0_u32..).zip(frames) {
        let time = 0.1 * f64::from(frame);
        let percept = Percept { time, body: body.clone(), action: None, surface: None };
        writer.write(&percept).unwrap();
    }
    let bytes = writer.finish().unwrap();
    Recording::read(Reader::new(&bytes[..]).unwrap(), IfPartial::Refuse).unwrap()
}

/// A body whose joints are in a column at `x` \[m\], but for some that are not seen.
fn column(x: f64, hidden: &[Body25]) -> Body {
    let mut body = Body::default();
    for joint in Body25::ALL.into_iter().filter(|joint| !hidden.contains(joint)) {
        let position = Point3::new(x, 0.0, 0.05 * joint.index() as f64);
        body.set(joint, Some(Keypoint { position, confidence: Confidence::ONE }));
    }
    body
}

#[test]
fn played_no_faster_than_recorded() {
    for motion in motions() {
        let frames = motion.times.windows(2).zip(motion.frames.windows(2));
        let fastest = |joint: usize| {
            let speeds = frames.clone().map(|(times, frames)| {
                (frames[1][joint] - frames[0][joint]).norm() / (times[1] - times[0])
            });
            speeds.fold(0.0, f64::max)
        };
        let own: [f64; Body25::COUNT] = std::array::from_fn(fastest);
        let (step, mut before) = (1e-3, motion.joints(0.0));
        let mut reached = [0.0_f64; Body25::COUNT];
        let mut time = 0.0;
        while time < motion.cycle() {
            time += step;
            let now = motion.joints(time);
            for ((reached, now), before) in reached.iter_mut().zip(&now).zip(&before) {
                *reached = reached.max((now - before).norm() / step);
            }
            before = now;
        }
        for (own, reached) in own.into_iter().zip(reached) {
            // A curve through the frames is a little faster than the chords between them.
            assert!(reached <= 1.2 * own + 0.05, "{reached} m/s of {own} m/s");
            assert!(reached > 0.4 * own, "{reached} m/s of {own} m/s");
        }
        let again = motion.joints(motion.cycle());
        for (now, first) in again.iter().zip(&motion.joints(0.0)) {
            assert!((now - first).norm() < 1e-9);
        }
    }
}

#[test]
fn moved_to_a_place_and_heading() {
    let (floor, heading) = (Point2::new(-2.0, 0.7), 2.2);
    for motion in motions() {
        let moved = motion.clone().moved_to(floor, heading);
        let count = moved.frames.len() as f64;
        let mean = moved.frames.iter().map(|frame| pelvis(frame).coords).sum::<Vector2<f64>>();
        assert!((mean / count - floor.coords).norm() < 1e-9);
        let towards: Vector2<f64> = moved.frames.iter().map(forwards).sum();
        assert!((towards.y.atan2(towards.x) - heading).abs() < 1e-9);
        for (before, after) in motion.frames.iter().flatten().zip(moved.frames.iter().flatten()) {
            assert!((before.z - after.z).abs() < 1e-12);
        }
    }
}

#[test]
fn hidden_joints_are_filled_in() {
    let toe = Body25::LeftBigToe;
    let mut doubtful = column(1.0, &[toe]);
    let far = Point3::new(5.0, 0.0, 0.5);
    let keypoint = Keypoint { position: far, confidence: Confidence::new(0.3).unwrap() };
    doubtful.set(LeftKnee, Some(keypoint));
    let frames =
        [Some(column(0.0, &[toe])), Some(doubtful), None, Some(column(0.6, &[toe, LeftWrist]))];
    let motion = CapturedMotion::new(&recording(&frames, Some(1.7))).unwrap();
    assert_eq!(motion.times, [0.0, 0.1, 0.3]);
    let [_, second, third] = &motion.frames[..] else { panic!("three frames") };
    // They move along with the pelvis.
    assert!((place(second, LeftKnee).x - 1.0).abs() < 1e-12, "{}", place(second, LeftKnee));
    assert!((place(third, LeftWrist).x - 0.6).abs() < 1e-12, "{}", place(third, LeftWrist));
    assert_eq!(place(second, toe), place(second, LeftAnkle));
    assert_eq!(motion.at(0.1), *second);
    assert!((motion.duration() - 0.3).abs() < 1e-12);
}

#[test]
fn unfit_recordings_say_what_is_missing() {
    let whole = || Some(column(0.0, &[]));
    let refused = |frames: &[Option<Body>], stature| {
        CapturedMotion::new(&recording(frames, stature)).unwrap_err().to_string()
    };
    let says = refused(&[whole(), whole(), whole()], None);
    assert!(says.contains("how tall"), "{says}");
    let says = refused(&[whole(), None, None], Some(1.7));
    assert!(says.contains("frames with a person: 1; give at least 2"), "{says}");
    let says = refused(&[whole(), whole()], Some(1.7));
    assert!(says.contains("it lasts 0.1 s; give at least 0.2 s"), "{says}");
    let hidden = || Some(column(0.0, &[LeftWrist]));
    let frames: Vec<_> = (0..15).map(|frame| if frame == 0 { whole() } else { hidden() }).collect();
    let says = refused(&frames, Some(1.7));
    assert!(says.contains("the left wrist is hidden for 1.40 s"), "{says}");
    for joint in [MidHip, Nose, LeftWrist] {
        let frames: Vec<_> = (0..5).map(|_| Some(column(0.0, &[joint]))).collect();
        let says = refused(&frames, Some(1.7));
        assert!(says.contains(&format!("no frame surely shows the {}", joint.name())), "{says}");
    }
    let mut disordered = recording(&[whole(), whole(), whole(), whole()], Some(1.7));
    disordered.percepts[2].time = 0.05;
    let says = CapturedMotion::new(&disordered).unwrap_err().to_string();
    assert!(says.contains("do not increase"), "{says}");
    let says = CapturedMotion::from_argument("fly").unwrap_err().to_string();
    assert_eq!(
        says,
        "motion \"fly\": give walk, balance, punch, dance, get-up, or a recording of a person"
    );
    let says = CapturedMotion::from_argument("Cargo.toml").unwrap_err().to_string();
    assert!(says.starts_with("Cargo.toml: "), "{says}");
}
