//! Converts the numbers of the landmark network to points of the body.

use nalgebra::{Point2, Point3, Vector2};
use ndarray::{ArrayView1, ArrayView3};

use crate::body::{ImageKeypoint, JointLayout, ObservedBody};
use crate::confidence::Confidence;

use super::region::PoseRegion;

/// Rows and columns of the network's input.
pub(super) const INPUT: usize = 256;
/// Number of the network's points: those of the body, and six auxiliary ones.
pub(super) const COUNT: usize = 39;
/// Numbers of a point: x, y, depth, visibility, presence.
pub(super) const NUMBERS: usize = 5;
/// Cells to each side of a point that are read in its map.
const AROUND: usize = 3;
/// Smallest height of a map that moves a point.
const LEAST: f64 = 0.5;
/// The points that define the circle around the body.
const CIRCLE: [usize; 2] = [33, 34];

/// A point of the body, one of BlazePose's thirty-three.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmark {
    /// Position in the image (pixels). The centre of the pixel at the top left is 0, 0.
    pub position: Point2<f64>,
    /// Additional distance from the camera relative to the middle of the hips, in pixels at the
    /// hips' distance.
    pub depth: f64,
    /// Position relative to the middle of the hips (m): x to the right in the image, y downwards, z
    /// away from the camera.
    pub metric: Point3<f64>,
    /// Probability that the point is in the image and not hidden.
    pub visibility: Confidence,
    /// Probability that the point is in the image.
    pub presence: Confidence,
}

/// Landmarks of a person, found by BlazePose in a region of an image.
///
/// The landmarks are in this order:
/// - the nose
/// - of the left eye, then of the right eye: the inner corner, the middle and the outer corner
/// - the ears, and the corners of the mouth
/// - shoulders, elbows, wrists
/// - little fingers, index fingers and thumbs
/// - hips, knees, ankles, heels and tips of the feet
///
/// Left is before right, as the person has them.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmarks {
    /// The thirty-three points.
    pub points: [Landmark; 33],
    /// Probability that there is a person in the region.
    pub score: Confidence,
    /// The circle around the body: its centre between the hips, and a point on it in the direction
    /// of the head. [`PoseRegion::around`] makes the next region from it.
    pub circle: [Point2<f64>; 2],
}

impl Landmarks {
    /// Returns the person's joints in the image and in metres, in [`JointLayout::BlazePose`]. The
    /// confidence of each is the smaller of visibility and presence.
    pub fn body(&self) -> ObservedBody {
        let keypoint = |&Landmark { position, visibility, presence, .. }: &Landmark| {
            let confidence = if presence < visibility { presence } else { visibility };
            Some(ImageKeypoint { position, confidence })
        };
        let keypoints: Vec<_> = self.points.iter().map(keypoint).collect();
        let points: Vec<_> = self.points.iter().map(|landmark| Some(landmark.metric)).collect();
        let layout = JointLayout::BlazePose;
        ObservedBody { image: layout.body(&keypoints), metric: Some(layout.metric(&points)) }
    }
}

/// The network's output for a region.
pub(super) struct Numbers<'a> {
    pub(super) points: ArrayView1<'a, f32>,
    pub(super) metric: ArrayView1<'a, f32>,
    /// Points × rows × columns.
    pub(super) maps: ArrayView3<'a, f32>,
    /// Score from 0 to 1.
    pub(super) score: f32,
}

/// Returns 1 / (1 + exp(-x)).
fn logistic(value: f32) -> f64 {
    1.0 / (1.0 + f64::from(-value).exp())
}

fn confidence(value: f64) -> Confidence {
    Confidence::new(value).unwrap_or(Confidence::ZERO)
}

impl Numbers<'_> {
    /// Returns the person in the region.
    pub(super) fn decode(&self, region: &PoseRegion) -> Landmarks {
        let score = confidence(f64::from(self.score));
        let points = std::array::from_fn(|index| {
            let number = |part: usize| self.points[NUMBERS * index + part];
            let [x, y, z] = [0, 1, 2].map(|axis| f64::from(self.metric[3 * index + axis]));
            let across = region.turn(Vector2::new(x, y));
            Landmark {
                position: region.place(self.place(index)),
                depth: f64::from(number(2)) / INPUT as f64 * region.side,
                metric: Point3::new(across.x, across.y, z),
                visibility: confidence(logistic(number(3))),
                presence: confidence(logistic(number(4))),
            }
        });
        let circle = CIRCLE.map(|index| region.place(self.place(index)));
        Landmarks { points, score, circle }
    }

    /// Returns a point in its region: the mean of the cells around it in its map, if the map is
    /// high enough.
    #[expect(clippy::cast_possible_truncation, reason = "rounds towards zero, as MediaPipe does")]
    fn place(&self, index: usize) -> [f64; 2] {
        let coarse =
            [0, 1].map(|axis| f64::from(self.points[NUMBERS * index + axis]) / INPUT as f64);
        let (_, rows, columns) = self.maps.dim();
        let cell = |part: f64, count: usize| {
            usize::try_from((part * count as f64) as i64).ok().filter(|&cell| cell < count)
        };
        let (Some(column), Some(row)) = (cell(coarse[0], columns), cell(coarse[1], rows)) else {
            return coarse;
        };
        let near =
            |cell: usize, count: usize| cell.saturating_sub(AROUND)..(cell + AROUND + 1).min(count);
        let (mut sum, mut highest, mut at) = (0.0, 0.0_f64, [0.0; 2]);
        for row in near(row, rows) {
            for column in near(column, columns) {
                let height = logistic(self.maps[[index, row, column]]);
                sum += height;
                highest = highest.max(height);
                at = [at[0] + height * column as f64, at[1] + height * row as f64];
            }
        }
        if highest < LEAST || sum <= 0.0 {
            return coarse;
        }
        [at[0] / columns as f64 / sum, at[1] / rows as f64 / sum]
    }
}
