//! Contact limits in settings files.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{BodyRegion, ContactKind, ContactLimits, RegionLimits};
use crate::error::Error;

/// Declares the table with a field for each region, in the order of [`BodyRegion::ALL`].
macro_rules! table {
    ($($(#[$doc:meta])* $region:ident,)*) => {
        /// Contact limits as a table with one table for each region.
        #[derive(Clone, Serialize, Deserialize, JsonSchema)]
        #[serde(deny_unknown_fields)]
        pub(super) struct ContactLimitsTable {
            /// Smallest contact area of the robot \[m²\].
            area: f64,
            /// Duration of contacts.
            kind: ContactKind,
            $($(#[$doc])* $region: RegionLimits,)*
        }

        impl From<ContactLimits> for ContactLimitsTable {
            fn from(ContactLimits { regions: [$($region),*], area, kind }: ContactLimits) -> Self {
                Self { area, kind, $($region),* }
            }
        }

        impl TryFrom<ContactLimitsTable> for ContactLimits {
            type Error = Error;

            fn try_from(table: ContactLimitsTable) -> Result<Self, Error> {
                let limits = Self::default().with_area(table.area)?.with_kind(table.kind);
                let mut regions = BodyRegion::ALL.into_iter().zip([$(table.$region),*]);
                regions.try_fold(limits, |limits, (region, own)| limits.with(region, own))
            }
        }
    };
}

table! {
    /// The skull with the forehead.
    skull,
    /// The face.
    face,
    /// The neck.
    neck,
    /// The back and the shoulders.
    back,
    /// The chest.
    chest,
    /// The abdomen.
    abdomen,
    /// The pelvis.
    pelvis,
    /// The upper arm with the elbow.
    upper_arm,
    /// The forearm with the wrist.
    forearm,
    /// The hand with the fingers.
    hand,
    /// The thigh with the knee.
    thigh,
    /// The lower leg.
    lower_leg,
}
