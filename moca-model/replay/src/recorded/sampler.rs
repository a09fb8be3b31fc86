//! Samples of ticks: poses, scores and limits as a row of numbers.

use ergo_map::{Conditions, ErgonomicsMap, PersonFrame, RebaSubScores};
use hrsw_safety::Capsule;
use moca_model::whole_body::{Data, FrameId, Model};
use moca_model::{Controller, ControllerSettings, GraspedObject, moca_safety};
use nalgebra::{Isometry3, Translation3, Vector3};
use vision_models::{Body, TrackedPerson};

use super::body::{self, BODY_POINTS, BodyPart, POINT_COUNT, Points};
use super::limit_use::{self, LimitUse};
use super::nearest::nearest;
use super::others_track;
use super::person_track::{self, PARTS, write_parts, write_points};
use super::replay::Replay;
use super::stage::{Role, Shape, Stage};
use super::table::{Encoding, Group, Table};
use super::{MapGrid, ReplayError};
use crate::report::TickRow;

/// Frames that every run has, beside those of the robot.
const OWN_FRAMES: [&str; 4] = ["tool", "desired", "workspace", "person"];

/// Names of the values that are one number a sample.
const SERIES: [&str; 25] = [
    "e_s",
    "REBA predicted",
    "REBA measured",
    "working together",
    "desired x",
    "desired y",
    "desired z",
    "actual x",
    "actual y",
    "actual z",
    "lower x",
    "lower y",
    "lower z",
    "upper x",
    "upper y",
    "upper z",
    "tracking error",
    "speed of the tool",
    "speed of the person",
    "slack of position",
    "slack of orientation",
    "share of ergonomics",
    "share of speed",
    "monitored distance",
    "protective distance",
];

/// Nearest points of robot and person, without the forearms, which work on the object.
const NEAREST: [&str; 8] = [
    "robot x",
    "robot y",
    "robot z",
    "person x",
    "person y",
    "person z",
    "distance",
    "of the forearms",
];

/// A frame that the caller moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameSlot(usize);

/// Makes a row of numbers of a tick, in the order of [`groups`](Self::groups).
///
/// ```
/// use ergo_map::{ErgonomicsMap, MapOptions, Person};
/// use moca_replay::recorded::Sampler;
/// use moca_model::{ControllerSettings, MOCA_URDF, moca};
///
/// let options = MapOptions { spacing: 0.3, ..MapOptions::default() };
/// let map = ErgonomicsMap::build(&Person::average(), &options, None)?;
/// let sampler = Sampler::new(&moca()?, MOCA_URDF, &ControllerSettings::default(), &map)?;
/// assert!(sampler.groups().iter().any(|group| group.name == "frames"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sampler {
    stage: Stage,
    map: ErgonomicsMap,
    model: Model,
    data: Data,
    robot: Vec<FrameId>,
    tool: FrameId,
    capsules: Vec<(usize, Capsule)>,
    /// Poses of frames that the caller moves.
    placed: Vec<Option<Isometry3<f64>>>,
    /// Object that the robot holds.
    object: Option<FrameSlot>,
    limits: LimitUse,
    /// Place of the tool at the last sample, and its time \[m, s\].
    actual: Option<(Vector3<f64>, f64)>,
}

/// Wood.
const OBJECT_COLOUR: [f64; 3] = [0.76, 0.6, 0.42];

impl Sampler {
    /// Takes a robot with the text of its URDF, which says what it looks like, and a person's map.
    ///
    /// # Errors
    /// [`ReplayError::Urdf`], or a tool or link that the robot does not have.
    pub fn new(
        model: &Model,
        urdf: &str,
        settings: &ControllerSettings,
        map: &ErgonomicsMap,
    ) -> Result<Self, ReplayError> {
        let mut stage = Stage::of_robot(model, urdf)?;
        let bodies = match &settings.safety.bodies {
            // Nothing is monitored; the distance is of interest all the same.
            none if none.is_empty() => moca_safety().bodies,
            bodies => bodies.clone(),
        };
        let known = bodies.iter().filter(|body| model.frame_id(&body.link).is_ok());
        let capsules = known.map(|body| (stage.add_frame(&body.link), body.capsule)).collect();
        let robot: Result<Vec<_>, _> =
            stage.frames().iter().map(|name| model.frame_id(name)).collect();
        for name in OWN_FRAMES {
            stage.add_frame(name);
        }
        Ok(Self {
            data: Data::new(model),
            robot: robot?,
            tool: model.frame_id(&settings.tool)?,
            placed: Vec::new(),
            object: None,
            limits: LimitUse::new(model, settings),
            actual: None,
            model: model.clone(),
            capsules,
            stage,
            map: map.clone(),
        })
    }

    /// The things that are there, and their frames.
    pub fn stage(&self) -> &Stage {
        &self.stage
    }

    /// The person's map.
    pub fn map(&self) -> &ErgonomicsMap {
        &self.map
    }

    /// The columns of a row.
    pub fn groups(&self) -> Vec<Group> {
        groups(&self.stage, &self.model, self.is_on_wheels())
    }

    /// The columns of [`nearest`](Self::nearest).
    pub(crate) fn nearest_group() -> Group {
        Group::new("nearest", &NEAREST, 1, Encoding::Exact)
    }

    /// A run without a sample: all that a page has to know before the first.
    pub fn empty_run(&self, title: impl Into<String>) -> Replay {
        let mut samples = self.groups();
        samples.push(Self::nearest_group());
        Replay {
            title: title.into(),
            stage: self.stage.clone(),
            samples: Table::new(samples),
            person: Table::new(person_track::groups()),
            others: Some(Table::new(others_track::groups())),
            lanes: Vec::new(),
            stature: self.map.stature(),
            side: self.map.side(),
            map: MapGrid::of(&self.map),
        }
    }

    /// Returns true if the robot has wheels.
    pub(crate) fn is_on_wheels(&self) -> bool {
        self.limits.is_of_wheels()
    }

    /// Adds something that stands or moves on its own, such as the object; its place is told by
    /// [`place`](Self::place).
    ///
    /// To be called before the first sample: the groups grow.
    pub fn add(&mut self, name: &str, role: Role, shape: Shape, colour: [f64; 3]) -> FrameSlot {
        let first = self.robot.len() + OWN_FRAMES.len();
        let frame = self.stage.add_frame(name);
        self.stage.add(name, role, frame, shape, colour);
        if frame >= first + self.placed.len() {
            self.placed.push(None);
        }
        FrameSlot(frame.saturating_sub(first))
    }

    /// Shows the object that the robot holds, as soon as the controller says so. To be called before the first sample.
    pub fn grasping(&mut self, object: &GraspedObject) {
        let shape = Shape::Box { size: object.size.into() };
        self.object = Some(self.add("object", Role::Object, shape, OBJECT_COLOUR));
    }

    /// Places a frame here in the world from now on; `None` while it is nowhere.
    ///
    /// # Errors
    /// [`ReplayError::UnknownFrame`] for a frame of another recorder.
    pub fn place(
        &mut self,
        slot: FrameSlot,
        pose: Option<Isometry3<f64>>,
    ) -> Result<(), ReplayError> {
        let count = self.placed.len();
        let place = self.placed.get_mut(slot.0);
        *place.ok_or(ReplayError::UnknownFrame { slot: slot.0, count })? = pose;
        Ok(())
    }

    /// Takes the use of limits of a tick; to be called at every one.
    pub fn watch(&mut self, controller: &Controller, configuration: &[f64]) {
        self.limits.update(controller.command(), configuration);
    }

    /// The row of a tick: the controller after its step, the configuration of the robot \[m or rad\], and what was made
    /// of it. The use of limits is the greatest since the last row.
    ///
    /// # Errors
    /// A configuration that does not fit the robot.
    pub fn sample(
        &mut self,
        controller: &Controller,
        configuration: &[f64],
        row: &TickRow,
    ) -> Result<Vec<f32>, ReplayError> {
        if let Some(slot) = self.object {
            let tool = self.data.pose(&self.model, configuration)?.world_from(self.tool)?;
            self.place(slot, controller.object().map(|object| tool * object.tool_from_object))?;
        }
        let mut values = self.poses(controller, configuration)?;
        let workspace = controller.space().workspace().position();
        write_vectors(&[*workspace.min(), *workspace.max()], &mut values);
        self.write_predicted(controller, row, &mut values);
        let (actual, time) = (Vector3::from(row.actual), row.time);
        let before = self.actual.replace((actual, time));
        let speed =
            before.map_or(f64::NAN, |(place, then)| (actual - place).norm() / (time - then));
        write_series(controller, row, speed, &mut values);
        self.limits.take(&mut values);
        Ok(values)
    }

    /// Nearest points of robot and person in a row, with the body's joints as they were seen.
    pub fn nearest(&self, row: &[f32], body: &Body) -> Vec<f32> {
        self.nearest_to(row, &body::seen(body, self.map.stature()))
    }

    /// The same with the points of a body.
    #[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
    pub(super) fn nearest_to(&self, row: &[f32], points: &Points) -> Vec<f32> {
        let stature = self.map.stature();
        let of = |counts: fn(BodyPart) -> bool| {
            nearest(&self.capsules, |frame| read_pose(row, frame), points, stature, counts)
        };
        let mut values = Vec::with_capacity(NEAREST.len());
        let body = of(|part| !works(part));
        write_optional(body.map(|near| near.on_robot), &mut values);
        write_optional(body.map(|near| near.on_person), &mut values);
        for near in [body, of(works)] {
            values.push(near.map_or(f32::NAN, |near| near.distance as f32));
        }
        values
    }

    /// The poses of all frames.
    fn poses(
        &mut self,
        controller: &Controller,
        configuration: &[f64],
    ) -> Result<Vec<f32>, ReplayError> {
        let mut values = Vec::new();
        let posed = self.data.pose(&self.model, configuration)?;
        for frame in &self.robot {
            write_pose(Some(&posed.world_from(*frame)?), &mut values);
        }
        // Where the hand is of a person who works on what the tool holds.
        let hand = Translation3::from(*controller.robot().tool_from_hand());
        write_pose(Some(&(posed.world_from(self.tool)? * hand)), &mut values);
        let space = controller.space();
        write_pose(Some(&controller.command().desired), &mut values);
        write_pose(Some(space.workspace().world_from_workspace()), &mut values);
        let person = controller.situation().worker.as_ref().map(TrackedPerson::world_from_person);
        write_pose(person.as_ref(), &mut values);
        for pose in &self.placed {
            write_pose(pose.as_ref(), &mut values);
        }
        Ok(values)
    }

    /// The body with its hand at the tool, and the sub-scores of that posture.
    fn write_predicted(&self, controller: &Controller, row: &TickRow, values: &mut Vec<f32>) {
        let predicted = self.predict(controller, row);
        let unknown: Points = [None; POINT_COUNT];
        write_points(predicted.as_ref().map_or(&unknown, |(points, _)| points), values);
        write_parts(predicted.map(|(_, scores)| scores), values);
    }

    fn predict(&self, controller: &Controller, row: &TickRow) -> Option<(Points, RebaSubScores)> {
        let person = controller.situation().worker.filter(|_| row.collaborating)?;
        let floor = Vector3::new(person.floor.x, person.floor.y, 0.0);
        let frame = PersonFrame::new(floor, person.heading).ok()?;
        let hand = frame.to_person(&row.actual.into());
        let angles = self.map.posture(&hand).ok()?;
        let scores = self.map.assess(&hand, &Conditions::default()).ok()?.sub_scores;
        let points = body::posed(self.map.person(), self.map.side(), &angles).ok()?;
        Some((points.map(|point| point.map(|point| frame.to_world(&point))), scores))
    }
}

/// Returns true for what works on the object.
fn works(part: BodyPart) -> bool {
    matches!(part, BodyPart::LowerArm(_) | BodyPart::Wrist(_))
}

fn groups(stage: &Stage, model: &Model, on_wheels: bool) -> Vec<Group> {
    let limits = limit_use::columns(model, on_wheels);
    let limits: Vec<&str> = limits.iter().map(String::as_str).collect();
    let frames: Vec<&str> = stage.frames().iter().map(String::as_str).collect();
    vec![
        Group::new("frames", &frames, 7, Encoding::Steps),
        Group::new("workspace", &["lower", "upper"], 3, Encoding::Steps),
        Group::new("body", &BODY_POINTS, 3, Encoding::Steps),
        Group::new("parts", &PARTS, 1, Encoding::Exact),
        Group::new("series", &SERIES, 1, Encoding::Exact),
        Group::new("limits", &limits, 1, Encoding::Steps),
    ]
}

/// Position, then quaternion x, y, z, w.
#[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
fn write_pose(pose: Option<&Isometry3<f64>>, row: &mut Vec<f32>) {
    row.extend(pose.map_or([f32::NAN; 7], |pose| {
        let (p, r) = (pose.translation, pose.rotation);
        // A rotation has two quaternions: always the same is taken.
        let sign = if r.w < 0.0 { -1.0 } else { 1.0 };
        [p.x, p.y, p.z, sign * r.i, sign * r.j, sign * r.k, sign * r.w].map(|value| value as f32)
    }));
}

fn read_pose(row: &[f32], frame: usize) -> Option<Isometry3<f64>> {
    let [x, y, z, i, j, k, w] = row.get(7 * frame..)?.first_chunk()?.map(f64::from);
    if x.is_nan() {
        return None;
    }
    let rotation = nalgebra::UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, i, j, k));
    Some(Isometry3::from_parts(nalgebra::Translation3::new(x, y, z), rotation))
}

#[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
fn write_vectors(vectors: &[Vector3<f64>], row: &mut Vec<f32>) {
    row.extend(vectors.iter().flatten().map(|value| *value as f32));
}

fn write_optional(vector: Option<Vector3<f64>>, row: &mut Vec<f32>) {
    write_vectors(&[vector.unwrap_or(Vector3::repeat(f64::NAN))], row);
}

/// Writes the values in the order of [`SERIES`].
#[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
fn write_series(controller: &Controller, tick: &TickRow, speed: f64, row: &mut Vec<f32>) {
    let scored = tick.reba > 0;
    let known = |value: f64| if scored { value } else { f64::NAN };
    let (desired, actual) = (Vector3::from(tick.desired), Vector3::from(tick.actual));
    let [x, y, z, roll, pitch, yaw] = tick.slack;
    let nearest = controller.safety().nearest();
    let values = [
        known(tick.score),
        known(f64::from(tick.reba)),
        tick.reba_measured.map_or(f64::NAN, f64::from),
        f64::from(u8::from(tick.collaborating)),
    ];
    let places = [tick.desired, tick.actual, tick.workspace_min, tick.workspace_max];
    let rest = [
        (desired - actual).norm(),
        speed,
        controller.situation().worker.map_or(f64::NAN, |person| person.velocity.norm()),
        Vector3::new(x, y, z).norm(),
        Vector3::new(roll, pitch, yaw).norm(),
        controller.command().activation,
        controller.safety().speed_scale(),
        nearest.map_or(f64::NAN, |nearest| nearest.distance),
        nearest.map_or(f64::NAN, |nearest| nearest.required),
    ];
    let all = values.into_iter().chain(places.into_iter().flatten()).chain(rest);
    row.extend(all.map(|value| value as f32));
}
