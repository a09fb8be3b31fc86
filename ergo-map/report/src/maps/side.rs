//! Names of sides.

use ergo_map::Side;

/// Returns the name of a side in reports and pictures.
pub(super) fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}
