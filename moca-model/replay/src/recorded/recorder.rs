//! Records a run for pictures while it goes on.

use ergo_map::{Conditions, ErgonomicsMap, PersonFrame, RebaSubScores, Side};
use hrsw_safety::Capsule;
use moca_model::whole_body::{Data, FrameId, Model};
use moca_model::{Controller, ControllerSettings, HeldObject, moca_safety};
use nalgebra::{Isometry3, Translation3, Vector3};
use vision_models::{Body, Percept, TrackedPerson};

use super::body::{self, BODY_POINTS, BodyPart, POINT_COUNT, Points};
use super::lanes::{self, Lane, Tone};
use super::limit_use::{self, LimitUse};
use super::nearest::nearest;
use super::others_track::OthersTrack;
use super::person_track::{PARTS, PersonTrack, points_at, write_parts, write_points};
use super::stage::{Role, Shape, Stage};
use super::table::{Encoding, Group, Table};
use super::{MapGrid, ReplayError};
use crate::report::TickRow;

/// Time between two samples \[s\]: 50 samples a second.
const INTERVAL: f64 = 0.02;

/// Frames of every run, in addition to those of the robot.
const OWN_FRAMES: [&str; 4] = ["tool", "desired", "workspace", "person"];

/// Series: one number for each sample.
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

/// Nearest points of robot and person. The forearms are left out, because they work on the object that the robot holds.
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

/// Record of a run.
#[derive(Clone, Debug)]
pub struct Replay {
    /// Title of the run.
    pub title: String,
    /// Solids and their frames.
    pub stage: Stage,
    /// Samples: poses of the frames, the predicted body, series, limits, and the nearest points of robot and person.
    pub samples: Table,
    /// Camera frames: the body that was seen and its scores.
    pub person: Table,
    /// Bodies of other people, frame by frame; `None` if there was never anybody.
    pub others: Option<Table>,
    /// States.
    pub lanes: Vec<Lane>,
    /// Stature of the person \[m\].
    pub stature: f64,
    /// Working hand.
    pub side: Side,
    /// Map of the person.
    pub map: MapGrid,
}

/// Frame that the caller moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameSlot(usize);

/// Samples a run 50 times a second.
///
/// Memory: at most [`Table::MOST`] samples of some 800 bytes, as many camera frames of 300 bytes, and 2000 states of
/// each lane. A longer run is sampled less often.
#[derive(Debug)]
pub struct Recorder {
    title: String,
    stage: Stage,
    map: ErgonomicsMap,
    model: Model,
    data: Data,
    robot: Vec<FrameId>,
    tool: FrameId,
    capsules: Vec<(usize, Capsule)>,
    /// Poses of the frames that the caller moves.
    placed: Vec<Option<Isometry3<f64>>>,
    /// Frame of the object that the robot holds.
    object: Option<FrameSlot>,
    samples: Option<Table>,
    person: PersonTrack,
    others: OthersTrack,
    limits: LimitUse,
    /// Ticks between two samples, and ticks until the next one.
    stride: u32,
    left: u32,
    /// Position of the tool at the last sample, and its time \[m, s\].
    actual: Option<(Vector3<f64>, f64)>,
    phase: Lane,
    intention: Lane,
    safety: Lane,
    base: Lane,
    solver: Lane,
    action: Lane,
    surface: Lane,
}

/// Colour of wood.
const OBJECT_COLOUR: [f64; 3] = [0.76, 0.6, 0.42];

impl Recorder {
    /// Creates a recorder for a robot and a person's map. The text of the URDF gives the robot's shapes.
    ///
    /// # Errors
    /// [`ReplayError::Urdf`], or a tool or link that the robot does not have.
    pub fn new(
        title: impl Into<String>,
        model: &Model,
        urdf: &str,
        settings: &ControllerSettings,
        map: &ErgonomicsMap,
    ) -> Result<Self, ReplayError> {
        let mut stage = Stage::of_robot(model, urdf)?;
        let bodies = match &settings.safety.bodies {
            // No body is monitored, but the distance is still recorded.
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
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
        let stride = (INTERVAL / settings.period).round().clamp(1.0, 1e6) as u32;
        Ok(Self {
            title: title.into(),
            data: Data::new(model),
            robot: robot?,
            tool: model.frame_id(&settings.tool)?,
            placed: Vec::new(),
            object: None,
            samples: None,
            person: PersonTrack::new(map.stature()),
            others: OthersTrack::new(map.stature()),
            limits: LimitUse::new(model, settings),
            left: 0,
            phase: Lane::new("phase"),
            intention: Lane::new("intention"),
            safety: Lane::new("safety"),
            base: Lane::new("base"),
            actual: None,
            solver: Lane::new("solver"),
            action: Lane::new("action seen"),
            surface: Lane::new("surface seen"),
            model: model.clone(),
            stride,
            capsules,
            stage,
            map: map.clone(),
        })
    }

    /// Adds a solid that stands or moves on its own, such as the object. [`place`](Self::place) sets its pose.
    ///
    /// # Errors
    /// [`ReplayError::LateFrame`] after the first sample.
    pub fn add(
        &mut self,
        name: &str,
        role: Role,
        shape: Shape,
        colour: [f64; 3],
    ) -> Result<FrameSlot, ReplayError> {
        if self.samples.is_some() {
            return Err(ReplayError::LateFrame { name: name.to_owned() });
        }
        let first = self.robot.len() + OWN_FRAMES.len();
        let frame = self.stage.add_frame(name);
        self.stage.add(name, role, frame, shape, colour);
        if frame >= first + self.placed.len() {
            self.placed.push(None);
        }
        Ok(FrameSlot(frame.saturating_sub(first)))
    }

    /// Shows the object that the robot holds from the time at which the controller reports it.
    ///
    /// # Errors
    /// [`ReplayError::LateFrame`] after the first sample.
    pub fn holding(&mut self, object: &HeldObject) -> Result<(), ReplayError> {
        let shape = Shape::Box { size: object.size.into() };
        self.object = Some(self.add("object", Role::Object, shape, OBJECT_COLOUR)?);
        Ok(())
    }

    /// Sets the pose of a frame in the world from this time on; `None` hides it.
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

    /// Adds a camera frame with the other people in it. `measured` has the scores of the person's posture and the side
    /// of the scored arm.
    pub fn observe(
        &mut self,
        percept: &Percept,
        others: &[Body],
        measured: Option<(Side, RebaSubScores)>,
    ) {
        self.person.observe(percept, measured);
        self.others.observe(percept.time, others);
        let (action, tone) = percept.action.map_or(("none", Tone::Quiet), |seen| {
            let works = seen.action.is_collaborative();
            let walks = seen.action.walking_direction().is_some();
            let tone = if walks { Tone::Walk } else { Tone::Work };
            (seen.action.name(), if works { tone } else { Tone::Quiet })
        });
        self.action.set(percept.time, action, tone);
        if let Some(seen) = percept.surface {
            self.surface.set(percept.time, lanes::surface(seen.surface), Tone::Work);
        }
    }

    /// Adds a tick: the controller after its step, the configuration of the robot \[m or rad\], and the row of the
    /// tick's results.
    ///
    /// # Errors
    /// A configuration that does not fit the robot.
    pub fn tick(
        &mut self,
        controller: &Controller,
        configuration: &[f64],
        row: &TickRow,
    ) -> Result<(), ReplayError> {
        let command = controller.command();
        if self.phase.spans.is_empty() || command.transition.is_some() {
            let reason = command.transition.map(|transition| transition.reason);
            let (phase, tone) = lanes::phase(command.phase, reason);
            self.phase.set(row.time, phase, tone);
        }
        self.phase.lasts(row.time);
        let (intention, tone) = lanes::intention(command.intention);
        self.intention.set(row.time, intention, tone);
        let cause = controller.safety().supervisor().cause();
        let (safety, tone) = lanes::safety(command.safety, cause);
        self.safety.set(row.time, safety, tone);
        if self.limits.is_of_wheels() {
            let (base, tone) = lanes::base(command.base_motion);
            self.base.set(row.time, base, tone);
        }
        let (solver, tone) = lanes::solver(command.outcome);
        self.solver.set(row.time, solver, tone);
        self.limits.update(command, configuration);
        if self.left > 0 {
            self.left -= 1;
            return Ok(());
        }
        self.left = self.stride - 1;
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
        let (stage, model, on_wheels) = (&self.stage, &self.model, self.limits.is_of_wheels());
        let table = self.samples.get_or_insert_with(|| Table::new(groups(stage, model, on_wheels)));
        table.push(row.time, &values);
        Ok(())
    }

    /// Returns the poses of all frames.
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
        // Position of the person's hand at the tool.
        let hand = Translation3::from(*controller.robot().tool_from_hand());
        write_pose(Some(&(posed.world_from(self.tool)? * hand)), &mut values);
        let space = controller.space();
        write_pose(Some(&controller.command().desired), &mut values);
        write_pose(Some(space.workspace().world_from_workspace()), &mut values);
        let person = space.person().map(TrackedPerson::world_from_person);
        write_pose(person.as_ref(), &mut values);
        for pose in &self.placed {
            write_pose(pose.as_ref(), &mut values);
        }
        Ok(values)
    }

    /// Appends the body with its hand at the tool, and the sub-scores of that posture.
    fn write_predicted(&self, controller: &Controller, row: &TickRow, values: &mut Vec<f32>) {
        let predicted = self.predict(controller, row);
        let unknown: Points = [None; POINT_COUNT];
        write_points(predicted.as_ref().map_or(&unknown, |(points, _)| points), values);
        write_parts(predicted.map(|(_, scores)| scores), values);
    }

    fn predict(
        &self,
        controller: &Controller,
        row: &TickRow,
    ) -> Option<(Points, ergo_map::RebaSubScores)> {
        let person = controller.space().person().filter(|_| row.collaborating)?;
        let floor = Vector3::new(person.floor.x, person.floor.y, 0.0);
        let frame = PersonFrame::new(floor, person.heading).ok()?;
        let hand = frame.to_person(&row.actual.into());
        let angles = self.map.posture(&hand).ok()?;
        let scores = self.map.assess(&hand, &Conditions::default()).ok()?.sub_scores;
        let points = body::posed(self.map.person(), self.map.side(), &angles).ok()?;
        Some((points.map(|point| point.map(|point| frame.to_world(&point))), scores))
    }

    /// Returns the record of the run so far.
    #[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
    pub fn finish(self) -> Replay {
        let Self { title, stage, map, model, capsules, person, others, samples, limits, .. } = self;
        let person = person.smoothed();
        let mut samples =
            samples.unwrap_or_else(|| Table::new(groups(&stage, &model, limits.is_of_wheels())));
        let times = samples.times().to_vec();
        let near = |index: usize, row: &[f32]| {
            let points = points_at(&person, times.get(index).copied().unwrap_or_default());
            let of = |counts: fn(BodyPart) -> bool| {
                nearest(&capsules, |frame| read_pose(row, frame), &points, map.stature(), counts)
            };
            let mut values = Vec::with_capacity(8);
            let body = of(|part| !works(part));
            write_optional(body.map(|near| near.on_robot), &mut values);
            write_optional(body.map(|near| near.on_person), &mut values);
            for near in [body, of(works)] {
                values.push(near.map_or(f32::NAN, |near| near.distance as f32));
            }
            values
        };
        samples.add_group(Group::new("nearest", &NEAREST, 1, Encoding::Exact), near);
        let lanes = [
            self.phase,
            self.intention,
            self.safety,
            self.base,
            self.action,
            self.surface,
            self.solver,
        ];
        Replay {
            title,
            stage,
            samples,
            person,
            others: others.finish(),
            lanes: lanes.into_iter().filter(|lane| !lane.spans.is_empty()).collect(),
            stature: map.stature(),
            side: map.side(),
            map: MapGrid::of(&map),
        }
    }
}

/// Returns true for parts that work on the object.
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

/// Appends the position, then the quaternion x, y, z, w.
#[expect(clippy::cast_possible_truncation, reason = "f32 is what is kept")]
fn write_pose(pose: Option<&Isometry3<f64>>, row: &mut Vec<f32>) {
    row.extend(pose.map_or([f32::NAN; 7], |pose| {
        let (p, r) = (pose.translation, pose.rotation);
        // A rotation has two quaternions; the sign always selects the one with w ≥ 0.
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

/// Appends the numbers in the order of [`SERIES`].
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
        controller.space().person().map_or(f64::NAN, |person| person.velocity.norm()),
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
