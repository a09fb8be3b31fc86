//! The map of one person: build, interpolation, domain, files.

use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::support::{MAP, Random};
use ergo_map::{
    Conditions, ErgonomicsMap, Error, HandTarget, MapOptions, Mode, Person, PosturePredictor,
    Region, Segments, Side, ergonomics_score,
};
use nalgebra::Vector3;
use proptest::prelude::*;

fn within(region: &Region, t: [f64; 3]) -> Vector3<f64> {
    region.min() + region.size().component_mul(&Vector3::from(t))
}

fn anywhere() -> impl Strategy<Value = Vector3<f64>> {
    proptest::array::uniform3(0.0..1.0_f64)
        .prop_map(|t| within(&Region::surroundings(1.75, Side::Right), t))
}

#[test]
fn the_map_covers_exactly_the_reachable_volume() {
    assert!(MAP.len() > 4000 && !MAP.is_empty(), "{}", MAP.len());
    let inside = Vector3::new(0.4, -0.2, 1.1);
    assert!(MAP.contains(&inside));
    for outside in [
        Vector3::new(1.5, 0.0, 1.0),
        Vector3::new(0.0, 0.0, 1.2),
        Vector3::new(0.4, -0.2, -0.5),
        Vector3::new(f64::NAN, 0.0, 1.0),
        Vector3::new(0.4, f64::INFINITY, 1.0),
    ] {
        assert!(!MAP.contains(&outside), "{outside}");
        assert!(matches!(MAP.sample(&outside), Err(Error::OutOfDomain { .. })));
        assert!(MAP.posture(&outside).is_err());
        assert!(MAP.assess(&outside, &Conditions::default()).is_err());
    }
}

#[test]
fn nodes_contain_the_predicted_postures() {
    let predictor = PosturePredictor::new(&Person::average(), Side::Right);
    for node in MAP.nodes().step_by(97) {
        let prediction = predictor.predict(&HandTarget::point(node.position)).unwrap();
        assert_eq!(prediction.angles, node.angles);
        let posture = node.angles.posture();
        let score = ergonomics_score(&posture, &Conditions::default(), Mode::Graded);
        assert_eq!(score, node.score);
        if let Ok(sample) = MAP.sample(&node.position) {
            assert!((sample.score - node.score).abs() < 1e-9);
        }
    }
}

#[test]
fn the_interpolated_map_is_close_to_predictions() {
    let predictor = PosturePredictor::new(&Person::average(), Side::Right);
    let zone = Region::work_zone(1.75, Side::Right);
    let mut random = Random(5);
    let (mut square, mut worst, mut count, mut same_level) = (0.0, 0.0_f64, 0, 0);
    for _ in 0..1000 {
        let hand = within(&zone, core::array::from_fn(|_| random.uniform(0.0, 1.0)));
        let (Ok(sample), Ok(prediction)) =
            (MAP.sample(&hand), predictor.predict(&HandTarget::point(hand)))
        else {
            continue;
        };
        let posture = prediction.angles.posture();
        let score = ergonomics_score(&posture, &Conditions::default(), Mode::Graded);
        let error = (sample.score - score).abs();
        square += error * error;
        worst = worst.max(error);
        count += 1;
        let conditions = Conditions::default();
        let direct = ergo_map::Worksheet::from_posture(&posture, conditions).score().unwrap();
        let read = MAP.assess(&hand, &conditions).unwrap();
        same_level += usize::from(direct.action_level == read.action_level);
    }
    let rms = (square / f64::from(count)).sqrt();
    let share = same_level as f64 / f64::from(count);
    println!("{count} points: rms {rms:.4}, worst {worst:.3}, same action level {share:.3}");
    assert!(count > 900 && rms < 0.03 && worst < 0.25 && share > 0.95);
}

#[test]
fn progress_is_complete_and_threads_are_irrelevant() {
    let options = MapOptions { spacing: 0.12, ..MapOptions::default() };
    let (calls, last) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let progress = |done: usize, all: usize| {
        assert!(done <= all);
        calls.fetch_add(1, Ordering::Relaxed);
        last.fetch_max(done, Ordering::Relaxed);
    };
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| ErgonomicsMap::build(&Person::average(), &options, Some(&progress)))
    };
    let one = build(1).unwrap();
    let two = build(2).unwrap();
    assert!(calls.load(Ordering::Relaxed) >= 2 && last.load(Ordering::Relaxed) > 500);
    assert_eq!(one.to_bytes(), two.to_bytes());
}

#[test]
fn one_map_serves_every_stature_of_equal_proportions() {
    let region = |stature| Some(Region::work_zone(stature, Side::Right));
    let build = |stature| {
        let options =
            MapOptions { spacing: 0.06, region: region(stature), ..MapOptions::default() };
        ErgonomicsMap::build(&Person::new(stature).unwrap(), &options, None).unwrap()
    };
    let (average, tall) = (build(1.75), build(1.94));
    let scaled = average.for_stature(1.94).unwrap();
    assert_eq!(scaled.len(), tall.len());
    let mut worst = 0.0_f64;
    for (a, b) in scaled.nodes().zip(tall.nodes()) {
        assert!((a.position - b.position).norm() < 1e-9);
        worst = worst.max((a.score - b.score).abs());
    }
    println!("scale invariance: scores differ by at most {worst:.1e}");
    assert!(worst <= 1e-6);
    assert!(average.for_stature(-1.0).is_err());
}

#[test]
fn longer_arms_make_another_map() {
    let options = MapOptions { spacing: 0.1, ..MapOptions::default() };
    let long = Segments { upper_arm: Some(0.38), forearm: Some(0.30), ..Segments::default() };
    let person = Person::average().with_segments(&long).unwrap();
    let long = ErgonomicsMap::build(&person, &options, None).unwrap();
    let average = ErgonomicsMap::build(&Person::average(), &options, None).unwrap();
    assert!(long.len() > average.len());
    let far = Vector3::new(0.6, -0.2, 1.1);
    assert!(long.sample(&far).unwrap().score < average.sample(&far).unwrap().score);
}

#[test]
fn bad_options_are_refused() {
    let person = Person::average();
    for spacing in [0.0, -1.0, f64::NAN, 1.0] {
        let options = MapOptions { spacing, ..MapOptions::default() };
        assert!(ErgonomicsMap::build(&person, &options, None).is_err());
    }
    let options = MapOptions { spacing: 0.001, ..MapOptions::default() };
    let error = ErgonomicsMap::build(&person, &options, None).unwrap_err();
    assert!(matches!(error, Error::Value { .. }), "{error}");
    assert!(Region::new(Vector3::zeros(), Vector3::new(1.0, 0.0, 1.0)).is_err());
}

#[test]
fn a_saved_map_comes_back_the_same() {
    let path = std::env::temp_dir().join(format!("ergo-map-{}.map", std::process::id()));
    MAP.save(&path).unwrap();
    let loaded = ErgonomicsMap::load(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert_eq!(loaded.to_bytes(), MAP.to_bytes());
    assert_eq!(loaded.nodes().collect::<Vec<_>>(), MAP.nodes().collect::<Vec<_>>());
    assert!(matches!(ErgonomicsMap::load(&path), Err(Error::Io { .. })));
    assert!(matches!(MAP.save("/nowhere/at/all.map"), Err(Error::Io { .. })));
}

/// Message for a file that is not a map.
const FOREIGN: &str = "it does not start with the mark of a map file";

#[test]
fn foreign_and_damaged_files_are_told_apart() {
    let options = MapOptions { spacing: 0.15, side: Side::Left, ..MapOptions::default() };
    let map = ErgonomicsMap::build(&Person::short(), &options, None).unwrap();
    let bytes = map.to_bytes();
    let problem = |bytes: &[u8]| match ErgonomicsMap::from_bytes(bytes) {
        Err(Error::MapFile { problem }) => problem,
        other => panic!("{other:?}"),
    };
    assert_eq!(problem(b""), FOREIGN);
    assert_eq!(problem(b"\x89PNG\r\n\x1a\n and so on"), FOREIGN);
    let mut newer = bytes.clone();
    newer[8] = 9;
    assert_eq!(problem(&newer), "its format has version 9; this program reads version 2");
    assert!(problem(&bytes[..20]).ends_with("it was cut or extended"));
    assert!(problem(&bytes[..bytes.len() - 1]).ends_with("it was cut or extended"));
    let mut damaged = bytes.clone();
    damaged[200] ^= 1;
    assert!(problem(&damaged).starts_with("its checksum is 0x"));
    assert_eq!(ErgonomicsMap::from_bytes(&bytes).unwrap().to_bytes(), bytes);
}

/// Returns a file with this header and as many unreachable nodes, with its checksum.
fn file_of_nothing(size: [u32; 3]) -> Vec<u8> {
    let options = MapOptions { spacing: 0.2, ..MapOptions::default() };
    let bytes = ErgonomicsMap::build(&Person::average(), &options, None).unwrap().to_bytes();
    let header = 80 + 8 * 41;
    let mut file = bytes[..header].to_vec();
    for (place, count) in size.into_iter().chain([0]).enumerate() {
        let at = header - 16 + 4 * place;
        file[at..at + 4].copy_from_slice(&count.to_le_bytes());
    }
    file.resize(header + size.iter().product::<u32>() as usize, 0);
    let sum = crc(&file);
    [file, sum.to_le_bytes().to_vec()].concat()
}

/// Computes CRC-32 of IEEE 802.3 bit by bit. The reflected polynomial is 0xedb88320.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

#[test]
fn a_map_needs_little_more_than_its_file() {
    for (file, times) in [(file_of_nothing([2, 1000, 1000]), 5), (MAP.to_bytes(), 3)] {
        let length = file.len() as u64;
        let read = || assert!(ErgonomicsMap::from_bytes(&file).is_ok());
        let held = allocation_counter::measure(read).bytes_max;
        assert!(held <= times * length, "{held} bytes for a file of {length}");
    }
    for size in [[2, 1000, 1001], [u32::MAX; 3], [1, 2, 2], [0, 0, 0]] {
        let mut file = file_of_nothing([2, 2, 2]);
        for (place, count) in size.into_iter().enumerate() {
            let at = 80 + 8 * 41 - 16 + 4 * place;
            file[at..at + 4].copy_from_slice(&count.to_le_bytes());
        }
        let problem = "its size makes no sense".to_owned();
        assert_eq!(ErgonomicsMap::from_bytes(&file), Err(Error::MapFile { problem }));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_endless_device_is_not_read_for_ever() {
    let load = || {
        let problem = FOREIGN.to_owned();
        assert_eq!(ErgonomicsMap::load("/dev/zero"), Err(Error::MapFile { problem }));
    };
    assert!(allocation_counter::measure(load).bytes_max < 1 << 16);
    // Neither is a file read that continues after the map.
    let path = std::env::temp_dir().join(format!("ergo-map-long-{}.map", std::process::id()));
    let bytes = file_of_nothing([2, 2, 2]);
    std::fs::write(&path, [&bytes[..], &vec![0; 8 << 20]].concat()).unwrap();
    let load = || {
        let (expected, found) = (bytes.len(), bytes.len() + 1);
        let problem =
            format!("it has {found} bytes where {expected} are announced: it was cut or extended");
        assert_eq!(ErgonomicsMap::load(&path), Err(Error::MapFile { problem }));
    };
    assert!(allocation_counter::measure(load).bytes_max < 1 << 16);
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn a_map_file_names_its_person() {
    let lengths = Segments { upper_arm: Some(0.36), foot: Some(0.25), ..Segments::default() };
    let mut ranges = ergo_map::JointRanges::default();
    ranges.max.elbow = 1.7;
    let person = Person::new(1.83).unwrap().with_segments(&lengths).unwrap();
    let person = person.with_mass(91.5).unwrap().with_ranges(ranges).unwrap();
    let options = MapOptions { spacing: 0.15, ..MapOptions::default() };
    let map = ErgonomicsMap::build(&person, &options, None).unwrap();
    let read = ErgonomicsMap::from_bytes(&map.to_bytes()).unwrap();
    assert_eq!((read.person(), &read), (&person, &map));
    // Another stature keeps the proportions.
    let tall = read.for_stature(2.0).unwrap();
    let arm = tall.person().segments().upper_arm.unwrap();
    assert!((arm - 0.36 * 2.0 / 1.83).abs() < 1e-12 && tall.stature() == 2.0);
}

/// Version 1 contains only the stature.
#[test]
fn a_version_1_file_has_average_proportions() {
    let options = MapOptions { spacing: 0.15, ..MapOptions::default() };
    let map = ErgonomicsMap::build(&Person::tall(), &options, None).unwrap();
    let bytes = map.to_bytes();
    let mut old = [&bytes[..8], &1_u32.to_le_bytes(), &bytes[12..32]].concat();
    old.extend(&bytes[32 + 8 * 41..bytes.len() - 4]);
    old.extend(crc(&old).to_le_bytes());
    assert_eq!(ErgonomicsMap::from_bytes(&old), Ok(map));
}

#[test]
fn an_impossible_person_in_a_file_is_refused() {
    let good = file_of_nothing([2, 2, 2]);
    for (place, value, named) in [
        (0, 0.3, "stature"),
        (1, f64::NAN, "mass"),
        (2, 0.5, "segments"),
        (7, -1.0, "segments"),
        (12, 0.5, "ranges of motion"),
        (30, f64::INFINITY, "ranges of motion"),
    ] {
        let mut file = good.clone();
        file.truncate(good.len() - 4);
        file[24 + 8 * place..32 + 8 * place].copy_from_slice(&f64::to_le_bytes(value));
        file.extend(crc(&file).to_le_bytes());
        let problem = format!("its {named} makes no sense");
        assert_eq!(ErgonomicsMap::from_bytes(&file), Err(Error::MapFile { problem }), "{place}");
    }
}

proptest! {
    #[test]
    fn no_damage_goes_unseen_and_none_panics(
        place in any::<proptest::sample::Index>(),
        flip in 1..=255_u8,
        cut in any::<proptest::sample::Index>(),
    ) {
        static BYTES: LazyLock<Vec<u8>> = LazyLock::new(|| {
            let options = MapOptions { spacing: 0.2, ..MapOptions::default() };
            ErgonomicsMap::build(&Person::tall(), &options, None).unwrap().to_bytes()
        });
        let mut damaged = BYTES.clone();
        damaged[place.index(BYTES.len())] ^= flip;
        prop_assert!(ErgonomicsMap::from_bytes(&damaged).is_err());
        prop_assert!(ErgonomicsMap::from_bytes(&BYTES[..cut.index(BYTES.len())]).is_err());
    }

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let mut marked = b"ERGOMAP\0\x01\0\0\0".to_vec();
        marked.extend(&bytes);
        prop_assert!(ErgonomicsMap::from_bytes(&bytes).is_err());
        prop_assert!(ErgonomicsMap::from_bytes(&marked).is_err());
    }

    #[test]
    fn the_gradient_is_the_derivative(hand in anywhere()) {
        let Ok(sample) = MAP.sample(&hand) else { return Ok(()) };
        prop_assert!((0.0..=4.25).contains(&sample.score));
        let step = 1e-6;
        for axis in 0..3 {
            let mut way = Vector3::zeros();
            way[axis] = step;
            let (Ok(low), Ok(high)) = (MAP.sample(&(hand - way)), MAP.sample(&(hand + way)))
            else { continue };
            let (left, right) =
                ((sample.score - low.score) / step, (high.score - sample.score) / step);
            // The two sides differ at a cell's face.
            let between = (left.min(right) - 1e-5)..=(left.max(right) + 1e-5);
            prop_assert!(between.contains(&sample.gradient[axis]));
        }
    }

    #[test]
    fn the_score_is_continuous_within_the_domain(
        hand in anywhere(),
        way in proptest::array::uniform3(-1e-6..1e-6_f64),
    ) {
        let (Ok(a), Ok(b)) = (MAP.sample(&hand), MAP.sample(&(hand + Vector3::from(way))))
        else { return Ok(()) };
        prop_assert!((a.score - b.score).abs() < 1e-3);
    }
}
