//! Reports and pictures of maps.

use ergo_map::{ErgonomicsMap, MapOptions, Person, Region, Side};
use ergo_report::Error;
use ergo_report::maps::{ACCEPTABLE, Assessment, MapStudy, manikin, slices};
use nalgebra::Vector3;
use proptest::prelude::*;

fn coarse_map() -> ErgonomicsMap {
    let options = MapOptions { spacing: 0.1, ..MapOptions::default() };
    ErgonomicsMap::build(&Person::average(), &options, None).unwrap()
}

/// Returns a picture's width and height.
fn size(svg: &str) -> (f64, f64) {
    let number = |name: &str| {
        let (_, rest) = svg.split_once(&format!(" {name}=\"")).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    (number("width"), number("height"))
}

/// Returns all pairs of coordinates of lines and areas.
fn points(svg: &str) -> Vec<(f64, f64)> {
    let lists = svg.split(" points=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    let pairs = lists.flat_map(str::split_whitespace).map(|pair| pair.split_once(',').unwrap());
    pairs.map(|(x, y)| (x.parse().unwrap(), y.parse().unwrap())).collect()
}

fn assert_is_picture(svg: &str, texts: &[&str]) {
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let (width, height) = size(svg);
    let points = points(svg);
    assert!(points.len() > 200);
    for (x, y) in points {
        assert!((0.0..=width).contains(&x) && (0.0..=height).contains(&y), "{x}, {y}");
    }
    for text in texts {
        assert!(svg.contains(text), "no {text:?}");
    }
}

#[test]
fn studies_refuse_invalid_input() {
    let map = coarse_map();
    for threshold in [0.0, -1.0, 5.0, f64::NAN, f64::INFINITY] {
        let study = MapStudy::new(map.clone(), Person::average(), threshold);
        assert!(matches!(study, Err(Error::Value { .. })));
    }
    let outside = Assessment::new(&map, &Person::average(), &Vector3::new(9.0, 0.0, 1.0));
    assert!(matches!(outside, Err(Error::OutsideMap { .. })));
}

#[test]
fn the_books_statements_on_the_work_zone_hold() {
    for side in [Side::Left, Side::Right] {
        let person = Person::average();
        let zone = Region::work_zone(person.stature(), side);
        let options = MapOptions { side, region: Some(zone), ..MapOptions::default() };
        let map = ErgonomicsMap::build(&person, &options, None).unwrap();
        for index in 0..1000_u32 {
            let share = [index / 100, index / 10 % 10, index % 10].map(|k| f64::from(k) / 9.0);
            let hand = zone.min() + zone.size().component_mul(&Vector3::from(share));
            if let Ok(assessment) = Assessment::new(&map, &person, &hand) {
                assert!((assessment.landmarks.hand - hand).norm() < 0.02, "{hand}");
            }
        }
        let study = MapStudy::new(map, person, ACCEPTABLE).unwrap();
        assert!(study.acceptable.highest_reba.is_some_and(|reba| reba <= 3));
    }
}

#[test]
fn the_acceptable_region_grows_with_its_threshold() {
    let map = coarse_map();
    let shares = [0.05, 0.5, 1.0, 4.25].map(|threshold| {
        MapStudy::new(map.clone(), Person::average(), threshold).unwrap().acceptable.share
    });
    assert!(shares.is_sorted() && shares[0] < shares[2] && shares[3] == 1.0, "{shares:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// The pictures of every person have all their content within their frame, wherever the hand
    /// is.
    #[test]
    fn everyone_can_be_drawn(stature in 1.2..2.2_f64, left in any::<bool>(), at in any::<prop::sample::Index>()) {
        let side = if left { Side::Left } else { Side::Right };
        let person = Person::new(stature).unwrap();
        let options = MapOptions { spacing: 0.16, side, ..MapOptions::default() };
        let map = ErgonomicsMap::build(&person, &options, None).unwrap();
        let nodes: Vec<_> = map.nodes().filter(|node| map.contains(&node.position)).collect();
        let hand = nodes[at.index(nodes.len())].position;
        let drawn = manikin(&Assessment::new(&map, &person, &hand).unwrap(), &person, side).unwrap();
        assert_is_picture(&drawn, &[if left { "from the left" } else { "from the right" }]);
        if let Ok(study) = MapStudy::new(map, person, ACCEPTABLE) {
            assert_is_picture(&slices(&study).unwrap(), &["sagittal slice"]);
        }
    }
}
