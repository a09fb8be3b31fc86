//! The JSON in which pose programs write joints.

mod arrays;
mod body_25b;
mod instances;
mod keypoints;
mod landmarks;
mod openpose;

use serde::Deserialize;
use serde_json::value::RawValue;

use self::arrays::{Bounded, for_each};
use super::observed::ObservedBody;
use crate::error::Error;
use crate::excerpt::Excerpt;

/// People in one image of a camera, read from a file of joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFrame {
    /// Number of the image in the file, or its index there, from 0, if the file gives no number.
    pub number: u64,
    /// People in the image.
    pub people: Vec<ObservedBody>,
}

/// Entries that an object may hold. Names are those of the programs.
#[derive(Deserialize)]
struct Entry<'a> {
    /// OpenPose's, an image.
    #[serde(borrow)]
    people: Option<&'a RawValue>,
    /// A film of mmpose's demo.
    #[serde(borrow, alias = "frames")]
    instance_info: Option<&'a RawValue>,
    /// An image of mmpose.
    #[serde(borrow)]
    instances: Option<&'a RawValue>,
    #[serde(borrow, alias = "frame", alias = "frame_number", alias = "frame_index")]
    frame_id: Option<&'a RawValue>,
    /// COCO's and AlphaPose's.
    #[serde(borrow)]
    image_id: Option<&'a RawValue>,
    /// A person of COCO, AlphaPose and mmpose.
    #[serde(borrow)]
    keypoints: Option<&'a RawValue>,
    #[serde(borrow)]
    keypoint_scores: Option<&'a RawValue>,
    /// MediaPipe's, in the image.
    #[serde(borrow, alias = "landmark", alias = "pose_landmarks", alias = "poseLandmarks")]
    landmarks: Option<&'a RawValue>,
    /// MediaPipe's, in metres.
    #[serde(
        borrow,
        alias = "poseWorldLandmarks",
        alias = "world_landmarks",
        alias = "worldLandmarks"
    )]
    pose_world_landmarks: Option<&'a RawValue>,
}

impl JointFrame {
    /// Largest number of people read per image.
    pub const MAX_PEOPLE: usize = 64;

    /// Largest size of a text (bytes).
    pub const LARGEST: u64 = 512 << 20;

    /// Reads the joints of an image, or of all images of a film, in the order of their numbers:
    ///
    /// - OpenPose's files and those that look like them, as Pose2Sim writes them: `pose_keypoints_2d` of
    ///   [any layout](crate::JointLayout), told by the number of joints; BODY_25 and BODY_25B by where neck and mid hip lie;
    /// - mmpose's predictions (RTMPose), of an image or of a film;
    /// - results as COCO and AlphaPose write them, a person an entry, with `image_id`;
    /// - MediaPipe's landmarks, in the image and in metres, of one person or several, of one image or an array of images.
    ///   Those in the image are parts of its width and height: `size` in pixels is needed for them.
    ///
    /// Joints of zeros were not seen, confidences above 1 count as 1. An image without people can be missing. An object
    /// takes at most five times the text's size and 128 KiB of memory, an array thirty times its size.
    ///
    /// ```
    /// use vision_models::{Body25, JointFrame};
    ///
    /// let nothing = "0,0,0,".repeat(24);
    /// let json = format!(r#"{{"people":[{{"pose_keypoints_2d":[{nothing}5,6,0.7]}}]}}"#);
    /// let frames = JointFrame::from_json(json.as_bytes(), None)?;
    /// let heel = frames[0].people[0].image.get(Body25::RightHeel).expect("seen");
    /// assert_eq!((heel.position.x, heel.confidence.value()), (5.0, 0.7));
    /// # Ok::<(), vision_models::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Malformed`] for what is no such JSON, with the place that is wrong and what would be right.
    pub fn from_json(json: &[u8], size: Option<[usize; 2]>) -> Result<Vec<Self>, Error> {
        if json.len() as u64 > Self::LARGEST {
            return Err(refuse(&format!(
                "{} bytes, at most {} are read",
                json.len(),
                Self::LARGEST
            )));
        }
        let json = json.strip_prefix("\u{feff}".as_bytes()).unwrap_or(json);
        let text: &RawValue = serde_json::from_slice(json).map_err(|error| of_syntax(&error))?;
        let mut frames = Vec::new();
        if !text.get().starts_with('[') {
            match object(text, size)? {
                Found::Film(list) => film(list, size, &mut frames)?,
                Found::Frame(number, people) => push(&mut frames, number.unwrap_or(0), people)?,
                Found::Person(number, person) => {
                    push(&mut frames, number.unwrap_or(0), vec![*person])?;
                }
            }
            if frames.is_empty() {
                frames.push(Self { number: 0, people: Vec::new() });
            }
        } else if landmarks::is_person(text) {
            push(&mut frames, 0, landmarks::people(Some(text), None, size)?)?;
        } else {
            film(text, size, &mut frames)?;
        }
        frames.sort_by_key(|frame| frame.number);
        frames.dedup_by(|again, frame| {
            let is_same = again.number == frame.number;
            if is_same {
                frame.people.append(&mut again.people);
            }
            is_same
        });
        frames.iter().try_for_each(|frame| check_people(frame.people.len()))?;
        Ok(frames)
    }
}

/// Kind of an object.
enum Found<'a> {
    Film(&'a RawValue),
    Frame(Option<u64>, Vec<ObservedBody>),
    Person(Option<u64>, Box<ObservedBody>),
}

fn object(text: &RawValue, size: Option<[usize; 2]>) -> Result<Found<'_>, Error> {
    let entry: Entry<'_> = serde_json::from_str(text.get()).map_err(|error| of_syntax(&error))?;
    let number = |text: Option<&RawValue>| text.map(number).transpose();
    if let Some(people) = entry.people {
        return Ok(Found::Frame(number(entry.frame_id)?, openpose::people(people)?));
    }
    if let Some(list) = entry.instance_info {
        return Ok(Found::Film(list));
    }
    if let Some(instances) = entry.instances {
        return Ok(Found::Frame(number(entry.frame_id)?, instances::people(instances)?));
    }
    if let Some(keypoints) = entry.keypoints {
        let person = instances::person(keypoints, entry.keypoint_scores)?;
        return Ok(Found::Person(number(entry.image_id)?, Box::new(person)));
    }
    if entry.landmarks.is_some() || entry.pose_world_landmarks.is_some() {
        let people = landmarks::people(entry.landmarks, entry.pose_world_landmarks, size)?;
        return Ok(Found::Frame(number(entry.frame_id)?, people));
    }
    Err(refuse("an object without joints"))
}

/// An array: of images, or of people with the number of their image each; without one they are in the same image.
fn film(
    list: &RawValue,
    size: Option<[usize; 2]>,
    frames: &mut Vec<JointFrame>,
) -> Result<(), Error> {
    for_each(list, |index, text| {
        let index = index as u64;
        match text.get().as_bytes().first() {
            Some(b'{') => match object(text, size)? {
                Found::Film(_) => Err(refuse("a film in a film")),
                Found::Frame(number, people) => push(frames, number.unwrap_or(index), people),
                Found::Person(number, person) => push(frames, number.unwrap_or(0), vec![*person]),
            },
            Some(b'[' | b'n') => push(frames, index, landmarks::people(Some(text), None, size)?),
            _ => Err(refuse(&format!("{} as element {index}", Excerpt(text.get())))),
        }
    })
}

/// Adds people to the last image, if that is theirs.
fn push(frames: &mut Vec<JointFrame>, number: u64, people: Vec<ObservedBody>) -> Result<(), Error> {
    let found = match frames.last_mut().filter(|last| last.number == number) {
        Some(last) => {
            last.people.extend(people);
            last.people.len()
        }
        None if people.is_empty() => 0,
        None => {
            frames.push(JointFrame { number, people });
            1
        }
    };
    check_people(found)
}

fn check_people(found: usize) -> Result<(), Error> {
    let most = JointFrame::MAX_PEOPLE;
    if found > most {
        return Err(refuse(&format!("{found} people, at most {most} are read")));
    }
    Ok(())
}

/// The people of one image, each as they stand in the text.
fn listed(list: &RawValue) -> Result<Vec<&RawValue>, Error> {
    let people: Bounded<'_, { JointFrame::MAX_PEOPLE }> =
        serde_json::from_str(list.get()).map_err(|error| of_syntax(&error))?;
    check_people(people.count)?;
    Ok(people.first)
}

/// The number of an image, or the one at the end of its name.
fn number(text: &RawValue) -> Result<u64, Error> {
    let name: Option<String> = serde_json::from_str(text.get()).ok();
    let name = name.as_deref().unwrap_or(text.get());
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let digits = &stem[stem.trim_end_matches(|last: char| last.is_ascii_digit()).len()..];
    let refused = || refuse(&format!("{} as the number of an image", Excerpt(text.get())));
    digits.parse().map_err(|_| refused())
}

fn of_syntax(error: &serde_json::Error) -> Error {
    refuse(&Excerpt(&error.to_string()).to_string())
}

fn refuse(problem: &str) -> Error {
    let wanted = "give OpenPose's \"people\", mmpose's or COCO's \"keypoints\", or MediaPipe's \"landmarks\"";
    Error::malformed("no JSON of joints", format!("{problem}; {wanted}"))
}
