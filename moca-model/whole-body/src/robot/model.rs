//! The model of a robot: a tree of joints and bodies.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, Ordering};

use nalgebra::Vector3;

use super::bodies::Mover;
use super::description::Base;
use super::frame::{Frame, FrameId};
use super::friction::JointFriction;
use super::joint::{Joint, JointId, JointKind, MimicJoint};
use super::limit_sources::LimitSources;
use super::limits::JointLimits;
use super::warning::Warning;
use crate::error::Error;
use crate::inertia::body::BodyInertia;
use crate::urdf::names::nearest;

/// A robot: a tree of joints, the bodies that they move, and frames on these.
///
/// It does not change while the robot moves: share it by reference or in an `Arc`. Changing quantities are in
/// [`Data`](crate::Data), one for each thread.
///
/// q and q̇ begin with the entries of the [`Base`]. One entry follows for each joint that moves by itself, depth first
/// in the order of the URDF. Fixed and locked joints are merged into the bodies that they join; their links remain as
/// frames. Mimic joints move with the joint that they follow; see [`MimicJoint`].
///
/// ```
/// use whole_body::{Data, Description, Model};
///
/// let urdf = r#"<robot name="pendulum">
///   <link name="ceiling"/>
///   <link name="rod"><inertial>
///     <origin xyz="0 0 -0.5"/><mass value="2"/>
///     <inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/>
///   </inertial></link>
///   <joint name="hinge" type="revolute">
///     <parent link="ceiling"/><child link="rod"/><axis xyz="0 1 0"/>
///     <limit lower="-3" upper="3" velocity="5" effort="20"/>
///   </joint>
/// </robot>"#;
/// let model = Model::from_urdf(urdf, &Description::default())?;
/// let rod = model.frame_id("rod")?;
///
/// let mut data = Data::new(&model);
/// let mut posed = data.pose(&model, &[0.5])?;
/// assert!((posed.world_from(rod)?.rotation.angle() - 0.5).abs() < 1e-12);
///
/// let mut torque = [0.0];
/// posed.gravity_into(&mut torque)?;
/// assert!((torque[0] - 2.0 * 9.81 * 0.5 * 0.5_f64.sin()).abs() < 1e-12); // Nm
/// # Ok::<(), whole_body::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Model {
    /// Identifies the model and its clones.
    pub(crate) tag: u64,
    pub(crate) name: String,
    pub(crate) base: Base,
    pub(crate) positions: usize,
    pub(crate) velocities: usize,
    pub(crate) joints: Vec<Joint>,
    pub(crate) mimics: Vec<MimicJoint>,
    /// Limits of each entry of q̇.
    pub(crate) limits: Vec<JointLimits>,
    /// Mimic joints whose limits are in force, for each entry of q̇.
    pub(crate) limit_sources: Vec<LimitSources>,
    /// Friction of each entry of q̇.
    pub(crate) friction: Vec<Option<JointFriction>>,
    pub(crate) default_accelerations: Vec<JointId>,
    /// Mover k moves body k + 1.
    pub(crate) movers: Vec<Mover>,
    /// Inertia of each body.
    pub(crate) inertias: Vec<BodyInertia>,
    pub(crate) frames: Vec<Frame>,
    pub(crate) frame_names: HashMap<String, usize>,
    pub(crate) joint_names: HashMap<String, usize>,
    pub(crate) gravity: Vector3<f64>,
    pub(crate) warnings: Vec<Warning>,
}

impl Model {
    /// The robot's name in the URDF.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The kind of motion of the root link.
    pub fn base(&self) -> Base {
        self.base
    }

    /// The size of q: that of q̇, or one more for a floating base.
    pub fn position_count(&self) -> usize {
        self.positions
    }

    /// The size of q̇, the number of degrees of freedom.
    pub fn velocity_count(&self) -> usize {
        self.velocities
    }

    /// The joints that move by themselves, in the order of q; the base's come first.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// The ids of [`joints`](Self::joints).
    pub fn joint_ids(&self) -> impl Iterator<Item = JointId> + use<> {
        let model = self.tag;
        (0..self.joints.len()).map(move |index| JointId { model, index })
    }

    /// The joint named `name`.
    ///
    /// # Errors
    /// [`Error::UnknownName`] if no joint of that name moves by itself.
    pub fn joint_id(&self, name: &str) -> Result<JointId, Error> {
        let index = self.joint_names.get(name).copied().ok_or_else(|| {
            let known = self.joints.iter().map(|joint| joint.name.as_str());
            self.unknown("joint", "the joint", name, nearest(name, known))
        })?;
        Ok(JointId { model: self.tag, index })
    }

    /// The joint of this id.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn joint(&self, id: JointId) -> Result<&Joint, Error> {
        let own = self.joints.get(id.index).filter(|_| id.model == self.tag);
        own.ok_or_else(|| self.foreign("joint"))
    }

    /// The joints that follow another one.
    pub fn mimic_joints(&self) -> &[MimicJoint] {
        &self.mimics
    }

    /// The limits, one an entry of q̇. Those of a floating base are infinite.
    pub fn limits(&self) -> &[JointLimits] {
        &self.limits
    }

    /// Returns an error unless the effort limit of an entry of q̇ is known.
    pub(crate) fn expect_effort(&self, entry: usize) -> Result<(), Error> {
        match self.limits.get(entry) {
            Some(limits) if limits.effort == JointLimits::UNKNOWN_EFFORT => {
                let joint = self.velocity_names().swap_remove(entry);
                Err(Error::UnknownEffort { joint })
            }
            _ => Ok(()),
        }
    }

    /// [`JointLimits::fading_time`] of each entry of q̇. All joints of a base that moves on a plane share the
    /// longest of their times.
    pub(crate) fn fading_times(&self) -> Vec<f64> {
        let mut times: Vec<f64> = self.limits.iter().map(JointLimits::fading_time).collect();
        if self.moves_on_a_plane() {
            times.iter_mut().take(3).for_each(|own| *own = self.base_fading_time());
        }
        times
    }

    /// True for a planar base, and for a robot whose first joints slide, slide and turn as those of one.
    pub(crate) fn moves_on_a_plane(&self) -> bool {
        use JointKind::{Continuous, Prismatic, Revolute};
        let kinds = self.joints.iter().map(|joint| joint.kind);
        self.base != Base::Floating
            && [[Prismatic, Prismatic, Continuous], [Prismatic, Prismatic, Revolute]]
                .into_iter()
                .any(|base| kinds.clone().take(3).eq(base))
    }

    /// The longest fading time of a planar base's joints.
    pub(crate) fn base_fading_time(&self) -> f64 {
        self.limits.iter().take(3).map(JointLimits::fading_time).fold(0.0, f64::max)
    }

    /// The joints that state no acceleration limit and use the description's default.
    pub fn default_accelerations(&self) -> &[JointId] {
        &self.default_accelerations
    }

    /// Names of the entries of q̇: the joints' names, and `floating_base.vx`, …, `floating_base.wz`.
    pub fn velocity_names(&self) -> Vec<String> {
        let parts = ["vx", "vy", "vz", "wx", "wy", "wz"];
        let names = self.joints.iter().flat_map(|joint| match joint.kind {
            JointKind::Floating => parts.map(|part| format!("{}.{part}", joint.name)).to_vec(),
            _ => vec![joint.name.clone()],
        });
        names.collect()
    }

    /// Frames with their names: the links from the root down, then the added ones.
    pub fn frames(&self) -> impl Iterator<Item = (FrameId, &str)> {
        let model = self.tag;
        let names = self.frames.iter().map(|frame| frame.name.as_str());
        names.enumerate().map(move |(index, name)| (FrameId { model, index }, name))
    }

    /// The number of frames.
    pub fn frame_count(&self) -> usize {
        self.frames.len()
    }

    /// The link or added frame named `name`.
    ///
    /// # Errors
    /// [`Error::UnknownName`], with the most similar names first.
    pub fn frame_id(&self, name: &str) -> Result<FrameId, Error> {
        self.frame_as(name, "the frame")
    }

    /// The name of a frame.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn frame_name(&self, id: FrameId) -> Result<&str, Error> {
        Ok(&self.frame(id)?.name)
    }

    /// The entries of q̇ that move a frame, from the last to the first; none if it is fixed in the world. An entry that
    /// moves several joints on the path is repeated.
    ///
    /// # Errors
    /// [`Error::ForeignId`].
    pub fn moved_by(&self, id: FrameId) -> Result<impl Iterator<Item = usize>, Error> {
        let base = if self.base == Base::Floating { 0..6 } else { 0..0 };
        Ok(self.movers_of(self.frame(id)?.body).map(|mover| mover.velocity).chain(base.rev()))
    }

    /// The acceleration of gravity in the world frame \[m/s²\].
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// The mass of all links that move \[kg\].
    pub fn mass(&self) -> f64 {
        self.inertias.iter().map(|inertia| inertia.mass).sum()
    }

    /// Warnings about the URDF, which is usable nevertheless.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    pub(crate) fn frame(&self, id: FrameId) -> Result<&Frame, Error> {
        match self.frames.get(id.index) {
            Some(frame) if id.model == self.tag => Ok(frame),
            _ => Err(self.foreign("frame")),
        }
    }

    /// The movers of a body and its ancestors, from the body to the root.
    pub(crate) fn movers_of(&self, body: usize) -> impl Iterator<Item = &Mover> {
        let mover = |body: usize| body.checked_sub(1).and_then(|index| self.movers.get(index));
        std::iter::successors(mover(body), move |below| mover(below.parent))
    }

    #[cold]
    pub(crate) fn foreign(&self, element: &'static str) -> Error {
        Error::ForeignId { element, robot: self.name.clone() }
    }

    pub(super) fn frame_as(&self, name: &str, role: &'static str) -> Result<FrameId, Error> {
        let index = self.frame_names.get(name).copied().ok_or_else(|| {
            let known = self.frames.iter().map(|frame| frame.name.as_str());
            self.unknown("frame", role, name, nearest(name, known))
        })?;
        Ok(FrameId { model: self.tag, index })
    }

    fn unknown(
        &self,
        element: &'static str,
        role: &'static str,
        name: &str,
        known: String,
    ) -> Error {
        let (name, robot) = (name.to_owned(), self.name.clone());
        Error::UnknownName { line: None, element, name, role, robot, known }
    }
}

/// Returns a number that no other model has, so that foreign ids are recognised.
pub(super) fn next_tag() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}
