//! The limits of contacts in files of settings.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{BodyRegion, ContactKind, ContactLimits, RegionLimits};
use crate::error::Error;

/// The limits of contacts as a table, a table a region.
#[derive(Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactLimitsTable {
    /// With which area the robot touches at least \[m²\].
    area: f64,
    /// How long contacts last.
    kind: ContactKind,
    /// Of the skull with the forehead.
    skull: RegionLimits,
    /// Of the face.
    face: RegionLimits,
    /// Of the neck.
    neck: RegionLimits,
    /// Of the back and the shoulders.
    back: RegionLimits,
    /// Of the chest.
    chest: RegionLimits,
    /// Of the abdomen.
    abdomen: RegionLimits,
    /// Of the pelvis.
    pelvis: RegionLimits,
    /// Of the upper arm with the elbow.
    upper_arm: RegionLimits,
    /// Of the forearm with the wrist.
    forearm: RegionLimits,
    /// Of the hand with the fingers.
    hand: RegionLimits,
    /// Of the thigh with the knee.
    thigh: RegionLimits,
    /// Of the lower leg.
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
