//! Names of sides.

use ergo_map::Side;

/// The name of a side as reports and pictures show it.
pub(super) fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}
