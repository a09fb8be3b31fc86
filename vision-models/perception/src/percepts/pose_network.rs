//! Finds joints by a pose network.

use std::path::Path;

use vision_models::{
    BlazePose, BlazePoseSettings, GroupingSettings, ImageBody, NetworkKind, OpenPose, Options,
    Passes, PersonBox, SimpleBaseline, TensorFlowLite,
};

use super::pose_source::{Frame, PoseSource};
use crate::{error::Error, networks::checkpoint::open_weights, watch::Watch};

/// Number of rows of OpenPose's input. The columns follow from the proportions.
const ROWS: f64 = 368.0;

/// The pose network that a checkpoint holds:
/// - A simple baseline finds one person, in the box where the tracker expects them or around the
///   nearest person of the depth image.
/// - OpenPose finds all people.
/// - BlazePose finds people and tracks them.
#[derive(Debug)]
pub struct PoseNetwork {
    network: Network,
}

#[derive(Debug)]
enum Network {
    SimpleBaseline(Box<SimpleBaseline>),
    OpenPose(Box<OpenPose>),
    BlazePose(Box<BlazePose>),
}

/// The file of MediaPipe's package that holds BlazePose's detector.
const DETECTOR: &str = "pose_solution_packed_assets.data";

impl PoseNetwork {
    /// Loads the network for images of this width and height (pixels). `detector` and `most` are
    /// for BlazePose: its detector, by default MediaPipe's file beside the landmarks, and the
    /// largest number of tracked people.
    ///
    /// # Errors
    /// Names the checkpoint. If it holds another network, the error says which.
    pub fn load(
        weights: &Path,
        (detector, most): (Option<&Path>, usize),
        [width, height]: [usize; 2],
        passes: Passes,
        threads: usize,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let options = Options { threads, ..Options::default() };
        if TensorFlowLite::is_in(weights) {
            let beside = weights.with_file_name(DETECTOR);
            return Self::blaze_pose(weights, detector.unwrap_or(&beside), most, options);
        }
        let checkpoint = open_weights(weights, watch)?;
        let of_file = Error::content(weights);
        let none =
            |found: String, wanted: &str| Err(Error::unfit(weights.display(), found, wanted));
        let network = match NetworkKind::of(&checkpoint) {
            Some(NetworkKind::SimpleBaseline(_)) => {
                let network =
                    SimpleBaseline::load(checkpoint, passes, options).map_err(&of_file)?;
                Network::SimpleBaseline(Box::new(network))
            }
            Some(NetworkKind::OpenPose(_)) => {
                let columns = (ROWS * width as f64 / height as f64).round();
                #[expect(
                    clippy::cast_possible_truncation,
                    clippy::cast_sign_loss,
                    reason = "as large as an image"
                )]
                let size = [ROWS as usize, columns as usize];
                let network = OpenPose::load(checkpoint, size, options).map_err(&of_file)?;
                Network::OpenPose(Box::new(network))
            }
            Some(other) => {
                let wanted = "give the weights of a simple baseline or of OpenPose";
                return none(format!("this is a {other}"), wanted);
            }
            None => {
                return none(
                    "no pose network that is known has these tensors".to_owned(),
                    "give the weights of a simple baseline (Microsoft's or mmpose's) or of OpenPose (COCO-18)",
                );
            }
        };
        Ok(Self { network })
    }

    /// Loads BlazePose from its landmarks and its detector, for at most this many people.
    ///
    /// # Errors
    /// Names the file that does not fit.
    fn blaze_pose(
        landmarks: &Path,
        detector: &Path,
        most: usize,
        options: Options,
    ) -> Result<Self, Error> {
        let open = |file: &Path| TensorFlowLite::open(file).map_err(Error::content(file));
        let settings = BlazePoseSettings { most, ..BlazePoseSettings::default() };
        let network = BlazePose::load(open(detector)?, open(landmarks)?, settings, options);
        let network = network.map_err(Error::content(landmarks))?;
        Ok(Self { network: Network::BlazePose(Box::new(network)) })
    }
}

impl PoseSource for PoseNetwork {
    fn people(&mut self, frame: &Frame<'_>) -> Result<Option<Vec<ImageBody>>, Error> {
        let image = frame.colour.read()?;
        let (rows, columns, _) = image.dim();
        let size = frame.depth.size();
        if [columns, rows] != size {
            let [width, height] = size;
            let found =
                format!("{columns} × {rows} pixels, but the depth image has {width} × {height}");
            return Err(Error::at(frame.colour.name().display(), found));
        }
        match &mut self.network {
            Network::OpenPose(network) => {
                Ok(Some(network.estimate(image.view(), &GroupingSettings::default())?))
            }
            Network::BlazePose(network) => {
                let people = network.estimate(frame.entry.time, image.view())?;
                Ok(Some(people.iter().map(|person| person.body().image).collect()))
            }
            Network::SimpleBaseline(network) => {
                let nearest = || PersonBox::nearest(frame.camera, frame.depth);
                let Some(person) = frame.expected.or_else(nearest) else {
                    return Ok(Some(Vec::new()));
                };
                Ok(Some(vec![network.estimate(image.view(), &person)?]))
            }
        }
    }
}
