//! Counts of people in the images, to explain why none was found.

use vision_models::{DepthImage, ImageBody, LiftingSettings};

use crate::error::Error;

/// Counts of people and joints in the images so far, and the depths there.
#[derive(Clone, Debug, Default)]
pub(super) struct Sightings {
    frames: u64,
    /// Number of frames that were not searched for people.
    unlooked: u64,
    people: u64,
    joints: u64,
    /// Number of joints with a depth at which a person can be.
    reachable: u64,
    /// Depths of joints, up to the largest number that is kept (m).
    depths: Vec<f32>,
}

/// Largest number of depths that are kept for the median.
const KEPT: usize = 4096;

impl Sightings {
    /// Counts the people in a frame. `None` if it was not searched.
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

    /// Checks that people could be found, after all frames were processed and none was found.
    ///
    /// # Errors
    /// The reason why none could be found: no file of joints matches a frame, joints are outside
    /// the images, or depths are out of range.
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

/// Returns the pixel at a position in an image of this width and height.
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
