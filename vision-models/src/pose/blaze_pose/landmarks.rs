//! From the numbers of the network of landmarks to points of the body.

use nalgebra::{Point2, Point3, Vector2};
use ndarray::{ArrayView1, ArrayView3};

use crate::body::{ImageKeypoint, JointLayout, ObservedBody};
use crate::confidence::Confidence;

use super::region::PoseRegion;

/// Rows and columns of what the network sees.
pub(super) const INPUT: usize = 256;
/// Points that the network gives: those of the body, and six that help.
pub(super) const COUNT: usize = 39;
/// Numbers of a point: x, y, depth, visibility, presence.
pub(super) const NUMBERS: usize = 5;
/// Cells around a point that are looked at in its map, to each side.
const AROUND: usize = 3;
/// The least height of a map that moves a point.
const LEAST: f64 = 0.5;
/// The points that say where the circle around the body is.
const CIRCLE: [usize; 2] = [33, 34];

/// A point of the body, of the thirty-three of BlazePose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Landmark {
    /// In the image (pixels), the centre of the pixel at the top left at 0, 0.
    pub position: Point2<f64>,
    /// How much farther from the camera it is than the middle of the hips, as many pixels as it is at their distance.
    pub depth: f64,
    /// From the middle of the hips (m): x to the right in the image, y downwards, z away from the camera.
    pub metric: Point3<f64>,
    /// How probably it is in the image and nothing hides it.
    pub visibility: Confidence,
    /// How probably it is in the image.
    pub presence: Confidence,
}

/// A person as BlazePose sees them.
///
/// The landmarks are, in order: the nose; of the left eye, then of the right one the inner corner, the middle and the
/// outer corner; the ears; the corners of the mouth; shoulders, elbows, wrists; little fingers, index fingers and thumbs;
/// hips, knees, ankles, heels and tips of the feet. Left is before right, as the person has them.
#[derive(Clone, Debug, PartialEq)]
pub struct Landmarks {
    /// The thirty-three points.
    pub points: [Landmark; 33],
    /// How probably there is a person in the region.
    pub score: Confidence,
    /// The circle around the body: between the hips, and a point on it in the direction of the head. What
    /// [`PoseRegion::around`] makes the next region of.
    pub circle: [Point2<f64>; 2],
}

impl Landmarks {
    /// The person's joints, each as sure as it is visible. [`JointLayout::BlazePose`] says which they are.
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

/// What the network says of a region.
pub(super) struct Numbers<'a> {
    pub(super) points: ArrayView1<'a, f32>,
    pub(super) metric: ArrayView1<'a, f32>,
    /// Points × rows × columns.
    pub(super) maps: ArrayView3<'a, f32>,
    /// From 0 to 1.
    pub(super) score: f32,
}

/// 1 / (1 + exp(-x)).
fn logistic(value: f32) -> f64 {
    1.0 / (1.0 + f64::from(-value).exp())
}

fn confidence(value: f64) -> Confidence {
    Confidence::new(value).unwrap_or(Confidence::ZERO)
}

impl Numbers<'_> {
    /// The person in the region.
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

    /// A point in its region: the mean of the cells around it in its map, where that is high enough.
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
