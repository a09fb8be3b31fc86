//! A camera on the ROS graph.

use std::fmt;
use std::io::ErrorKind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

use nalgebra::Isometry3;
use ndarray::Array3;
use ros2_client::dds::rustdds::mio1::{Events, Interest, Poll, Token};
use serde::Serialize;
use vision_models::Intrinsics;

use super::domain::RosDomain;
use super::error::Ros2Error;
use super::frame_pairs::{CameraImages, FramePairs};
use super::frame_tree::FrameTree;
use super::inbox::Inbox;
use super::messages::{CameraInfo, Image, TfMessage};
use super::node::RosNode;
use super::peers::Peers;
use super::people_publisher::PeoplePublisher;
use super::pictures::colour_of;
use super::report::TopicReport;
use super::side::{Ending, spawn};
use super::stamps::Stamps;
use super::topic::Topic;
use super::wakes::WAKES;
use crate::topic_names::TopicNames;

/// Longest time after which a wait notices that it should end.
const LOOK: Duration = Duration::from_millis(20);

/// Images of a moment, and when they came.
#[derive(Clone, Debug)]
pub struct ReceivedImages {
    /// Number of the moment, counted from 0. Missing numbers were overtaken.
    pub number: u64,
    /// Colour and depth.
    pub images: CameraImages,
    /// Newest colour image of the on-board camera: height × width × 3.
    pub on_board: Option<Arc<Array3<u8>>>,
    /// Moment at which the second image came.
    pub came: Instant,
}

/// Messages of a camera, and the images that were not processed, by reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraReport {
    /// Images of moments that a newer one overtook.
    pub overtaken: u64,
    /// Images whose other half, colour or depth, never came.
    pub unpaired: u64,
    /// Messages of each topic: those that were taken, lost, and refused by reason.
    pub topics: Vec<TopicReport>,
}

/// A camera on the ROS graph with colour, aligned depth and its geometry, as `realsense2_camera` publishes them.
///
/// A thread takes all messages. The newest images wait for [`next`](Self::next); older ones are counted as overtaken.
pub struct Ros2Camera {
    shared: Arc<Shared>,
    ending: Ending,
    reader: JoinHandle<Result<(Vec<TopicReport>, u64), Ros2Error>>,
}

impl fmt::Debug for Ros2Camera {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ros2Camera").finish_non_exhaustive()
    }
}

/// Data that the thread of messages leaves for the other one.
#[derive(Default)]
struct Shared {
    waiting: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Default)]
struct Waiting {
    intrinsics: Option<Intrinsics>,
    /// Frame of the images.
    frame: String,
    frames: FrameTree,
    newest: Option<ReceivedImages>,
    on_board: Option<Arc<Array3<u8>>>,
    moments: u64,
    overtaken: u64,
    has_ended: bool,
}

impl Ros2Camera {
    /// Joins a domain as the node `moca_perception`. Also returns the publisher of its results. An on-board camera is
    /// listened to if `on_board`.
    ///
    /// # Errors
    /// [`Ros2Error::Create`]
    pub fn join(
        domain: RosDomain,
        names: &TopicNames,
        on_board: bool,
    ) -> Result<(Self, PeoplePublisher), Ros2Error> {
        let mut node = RosNode::join(domain, "moca_perception", names)?;
        let publisher = PeoplePublisher::new(&mut node)?;
        let shared = Arc::new(Shared::default());
        let reader = Reader::new(node, shared.clone(), on_board)?;
        let ending = Ending(Arc::new(AtomicBool::new(false)));
        let reads = ending.0.clone();
        let reader = spawn("ros2-camera", move || reader.run(&reads))?;
        Ok((Self { shared, ending, reader }, publisher))
    }

    /// Waits for the camera's geometry. Returns `None` after `wait`, when `stop` returns true, or after the connection's end.
    pub fn intrinsics(&self, wait: Duration, stop: impl Fn() -> bool) -> Option<Intrinsics> {
        self.shared.wait(wait, stop, |waiting| waiting.intrinsics)
    }

    /// Waits for the place of the camera in a frame, by the transforms on the graph that stay valid. Returns `None` after
    /// `wait`, when `stop` returns true, or after the connection's end.
    pub fn pose(
        &self,
        within: &str,
        wait: Duration,
        stop: impl Fn() -> bool,
    ) -> Option<Isometry3<f64>> {
        let now = SystemTime::now();
        self.shared.wait(wait, stop, |waiting| waiting.frames.pose(&waiting.frame, within, now))
    }

    /// Waits for the newest images. Returns `None` after `wait`, when `stop` returns true, or after the connection's end.
    pub fn next(&self, wait: Duration, stop: impl Fn() -> bool) -> Option<ReceivedImages> {
        self.shared.wait(wait, stop, |waiting| waiting.newest.take())
    }

    /// Returns the number of images that a newer one overtook.
    pub fn overtaken(&self) -> u64 {
        self.shared.lock().overtaken
    }

    /// Closes the connection, and returns what came and what was not processed.
    ///
    /// # Errors
    /// The error that ended the thread.
    pub fn close(self) -> Result<CameraReport, Ros2Error> {
        self.ending.begin();
        let joined = self.reader.join().map_err(|_| Ros2Error::Ended { does: "takes" })?;
        let (topics, unpaired) = joined?;
        Ok(CameraReport { overtaken: self.shared.lock().overtaken, unpaired, topics })
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until `ready` gives something.
    fn wait<T>(
        &self,
        wait: Duration,
        stop: impl Fn() -> bool,
        mut ready: impl FnMut(&mut Waiting) -> Option<T>,
    ) -> Option<T> {
        let begun = Instant::now();
        let mut waiting = self.lock();
        loop {
            if let Some(found) = ready(&mut waiting) {
                return Some(found);
            }
            if waiting.has_ended || begun.elapsed() >= wait || stop() {
                return None;
            }
            let woken = self.changed.wait_timeout(waiting, LOOK);
            (waiting, _) = woken.unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn update(&self, change: impl FnOnce(&mut Waiting)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }
}

/// The thread that takes messages.
struct Reader {
    poll: Poll,
    peers: Peers,
    infos: Inbox<CameraInfo>,
    transforms: Inbox<TfMessage>,
    colours: Inbox<Image>,
    depths: Inbox<Image>,
    on_board: Option<Inbox<Image>>,
    on_board_stamps: Stamps,
    pairs: FramePairs,
    shared: Arc<Shared>,
    /// Keeps the connection open.
    _node: RosNode,
}

impl Reader {
    fn new(mut node: RosNode, shared: Arc<Shared>, on_board: bool) -> Result<Self, Ros2Error> {
        let topics = [
            Topic::CameraInfo,
            Topic::StaticTransforms,
            Topic::Colour,
            Topic::Depth,
            Topic::OnBoardColour,
        ];
        let mut reader = Self {
            poll: Poll::new().map_err(|error| Ros2Error::create("a poll", &error))?,
            peers: node.peers(topics.to_vec()),
            infos: node.inbox(Topic::CameraInfo)?,
            transforms: node.inbox(Topic::StaticTransforms)?,
            colours: node.inbox(Topic::Colour)?,
            depths: node.inbox(Topic::Depth)?,
            on_board: on_board.then(|| node.inbox(Topic::OnBoardColour)).transpose()?,
            on_board_stamps: Stamps::of_camera(),
            pairs: FramePairs::default(),
            shared,
            _node: node,
        };
        let registry = reader.poll.registry();
        let images = [&mut reader.colours, &mut reader.depths];
        for (token, inbox) in images.into_iter().chain(&mut reader.on_board).enumerate() {
            registry
                .register(&mut inbox.subscription, Token(token), Interest::READABLE)
                .map_err(|error| Ros2Error::create("a poll", &error))?;
        }
        Ok(reader)
    }

    fn run(mut self, ending: &AtomicBool) -> Result<(Vec<TopicReport>, u64), Ros2Error> {
        let mut events = Events::with_capacity(8);
        let mut result = Ok(());
        while result.is_ok() && !ending.load(Ordering::Acquire) {
            result = match self.poll.poll(&mut events, Some(WAKES)) {
                Err(error) if error.kind() != ErrorKind::Interrupted => {
                    Err(Ros2Error::create("a wait for messages", &error))
                }
                _ => self.drain(),
            };
        }
        self.shared.update(|waiting| waiting.has_ended = true);
        result?;
        let images = [self.colours, self.depths].into_iter().chain(self.on_board);
        let images = images.map(|inbox| inbox.statistics);
        let of_place = [self.infos.statistics, self.transforms.statistics];
        let statistics = of_place.into_iter().chain(images);
        let reports = statistics.map(|mut statistics| {
            self.peers.count(&mut statistics);
            TopicReport::from(&statistics)
        });
        Ok((reports.collect(), self.pairs.unpaired()))
    }

    fn drain(&mut self) -> Result<(), Ros2Error> {
        self.peers.update();
        let Self { peers, pairs, shared, on_board_stamps, .. } = self;
        self.infos.drain(peers, |info, _| {
            pairs.take_info(info)?;
            shared.update(|waiting| {
                waiting.intrinsics = pairs.intrinsics();
                waiting.frame.clone_from(&info.header.frame_id);
            });
            Ok(None)
        })?;
        self.transforms.drain(peers, |transforms, _| {
            let mut taken = Ok(());
            shared.update(|waiting| taken = waiting.frames.take_static(transforms));
            taken.map(|()| None)
        })?;
        if let Some(inbox) = &mut self.on_board {
            inbox.drain(peers, |image, now| {
                let colour = Arc::new(colour_of(image)?);
                let age = on_board_stamps.admit(image.header.stamp, now)?;
                shared.update(|waiting| waiting.on_board = Some(colour));
                Ok(Some(age))
            })?;
        }
        self.colours.drain(peers, |image, now| {
            let (age, images) = pairs.take_colour(image, now)?;
            if let Some(images) = images {
                shared.leave(images);
            }
            Ok(Some(age))
        })?;
        self.depths.drain(peers, |image, now| {
            let (age, images) = pairs.take_depth(image, now)?;
            if let Some(images) = images {
                shared.leave(images);
            }
            Ok(Some(age))
        })
    }
}

impl Shared {
    /// Leaves images for the other thread, in place of older ones.
    fn leave(&self, images: CameraImages) {
        self.update(|waiting| {
            let on_board = waiting.on_board.clone();
            let (number, came) = (waiting.moments, Instant::now());
            waiting.moments += 1;
            let older = waiting.newest.replace(ReceivedImages { number, images, on_board, came });
            waiting.overtaken += u64::from(older.is_some());
        });
    }
}
