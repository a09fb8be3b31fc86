//! The body as parts with outlines. The thicknesses are chosen for a clear picture, and do not
//! affect any score.

use ergo_map::{JointAngles, Person, Side, Skeleton};
use nalgebra::Vector3;

use super::contour::{Field, Ring, area};
use super::paint::View;

/// A part of the body, with or without a sub-score.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Neck,
    Trunk,
    Legs,
    UpperArm,
    LowerArm,
    Wrist,
    OtherArm,
}

/// A convex piece of the body: the hull of several balls.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) part: Part,
    /// Centres \[m\] and radii \[m\].
    balls: Vec<(Vector3<f64>, f64)>,
}

/// Returns the pieces of a body in a posture.
pub(super) fn pieces(
    person: &Person,
    side: Side,
    angles: &JointAngles,
) -> Result<Vec<Piece>, ergo_map::Error> {
    let stature = person.stature();
    let skeleton = Skeleton::new(person, side);
    let at = skeleton.landmarks(angles)?;
    let segments = person.segments();
    let length = |measured: Option<f64>| measured.unwrap_or_default();
    let piece = |part, balls: &[(Vector3<f64>, f64)]| Piece {
        part,
        balls: balls.iter().map(|(centre, radius)| (*centre, radius * stature)).collect(),
    };
    let mut pieces = Vec::new();

    let foot = length(segments.foot);
    for y in [-0.055 * stature, 0.055 * stature] {
        let beside = Vector3::new(0.0, y, 0.0);
        let [hip, knee, ankle] = [at.hip, at.knee, at.ankle].map(|joint| joint + beside);
        let sole = Vector3::new(ankle.x, y, 0.017 * stature);
        let (heel, toe) = (sole - Vector3::x() * 0.15 * foot, sole + Vector3::x() * 0.65 * foot);
        pieces.push(piece(Part::Legs, &[(heel, 0.017), (toe, 0.015), (ankle, 0.024)]));
        pieces.push(piece(Part::Legs, &[(knee, 0.032), (ankle, 0.023)]));
        pieces.push(piece(Part::Legs, &[(hip, 0.048), (knee, 0.034)]));
    }

    let left = (at.shoulder - at.other_shoulder).normalize() * side.sign();
    let aside = |centre: Vector3<f64>, by: f64| [centre - left * by, centre + left * by];
    let hips = [-0.045, 0.045].map(|y| at.hip + Vector3::new(0.0, y * stature, 0.0));
    let [waist_right, waist_left] = aside(at.lumbar, 0.035 * stature);
    let pelvis = [hips[0], hips[1], waist_right, waist_left].map(|ball| (ball, 0.055));
    pieces.push(piece(Part::Trunk, &pelvis));
    let chest = at.lumbar + (at.neck - at.lumbar) * 0.55;
    let [chest_right, chest_left] = aside(chest, 0.035 * stature);
    pieces.push(piece(
        Part::Trunk,
        &[
            (waist_right, 0.052),
            (waist_left, 0.052),
            (chest_right, 0.062),
            (chest_left, 0.062),
            (at.shoulder, 0.030),
            (at.other_shoulder, 0.030),
        ],
    ));

    // Turning the head by half a turn shows its axis, since the eyes are then on the other side of
    // it.
    let about =
        JointAngles { neck_rotation: angles.neck_rotation + std::f64::consts::PI, ..*angles };
    let behind = skeleton.landmarks(&about)?.eyes;
    let (middle, face) = ((at.eyes + behind) * 0.5, (at.eyes - behind) * 0.5);
    let crown = (middle - at.neck).normalize() * 0.014 * stature;
    let throat = at.neck - (at.neck - at.lumbar).normalize() * 0.03 * stature;
    pieces.push(piece(Part::Neck, &[(throat, 0.032), (at.neck, 0.030)]));
    let (centre, nose) = (middle + face * 0.15, middle + face - crown);
    let head = [(centre - crown, 0.047), (centre + crown, 0.052), (nose, 0.012)];
    pieces.push(piece(Part::Neck, &head));

    let fingers = at.wrist + (at.hand - at.wrist) * 1.8;
    pieces.push(piece(Part::UpperArm, &[(at.shoulder, 0.029), (at.elbow, 0.022)]));
    pieces.push(piece(Part::LowerArm, &[(at.elbow, 0.022), (at.wrist, 0.015)]));
    pieces.push(piece(Part::Wrist, &[(at.wrist, 0.014), (at.hand, 0.019), (fingers, 0.010)]));

    // The other arm hangs, and the model does not score it.
    let down = |from: Vector3<f64>, by: f64| from - Vector3::z() * by;
    let elbow = down(at.other_shoulder, length(segments.upper_arm));
    let wrist = down(elbow, length(segments.forearm));
    let fingers = down(wrist, 1.8 * length(segments.grip));
    pieces.push(piece(Part::OtherArm, &[(at.other_shoulder, 0.029), (elbow, 0.022)]));
    pieces.push(piece(Part::OtherArm, &[(elbow, 0.022), (wrist, 0.015)]));
    pieces.push(piece(Part::OtherArm, &[(wrist, 0.015), (fingers, 0.012)]));
    Ok(pieces)
}

impl Piece {
    /// Returns the outline in a view, counterclockwise.
    pub(super) fn outline(&self, view: &View) -> Vec<(f64, f64)> {
        const CORNERS: u32 = 36;
        let corner = |k| (f64::from(k) * std::f64::consts::TAU / f64::from(CORNERS)).sin_cos();
        let circles = self.balls.iter().flat_map(|(centre, radius)| {
            let (u, v) = view.of(centre);
            let around = (0..CORNERS).map(corner);
            around.map(move |(sin, cos)| (u + radius * cos, v + radius * sin))
        });
        hull(circles.collect())
    }

    /// Returns the centre \[m\].
    pub(super) fn middle(&self) -> Vector3<f64> {
        let sum: Vector3<f64> = self.balls.iter().map(|(centre, _)| centre).sum();
        sum / self.balls.len().max(1) as f64
    }
}

/// Returns the outline of all pieces together, without the gaps between them, from points `step`
/// apart \[m\].
pub(super) fn silhouette(pieces: &[Piece], view: &View, step: f64) -> Vec<Ring> {
    let outlines: Vec<_> = pieces.iter().map(|piece| piece.outline(view)).collect();
    let depth = |u, v| {
        let depths = outlines.iter().map(|outline| depth(outline, (u, v)));
        depths.fold(f64::NEG_INFINITY, f64::max)
    };
    let mut outlines = Field::sampled(&view.right.range, &view.up.range, step, depth).outlines(0.0);
    outlines.retain(|ring| area(ring) > 0.0);
    outlines
}

/// Returns the depth of a point in a convex, counterclockwise outline, negative outside.
fn depth(outline: &[(f64, f64)], (u, v): (f64, f64)) -> f64 {
    let next = outline.iter().cycle().skip(1);
    let depths = outline.iter().zip(next).map(|(a, b)| {
        let (du, dv) = (b.0 - a.0, b.1 - a.1);
        (du * (v - a.1) - dv * (u - a.0)) / (du * du + dv * dv).sqrt()
    });
    depths.fold(f64::INFINITY, f64::min)
}

/// Returns the convex hull, counterclockwise (Andrew's monotone chain).
fn hull(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let half = |points: &mut dyn Iterator<Item = (f64, f64)>| {
        let mut chain: Vec<(f64, f64)> = Vec::new();
        for p in points {
            while let [.., a, b] = chain.as_slice()
                && (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        // The last point begins the other half.
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_hull_is_convex_and_encloses_its_points(
            points in prop::collection::vec((-5.0..5.0, -5.0..5.0), 3..60),
        ) {
            let outline = hull(points.clone());
            prop_assert!(outline.len() >= 3);
            let next = outline.iter().cycle().skip(1);
            for (a, b) in outline.iter().zip(next) {
                for p in &points {
                    let side = (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0);
                    prop_assert!(side >= -1e-9);
                }
            }
        }
    }
}
