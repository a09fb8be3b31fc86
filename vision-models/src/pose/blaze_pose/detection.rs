//! Converts the detector's numbers to people: anchors, boxes, and their merging.

use nalgebra::Point2;
use ndarray::ArrayView2;

use super::region::PoseRegion;

/// Rows and columns of the detector's input.
pub(super) const INPUT: usize = 224;
/// Pixels from one anchor to the next, and the number of anchors at each position.
const ANCHORS: [(usize, usize); 3] = [(8, 2), (16, 2), (32, 6)];
/// Number of anchors.
pub(super) const COUNT: usize = 2254;
/// A box's centre and size, then four points.
pub(super) const NUMBERS: usize = 12;
/// Boxes that share this part of their area belong to one person.
const OVERLAP: f64 = 0.3;

/// A person, in fractions of the detector's input.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Detection {
    score: f64,
    /// Left, top, right, bottom.
    sides: [f64; 4],
    /// The middle of the hips, and a point on the circle around the person.
    points: [Point2<f64>; 2],
}

/// Returns the centre of every anchor, in order.
fn anchors() -> impl Iterator<Item = Point2<f64>> {
    ANCHORS.into_iter().flat_map(|(step, count)| {
        let side = INPUT / step;
        (0..side * side * count).map(move |index| {
            let (row, column) = (index / count / side, index / count % side);
            Point2::new(column as f64 + 0.5, row as f64 + 0.5) / side as f64
        })
    })
}

/// Returns the regions of the people whose score is at least `least`, in falling order of score, in
/// fractions of the detector's input.
pub(super) fn decode(
    boxes: ArrayView2<'_, f32>,
    scores: ArrayView2<'_, f32>,
    least: f64,
) -> Vec<PoseRegion> {
    let mut found = Vec::new();
    for ((anchor, numbers), logit) in anchors().zip(boxes.rows()).zip(scores) {
        let score = 1.0 / (1.0 + f64::from(-logit.clamp(-100.0, 100.0)).exp());
        if score < least {
            continue;
        }
        let number = |index: usize| f64::from(numbers[index]) / INPUT as f64;
        let point =
            |index: usize| Point2::new(anchor.x + number(index), anchor.y + number(index + 1));
        let (centre, half) = (point(0), [0.5 * number(2), 0.5 * number(3)]);
        let sides =
            [centre.x - half[0], centre.y - half[1], centre.x + half[0], centre.y + half[1]];
        found.push(Detection { score, sides, points: [point(4), point(6)] });
    }
    merged(found).iter().map(|person| PoseRegion::around(&person.points)).collect()
}

/// Merges detections that overlap much with the best of them into their mean, weighted by the
/// scores.
fn merged(mut found: Vec<Detection>) -> Vec<Detection> {
    found.sort_by(|one, other| other.score.total_cmp(&one.score));
    let mut people = Vec::new();
    while let Some(&surest) = found.first() {
        let (same, others): (Vec<_>, Vec<_>) =
            found.into_iter().partition(|other| overlap(&surest, other) > OVERLAP);
        let mut person = surest;
        let total: f64 = same.iter().map(|one| one.score).sum();
        if total > 0.0 {
            person.points = [0, 1].map(|point| {
                let sum = same.iter().map(|one| one.points[point].coords * one.score);
                Point2::from(sum.sum::<nalgebra::Vector2<f64>>() / total)
            });
        }
        people.push(person);
        // A box without an area overlaps no box, not even itself.
        found = others.into_iter().filter(|other| *other != surest).collect();
    }
    people
}

/// Returns the share of their joint area that two boxes have in common.
fn overlap(one: &Detection, other: &Detection) -> f64 {
    let area =
        |[left, top, right, bottom]: [f64; 4]| (right - left).max(0.0) * (bottom - top).max(0.0);
    let ([a, b, c, d], [e, f, g, h]) = (one.sides, other.sides);
    let shared = area([a.max(e), b.max(f), c.min(g), d.min(h)]);
    let all = area(one.sides) + area(other.sides) - shared;
    if all > 0.0 { shared / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;

    #[test]
    fn the_number_of_anchors_is_the_detectors() {
        let anchors: Vec<_> = anchors().collect();
        assert_eq!(anchors.len(), COUNT);
        assert_eq!(anchors[1], Point2::new(0.5, 0.5) / 28.0);
        assert_eq!(anchors[2], Point2::new(1.5, 0.5) / 28.0);
        assert_eq!(anchors[COUNT - 1], Point2::new(6.5, 6.5) / 7.0);
    }

    /// Tests two boxes of one person and one of another.
    #[test]
    fn what_overlaps_is_one_person() {
        let mut boxes = Array2::zeros((COUNT, NUMBERS));
        let mut scores = Array2::from_elem((COUNT, 1), -9.0);
        // The middle of the hips is at the anchor, and the point on the circle is above it.
        for (anchor, logit, up) in [(0, 3.0, -40.0), (1, 3.0, -50.0), (COUNT - 1, 1.0, -60.0)] {
            boxes[[anchor, 2]] = 30.0;
            boxes[[anchor, 3]] = 30.0;
            boxes[[anchor, 7]] = up;
            scores[[anchor, 0]] = logit;
        }
        let people = decode(boxes.view(), scores.view(), 0.5);
        assert_eq!(people.len(), 2);
        let side = 2.5 * 45.0 / 224.0;
        assert!((people[0].side - side).abs() < 1e-9 && people[0].angle.abs() < 1e-9);
        assert!((people[0].centre - Point2::new(0.5, 0.5) / 28.0).norm() < 1e-9);
        assert!((people[1].centre - Point2::new(6.5, 6.5) / 7.0).norm() < 1e-9);
        assert!(decode(boxes.view(), scores.view(), 0.99).is_empty());
    }
}
