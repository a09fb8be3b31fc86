//! Maps from recordings.

use crate::support::{MAP, Random};
use ergo_map::{
    ErgonomicsMap, Error, FitOptions, HandTarget, JointAngles, MeasuredOptions, MeasuredSample,
    Person, PosturePredictor, Region, Side, read_samples,
};
use nalgebra::Vector3;
use proptest::prelude::*;

/// Returns a motion-capture recording of a person who moves as predicted, with noise.
fn recording(count: usize, noise: f64, seed: u64) -> Vec<MeasuredSample> {
    let predictor = PosturePredictor::new(&Person::average(), Side::Right);
    let zone = Region::work_zone(1.75, Side::Right);
    let mut random = Random(seed);
    let mut samples = Vec::new();
    while samples.len() < count {
        let t = Vector3::from_fn(|_, _| random.uniform(0.0, 1.0));
        let hand = zone.min() + zone.size().component_mul(&t);
        if let Ok(prediction) = predictor.predict(&HandTarget::point(hand)) {
            let angles = prediction.angles.to_array().map(|q| q + random.uniform(-noise, noise));
            samples.push(MeasuredSample { hand, angles: JointAngles::from_array(angles) });
        }
    }
    samples
}

#[test]
fn a_recorded_map_agrees_with_its_person() {
    let map =
        ErgonomicsMap::from_samples(1.75, &recording(3000, 0.05, 1), &MeasuredOptions::default())
            .unwrap();
    let validation = map.validate(&recording(500, 0.0, 2)).unwrap();
    println!("{validation:?}");
    assert!(validation.samples > 400 && validation.samples + validation.outside == 500);
    assert!(validation.score_rmse < 0.05 && validation.score_bias.abs() < 0.03);
    assert!(validation.spearman > 0.98);
    assert!(validation.joint_rmse.elbow < 0.1);

    let (measured, report) = map.fit(&FitOptions::default()).unwrap();
    assert!(report.r_squared > 0.85);
    let (predicted, _) = MAP.fit(&FitOptions::default()).unwrap();
    let apart = measured.minimiser().unwrap() - predicted.minimiser().unwrap();
    assert!(apart.norm() < 0.05, "{apart}");
}

#[test]
fn the_map_has_no_answer_without_recordings() {
    let samples: Vec<_> = recording(2000, 0.0, 3).into_iter().filter(|s| s.hand.z < 1.1).collect();
    let map = ErgonomicsMap::from_samples(1.75, &samples, &MeasuredOptions::default()).unwrap();
    assert!(map.contains(&Vector3::new(0.45, -0.2, 0.95)));
    assert!(!map.contains(&Vector3::new(0.45, -0.2, 1.5)));
}

#[test]
fn too_little_or_broken_data_is_refused() {
    let options = MeasuredOptions::default();
    let few = recording(4, 0.0, 4);
    let error = ErgonomicsMap::from_samples(1.75, &few, &options).unwrap_err();
    assert!(matches!(error, Error::TooFewSamples { got: 4, .. }), "{error}");
    let far_apart: Vec<_> = (0..20)
        .map(|i| MeasuredSample {
            hand: Vector3::new(f64::from(i), 0.0, 1.0),
            angles: JointAngles::default(),
        })
        .collect();
    assert!(ErgonomicsMap::from_samples(1.75, &far_apart, &options).is_err());
    let mut broken = recording(30, 0.0, 5);
    broken[3].angles.hip = f64::NAN;
    assert!(matches!(
        ErgonomicsMap::from_samples(1.75, &broken, &options),
        Err(Error::Value { what: "hip", .. })
    ));
    assert!(ErgonomicsMap::from_samples(f64::NAN, &few, &options).is_err());
    let options = MeasuredOptions { radius: -1.0, ..options };
    assert!(ErgonomicsMap::from_samples(1.75, &few, &options).is_err());
}

#[test]
fn a_table_is_read_in_any_order() {
    let table = "\u{feff}elbow_deg, hand_z_m,hand_x_m ,hand_y_m,lumbar_flexion_deg\r\n\
                 90,1.1,0.4,-0.2,5\r\n\r\n45,1.2,0.5,-0.1,-3.5\r\n";
    let samples = read_samples(table.as_bytes()).unwrap();
    assert_eq!(samples.len(), 2);
    assert_eq!(samples[1].hand, Vector3::new(0.5, -0.1, 1.2));
    assert_eq!(samples[1].angles.elbow, 45_f64.to_radians());
    assert_eq!(samples[1].angles.lumbar_flexion, (-3.5_f64).to_radians());
    assert_eq!(samples[1].angles.hip, 0.0);
}

#[test]
fn a_bad_table_names_line_and_column() {
    let at = |table: &str| match read_samples(table.as_bytes()) {
        Err(Error::Samples { line, column, problem }) => {
            println!("line {line}, column {column:?}: {problem}");
            (line, column)
        }
        other => panic!("{other:?}"),
    };
    let header = "hand_x_m,hand_y_m,hand_z_m,elbow_deg\n";
    let with = |rows: &str| at(&format!("{header}{rows}"));
    assert_eq!(with("1,2,3,4\n1,2,oops,4\n"), (3, "hand_z_m".into()));
    assert_eq!(with("1,2,3\n"), (2, "elbow_deg".into()));
    assert_eq!(with("1,2,3,NaN\n"), (2, "elbow_deg".into()));
    assert_eq!(with("1,2,3,inf\n"), (2, "elbow_deg".into()));
    assert_eq!(with("1,2,3,4,5\n"), (2, String::new()));
    assert_eq!(at("hand_x_m,hand_y_m,elbow_deg\n"), (1, "hand_z_m".into()));
    assert_eq!(at("hand_x_m,hand_y_m,hand_z_m,elbow\n"), (1, "elbow".into()));
    assert_eq!(at("hand_x_m,hand_y_m,hand_z_m,hand_z_m,hip_deg\n"), (1, "hand_z_m".into()));
    assert_eq!(at("hand_x_m,hand_y_m,hand_z_m\n1,2,3\n"), (1, String::new()));
    assert!(matches!(read_samples(&b""[..]), Err(Error::TooFewSamples { .. })));
    assert!(matches!(read_samples(header.as_bytes()), Err(Error::TooFewSamples { .. })));
    assert!(read_samples(&b"\xff\xfe\x00"[..]).is_err());
}

#[test]
fn lines_are_counted_as_an_editor_counts_them() {
    let at = |table: &str| match read_samples(table.as_bytes()) {
        Err(Error::Samples { line, .. }) => line,
        other => panic!("{other:?}"),
    };
    for end in ["\n", "\r\n"] {
        let table = |lines: &[&str]| lines.join(end);
        let header = "hand_x_m,hand_y_m,hand_z_m,elbow_deg";
        assert_eq!(at(&table(&[header, "1,2,3,4", "1,2,3,x"])), 3);
        assert_eq!(at(&table(&["", "  ", header, "", "1,2,3,4", " ", "", "1,2,3,x", ""])), 8);
        assert_eq!(at(&table(&["", "hand_x_m"])), 2);
        assert_eq!(at(&table(&[header, "\"1\",2,3,4", "1,2,3,x"])), 3);
        let quoted = table(&["\"hand_x_m\",hand_y_m,hand_z_m,elbow_deg", "\"1\",2,3, 4 "]);
        assert_eq!(read_samples(quoted.as_bytes()).unwrap()[0].hand.x, 1.0);
    }
}

/// Reads an endless table, an endless line, and too many samples.
#[test]
fn tables_are_read_within_bounds() {
    let held = |table: &mut dyn std::io::BufRead| {
        let read = || assert!(matches!(read_samples(table), Err(Error::Samples { .. })));
        allocation_counter::measure(read).bytes_max
    };
    assert!(held(&mut std::io::BufReader::new(std::io::repeat(b'\n'))) < 300 << 20);
    assert!(held(&mut ",".repeat(16 << 20).as_bytes()) < 100 << 20);
    let short = "hand_x_m,hand_y_m,hand_z_m,hip_deg\n".to_owned() + &"0,0,0,0\n".repeat(1_000_001);
    assert!(held(&mut short.as_bytes()) < 500 << 20);
    let cell = format!("hand_x_m,hand_y_m,hand_z_m,hip_deg\n{}", "9".repeat(60_000));
    assert!(read_samples(cell.as_bytes()).unwrap_err().to_string().len() < 300);
}

const TABLE: &str = "hand_x_m,hand_y_m,hand_z_m,elbow_deg\n0.4,-0.2,1.1,80\n0.5,-0.1,1.2,45\n";

proptest! {
    #[test]
    fn a_damaged_table_is_read_or_refused(
        at in 0..TABLE.len(), cut in 0..20_usize, put in "[a-z_0-9,.\\-\n ]{0,8}",
    ) {
        let end = (at + cut).min(TABLE.len());
        let text = format!("{}{put}{}", &TABLE[..at], &TABLE[end..]);
        match read_samples(text.as_bytes()) {
            Ok(samples) => {
                prop_assert!(!samples.is_empty());
                for sample in samples {
                    prop_assert!(sample.hand.iter().all(|value| value.is_finite()));
                    prop_assert!(sample.angles.to_array().iter().all(|angle| angle.is_finite()));
                }
            }
            Err(Error::Samples { line, problem, .. }) => {
                prop_assert!((1..=text.lines().count()).contains(&line), "line {line}");
                prop_assert!(!problem.is_empty());
            }
            Err(error) => prop_assert!(matches!(error, Error::TooFewSamples { .. }), "{error}"),
        }
    }

    #[test]
    fn text_that_is_no_table_is_refused(text in "[a-z_0-9,.\\-\n ]{0,200}") {
        prop_assert!(read_samples(text.as_bytes()).is_err());
    }
}
