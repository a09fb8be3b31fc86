//! Regions of a person's body and their contact limits.

#[cfg(feature = "serde")]
mod contact_limits_table;

#[cfg(feature = "serde")]
use contact_limits_table::ContactLimitsTable;

use crate::contact::ContactLimit;
use crate::error::{Error, not_negative, positive};

/// Region of the body in tables of power and force limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum BodyRegion {
    /// The skull with the forehead.
    Skull,
    /// The face.
    Face,
    /// The neck.
    Neck,
    /// The back and the shoulders.
    Back,
    /// The chest.
    Chest,
    /// The abdomen.
    Abdomen,
    /// The pelvis.
    Pelvis,
    /// The upper arm with the elbow.
    UpperArm,
    /// The forearm with the wrist.
    Forearm,
    /// The hand with the fingers.
    Hand,
    /// The thigh with the knee.
    Thigh,
    /// The lower leg.
    LowerLeg,
}

impl BodyRegion {
    /// Number of regions.
    pub const COUNT: usize = Self::ALL.len();

    /// Regions from head to foot.
    pub const ALL: [Self; 12] = [
        Self::Skull,
        Self::Face,
        Self::Neck,
        Self::Back,
        Self::Chest,
        Self::Abdomen,
        Self::Pelvis,
        Self::UpperArm,
        Self::Forearm,
        Self::Hand,
        Self::Thigh,
        Self::LowerLeg,
    ];

    /// Returns true for skull, face and neck. No contact with them is ever planned.
    pub fn is_of_the_head(self) -> bool {
        matches!(self, Self::Skull | Self::Face | Self::Neck)
    }
}

/// Contact limits of a region, and its mechanical properties.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct RegionLimits {
    /// Largest force F of a quasi-static contact \[N\]. Zero means that no contact is planned.
    pub force: f64,
    /// Largest pressure p of a quasi-static contact \[Pa\].
    pub pressure: f64,
    /// Stiffness k of the region \[N/m\].
    pub stiffness: f64,
    /// Effective mass m_H of the region, the part of the person's mass that moves with it \[kg\].
    pub mass: f64,
}

/// Duration of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ContactKind {
    /// Contact in which the part may be clamped between the robot and something else. No controller
    /// alone can exclude that.
    #[default]
    QuasiStatic,
    /// Contact in which the part is pushed away at once. Forces and pressures may be twice as
    /// large. Only for applications in which a risk assessment excludes clamping.
    Transient,
}

impl ContactKind {
    /// Returns the factor on the limits of quasi-static contacts.
    fn factor(self) -> f64 {
        match self {
            Self::QuasiStatic => 1.0,
            Self::Transient => 2.0,
        }
    }
}

/// Limits of power and force limiting for each region of the body.
///
/// The defaults follow open data for ISO 10218-2:2025, Annex M (formerly ISO/TS 15066, Annex A).
/// The lower end of each range is used. **They are no risk assessment**: replace them by your own.
///
/// ```
/// use hrsw_safety::{BodyRegion, ContactLimits};
///
/// let limits = ContactLimits::default();
/// let forearm = limits.of(BodyRegion::Forearm).ok_or("no contact is planned")?;
/// // A robot of 12 kg may touch a forearm at 0.61 m/s.
/// assert!((forearm.speed(12.0) - 0.61).abs() < 0.005);
/// assert!(limits.of(BodyRegion::Face).is_none());
/// # Ok::<(), &str>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize, schemars::JsonSchema))]
#[cfg_attr(feature = "serde", serde(try_from = "ContactLimitsTable", into = "ContactLimitsTable"))]
pub struct ContactLimits {
    regions: [RegionLimits; BodyRegion::COUNT],
    area: f64,
    kind: ContactKind,
}

impl Default for ContactLimits {
    fn default() -> Self {
        /// Force in N, pressure in N/cm², stiffness in N/mm, mass in kg, in the order of
        /// [`BodyRegion::ALL`].
        const TABLE: [[f64; 4]; BodyRegion::COUNT] = [
            [130.0, 110.0, 150.0, 4.4],
            [65.0, 110.0, 75.0, 4.4],
            [150.0, 140.0, 50.0, 1.2],
            [210.0, 160.0, 35.0, 40.0],
            [140.0, 120.0, 25.0, 40.0],
            [110.0, 140.0, 10.0, 40.0],
            [180.0, 210.0, 25.0, 40.0],
            [150.0, 190.0, 30.0, 3.0],
            [160.0, 180.0, 40.0, 2.0],
            [140.0, 200.0, 75.0, 0.6],
            [220.0, 220.0, 50.0, 75.0],
            [130.0, 210.0, 60.0, 75.0],
        ];
        let regions = TABLE.map(|[force, pressure, stiffness, mass]| RegionLimits {
            force,
            pressure: 1e4 * pressure,
            stiffness: 1e3 * stiffness,
            mass,
        });
        Self { regions, area: 2e-4, kind: ContactKind::QuasiStatic }
    }
}

impl ContactLimits {
    /// Replaces the limits of a region. Limits of skull, face and neck can be stored, but no
    /// contact with them is ever planned.
    ///
    /// # Errors
    /// [`Error::Value`] if the force is negative, if pressure, stiffness or mass is not positive,
    /// or if a number is not finite.
    pub fn with(mut self, region: BodyRegion, limits: RegionLimits) -> Result<Self, Error> {
        not_negative("the largest force on a region", limits.force)?;
        positive("the largest pressure on a region", limits.pressure)?;
        positive("the stiffness of a region", limits.stiffness)?;
        positive("the mass of a region", limits.mass)?;
        if let Some(place) = self.regions.get_mut(region as usize) {
            *place = limits;
        }
        Ok(self)
    }

    /// Sets the smallest contact area of the robot \[m²\]. Default 2 cm², for rounded covers.
    ///
    /// # Errors
    /// [`Error::Value`] if the area is not positive and finite.
    pub fn with_area(self, area: f64) -> Result<Self, Error> {
        Ok(Self { area: positive("the area of a contact", area)?, ..self })
    }

    /// Sets the kind of contacts. Default quasi-static.
    #[must_use]
    pub fn with_kind(self, kind: ContactKind) -> Self {
        Self { kind, ..self }
    }

    /// Returns the limits of a contact with a region. None if no contact is planned: for skull,
    /// face and neck, and for an allowed force of zero.
    pub fn of(&self, region: BodyRegion) -> Option<ContactLimit> {
        let limits = self.regions.get(region as usize)?;
        let force = self.kind.factor() * limits.force.min(limits.pressure * self.area);
        let planned = force > 0.0 && !region.is_of_the_head();
        planned.then_some(ContactLimit { force, stiffness: limits.stiffness, mass: limits.mass })
    }
}
