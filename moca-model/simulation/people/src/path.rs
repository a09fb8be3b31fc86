//! Paths along which the person leads the robot.

use std::{
    f64::consts::{PI, TAU},
    path::Path,
    str::FromStr,
};

use nalgebra::{Point2, Rotation2, Vector2};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::file::{Excerpt, read_text};

use crate::error::Error;

/// Place where the person receives the robot and works first, in the world \[m\].
pub(super) const WORKPLACE: Point2<f64> = Point2::new(1.4, 0.0);

/// Heading that faces the robot's first place \[rad\].
pub(super) const TOWARDS_ROBOT: f64 = PI;

/// Time for which the person works at a waypoint of a list \[s\].
const DWELL: f64 = 3.0;

/// Largest accepted file with a list of points (bytes).
const LARGEST_FILE: u64 = 1 << 20;

/// Largest distance of a waypoint from the origin \[m\].
const FARTHEST: f64 = 50.0;

/// A path along which the person leads the robot while working.
///
/// ```
/// use simulated_people::WalkingPath;
/// use nalgebra::Point2;
///
/// assert_eq!("figure-eight".parse::<WalkingPath>()?, WalkingPath::FigureEight);
/// let list: WalkingPath = "1.4,0 2.4,-1".parse()?;
/// assert_eq!(list, WalkingPath::Points(vec![Point2::new(1.4, 0.0), Point2::new(2.4, -1.0)]));
/// # Ok::<(), simulated_people::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum WalkingPath {
    /// Goes from station to station: backwards, left, diagonally backwards left, and after a turn diagonally backwards
    /// right.
    Stations,
    /// Goes backwards and forwards.
    Straight,
    /// Goes around a square with a stop at each corner.
    Square,
    /// Goes around a circle without a stop.
    Circle,
    /// Goes along a figure of eight without a stop.
    FigureEight,
    /// Goes to random places, turning at random.
    Random,
    /// Goes to random places, each time along one of HRI30's eight directions, with a stop at each.
    Directions,
    /// Goes to these points on the floor, in the world \[m\], with a stop at each.
    Points(Vec<Point2<f64>>),
}

/// A place on the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Waypoint {
    /// Point on the floor, in the world \[m\].
    pub(super) floor: Point2<f64>,
    /// Heading of the person there \[rad\].
    pub(super) heading: f64,
    /// Time for which the person stays and works \[s\]; zero passes by without a stop.
    pub(super) dwell: f64,
}

impl WalkingPath {
    /// Creates a path from the command line: a name, a list of points, or a file with one point a line.
    ///
    /// # Errors
    /// [`Error::Path`] or [`Error::PathFile`].
    pub fn from_argument(argument: &str) -> Result<Self, Error> {
        let file = Path::new(argument);
        if !file.is_file() {
            return argument.parse();
        }
        let fail = |source| Error::PathFile { path: file.to_owned(), source };
        let text = read_text(file, LARGEST_FILE).map_err(fail)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let lines = (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty());
        let points = lines.map(|(line, text)| {
            let path = file.to_owned();
            point(text).ok_or_else(|| Error::PathLine {
                path,
                line,
                text: Excerpt(text).to_string(),
            })
        });
        let path = Self::Points(points.collect::<Result<_, _>>()?);
        path.validate().map(|()| path)
    }

    /// Returns an error unless a list has points and they are within reach.
    pub(super) fn validate(&self) -> Result<(), Error> {
        match self {
            Self::Points(points) if points.is_empty() => Err(Error::Path { text: String::new() }),
            Self::Points(points) => {
                let outside = |value: &&f64| !(-FARTHEST..=FARTHEST).contains(*value);
                match points.iter().flat_map(|point| point.iter()).find(outside) {
                    Some(&got) => Err(Error::Value {
                        what: "path",
                        got,
                        wanted: "points within 50 m of the origin",
                    }),
                    None => Ok(()),
                }
            }
            _ => Ok(()),
        }
    }

    /// The waypoints in order.
    pub(super) fn waypoints(&self, draw: &mut ChaCha8Rng) -> Vec<Waypoint> {
        let place = |x, y, turn, dwell| Waypoint {
            floor: WORKPLACE + Vector2::new(x, y),
            heading: TOWARDS_ROBOT + turn,
            dwell,
        };
        // A closed curve from the workplace to the workplace, as a function of its angle.
        let curve = |at: fn(f64) -> (f64, f64)| {
            (1..=24).map(move |k| {
                let (x, y) = at(TAU * f64::from(k) / 24.0);
                place(x, y, 0.0, 0.0)
            })
        };
        match self {
            Self::Stations => vec![
                place(1.2, 0.0, 0.0, 3.0),
                place(1.2, -1.2, 0.0, 3.0),
                place(1.5, -1.5, 0.0, 3.0),
                place(1.5, -1.5, 0.4, 4.0),
                place(1.8, -0.8, 0.4, 14.0),
            ],
            Self::Straight => vec![place(1.5, 0.0, 0.0, DWELL), place(0.0, 0.0, 0.0, DWELL)],
            Self::Square => vec![
                place(1.0, 0.0, 0.0, DWELL),
                place(1.0, -1.0, 0.0, DWELL),
                place(0.0, -1.0, 0.0, DWELL),
                place(0.0, 0.0, 0.0, DWELL),
            ],
            Self::Circle => curve(|t| (0.6 - 0.6 * t.cos(), -0.6 * t.sin())).collect(),
            Self::FigureEight => curve(|t| (0.6 - 0.6 * t.cos(), -0.5 * (2.0 * t).sin())).collect(),
            Self::Random => {
                let mut random = || {
                    let dwell =
                        if draw.random_bool(0.5) { draw.random_range(0.5..2.0) } else { 0.0 };
                    let turn = draw.random_range(-0.6..0.6);
                    place(draw.random_range(-0.1..1.5), draw.random_range(-1.0..1.0), turn, dwell)
                };
                (0..32).map(|_| random()).collect()
            }
            Self::Directions => in_directions(draw),
            Self::Points(points) => points
                .iter()
                .map(|&floor| Waypoint { floor, heading: TOWARDS_ROBOT, dwell: DWELL })
                .collect(),
        }
    }
}

/// Paths along the eight directions in the frame of a person who hardly turns.
fn in_directions(draw: &mut ChaCha8Rng) -> Vec<Waypoint> {
    let heading = TOWARDS_ROBOT + draw.random_range(-0.25..0.25);
    let inside = |place: &Vector2<f64>| (-0.1..1.6).contains(&place.x) && place.y.abs() < 1.0;
    let mut place = Vector2::zeros();
    let mut way = vec![Waypoint { floor: WORKPLACE, heading, dwell: 1.0 }];
    while way.len() < 64 {
        let (eighth, length) = (draw.random_range(0..8_u8), draw.random_range(0.5..1.3));
        let (off, dwell) = (draw.random_range(-0.1..0.1), draw.random_range(1.0..3.0));
        let yaw = heading + TAU * f64::from(eighth) / 8.0 + off;
        let next = place + Rotation2::new(yaw) * Vector2::new(length, 0.0);
        if inside(&next) {
            place = next;
            way.push(Waypoint { floor: WORKPLACE + place, heading, dwell });
        }
    }
    way
}

impl FromStr for WalkingPath {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let path = match text {
            "stations" => Self::Stations,
            "straight" => Self::Straight,
            "square" => Self::Square,
            "circle" => Self::Circle,
            "figure-eight" => Self::FigureEight,
            "random" => Self::Random,
            "directions" => Self::Directions,
            list => {
                let points = list.split_whitespace().map(point).collect::<Option<_>>();
                Self::Points(points.ok_or_else(|| Error::Path { text: Excerpt(text).to_string() })?)
            }
        };
        path.validate().map(|()| path)
    }
}

/// Parses a point from a text such as "1.4,0".
fn point(text: &str) -> Option<Point2<f64>> {
    let (x, y) = text.split_once(',')?;
    Some(Point2::new(x.trim().parse().ok()?, y.trim().parse().ok()?))
}
