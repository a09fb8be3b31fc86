//! Networks that find people's joints in an image.
// Views are small. They are passed by value, as usual with ndarray.
#![allow(clippy::needless_pass_by_value)]

mod blaze_pose;
mod grouping;
mod nearest_person;
mod open_pose;
mod person_box;
mod sampling;
mod simple_baseline;

pub use blaze_pose::{BlazePose, BlazePoseSettings, Landmark, Landmarks, PoseRegion};
pub use grouping::{Coco18, GroupingSettings, group_parts};
pub use open_pose::OpenPose;
pub use person_box::PersonBox;
pub use simple_baseline::{Passes, SimpleBaseline};
