//! A manikin in a posture, with each part coloured by its REBA sub-score.

use ergo_map::{ActionLevel, Person, RulaActionLevel, Side};
use nalgebra::Vector3;
use plotters::prelude::*;

use super::assessment::Assessment;
use super::body::{self, Part, Piece};
use super::paint::{
    Area, Axis, Chart, MARK, Outcome, SCALE, TEXT, View, bold, canvas, centred, failed, font,
    ink_on, ramp, write,
};
use super::side::side_name;
use crate::error::Error;

/// Highest sub-score of all parts, which has the darkest colour.
const WORST: u8 = 6;
const TABLE: (u32, u32) = (470, 650);
const TITLE_HEIGHT: u32 = 46;
const UNSCORED: RGBColor = RGBColor(222, 222, 222);
const MASS: RGBColor = RGBColor(90, 90, 90);

/// Draws a posture from the side of the working hand and from the front. Adds the sub-scores, the
/// way to REBA, and `e_s`. Returns the picture as SVG.
///
/// # Errors
/// [`Error::Drawing`] if the picture cannot be drawn.
pub fn manikin(assessment: &Assessment, person: &Person, side: Side) -> Result<String, Error> {
    let pieces = body::pieces(person, side, &assessment.angles)?;
    let views = views(assessment, person, side);
    let [from_side, from_front] = &views;
    let (first, second) = (from_side.size(), from_front.size());
    let height = first.1.max(TABLE.1);
    let size = (first.0 + second.0 + TABLE.0, TITLE_HEIGHT + height);
    canvas(size, |root| {
        let hand = assessment.hand;
        let title = format!(
            "{} hand at ({:.2}, {:.2}, {:.2}) m, stature {:.2} m: REBA {}",
            if side == Side::Left { "Left" } else { "Right" },
            hand.x,
            hand.y,
            hand.z,
            person.stature(),
            assessment.reba.reba,
        );
        write(root, title, (16, 24), &bold(24))?;
        // Nearer pieces are drawn over farther ones.
        let near_side = |p: &Vector3<f64>| side.sign() * p.y;
        draw_view(root, (0, TITLE_HEIGHT), from_side, assessment, &pieces, near_side)?;
        draw_view(root, (first.0, TITLE_HEIGHT), from_front, assessment, &pieces, |p| p.x)?;
        let table = root.clone().shrink((first.0 + second.0, TITLE_HEIGHT), (TABLE.0, height));
        draw_table(&table, assessment)
    })
}

fn views(assessment: &Assessment, person: &Person, side: Side) -> [View; 2] {
    let stature = person.stature();
    let at = &assessment.landmarks;
    let points = [at.hip, at.neck, at.eyes, at.elbow, at.hand, assessment.hand];
    let least = Vector3::new(-0.20, -0.30, 0.0) * stature;
    let most = Vector3::new(0.35, 0.30, 1.0) * stature;
    let room = Vector3::repeat(0.10 * stature);
    let least = points.iter().fold(least, |least, p| least.inf(&(p - room)));
    let most = points.iter().fold(most, |most, p| most.sup(&(p + room)));
    let up = Axis::new(2, 1.0, -0.04 * stature, most.z.max(1.04 * stature));
    let forward = if side == Side::Right { 1.0 } else { -1.0 };
    let name = side_name(side);
    [
        View {
            title: format!("from the {name}"),
            right: Axis::new(0, forward, least.x, most.x),
            up: up.clone(),
        },
        View { title: "from the front".to_owned(), right: Axis::new(1, 1.0, least.y, most.y), up },
    ]
}

fn draw_view(
    root: &Area<'_>,
    at: (u32, u32),
    view: &View,
    assessment: &Assessment,
    pieces: &[Piece],
    nearness: impl Fn(&Vector3<f64>) -> f64,
) -> Outcome {
    let mut ordered: Vec<&Piece> = pieces.iter().collect();
    ordered.sort_by(|a, b| nearness(&a.middle()).total_cmp(&nearness(&b.middle())));
    view.chart(root, at, |chart| {
        let floor = [(view.right.range.start, 0.0), (view.right.range.end, 0.0)];
        chart.draw_series([PathElement::new(floor, TEXT.stroke_width(2))]).map_err(failed)?;
        for piece in ordered {
            let outline = piece.outline(view);
            let closed: Vec<_> = outline.iter().chain(outline.first()).copied().collect();
            let colour = sub_score(piece.part, assessment).map_or(UNSCORED, colour);
            chart.draw_series([Polygon::new(outline, colour.filled())]).map_err(failed)?;
            chart.draw_series([PathElement::new(closed, TEXT.stroke_width(1))]).map_err(failed)?;
        }
        draw_marks(chart, view, assessment)?;
        draw_badges(chart, view, assessment)
    })
}

/// Draws the number of each part unless it would cover another. A forearm that points to the viewer
/// has its number in the other view.
fn draw_badges(chart: &mut Chart<'_, '_>, view: &View, assessment: &Assessment) -> Outcome {
    const APART: f64 = 24.0 / SCALE;
    let mut taken: Vec<(f64, f64)> = Vec::new();
    for (part, place) in badges(assessment) {
        let at = view.of(&place);
        let free = taken
            .iter()
            .all(|other| (other.0 - at.0).powi(2) + (other.1 - at.1).powi(2) >= APART * APART);
        if let (Some(score), true) = (sub_score(part, assessment), free) {
            taken.push(at);
            let badge = EmptyElement::at(at)
                + Circle::new((0, 0), 11, WHITE.filled())
                + Circle::new((0, 0), 11, TEXT.stroke_width(1))
                + Text::new(score.to_string(), (0, 0), centred(&bold(18)));
            chart.plotting_area().draw(&badge).map_err(failed)?;
        }
    }
    Ok(())
}

/// Draws the hand's target, and the centre of mass with a plumb line.
fn draw_marks(chart: &mut Chart<'_, '_>, view: &View, assessment: &Assessment) -> Outcome {
    let mass = assessment.landmarks.centre_of_mass;
    let below = Vector3::new(mass.x, mass.y, 0.0);
    let plumb =
        DashedLineSeries::new([view.of(&mass), view.of(&below)], 5, 4, MASS.stroke_width(1));
    chart.draw_series(plumb).map_err(failed)?;
    chart.draw_series(mass_mark(&view.of(&mass))).map_err(failed)?;
    chart.draw_series(target_mark(&view.of(&assessment.hand))).map_err(failed)?;
    Ok(())
}

fn mass_mark<C: Clone>(at: &C) -> [Circle<C, i32>; 2] {
    [(7, WHITE), (5, MASS)].map(|(radius, colour)| Circle::new(at.clone(), radius, colour.filled()))
}

fn target_mark<C: Clone>(at: &C) -> [Cross<C, i32>; 2] {
    [(WHITE, 5), (MARK, 3)]
        .map(|(colour, width)| Cross::new(at.clone(), 8, colour.stroke_width(width)))
}

/// Returns the place of each part's number.
fn badges(assessment: &Assessment) -> [(Part, Vector3<f64>); 6] {
    let at = &assessment.landmarks;
    let along = |a: Vector3<f64>, b: Vector3<f64>, share: f64| a + (b - a) * share;
    let across = at.shoulder - at.other_shoulder;
    // The number is in front of the hanging arm.
    let spine = at.neck - at.lumbar;
    let forward = Vector3::new(spine.z, 0.0, -spine.x) * 0.1;
    [
        (Part::Neck, along(at.neck, at.lumbar, 0.02)),
        (Part::Trunk, along(at.lumbar, at.neck, 0.4) + forward - across * 0.1),
        (Part::Legs, at.knee + across * 0.24),
        (Part::UpperArm, along(at.shoulder, at.elbow, 0.4)),
        (Part::LowerArm, along(at.elbow, at.wrist, 0.4)),
        (Part::Wrist, along(at.wrist, at.hand, 2.4)),
    ]
}

fn sub_score(part: Part, assessment: &Assessment) -> Option<u8> {
    let scores = &assessment.reba.sub_scores;
    Some(match part {
        Part::Neck => scores.neck,
        Part::Trunk => scores.trunk,
        Part::Legs => scores.legs,
        Part::UpperArm => scores.upper_arm,
        Part::LowerArm => scores.lower_arm,
        Part::Wrist => scores.wrist,
        Part::OtherArm => return None,
    })
}

fn colour(score: u8) -> RGBColor {
    ramp(f64::from(score.saturating_sub(1)) / f64::from(WORST - 1))
}

/// Draws the sub-scores with their angles, the way to REBA, `e_s`, and a legend of the marks.
fn draw_table(area: &Area<'_>, assessment: &Assessment) -> Outcome {
    const X: i32 = 16;
    let mut y = 46;
    write(area, "part", (X + 44, y), &bold(16))?;
    write(area, "posture", (X + 138, y), &bold(16))?;
    y += 30;
    for (part, name, angles) in rows(assessment) {
        if let Some(score) = sub_score(part, assessment) {
            swatch(area, score, (X, y))?;
        }
        write(area, name, (X + 44, y), &font(17))?;
        write(area, angles, (X + 138, y), &font(17))?;
        y += 32;
    }
    y += 12;
    for line in way_to_reba(assessment) {
        write(area, line, (X, y), &font(17))?;
        y += 26;
    }
    y += 14;
    write(area, "sub-scores", (X, y), &bold(16))?;
    y += 28;
    for (k, score) in (0..).zip(1..=WORST) {
        swatch(area, score, (X + 44 * k, y))?;
    }
    write(area, "1 is best", (X + 44 * i32::from(WORST) + 4, y), &font(16))?;
    y += 36;
    let square = Rectangle::new([(X, y - 11), (X + 30, y + 11)], UNSCORED.filled());
    area.draw(&square).map_err(failed)?;
    write(area, "not scored", (X + 44, y), &font(16))?;
    y += 30;
    for cross in target_mark(&(X + 15, y)) {
        area.draw(&cross).map_err(failed)?;
    }
    write(area, "where the hand is wanted", (X + 44, y), &font(16))?;
    y += 30;
    for circle in mass_mark(&(X + 15, y)) {
        area.draw(&circle).map_err(failed)?;
    }
    write(area, "centre of mass and its plumb line", (X + 44, y), &font(16))
}

fn swatch(area: &Area<'_>, score: u8, (x, y): (i32, i32)) -> Outcome {
    let corners = [(x, y - 12), (x + 30, y + 12)];
    let colour = colour(score);
    area.draw(&Rectangle::new(corners, colour.filled())).map_err(failed)?;
    area.draw(&Rectangle::new(corners, TEXT.stroke_width(1))).map_err(failed)?;
    let style = centred(&bold(17).color(ink_on(colour)));
    area.draw(&Text::new(score.to_string(), (x + 15, y), style)).map_err(failed)
}

fn rows(assessment: &Assessment) -> [(Part, &'static str, String); 6] {
    let posture = assessment.angles.posture();
    // Adding zero avoids "-0".
    let whole = |angle: f64| angle.to_degrees().round() + 0.0;
    let flexed = |angle: f64| {
        let (angle, word) = (whole(angle.abs()), if angle < 0.0 { "extended" } else { "flexed" });
        format!("{word} {angle}°")
    };
    let with = |first: String, rest: &[(&str, f64)]| {
        let others = rest.iter().map(|(word, angle)| format!("{word} {}°", whole(angle.abs())));
        [first].into_iter().chain(others).collect::<Vec<_>>().join(", ")
    };
    [
        (Part::Neck, "neck", with(flexed(posture.neck_flexion), &[("turned", posture.neck_twist)])),
        (
            Part::Trunk,
            "trunk",
            with(
                flexed(posture.trunk_flexion),
                &[("twisted", posture.trunk_twist), ("bent aside", posture.trunk_side)],
            ),
        ),
        (Part::Legs, "legs", format!("knees {}", flexed(posture.knee_flexion))),
        (
            Part::UpperArm,
            "upper arm",
            with(
                flexed(posture.upper_arm_flexion),
                &[
                    ("abducted", posture.upper_arm_abduction),
                    ("rotated", posture.upper_arm_rotation),
                ],
            ),
        ),
        (Part::LowerArm, "lower arm", format!("elbow {}", flexed(posture.elbow_flexion))),
        (
            Part::Wrist,
            "wrist",
            with(
                flexed(posture.wrist_flexion),
                &[("deviated", posture.wrist_deviation), ("twisted", posture.wrist_twist)],
            ),
        ),
    ]
}

fn way_to_reba(assessment: &Assessment) -> Vec<String> {
    let (reba, rula, parts) = (&assessment.reba, &assessment.rula, &assessment.contributions);
    vec![
        format!("neck, trunk, legs: table A {}", reba.table_a),
        format!("upper arm, lower arm, wrist: table B {}", reba.table_b),
        format!(
            "REBA {}, action level {}: {}",
            reba.reba,
            reba.action_level.number(),
            risk(reba.action_level)
        ),
        format!(
            "RULA {}, action level {}: {}",
            rula.rula,
            rula.action_level.number(),
            advice(rula.action_level)
        ),
        String::new(),
        format!("e_s {:.2}, the mean of", parts.mean()),
        format!(
            "arms {:.2}, trunk {:.2}, legs {:.2}, neck {:.2}",
            parts.arms, parts.trunk, parts.legs, parts.neck
        ),
    ]
}

fn risk(level: ActionLevel) -> &'static str {
    match level {
        ActionLevel::None => "negligible risk",
        ActionLevel::MayBeNecessary => "low risk",
        ActionLevel::Necessary => "medium risk",
        ActionLevel::NecessarySoon => "high risk",
        ActionLevel::NecessaryNow => "very high risk",
    }
}

fn advice(level: RulaActionLevel) -> &'static str {
    match level {
        RulaActionLevel::Acceptable => "acceptable",
        RulaActionLevel::Investigate => "investigate",
        RulaActionLevel::ChangeSoon => "change soon",
        RulaActionLevel::ChangeNow => "change now",
    }
}
