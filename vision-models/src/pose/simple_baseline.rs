//! The joints of one person inside a given box.

use nalgebra::Point2;
use ndarray::{Array4, ArrayView3, ArrayView4, Axis, s};

use crate::body::{ImageBody, ImageKeypoint, JointLayout};
use crate::confidence::Confidence;
use crate::engine::{Network, Options, Threads, wrong_input};
use crate::error::Error;
use crate::networks::{NetworkKind, SimpleBaselineForm};
use crate::weights::TensorSource;

use super::person_box::PersonBox;
use super::sampling::{Scaling, check_image};

/// The number of passes of the network per person.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Passes {
    /// Single pass on the image as it is.
    #[default]
    One,
    /// A second pass on the mirrored image, and the mean of both maps. Published accuracies are
    /// measured in this way. It takes twice the time.
    Mirrored,
}

/// The simple baseline for pose estimation with a ResNet-50. It finds COCO's seventeen joints of
/// the person in a box. B. Xiao, H. Wu and Y. Wei, "Simple baselines for human pose estimation and
/// tracking", ECCV 2018.
///
/// The box is widened to 3 : 4 and by a quarter, and scaled to 192 × 256 pixels. Each joint is at
/// the maximum of its map of 48 × 64, moved by a quarter of a cell towards the higher neighbour.
/// Its confidence is the maximum, at most one. A joint is not seen if its map is nowhere positive.
///
/// ```no_run
/// use vision_models::{Body25, Checkpoint, Options, Passes, PersonBox, SimpleBaseline, read_image};
///
/// let weights = Checkpoint::open("res50_coco_256x192.pth")?;
/// let mut network = SimpleBaseline::load(weights, Passes::One, Options::default())?;
/// let image = read_image("frame.jpg")?;
/// let person = PersonBox { left: 200.0, top: 80.0, width: 120.0, height: 340.0 };
/// let body = network.estimate(image.view(), &person)?;
/// println!("{:?}", body.get(Body25::RightWrist));
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Debug)]
pub struct SimpleBaseline {
    network: Network,
    form: SimpleBaselineForm,
    passes: Passes,
    /// The network's input, plain and mirrored.
    input: Array4<f32>,
}

/// Rows and columns of the network's input.
const INPUT: [usize; 2] = [256, 192];
/// Pixels of the input per cell of the maps.
const CELL: f64 = 4.0;
/// Ratio of the network's box to the person's.
const WIDENING: f64 = 1.25;
/// COCO's joints with left and right exchanged.
const MIRRORED: [usize; 17] = [0, 2, 1, 4, 3, 6, 5, 8, 7, 10, 9, 12, 11, 14, 13, 16, 15];

impl SimpleBaseline {
    /// Returns the names and shapes of the tensors that a checkpoint must hold.
    pub fn parameters(form: SimpleBaselineForm) -> Vec<(String, Vec<usize>)> {
        NetworkKind::SimpleBaseline(form).parameters(0)
    }

    /// Loads a checkpoint of Microsoft's or mmpose's form, as its names show.
    ///
    /// # Errors
    /// - [`Error::Weights`] with every tensor that is missing, surplus or of the wrong shape.
    /// - [`Error::Value`] if a weight is not finite or a variance is negative.
    /// - [`Error::Overflow`] if a weight is too large for f32.
    /// - [`Error::Threads`] if this number of threads cannot be started.
    pub fn load(
        tensors: impl TensorSource,
        passes: Passes,
        options: Options,
    ) -> Result<Self, Error> {
        let form = SimpleBaselineForm::guess(&tensors.names());
        let [rows, columns] = INPUT;
        let kind = NetworkKind::SimpleBaseline(form);
        let network = kind.load(Box::new(tensors), [1, rows, columns], options)?;
        let images = if passes == Passes::Mirrored { 2 } else { 1 };
        Ok(Self { network, form, passes, input: Array4::zeros((images, 3, rows, columns)) })
    }

    /// Makes the network run on other threads, which networks may share.
    ///
    /// # Errors
    /// Those of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.network.share_threads(threads)
    }

    /// Returns the number of multiplications and additions for one pass.
    pub fn operations(&self) -> u64 {
        self.network.operations()
    }

    /// Returns the joints' maps of normalised images.
    ///
    /// The images are N × 3 × height × width, both sides multiples of 32. The maps are N × 17 × a
    /// quarter of the height × a quarter of the width. To find joints, use [`Self::estimate`].
    ///
    /// # Errors
    /// Those of [`Network::infer`].
    pub fn heatmaps(&mut self, images: ArrayView4<'_, f32>) -> Result<ArrayView4<'_, f32>, Error> {
        maps(&mut self.network, images)
    }

    /// Returns the joints of the person in the box. The image is height × width × 3 (red, green,
    /// blue).
    ///
    /// # Errors
    /// - [`Error::Size`] if the image has no pixels or not three channels.
    /// - [`Error::Value`] if the box is invalid or outside the image.
    /// - [`Error::Overflow`] if activations overflow.
    pub fn estimate(
        &mut self,
        image: ArrayView3<'_, u8>,
        person: &PersonBox,
    ) -> Result<ImageBody, Error> {
        let size = check_image(&image)?;
        person.validate()?;
        if !person.overlaps(size) {
            return Err(person.refused("a box that lies in the image, at least in part"));
        }
        let scaling = scaling(person);
        let is_bgr = self.form == SimpleBaselineForm::Microsoft;
        let colours = if is_bgr { image.slice(s![.., .., ..;-1]) } else { image };
        scaling.sample(&colours, 0.0, normalise, self.input.index_axis_mut(Axis(0), 0));
        if self.passes == Passes::Mirrored {
            let (seen, mut mirrored) = self.input.view_mut().split_at(Axis(0), 1);
            mirrored.assign(&seen.slice(s![.., .., .., ..;-1]));
        }
        let maps = maps(&mut self.network, self.input.view())?;
        let keypoints: [_; 17] = std::array::from_fn(|joint| {
            let map = maps.slice(s![0, joint, .., ..]);
            let seen = |row: usize, column: usize| map[[row, column]];
            let peak = match self.passes {
                Passes::One => decode(map.dim(), seen),
                Passes::Mirrored => {
                    let other = maps.slice(s![1, MIRRORED[joint], .., ..;-1]);
                    // Mirrored back, the map is moved by one cell to the right, as both libraries
                    // do in their tests.
                    decode(map.dim(), |row, column| {
                        0.5 * (seen(row, column) + other[[row, column.saturating_sub(1)]])
                    })
                }
            };
            peak.and_then(|Peak { at: [u, v], height }| {
                let [x, y] = scaling.source([CELL * u, CELL * v]);
                let confidence = Confidence::new(f64::from(height).min(1.0)).ok()?;
                Some(ImageKeypoint { position: Point2::new(x, y), confidence })
            })
        });
        Ok(JointLayout::Coco17.body(&keypoints))
    }
}

/// Returns the network's maps.
fn maps<'a>(
    network: &'a mut Network,
    images: ArrayView4<'_, f32>,
) -> Result<ArrayView4<'a, f32>, Error> {
    let shape = images.shape().to_vec();
    let inference = network.infer(images.insert_axis(Axis(2)))?;
    let maps = inference.map(0).ok_or_else(|| wrong_input(&shape))?;
    Ok(maps.index_axis_move(Axis(2), 0))
}

/// Returns the mapping from the input to the image. The box is widened to the input's proportions
/// and by [`WIDENING`].
fn scaling(person: &PersonBox) -> Scaling {
    let [rows, columns] = INPUT.map(|side| side as f64);
    let step = WIDENING * (person.width / columns).max(person.height / rows);
    let [x, y] = [person.left + 0.5 * person.width, person.top + 0.5 * person.height];
    Scaling { left: x - 0.5 * columns * step, top: y - 0.5 * rows * step, step }
}

/// Normalises by ImageNet's mean and deviation, in the network's order of colours.
fn normalise(channel: usize, level: f64) -> f32 {
    const MEAN: [f64; 3] = [0.485, 0.456, 0.406];
    const DEVIATION: [f64; 3] = [0.229, 0.224, 0.225];
    #[expect(clippy::cast_possible_truncation, reason = "the network's numbers are f32")]
    let value = ((level / 255.0 - MEAN[channel]) / DEVIATION[channel]) as f32;
    value
}

/// The maximum of a map.
struct Peak {
    /// Column and row, in cells.
    at: [f64; 2],
    height: f32,
}

/// Returns the maximum of a map, moved by a quarter of a cell towards the higher neighbour along
/// each axis. At the map's edges it is not moved. `None` if nothing is positive.
fn decode((rows, columns): (usize, usize), value: impl Fn(usize, usize) -> f32) -> Option<Peak> {
    let mut best = ([0, 0], 0.0);
    for row in 0..rows {
        for column in 0..columns {
            if value(row, column) > best.1 {
                best = ([row, column], value(row, column));
            }
        }
    }
    let ([row, column], height) = best;
    if height <= 0.0 {
        return None;
    }
    let mut at = [column as f64, row as f64];
    if 1 < row && row < rows - 1 && 1 < column && column < columns - 1 {
        let slopes = [
            value(row, column + 1) - value(row, column - 1),
            value(row + 1, column) - value(row - 1, column),
        ];
        for (at, slope) in at.iter_mut().zip(slopes) {
            if slope != 0.0 {
                *at += 0.25 * f64::from(slope.signum());
            }
        }
    }
    Some(Peak { at, height })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with Microsoft's `get_affine_transform` for this box, by its own formulas: centre
    /// 300, 250, scale 2.
    #[test]
    fn boxes_are_widened_to_three_by_four() {
        let person = PersonBox { left: 220.0, top: 100.0, width: 160.0, height: 300.0 };
        let scaling = scaling(&person);
        assert!((scaling.step - 375.0 / 256.0).abs() < 1e-12);
        let close = |[x, y]: [f64; 2], expected: [f64; 2]| {
            assert!((x - expected[0]).abs() < 1e-9 && (y - expected[1]).abs() < 1e-9, "{x} {y}");
        };
        close(scaling.source([96.0, 128.0]), [300.0, 250.0]);
        close(scaling.source([96.0, 0.0]), [300.0, 62.5]);
        close(scaling.source([0.0, 128.0]), [300.0 - 0.5 * 281.25, 250.0]);
    }

    /// A smooth image, mapped by OpenCV with Microsoft's matrix, by `tests/data/pose.py`. OpenCV
    /// rounds positions to a 32nd of a pixel, which changes the result by less than a level here.
    #[test]
    fn the_network_input_agrees_with_opencv() {
        let golden: serde_json::Value =
            serde_json::from_str(include_str!("../../tests/data/pose.json")).unwrap();
        let level = |row: usize, column: usize, colour: usize| {
            let [row, column, colour] = [row, column, colour].map(|index| index as f64);
            127.5 + 120.0 * (row / 17.0 + colour).sin() * (column / 23.0 - colour).cos()
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "levels of a byte"
        )]
        let image = ndarray::Array3::from_shape_fn((120, 160, 3), |(row, column, colour)| {
            level(row, column, colour).round_ties_even() as u8
        });
        let person = PersonBox { left: 50.0, top: 20.0, width: 45.0, height: 90.0 };
        let mut input = ndarray::Array3::zeros((3, INPUT[0], INPUT[1]));
        #[expect(clippy::cast_possible_truncation, reason = "levels of a byte")]
        let as_it_is = |_, level: f64| level as f32;
        scaling(&person).sample(&image.view(), 0.0, as_it_is, input.view_mut());
        let seen = input.permuted_axes([1, 2, 0]);
        let expected = golden["affine"].as_array().unwrap();
        let seen = seen.slice(s![..;5, ..;5, ..]);
        assert_eq!(seen.len(), expected.len());
        for (&seen, expected) in seen.iter().zip(expected) {
            let error = f64::from(seen) - expected.as_f64().unwrap();
            assert!(error.abs() <= 1.0, "{seen} instead of {expected}");
        }
    }

    #[test]
    fn a_maximum_moves_towards_its_higher_neighbour() {
        let map = |peak: [usize; 2], higher: [usize; 2]| {
            move |row: usize, column: usize| match [row, column] {
                at if at == peak => 0.9,
                at if at == higher => 0.5,
                _ => 0.0,
            }
        };
        let at = |peak, higher| decode((8, 6), map(peak, higher)).map(|peak| peak.at);
        assert_eq!(at([4, 3], [4, 4]), Some([3.25, 4.0]));
        assert_eq!(at([4, 3], [4, 2]), Some([2.75, 4.0]));
        assert_eq!(at([4, 3], [5, 3]), Some([3.0, 4.25]));
        assert_eq!(at([4, 3], [3, 3]), Some([3.0, 3.75]));
        // The second row and column count as the edge, as in Microsoft's code.
        assert_eq!(at([1, 3], [2, 3]), Some([3.0, 1.0]));
        assert_eq!(at([7, 3], [6, 3]), Some([3.0, 7.0]));
        assert!(decode((8, 6), |_, _| -0.1).is_none());
    }
}
