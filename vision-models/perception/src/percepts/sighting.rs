//! What was seen of people before anything was made of it, and why nothing came of it.

use vision_models::{DepthImage, ImageBody, LiftingSettings};

use crate::error::Error;

/// People and joints in the images so far, and the depths there.
#[derive(Clone, Debug, Default)]
pub(super) struct Sightings {
    frames: u64,
    /// Frames in which nobody looked for people.
    unlooked: u64,
    people: u64,
    joints: u64,
    /// Joints with a depth at which a person can be.
    reachable: u64,
    /// Every depth of a joint, within the most that is kept (m).
    depths: Vec<f32>,
}

/// Depths that are kept for the median.
const KEPT: usize = 4096;

impl Sightings {
    /// Takes the people in a frame; `None` where nobody looked.
    pub(super) fn push(&mut self, people: Option<&[ImageBody]>, depth: &DepthImage) {
        self.frames += 1;
        let Some(people) = people else {
            self.unlooked += 1;
            return;
        };
        self.people += people.len() as u64;
        let [nearest, farthest] = LiftingSettings::default().range;
        for (_, keypoint) in people.iter().flat_map(ImageBody::iter) {
            self.joints += 1;
            let Some([column, row]) = pixel(keypoint.position.into(), depth.size()) else {
                continue;
            };
            let Some(depth) = depth.depth(column, row) else { continue };
            self.reachable += u64::from((nearest..=farthest).contains(&f64::from(depth)));
            if self.depths.len() < KEPT {
                self.depths.push(depth);
            }
        }
    }

    /// Checks that somebody could be found, once all frames were looked at and nobody was.
    ///
    /// # Errors
    /// Why nobody could be: no file of joints is of a frame, joints outside the images, or depths at which nobody is.
    pub(super) fn check(mut self, expected: Option<&str>) -> Result<(), Error> {
        let Self { frames, unlooked, people, joints, .. } = self;
        if frames > 0 && unlooked == frames {
            let expected = expected.unwrap_or("one for each");
            return Err(Error::unfit(
                "no frame has a file of joints",
                format!(
                    "{expected} is looked for first, by the number of the frame in frames.jsonl"
                ),
                "name the files by it",
            ));
        }
        if joints == 0 || self.reachable > 0 {
            return Ok(());
        }
        let seen = format!("{joints} joints of {people} people were seen");
        self.depths.sort_unstable_by(f32::total_cmp);
        let [nearest, farthest] = LiftingSettings::default().range;
        match self.depths.get(self.depths.len() / 2) {
            Some(median) => Err(Error::unfit(
                format!("{seen}, but none at a depth from {nearest} to {farthest} m"),
                format!("half of them are nearer than {median} m"),
                "check depth_scale in camera.json, which is what a unit of the depth images is in metres",
            )),
            None => Err(Error::at(
                format!("{seen}, but at none of them is there a depth in the depth images"),
                "joints are pixels of the depth image, as large as camera.json says",
            )),
        }
    }
}

/// The pixel at a place of an image of this width and height.
fn pixel(place: [f64; 2], size: [usize; 2]) -> Option<[usize; 2]> {
    let within = |(place, size): (f64, usize)| {
        let rounded = place.round();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "it is within the image"
        )]
        ((0.0..size as f64).contains(&rounded)).then_some(rounded as usize)
    };
    let [x, y] = place;
    let [width, height] = size;
    Some([within((x, width))?, within((y, height))?])
}
