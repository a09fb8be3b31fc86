//! Contact limits in settings files.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{BodyRegion, ContactKind, ContactLimits, RegionLimits};
use crate::error::Error;

/// Contact limits as a table with one table for each region.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactLimitsTable {
    /// Smallest contact area of the robot \[m²\].
    area: f64,
    /// Duration of contacts.
    kind: ContactKind,
    /// The skull with the forehead.
    skull: RegionLimits,
    /// The face.
    face: RegionLimits,
    /// The neck.
    neck: RegionLimits,
    /// The back and the shoulders.
    back: RegionLimits,
    /// The chest.
    chest: RegionLimits,
    /// The abdomen.
    abdomen: RegionLimits,
    /// The pelvis.
    pelvis: RegionLimits,
    /// The upper arm with the elbow.
    upper_arm: RegionLimits,
    /// The forearm with the wrist.
    forearm: RegionLimits,
    /// The hand with the fingers.
    hand: RegionLimits,
    /// The thigh with the knee.
    thigh: RegionLimits,
    /// The lower leg.
    lower_leg: RegionLimits,
}

impl From<ContactLimits> for ContactLimitsTable {
    fn from(limits: ContactLimits) -> Self {
        let [
            skull,
            face,
            neck,
            back,
            chest,
            abdomen,
            pelvis,
            upper_arm,
            forearm,
            hand,
            thigh,
            lower_leg,
        ] = limits.regions;
        Self {
            area: limits.area,
            kind: limits.kind,
            skull,
            face,
            neck,
            back,
            chest,
            abdomen,
            pelvis,
            upper_arm,
            forearm,
            hand,
            thigh,
            lower_leg,
        }
    }
}

impl TryFrom<ContactLimitsTable> for ContactLimits {
    type Error = Error;

    fn try_from(table: ContactLimitsTable) -> Result<Self, Error> {
        let regions = [
            table.skull,
            table.face,
            table.neck,
            table.back,
            table.chest,
            table.abdomen,
            table.pelvis,
            table.upper_arm,
            table.forearm,
            table.hand,
            table.thigh,
            table.lower_leg,
        ];
        let limits = Self::default().with_area(table.area)?.with_kind(table.kind);
        BodyRegion::ALL
            .into_iter()
            .zip(regions)
            .try_fold(limits, |limits, (region, of_region)| limits.with(region, of_region))
    }
}
