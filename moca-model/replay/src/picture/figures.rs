//! Scene as lines and polygons.

use nalgebra::{Isometry3, Vector2, Vector3};

use super::colours::{self, Colour};
use super::moments::Moment;
use super::view::View;
use crate::recorded::{BodyPart, LIMBS, Role, Shape, Solid};
use ergo_map::Side;

/// Distance behind the middle of a box at which the things in it are drawn \[m\].
const BEHIND: f64 = 2.0;
/// Number of corners that the ends of a cylinder are drawn with.
const CORNERS: u32 = 16;

/// Outline of a solid or a limb.
#[derive(Clone, Debug)]
pub(super) enum Outline {
    /// Thick line; its ends are round or cut off.
    Line { ends: [Vector2<f64>; 2], width: f64, round: bool },
    /// Polygon.
    Polygon(Vec<Vector2<f64>>),
}

/// Outline with its colour, and its nearness to the eye.
#[derive(Clone, Debug)]
pub(super) struct Figure {
    pub(super) outline: Outline,
    pub(super) colour: String,
    pub(super) nearness: f64,
}

/// Returns all figures of robot, person and surroundings, in an order that is equal at every time.
pub(super) fn figures(moment: &Moment<'_>, view: &View) -> Vec<Figure> {
    let mut figures = Vec::new();
    let solids = moment.replay.stage.solids();
    let drawn = solids.iter().filter(|solid| solid.role != Role::Surroundings);
    for (index, solid) in drawn.enumerate() {
        let Some(frame) = moment.pose(solid.frame) else { continue };
        let pose = frame * solid.frame_from_shape;
        let begin = figures.len();
        add_shape(&mut figures, view, &pose, solid.shape, solid.colour);
        // Solids that are fixed to a box are treated as inside it: a wheel protrudes only below its chassis.
        let fixed = |other: &&Solid| other.frame == solid.frame && is_box(other);
        let chassis = solids.iter().take(index).find(fixed);
        if let Some(chassis) = chassis.filter(|_| !is_box(solid)) {
            let middle = (frame * chassis.frame_from_shape).translation.vector;
            let behind = view.nearness(&middle) - BEHIND;
            for figure in figures.iter_mut().skip(begin) {
                figure.nearness = figure.nearness.min(behind);
            }
        }
    }
    add_body(&mut figures, moment, view);
    figures
}

fn is_box(solid: &Solid) -> bool {
    matches!(solid.shape, Shape::Box { .. })
}

/// Returns the edges of the shared workspace.
pub(super) fn workspace(moment: &Moment<'_>, view: &View) -> Vec<[Vector2<f64>; 2]> {
    let (Some([low, high]), Some(pose)) = (moment.workspace(), moment.named("workspace")) else {
        return Vec::new();
    };
    let corner = |bits: usize| {
        let corner = Vector3::from_fn(|k, _| if bits >> k & 1 == 0 { low[k] } else { high[k] });
        view.at(&(pose * nalgebra::Point3::from(corner)).coords)
    };
    let pairs = (0..8_usize).flat_map(|bits| {
        (0..3).filter(move |axis| bits >> axis & 1 == 0).map(move |axis| (bits, bits | 1 << axis))
    });
    pairs.map(|(from, to)| [corner(from), corner(to)]).collect()
}

fn add_body(figures: &mut Vec<Figure>, moment: &Moment<'_>, view: &View) {
    let points = moment.body();
    let stature = moment.replay.stature;
    for limb in LIMBS {
        let [from, to] = limb.ends.map(|end| points.get(end).copied().flatten());
        let (Some(from), Some(to)) = (from, to) else { continue };
        let scored = |part: usize, side: Option<Side>| {
            if side.is_none_or(|side| side == moment.replay.side) {
                colours::part(part, moment.part(part))
            } else {
                colours::GREY
            }
        };
        let colour = match limb.part {
            BodyPart::Neck => scored(0, None),
            BodyPart::Trunk => scored(1, None),
            BodyPart::Legs => scored(2, None),
            BodyPart::UpperArm(side) => scored(3, Some(side)),
            BodyPart::LowerArm(side) => scored(4, Some(side)),
            BodyPart::Wrist(side) => scored(5, Some(side)),
        };
        let radius = 0.5 * (limb.radii[0] + limb.radii[1]) * stature;
        figures.push(rod(view, [from, to], radius, colour));
    }
}

fn rod(view: &View, ends: [Vector3<f64>; 2], radius: f64, colour: Colour) -> Figure {
    let middle = (ends[0] + ends[1]) * 0.5;
    Figure {
        outline: Outline::Line {
            ends: ends.map(|end| view.at(&end)),
            width: 2.0 * radius * view.scale,
            round: true,
        },
        colour: colours::css(colour, 0.96),
        nearness: view.nearness(&middle),
    }
}

fn add_shape(
    figures: &mut Vec<Figure>,
    view: &View,
    pose: &Isometry3<f64>,
    shape: Shape,
    colour: Colour,
) {
    let place = |x: f64, y: f64, z: f64| (pose * nalgebra::Point3::new(x, y, z)).coords;
    match shape {
        Shape::Sphere { radius } => {
            figures.push(rod(view, [place(0.0, 0.0, 0.0); 2], radius, colour));
        }
        Shape::Capsule { length, radius } => {
            let ends = [-0.5, 0.5].map(|end| place(0.0, 0.0, end * length));
            figures.push(rod(view, ends, radius, colour));
        }
        Shape::Cylinder { length, radius } => {
            let ends = [-0.5, 0.5].map(|end| place(0.0, 0.0, end * length));
            let mut side = rod(view, ends, radius, colour);
            if let Outline::Line { round, .. } = &mut side.outline {
                *round = false;
            }
            figures.push(side);
            for end in [-0.5, 0.5] {
                let corners = (0..CORNERS).map(|corner| {
                    let turn = f64::from(corner) * std::f64::consts::TAU / f64::from(CORNERS);
                    place(radius * turn.cos(), radius * turn.sin(), end * length)
                });
                let normal = pose.rotation * Vector3::z() * (2.0 * end);
                figures.push(face(view, &corners.collect::<Vec<_>>(), &normal, colour));
            }
        }
        Shape::Box { size } => {
            for axis in 0..3 {
                for sign in [-1.0, 1.0] {
                    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
                    let corners = corners.map(|[u, v]| {
                        let mut at = [0.0; 3];
                        at[axis] = 0.5 * sign * size[axis];
                        at[(axis + 1) % 3] = u * size[(axis + 1) % 3];
                        at[(axis + 2) % 3] = v * size[(axis + 2) % 3];
                        place(at[0], at[1], at[2])
                    });
                    let mut normal = Vector3::zeros();
                    normal[axis] = sign;
                    figures.push(face(view, &corners, &(pose.rotation * normal), colour));
                }
            }
        }
    }
}

/// Returns a flat face. A face that is turned away shrinks to its middle, so that the number of figures stays constant.
fn face(view: &View, corners: &[Vector3<f64>], normal: &Vector3<f64>, colour: Colour) -> Figure {
    let middle = corners.iter().sum::<Vector3<f64>>() / corners.len().max(1) as f64;
    let seen = view.facing(normal) > 0.0;
    let points = corners.iter().map(|corner| view.at(if seen { corner } else { &middle }));
    let light = 0.66 + 0.2 * normal.z + 0.16 * view.facing(normal);
    Figure {
        outline: Outline::Polygon(points.collect()),
        colour: colours::css(colour, light),
        nearness: view.nearness(&middle),
    }
}

impl Outline {
    /// Returns the outline as the data of an SVG path.
    pub(super) fn path(&self) -> String {
        match self {
            Self::Line { ends: [from, to], .. } => {
                // Some viewers draw no round ends for a line without length.
                format!("M{:.1} {:.1}L{:.2} {:.1}", from.x, from.y, to.x + 0.01, to.y)
            }
            Self::Polygon(points) => {
                let mut path = Vec::new();
                for (index, point) in points.iter().enumerate() {
                    path.push(if index == 0 { "M" } else { "L" }.to_owned());
                    path.push(format!("{:.1} {:.1}", point.x, point.y));
                }
                path.push("Z".to_owned());
                path.concat()
            }
        }
    }
}
