//! What an intention does to the workspace (the paper's Experiments 3 and 4).

use nalgebra::{Unit, UnitQuaternion, Vector3};

use crate::error::{Error, check_rotation, not_negative, positive};
use crate::moving::MovingWorkspace;
use crate::shape::{OrientationShape, PositionShape};

/// Where a person walks, in their own frame: x forward, y left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)]
pub enum Heading {
    Forward,
    ForwardLeft,
    Left,
    BackwardLeft,
    Backward,
    BackwardRight,
    Right,
    ForwardRight,
}

impl Heading {
    /// All headings, counter-clockwise from forward.
    pub const ALL: [Self; 8] = [
        Self::Forward,
        Self::ForwardLeft,
        Self::Left,
        Self::BackwardLeft,
        Self::Backward,
        Self::BackwardRight,
        Self::Right,
        Self::ForwardRight,
    ];

    /// The direction, of length 1, in the person's frame.
    pub fn unit(self) -> Vector3<f64> {
        const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;
        let (x, y) = match self {
            Self::Forward => (1.0, 0.0),
            Self::ForwardLeft => (DIAGONAL, DIAGONAL),
            Self::Left => (0.0, 1.0),
            Self::BackwardLeft => (-DIAGONAL, DIAGONAL),
            Self::Backward => (-1.0, 0.0),
            Self::BackwardRight => (-DIAGONAL, -DIAGONAL),
            Self::Right => (0.0, -1.0),
            Self::ForwardRight => (DIAGONAL, -DIAGONAL),
        };
        Vector3::new(x, y, 0.0)
    }
}

/// What the person wants of the workspace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Intent {
    /// To work where they stand, on surface `surface` of the object.
    Work {
        /// Index into [`IntentSettings::surfaces`].
        surface: usize,
    },
    /// To walk with the object, to be followed or led.
    Walk(Heading),
    /// To give or take the object: the workspace opens.
    Handover,
}

/// How intentions change the workspace.
#[derive(Debug, Clone, PartialEq)]
pub struct IntentSettings {
    /// How far the workspace runs ahead of a walking person \[m\].
    pub lead: f64,
    /// How long a change of shape takes \[s\].
    pub duration: f64,
    /// Positions and orientations for work.
    pub work: (PositionShape, OrientationShape),
    /// Positions and orientations for a handover.
    pub handover: (PositionShape, OrientationShape),
    /// The reference of orientations, in the axes of the frame, that shows each surface of the
    /// object to the person.
    pub surfaces: Vec<UnitQuaternion<f64>>,
    /// The axis about which half a turn goes the positive way, in the axes of the reference.
    pub turn_axis: Unit<Vector3<f64>>,
}

/// Applies intentions to a workspace; the same one again changes nothing, so that it may be
/// called with every percept.
///
/// ```
/// use hrsw::{
///     Bounds, Cone, Heading, Intent, IntentSettings, IntentUpdate, MovingSettings,
///     MovingWorkspace, Workspace,
/// };
/// use nalgebra::{Isometry3, UnitQuaternion, Vector3};
///
/// let work = Bounds::new(Vector3::new(0.25, -0.4, 0.7), Vector3::new(0.75, 0.3, 1.5))?;
/// let reach = Bounds::new(Vector3::new(0.2, -0.6, 0.6), Vector3::new(1.0, 0.6, 1.6))?;
/// let steady = Bounds::symmetric(Vector3::repeat(0.3))?;
/// let offered = Cone::new(Vector3::z(), -Vector3::x(), 0.5)?;
/// let updates = IntentUpdate::new(IntentSettings {
///     lead: 0.3,
///     duration: 1.0,
///     work: (work.into(), steady.into()),
///     handover: (reach.into(), offered.into()),
///     surfaces: vec![
///         UnitQuaternion::identity(),
///         UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI),
///     ],
///     turn_axis: Vector3::z_axis(),
/// })?;
/// let workspace = Workspace::new(Isometry3::identity(), work, steady)?;
/// let mut moving = MovingWorkspace::new(workspace, MovingSettings::default())?;
/// updates.apply(Intent::Work { surface: 1 }, &mut moving)?;
/// updates.apply(Intent::Walk(Heading::Backward), &mut moving)?;
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct IntentUpdate {
    settings: IntentSettings,
}

impl IntentUpdate {
    /// # Errors
    /// [`Error::Parameter`] for a negative lead or a duration that is not positive;
    /// [`Error::AngleTooLarge`], [`Error::NotFinite`], [`Error::NotUnit`] for orientations.
    pub fn new(settings: IntentSettings) -> Result<Self, Error> {
        not_negative("the lead of a workspace", settings.lead)?;
        positive("the duration of a change of shape", settings.duration)?;
        settings.work.1.validate()?;
        settings.handover.1.validate()?;
        for surface in &settings.surfaces {
            check_rotation("the reference of a surface", surface)?;
        }
        Ok(Self { settings })
    }

    /// The settings.
    pub fn settings(&self) -> &IntentSettings {
        &self.settings
    }

    /// Changes the workspace as `intent` asks: walking shifts it towards the heading in the axes
    /// of what carries it, working turns its reference to the surface, a handover opens it.
    ///
    /// # Errors
    /// [`Error::TooMany`] for a surface that is not in the settings; the workspace then stays
    /// as it was.
    pub fn apply(&self, intent: Intent, moving: &mut MovingWorkspace) -> Result<(), Error> {
        let settings = &self.settings;
        let mut lead = Vector3::zeros();
        let mut shapes = &settings.work;
        match intent {
            Intent::Work { surface } => {
                let limit = settings.surfaces.len();
                let goal = settings.surfaces.get(surface).ok_or(Error::TooMany {
                    what: "surfaces",
                    found: surface + 1,
                    limit,
                })?;
                moving.reorient(*goal, &settings.turn_axis)?;
            }
            Intent::Walk(heading) => lead = heading.unit() * settings.lead,
            Intent::Handover => shapes = &settings.handover,
        }
        moving.set_lead(lead)?;
        moving.reshape_position(&shapes.0, settings.duration)?;
        moving.reshape_orientation(&shapes.1, settings.duration)
    }
}
