//! From rendered frames to percepts, compared with the truth.

use std::{
    f64::consts::TAU,
    io::{BufRead, BufReader, Write},
    path::Path,
    time::{Duration, SystemTime, UNIX_EPOCH},
};

use crate::support::{Ran, Runs, cases, write_npy};
use ergo_map::{Conditions, LegSupport, Worksheet};
use human_perception::percepts::{Assessor, Perceiver, PerceiverSettings, assess};
use moca_simulation::people::{CameraSettings, Occupation, WalkerSettings, WalkingPath};
use moca_simulation::rendering::{Film, Viewpoint};
use vision_models::{
    Body, Body25, BodyTracker, DepthImage, ImageBody, LiftingSettings, Percept, TrackerSettings,
};

/// Errors against the truth as root mean squares.
#[derive(Debug, Default)]
struct Figures {
    pelvis: f64,
    worst: f64,
    heading: f64,
    wrists: f64,
    wrists_seen: f64,
    stature: f64,
    lost: u32,
    jumps: u64,
    frames: f64,
    reba_within: f64,
    reba_bias: f64,
    reba_of: f64,
    slowest_us: f64,
    mean_us: f64,
}

/// Judged is the time from full speed to 10 s, while the person walks. Later they turn and leave.
const FROM: f64 = 2.0;
const WALKING: f64 = 10.0;
const TURNING: f64 = 11.0;

/// Measures a walk around a circle at 1 m/s in front of the camera until this time \[s\]. A fifth of the joints is
/// missing, joints have errors of 3 pixels, and the depth has the noise of a D435i.
fn walk(viewpoint: Viewpoint, seed: u64, until: f64) -> Figures {
    let (size, duration) = ([640, 480], 16.0);
    let settings = WalkerSettings {
        path: WalkingPath::Circle,
        occupation: Occupation::Walking,
        speed: Some(1.0),
        duration,
        seed,
        camera: CameraSettings { drop: 0.2, ..CameraSettings::default() },
        ..WalkerSettings::default()
    };
    let film = Film::new(settings, viewpoint, size, 3.0).unwrap();
    let pixel_sigma = 3.0 * size[0] as f64 / 640.0;
    let lifting = LiftingSettings { pixel_sigma, ..LiftingSettings::default() };
    let settings = PerceiverSettings { lifting, ..PerceiverSettings::default() };
    let mut perceiver = Perceiver::new(*film.camera(), settings).unwrap();
    let mut tracker = BodyTracker::new(TrackerSettings::default()).unwrap();
    let mut figures = Figures::default();
    let (mut wrists, mut possible) = (0.0, 0.0);
    let mut stature = None;
    let mut assessor = Assessor::default();
    let mut pelves = Vec::new();
    for shot in film {
        let shot = shot.unwrap();
        let time = shot.entry.time;
        let people: Vec<_> = shot.skeleton.into_iter().collect();
        perceiver.see(time, &people, &shot.depth).unwrap();
        let taken = perceiver.time_taken().as_secs_f64() * 1e6;
        figures.mean_us += taken;
        figures.slowest_us = figures.slowest_us.max(taken);
        let body = perceiver.body().cloned();
        stature = perceiver.engaged().and_then(vision_models::PersonTrack::stature).or(stature);
        tracker.update(&Percept { time, body: body.clone(), action: None, surface: None }).unwrap();
        let scores = body.as_ref().and_then(|body| assessor.update(time, body).unwrap());
        let truth = shot.truth.body.unwrap();
        let at = |joint| truth.get(joint).unwrap().position;
        // A person walks if their true pelvis has moved by more than 10 cm in half a second.
        pelves.push((time, at(Body25::MidHip).xy()));
        let before = pelves.iter().rev().find(|(then, _)| time - then >= 0.5);
        let walks = before.is_some_and(|(_, then)| (at(Body25::MidHip).xy() - then).norm() > 0.1);
        if time > until {
            break;
        }
        if time < FROM {
            continue;
        }
        figures.frames += 1.0;
        let Some(person) = tracker.predict(time) else {
            figures.lost += 1;
            continue;
        };
        figures.lost += u32::from(!person.freshness.is_usable());
        let error = (person.floor - at(Body25::MidHip).xy()).norm();
        figures.pelvis += error.powi(2);
        figures.worst = figures.worst.max(error);
        let left = at(Body25::LeftShoulder) - at(Body25::RightShoulder);
        let turned = person.heading - (-left.x).atan2(left.y);
        figures.heading += (turned - TAU * (turned / TAU).round()).powi(2);
        if let (Some(seen), Some(true_score)) = (scores, assess(&truth).unwrap()) {
            let support = if walks { LegSupport::Walking } else { LegSupport::Bilateral };
            let conditions = Conditions { support, ..Conditions::default() };
            let sheet = Worksheet::from_posture(&true_score.measured.posture, conditions);
            let true_reba = sheet.score().unwrap().reba;
            let difference = f64::from(seen.reba.reba) - f64::from(true_reba);
            figures.reba_within += f64::from(u8::from(difference.abs() <= 1.0));
            figures.reba_bias += difference;
            figures.reba_of += 1.0;
        }
        for wrist in [Body25::LeftWrist, Body25::RightWrist] {
            possible += 1.0;
            if let Some(seen) = body.as_ref().and_then(|body| body.get(wrist)) {
                assert!(seen.position.iter().all(|x| x.is_finite()));
                figures.wrists += (seen.position - at(wrist)).norm_squared();
                wrists += 1.0;
            }
        }
    }
    figures.reba_within /= figures.reba_of;
    figures.reba_bias /= figures.reba_of;
    figures.mean_us /= figures.frames;
    figures.pelvis = (figures.pelvis / figures.frames).sqrt();
    figures.heading = (figures.heading / figures.frames).sqrt().to_degrees();
    figures.wrists = (figures.wrists / wrists).sqrt();
    figures.wrists_seen = wrists / possible;
    figures.stature = stature.unwrap().stature;
    figures.jumps = tracker.jumps();
    figures
}

/// Run further seeds by `AHQP_CASES=8 cargo test --release -p examples --test it measured_from -- --nocapture`.
#[test]
fn walking_person_is_measured_from_noisy_frames() {
    for seed in 1..=cases(1) {
        let figures = walk(Viewpoint::Facing, seed, TURNING);
        println!("seed {seed}: {figures:?}");
        figures.assert_place();
        assert!(figures.wrists < 0.040, "wrists {} m RMS", figures.wrists);
        figures.assert_posture(0.9, 0.3);
    }
}

/// The camera is beside and farther away, and half of the body is hidden by the other half.
#[test]
fn a_walking_person_is_measured_from_beside() {
    for seed in 1..=cases(1) {
        let figures = walk(Viewpoint::Beside, seed, WALKING);
        println!("seed {seed}: {figures:?}");
        figures.assert_place();
        // The far wrist is hidden half of the time, and its depth has an error of 35 mm then.
        assert!(figures.wrists < 0.055, "wrists {} m RMS", figures.wrists);
        figures.assert_posture(0.8, 0.6);
    }
}

impl Figures {
    fn assert_place(&self) {
        assert_eq!((self.jumps, self.lost), (0, 0));
        assert!(self.pelvis < 0.025, "pelvis {} m RMS", self.pelvis);
        assert!(self.heading < 5.0, "heading {}° RMS", self.heading);
        assert!((self.stature - 1.75).abs() < 0.025, "stature {} m", self.stature);
    }

    /// Asserts that REBA is measured in this share of the frames, in nine of ten of these within 1. The mean error is
    /// at most `bias`.
    fn assert_posture(&self, share: f64, bias: f64) {
        assert!(self.reba_of > share * self.frames, "{} of {}", self.reba_of, self.frames);
        assert!(self.reba_within >= 0.9, "REBA within 1 in {}", self.reba_within);
        assert!(self.reba_bias.abs() < bias, "REBA is off by {} on average", self.reba_bias);
    }
}

/// The value of a key in the last line of a program's output.
fn value(ran: &Ran, key: &str) -> serde_json::Value {
    let line = ran.output.lines().last().unwrap();
    serde_json::from_str::<serde_json::Value>(line).unwrap()[key].clone()
}

/// A short film in a folder, made once.
fn frames(folder: &Path, duration: &str) -> String {
    let frames = folder.join("frames").to_str().unwrap().to_owned();
    let ran = Runs::new("record")
        .with(&["--frames", &frames, "--size=160x120", "--duration", duration, "--walk", "--quiet"])
        .run();
    assert!(ran.status.success(), "{}", ran.errors);
    frames
}

fn perceive(frames: &str, output: &Path) -> Ran {
    perceiving(frames, output).with(&["--quiet"]).run()
}

fn perceiving(frames: &str, output: &Path) -> Runs {
    let skeletons = format!("{frames}/skeletons");
    Runs::new("perceive")
        .with(&[frames, "--skeletons", &skeletons, "--pixel-sigma=1", "--json", "--output"])
        .with(&[output])
}

fn read(path: &Path) -> Vec<Percept> {
    percept_recording::open(path).unwrap().collect::<Result<_, _>>().unwrap()
}

#[test]
fn rendered_frames_become_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let frames = frames(folder.path(), "4");
    let output = folder.path().join("walk.jsonl");
    let ran = perceive(&frames, &output);
    assert!(ran.status.success(), "{}", ran.errors);
    assert_eq!(value(&ran, "frames"), 81);
    assert_eq!(value(&ran, "jumps"), 0);
    assert!(value(&ran, "with_body").as_u64().unwrap() > 60);
    assert!(value(&ran, "reba_mean").as_f64().unwrap() >= 1.0);
    assert_eq!(value(&ran, "unseen")["wrist_flexion"], 1.0);
    let (found, truth) = (read(&output), read(&Path::new(&frames).join("truth.jsonl")));
    assert_eq!(found.len(), truth.len());
    let neck = |percept: &Percept| Some(percept.body.as_ref()?.get(Body25::Neck)?.position);
    let pairs = found.iter().zip(&truth).filter_map(|(a, b)| Some(neck(a)? - neck(b)?));
    let errors: Vec<f64> = pairs.map(|error| error.norm()).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(mean < 0.1, "{mean} m in small images");
}

/// The images show two people. The second one is the first again, farther to the right.
#[test]
fn everybody_else_in_a_frame_is_an_other() {
    const ASIDE: usize = 40;
    let size = [160, 120];
    let settings = WalkerSettings {
        path: WalkingPath::Circle,
        occupation: Occupation::Walking,
        duration: 3.0,
        ..WalkerSettings::default()
    };
    let film = Film::new(settings, Viewpoint::Facing, size, 0.0).unwrap();
    let mut perceiver = Perceiver::new(*film.camera(), PerceiverSettings::default()).unwrap();
    let mut frames = 0;
    for shot in film {
        let shot = shot.unwrap();
        let Some(image) = shot.skeleton else { continue };
        let mut second = ImageBody::default();
        for (joint, mut keypoint) in image.iter() {
            keypoint.position.x += ASIDE as f64;
            second.set(joint, Some(keypoint));
        }
        let depth = |column: usize, row: usize| shot.depth.depth(column, row);
        let nearest = (0..size[0] * size[1]).map(|index| {
            let (column, row) = (index % size[0], index / size[0]);
            let moved = column.checked_sub(ASIDE).and_then(|column| depth(column, row));
            [depth(column, row), moved].into_iter().flatten().reduce(f32::min).unwrap_or(0.0)
        });
        let depth = DepthImage::from_metres(size, nearest.collect()).unwrap();
        perceiver.see(shot.entry.time, &[image, second], &depth).unwrap();
        let people = usize::from(perceiver.body().is_some()) + perceiver.others().count();
        assert!(people <= 2);
        frames += usize::from(people == 2);
        let neck = |body: &Body| body.get(Body25::Neck).map(|neck| neck.position);
        if let (Some(body), Some(other)) = (perceiver.body(), perceiver.others().next()) {
            let apart = neck(body).zip(neck(other)).map(|(one, other)| (one - other).norm());
            assert!(apart.is_none_or(|apart| apart > 0.3), "{apart:?}");
        }
    }
    assert!(frames > 30, "both are seen in {frames} frames");
}

#[test]
fn broken_folders_are_named_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let frames = frames(folder.path(), "0.2");
    let place = Path::new(&frames).to_owned();
    let output = folder.path().join("walk.jsonl");
    let index = std::fs::read_to_string(place.join("frames.jsonl")).unwrap();
    let camera = std::fs::read_to_string(place.join("camera.json")).unwrap();
    let lines: Vec<_> = index.lines().collect();
    let fails = |expected: &str| {
        let ran = perceive(&frames, &output);
        assert!(
            !ran.status.success() && ran.errors.contains(expected),
            "{expected}: {}",
            ran.errors
        );
        assert!(!output.exists());
    };
    let with_index = |lines: &[&str]| {
        std::fs::write(place.join("frames.jsonl"), lines.join("\n") + "\n").unwrap();
    };
    with_index(&[lines[0], lines[2], lines[1]]);
    fails("line 3: frame 1 of 0.05 s comes after frame 2 of 0.1 s");
    with_index(&[lines[0], lines[0]]);
    fails("line 2: frame 0 of 0 s comes after frame 0");
    with_index(&[lines[0], "{\"frame\":77,\"time\":9.0,\"arrived\":null}"]);
    fails("line 2: frame 77 is listed");
    with_index(&[lines[0], "{\"end\":{\"frames\":3}}"]);
    fails("line 2: 3 frames at the end, and there are 1");
    with_index(&[lines[0], "walk"]);
    fails("frames.jsonl, line 2");
    with_index(&[]);
    fails("has no frame");
    with_index(&lines);
    std::fs::write(place.join("camera.json"), camera.replace("\"width\":160", "\"width\":320"))
        .unwrap();
    fails("the depth image has 160 × 120 pixels");
    let turned = camera.replace("\"gravity\":[", "\"gravity\":[9.0,");
    std::fs::write(place.join("camera.json"), turned).unwrap();
    fails("camera.json");
    std::fs::write(place.join("camera.json"), &camera).unwrap();
    // Frames that the camera lost are counted.
    with_index(&[lines[0], lines[2]]);
    let ran = perceive(&frames, &output);
    assert!(ran.status.success() && value(&ran, "lost") == 1, "{}", ran.errors);
    // A place that cannot be written is detected at once.
    let ran = perceive(&frames, &folder.path().join("missing/walk.jsonl"));
    assert!(!ran.status.success() && ran.errors.contains("missing"), "{}", ran.errors);
    // The folder is not overwritten.
    let ran = Runs::new("record").with(&["--frames", &frames, "--duration=0.1"]).run();
    assert!(!ran.status.success() && ran.errors.contains("holds frames already"), "{}", ran.errors);
}

/// The lines of an index, with the closing line.
fn lines(frames: &str) -> Vec<String> {
    let index = std::fs::read_to_string(Path::new(frames).join("frames.jsonl")).unwrap();
    index.lines().map(|line| format!("{line}\n")).collect()
}

#[test]
fn a_folder_that_grows_is_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let frames = frames(folder.path(), "0.5");
    let index = Path::new(&frames).join("frames.jsonl");
    let lines = lines(&frames);
    std::fs::write(&index, lines[..5].concat()).unwrap();
    let output = folder.path().join("walk.jsonl");
    let mut child = perceiving(&frames, &output).with(&["--wait=60"]).start();
    let mut said = String::new();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    while !said.contains("waiting for further frames") {
        assert!(errors.read_line(&mut said).unwrap() > 0, "{said}");
    }
    // A line arrives in two parts, followed by the others.
    let (begin, end) = lines[5].split_at(9);
    for part in [begin, end, &lines[6..].concat()] {
        let mut index = std::fs::OpenOptions::new().append(true).open(&index).unwrap();
        index.write_all(part.as_bytes()).unwrap();
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let ran = Ran::of(child);
    assert!(ran.status.success(), "{ran:?}");
    assert_eq!(value(&ran, "frames"), 11);
}

/// A line of the index for a frame that is taken now, by the system's clock.
fn taken_now(frame: u32) -> String {
    std::thread::sleep(Duration::from_millis(1));
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs_f64();
    format!("{{\"frame\":{frame},\"time\":{now},\"arrived\":null}}\n")
}

#[test]
fn live_perception_takes_the_newest_frame() {
    let folder = tempfile::tempdir().unwrap();
    let frames = frames(folder.path(), "0.5");
    let index = Path::new(&frames).join("frames.jsonl");
    let output = folder.path().join("walk.jsonl");
    perceiving(&frames, &output).with(&["--live"]).run().failed(1, "--wait");
    std::fs::write(&index, (0..5).map(taken_now).collect::<String>()).unwrap();
    let live = || perceiving(&frames, &output).with(&["--live", "--wait=60"]);
    let mut child = live().start();
    // A percept is there while the program goes on.
    let waits_for = |lines: usize| {
        let has_come =
            || std::fs::read_to_string(&output).is_ok_and(|text| text.lines().count() == lines);
        let come = (0..6000).any(|_| {
            std::thread::sleep(Duration::from_millis(10));
            has_come()
        });
        assert!(come, "{lines} lines");
    };
    waits_for(2);
    let append = |text: &str| {
        let mut index = std::fs::OpenOptions::new().append(true).open(&index).unwrap();
        index.write_all(text.as_bytes()).unwrap();
    };
    append(&taken_now(5));
    waits_for(3);
    append(&(taken_now(6) + "{\"end\":{\"frames\":7}}\n"));
    let ran = Ran::of({
        drop(child.stdin.take());
        child
    });
    assert!(ran.status.success(), "{ran:?}");
    assert_eq!((value(&ran, "frames"), &value(&ran, "live")["late"]), (3.into(), &4.into()));
    let text = std::fs::read_to_string(&output).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap());
    let stamps: Vec<_> = lines
        .filter_map(|line| Some((line["time"].as_f64()?, line["arrived"].as_f64()?)))
        .collect();
    assert_eq!(stamps.len(), 3);
    assert!(
        stamps.iter().all(|(taken, arrived)| (0.0..60.0).contains(&(arrived - taken))),
        "{stamps:?}"
    );
    // An interrupt ends it, and what was written is whole.
    std::fs::write(&index, taken_now(0)).unwrap();
    let ran = live().interrupt_at("waiting for further frames", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    assert_eq!(read(&output).len(), 1);
}

#[test]
fn an_interrupt_keeps_the_frames_so_far() {
    let folder = tempfile::tempdir().unwrap();
    let frames = frames(folder.path(), "0.5");
    let lines = lines(&frames);
    std::fs::write(Path::new(&frames).join("frames.jsonl"), lines[..5].concat()).unwrap();
    let output = folder.path().join("walk.jsonl");
    let perceive = perceiving(&frames, &output).with(&["--wait=600"]);
    let ran = perceive.interrupt_at("waiting for further frames", "INT");
    assert_eq!((ran.code(), &value(&ran, "partial")), (Some(130), &true.into()), "{ran:?}");
    assert!(!output.exists());
    let kept = std::fs::read_to_string(folder.path().join("walk.partial.jsonl")).unwrap();
    assert_eq!(kept.lines().count(), 7, "a header, five frames and the end");
}

/// Depth in metres in NumPy's arrays gives the same result as PNG.
#[test]
fn depth_comes_as_png_or_npy() {
    let folder = tempfile::tempdir().unwrap();
    let frames = frames(folder.path(), "1");
    let necks = |name: &str| -> Vec<_> {
        let output = folder.path().join(name);
        let ran = perceive(&frames, &output);
        assert!(ran.status.success(), "{}", ran.errors);
        let neck = |percept: &Percept| Some(percept.body.as_ref()?.get(Body25::Neck)?.position);
        read(&output).iter().filter_map(neck).collect()
    };
    let png = necks("png.jsonl");
    for_each_depth(&frames, |path, image| {
        let metres = image.iter().map(|&unit| f32::from(unit) * 0.001).collect();
        let metres = ndarray::Array2::from_shape_vec((120, 160), metres).unwrap();
        write_npy(path.with_extension("npy"), &metres);
        std::fs::remove_file(path).unwrap();
    });
    let npy = necks("npy.jsonl");
    assert!(png.len() > 5 && png.len() == npy.len());
    assert!(png.iter().zip(&npy).all(|(one, other)| (one - other).norm() < 1e-3));
    // Columns and rows are exchanged.
    let turned = Path::new(&frames).join("depth/000003.npy");
    write_npy(turned, &ndarray::Array2::<f32>::ones((160, 120)));
    let ran = perceive(&frames, &folder.path().join("turned.jsonl"));
    assert!(!ran.status.success() && ran.errors.contains("120 × 160"), "{}", ran.errors);
}

#[test]
fn images_that_are_upside_down_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let frames = frames(folder.path(), "2.5");
    for_each_depth(&frames, |path, image| {
        let turned: Vec<u16> = image.iter().rev().copied().collect();
        let turned = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(160, 120, turned).unwrap();
        turned.save(path).unwrap();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let skeleton = Path::new(&frames).join(format!("skeletons/{name}_keypoints.json"));
        let text = std::fs::read_to_string(&skeleton).unwrap();
        let mut people: serde_json::Value = serde_json::from_str(&text).unwrap();
        for person in people["people"].as_array_mut().unwrap() {
            let joints = person["pose_keypoints_2d"].as_array_mut().unwrap();
            for joint in joints.chunks_mut(3).filter(|joint| joint[2] != 0.0) {
                joint[0] = (159.0 - joint[0].as_f64().unwrap()).into();
                joint[1] = (119.0 - joint[1].as_f64().unwrap()).into();
            }
        }
        std::fs::write(&skeleton, people.to_string()).unwrap();
    });
    let output = folder.path().join("walk.jsonl");
    let ran = perceive(&frames, &output).failed(1, "the images are upside down");
    assert!(ran.errors.contains("of 20 people have the neck below the hips"), "{}", ran.errors);
    assert!(!output.exists());
}

/// Calls `each` with every depth image's file and its units.
fn for_each_depth(frames: &str, each: impl Fn(&Path, &[u16])) {
    for entry in std::fs::read_dir(Path::new(frames).join("depth")).unwrap() {
        let path = entry.unwrap().path();
        each(&path, image::open(&path).unwrap().into_luma16().as_raw());
    }
}
