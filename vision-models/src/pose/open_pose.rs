//! The joints of all people in an image.

use nalgebra::Point2;
use ndarray::{Array4, ArrayView3, ArrayView4, Axis, s};

use crate::body::{ImageBody, ImageKeypoint, JointLayout};
use crate::engine::{Network, Options, Threads, too_large, wrong_input};
use crate::error::Error;
use crate::networks::{NetworkKind, OpenPoseForm};
use crate::weights::TensorSource;

use super::grouping::{GroupingSettings, group_parts};
use super::sampling::{Scaling, check_image};

/// OpenPose's body network with COCO's eighteen joints. It finds all people in an image at once,
/// without boxes. Users need its weights, whose licence is non-commercial.
///
/// Z. Cao, T. Simon, S.-E. Wei and Y. Sheikh, "Realtime multi-person 2D pose estimation using part
/// affinity fields", CVPR 2017.
///
/// It needs much computation: 366 GFLOP for 368 × 496 pixels, 34 times as much as
/// [`SimpleBaseline`](crate::SimpleBaseline).
///
/// ```no_run
/// use vision_models::{Checkpoint, GroupingSettings, OpenPose, Options, read_image};
///
/// let weights = Checkpoint::open("body_pose_model.pth")?;
/// let mut network = OpenPose::load(weights, [368, 496], Options::default())?;
/// let image = read_image("frame.jpg")?;
/// for body in network.estimate(image.view(), &GroupingSettings::default())? {
///     println!("{} joints", body.iter().count());
/// }
/// # Ok::<(), vision_models::Error>(())
/// ```
#[derive(Debug)]
pub struct OpenPose {
    network: Network,
    /// The network's input.
    input: Array4<f32>,
}

/// Pixels of the input per cell of the maps.
const CELL: usize = 8;
/// Grey level around the image.
const GREY: f64 = 128.0;

impl OpenPose {
    /// Returns the names and shapes of the tensors that a checkpoint must hold.
    pub fn parameters(form: OpenPoseForm) -> Vec<(String, Vec<usize>)> {
        NetworkKind::OpenPose(form).parameters(0)
    }

    /// Loads a checkpoint with names of either form. Images are scaled to fit `height` × `width`
    /// pixels, rounded up to multiples of eight. OpenPose itself uses a height of 368.
    ///
    /// # Errors
    /// - [`Error::Weights`] with every tensor that is missing, surplus or of the wrong shape.
    /// - [`Error::Value`] if a weight is not finite.
    /// - [`Error::Size`] if the size does not fit.
    /// - [`Error::Threads`] if this number of threads cannot be started.
    pub fn load(
        tensors: impl TensorSource,
        [height, width]: [usize; 2],
        options: Options,
    ) -> Result<Self, Error> {
        let form = OpenPoseForm::guess(&tensors.names());
        let whole = |side: usize| side.checked_next_multiple_of(CELL);
        let size = [1, height, width];
        let (Some(rows), Some(columns)) = (whole(height), whole(width)) else {
            return Err(too_large(size));
        };
        let kind = NetworkKind::OpenPose(form);
        let network = kind.load(Box::new(tensors), [1, rows, columns], options)?;
        Ok(Self { network, input: Array4::zeros((1, 3, rows, columns)) })
    }

    /// Makes the network run on other threads, which networks may share.
    ///
    /// # Errors
    /// Those of [`Network::share_threads`].
    pub fn share_threads(&mut self, threads: &Threads) -> Result<(), Error> {
        self.network.share_threads(threads)
    }

    /// Returns the number of multiplications and additions for one image.
    pub fn operations(&self) -> u64 {
        self.network.operations()
    }

    /// Returns the maps of prepared images, N × 3 × height × width (blue, green, red, each level v
    /// as v/256 − 1/2). They are the limbs' fields, N × 38 × rows × columns, and the joints' maps,
    /// N × 19 × rows × columns. To find people, use [`Self::estimate`].
    ///
    /// # Errors
    /// Those of [`Network::infer`].
    pub fn maps(&mut self, images: ArrayView4<'_, f32>) -> Result<[ArrayView4<'_, f32>; 2], Error> {
        maps(&mut self.network, images)
    }

    /// Returns the joints of all people in the image, height × width × 3 (red, green, blue).
    ///
    /// # Errors
    /// - [`Error::Size`] if the image has no pixels or not three channels.
    /// - [`Error::Value`] if a setting is out of range.
    /// - [`Error::Overflow`] if activations overflow.
    pub fn estimate(
        &mut self,
        image: ArrayView3<'_, u8>,
        settings: &GroupingSettings,
    ) -> Result<Vec<ImageBody>, Error> {
        let [height, width] = check_image(&image)?;
        settings.validate()?;
        let (_, _, rows, columns) = self.input.dim();
        // Pixels of the image per pixel of the input. The centres of pixels are half a pixel from
        // the edges.
        let step = (height as f64 / rows as f64).max(width as f64 / columns as f64);
        let scaling = Scaling { left: 0.5 * step - 0.5, top: 0.5 * step - 0.5, step };
        let blue_first = image.slice(s![.., .., ..;-1]);
        #[expect(clippy::cast_possible_truncation, reason = "the network's numbers are f32")]
        let normalise = |_, level: f64| (level / 256.0 - 0.5) as f32;
        scaling.sample(&blue_first, GREY, normalise, self.input.index_axis_mut(Axis(0), 0));
        let [fields, joints] = maps(&mut self.network, self.input.view())?;
        let first = |maps: ArrayView4<'_, f32>| maps.index_axis_move(Axis(0), 0).to_owned();
        let people = group_parts(first(joints).view(), first(fields).view(), settings)?;
        let place = |keypoint: ImageKeypoint| {
            let pixel = |cell: f64| (cell + 0.5) * CELL as f64 - 0.5;
            let [x, y] = scaling.source([pixel(keypoint.position.x), pixel(keypoint.position.y)]);
            ImageKeypoint { position: Point2::new(x, y), ..keypoint }
        };
        let body =
            |person: super::Coco18| JointLayout::Coco18.body(&person.map(|joint| joint.map(place)));
        Ok(people.into_iter().map(body).collect())
    }
}

/// Returns the network's fields and joints.
fn maps<'a>(
    network: &'a mut Network,
    images: ArrayView4<'_, f32>,
) -> Result<[ArrayView4<'a, f32>; 2], Error> {
    let shape = images.shape().to_vec();
    let inference = network.infer(images.insert_axis(Axis(2)))?;
    let map = |index| -> Result<ArrayView4<'a, f32>, Error> {
        let map = inference.map(index).ok_or_else(|| wrong_input(&shape))?;
        Ok(map.index_axis_move(Axis(2), 0))
    };
    Ok([map(0)?, map(1)?])
}
