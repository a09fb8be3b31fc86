//! Grouping on maps that are drawn from known people.

use ndarray::Array3;
use proptest::prelude::*;
use vision_models::{Coco18, Error, GroupingSettings, group_parts};

const ROWS: usize = 46;
const COLUMNS: usize = 82;
/// Standard deviation of a joint's maximum (cells): OpenPose's seven pixels.
const DEVIATION: f64 = 7.0 / 8.0;
/// Smallest distance between the same joints of two people. If they are closer, their maxima merge.
const APART: f64 = 3.0;

/// The joints of the limbs, and the first of their two fields, as in OpenPose's `poseParameters`
/// for COCO.
const LIMBS: [(usize, usize, usize); 19] = [
    (1, 8, 0),
    (8, 9, 2),
    (9, 10, 4),
    (1, 11, 6),
    (11, 12, 8),
    (12, 13, 10),
    (1, 2, 12),
    (2, 3, 14),
    (3, 4, 16),
    (2, 16, 18),
    (1, 5, 20),
    (5, 6, 22),
    (6, 7, 24),
    (5, 17, 26),
    (1, 0, 28),
    (0, 14, 30),
    (0, 15, 32),
    (14, 16, 34),
    (15, 17, 36),
];

/// A standing person, relative to the neck, in units of the body's height.
const STANDING: [[f64; 2]; 18] = [
    [0.0, -0.10],
    [0.0, 0.0],
    [-0.11, 0.01],
    [-0.16, 0.17],
    [-0.18, 0.32],
    [0.11, 0.01],
    [0.16, 0.17],
    [0.18, 0.32],
    [-0.07, 0.33],
    [-0.08, 0.56],
    [-0.08, 0.80],
    [0.07, 0.33],
    [0.08, 0.56],
    [0.08, 0.80],
    [-0.03, -0.13],
    [0.03, -0.13],
    [-0.07, -0.11],
    [0.07, -0.11],
];

/// The joints of a person, `None` if hidden.
type Person = [Option<[f64; 2]>; 18];

prop_compose! {
    fn person()(
        at in [4.0..78.0, 8.0..16.0],
        size in 26.0..34.0,
        moved in prop::collection::vec([-0.03..0.03, -0.03..0.03], 18),
        hidden in prop::collection::vec(prop::bool::weighted(0.15), 18),
        arms in [-1.2..1.2, -1.2..1.2],
    ) -> Person {
        std::array::from_fn(|joint| {
            let mut offset = STANDING[joint];
            // Forearms and upper arms rotate around the shoulder.
            let arm = match joint { 3 | 4 => Some((2, arms[0])), 6 | 7 => Some((5, arms[1])), _ => None };
            if let Some((shoulder, angle)) = arm {
                let (sine, cosine) = f64::sin_cos(angle);
                let [x, y] = [offset[0] - STANDING[shoulder][0], offset[1] - STANDING[shoulder][1]];
                offset = [
                    STANDING[shoulder][0] + cosine * x - sine * y,
                    STANDING[shoulder][1] + sine * x + cosine * y,
                ];
            }
            let place = [0, 1].map(|axis| at[axis] + size * (offset[axis] + moved[joint][axis]));
            let inside = (1.0..COLUMNS as f64 - 2.0).contains(&place[0])
                && (1.0..ROWS as f64 - 2.0).contains(&place[1]);
            (!hidden[joint] && inside).then_some(place)
        })
    }
}

fn distance(one: [f64; 2], other: [f64; 2]) -> f64 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

/// Returns true if the line between two people's joints runs along limbs of its kind for its whole
/// length. If one person's trunk covers another's, the fields do not tell which person has a hip.
fn has_mixed_limb(people: &[Person]) -> bool {
    LIMBS.iter().any(|&(from, to, _)| {
        let limbs: Vec<_> =
            people.iter().filter_map(|person| Some((person[from]?, person[to]?))).collect();
        let on_a_limb = |at: [f64; 2]| {
            limbs.iter().any(|&(from, to)| {
                let line = [to[0] - from[0], to[1] - from[1]];
                let square = line[0] * line[0] + line[1] * line[1];
                let along = ((at[0] - from[0]) * line[0] + (at[1] - from[1]) * line[1]) / square;
                let along = along.clamp(0.0, 1.0);
                distance(at, [from[0] + along * line[0], from[1] + along * line[1]]) <= 1.5
            })
        };
        let pairs = people.iter().enumerate().flat_map(|(one, person)| {
            people
                .iter()
                .enumerate()
                .filter(move |&(other, _)| other != one)
                .map(move |pair| (person, pair.1))
        });
        pairs.filter_map(|(one, other)| Some((one[from]?, other[to]?))).any(|(from, to)| {
            (0..10).map(|sample| f64::from(sample) / 9.0).all(|part| {
                on_a_limb([0, 1].map(|axis| from[axis] + part * (to[axis] - from[axis])))
            })
        })
    })
}

/// Leaves out people who cannot be distinguished from others. Their joint is too close to the same
/// joint of another person, or a limb could belong to another person. Also leaves out people with
/// two joints closer than half a cell, whose limb has no direction.
fn tell_apart(people: Vec<Person>) -> Vec<Person> {
    let mut apart: Vec<Person> = Vec::new();
    for person in people {
        let clear = apart.iter().all(|other| {
            person.iter().zip(other).all(|(one, other)| match (one, other) {
                (Some(one), Some(other)) => distance(*one, *other) >= APART,
                _ => true,
            })
        });
        let long = LIMBS.iter().all(|&(from, to, _)| match (person[from], person[to]) {
            (Some(from), Some(to)) => distance(from, to) > 0.5,
            _ => true,
        });
        let with_others: Vec<Person> = apart.iter().copied().chain([person]).collect();
        if clear && long && !has_mixed_limb(&with_others) {
            apart.push(person);
        }
    }
    apart
}

/// Draws the maps of a perfect network (Sec. 2.2 and 2.3 of the paper): the largest Gaussian of
/// each joint, and the mean of the limbs' directions within a cell of their lines.
#[allow(clippy::cast_possible_truncation)]
fn draw(people: &[Person]) -> (Array3<f32>, Array3<f32>) {
    let mut joints = Array3::zeros((19, ROWS, COLUMNS));
    let mut limbs = Array3::zeros((38, ROWS, COLUMNS));
    for ((joint, row, column), value) in joints.indexed_iter_mut() {
        for place in people.iter().filter_map(|person| *person.get(joint)?) {
            let square = distance(place, [column as f64, row as f64]).powi(2);
            let height = (-square / (2.0 * DEVIATION * DEVIATION)).exp() as f32;
            *value = f32::max(*value, height);
        }
    }
    for (from, to, map) in LIMBS {
        for row in 0..ROWS {
            for column in 0..COLUMNS {
                let (mut sum, mut count) = ([0.0, 0.0], 0.0);
                for (from, to) in
                    people.iter().filter_map(|person| Some((person[from]?, person[to]?)))
                {
                    let length = distance(from, to);
                    let unit = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
                    let at = [column as f64 - from[0], row as f64 - from[1]];
                    let along = at[0] * unit[0] + at[1] * unit[1];
                    let across = at[0] * unit[1] - at[1] * unit[0];
                    if (-1.0..=length + 1.0).contains(&along) && across.abs() <= 1.0 {
                        sum = [sum[0] + unit[0], sum[1] + unit[1]];
                        count += 1.0;
                    }
                }
                for axis in 0..2 {
                    limbs[[map + axis, row, column]] = (sum[axis] / f64::max(count, 1.0)) as f32;
                }
            }
        }
    }
    (joints, limbs)
}

/// Returns the parts of people that are connected by visible limbs, if they have at least four
/// joints. Only these can be found.
fn visible_parts(people: &[Person]) -> Vec<Person> {
    let mut parts = Vec::new();
    for person in people {
        let mut part_of: [usize; 18] = std::array::from_fn(|joint| joint);
        for _ in 0..18 {
            for (from, to, _) in LIMBS {
                if person[from].is_some() && person[to].is_some() {
                    let least = part_of[from].min(part_of[to]);
                    (part_of[from], part_of[to]) = (least, least);
                }
            }
        }
        for first in 0..18 {
            let part: Person =
                std::array::from_fn(|joint| person[joint].filter(|_| part_of[joint] == first));
            if part.iter().flatten().count() >= 4 {
                parts.push(part);
            }
        }
    }
    parts
}

/// Returns true if a found person has exactly the joints of a part, within half a cell.
fn is(found: &Coco18, part: &Person) -> bool {
    found.iter().zip(part).all(|(found, place)| match (found, place) {
        (Some(found), Some(place)) => distance([found.position.x, found.position.y], *place) < 0.5,
        (None, None) => true,
        _ => false,
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn people_are_assembled_from_their_own_joints(people in prop::collection::vec(person(), 1..=6)) {
        let people = tell_apart(people);
        let (joints, limbs) = draw(&people);
        let found = group_parts(joints.view(), limbs.view(), &GroupingSettings::default())?;
        let parts = visible_parts(&people);
        for part in &parts {
            prop_assert!(
                found.iter().any(|person| is(person, part)),
                "{part:?} is none of {found:?}"
            );
        }
        prop_assert_eq!(found.len(), parts.len());
    }
}

#[test]
fn maps_of_other_shapes_are_refused() {
    let group = |joints: (usize, usize, usize), limbs: (usize, usize, usize)| {
        let (joints, limbs) = (Array3::zeros(joints), Array3::zeros(limbs));
        group_parts(joints.view(), limbs.view(), &GroupingSettings::default())
    };
    assert_eq!(group((18, 5, 6), (38, 5, 6)), Ok(Vec::new()));
    for (joints, limbs) in [
        ((17, 5, 6), (38, 5, 6)),
        ((20, 5, 6), (38, 5, 6)),
        ((19, 5, 6), (37, 5, 6)),
        ((19, 5, 6), (38, 5, 7)),
        ((19, 0, 6), (38, 0, 6)),
    ] {
        assert!(matches!(group(joints, limbs), Err(Error::Size { .. })));
    }
    let mut joints = Array3::zeros((19, 5, 6));
    joints[[3, 1, 2]] = f32::NAN;
    let limbs = Array3::zeros((38, 5, 6));
    let error = group_parts(joints.view(), limbs.view(), &GroupingSettings::default()).unwrap_err();
    assert_eq!(error.to_string(), "map 3, row 1, column 2 is NaN: give finite numbers");
}

#[test]
fn noise_everywhere_ends_soon() {
    let noise = |index: usize| (index.wrapping_mul(2_654_435_761) % 1000) as f32 / 1000.0;
    let maps = |count: usize| {
        let values = (0..count * ROWS * COLUMNS).map(noise).collect();
        Array3::from_shape_vec((count, ROWS, COLUMNS), values).unwrap()
    };
    let people =
        group_parts(maps(19).view(), maps(38).view(), &GroupingSettings::default()).unwrap();
    assert!(people.len() <= 18 * 64);
}
