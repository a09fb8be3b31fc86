//! A regular grid of nodes and its cells. Lengths in statures.

use nalgebra::Vector3;

use crate::error::{Error, Result, within};
use crate::region::Region;

/// Largest number of nodes: a hundred times that of a typical map.
pub(crate) const MAX_NODES: usize = 2_000_000;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    pub(crate) origin: Vector3<f64>,
    pub(crate) spacing: f64,
    /// Numbers of nodes along x, y and z, at least 2 each.
    pub(crate) size: [usize; 3],
}

/// A point between eight nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    base: usize,
    stride: [usize; 3],
    fraction: Vector3<f64>,
    spacing: f64,
}

impl Grid {
    /// Creates the smallest grid of this spacing that covers the region.
    pub(crate) fn covering(region: &Region, spacing: f64) -> Result<Self> {
        let spacing = within("spacing", spacing, [1e-3, 0.5], "statures")?;
        // Rounding must not add a last node beyond the region.
        let cells = region.size().map(|length| (length / spacing - 1e-9).ceil().max(1.0));
        let nodes = (cells.x + 1.0) * (cells.y + 1.0) * (cells.z + 1.0);
        if nodes > MAX_NODES as f64 {
            return Err(Error::Value {
                what: "the grid",
                got: nodes,
                unit: "nodes",
                wanted: format!("have at most {MAX_NODES}: use a coarser spacing"),
            });
        }
        // The numbers are positive and below `MAX_NODES`.
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let size = [cells.x as usize + 1, cells.y as usize + 1, cells.z as usize + 1];
        Ok(Self { origin: *region.min(), spacing, size })
    }

    pub(crate) fn len(&self) -> usize {
        self.size.iter().product()
    }

    /// Returns the position of a node.
    pub(crate) fn node(&self, index: usize) -> Vector3<f64> {
        let [_, ny, nz] = self.size;
        let (x, y, z) = (index / (ny * nz), index / nz % ny, index % nz);
        self.origin + Vector3::new(x as f64, y as f64, z as f64) * self.spacing
    }

    /// Returns the cell around a point. `None` outside the grid.
    pub(crate) fn cell(&self, at: &Vector3<f64>) -> Option<Cell> {
        let [nx, ny, nz] = self.size;
        let stride = [ny * nz, nz, 1];
        let scaled = (at - self.origin) / self.spacing;
        let (mut base, mut fraction) = (0, Vector3::zeros());
        for (axis, nodes) in [nx, ny, nz].into_iter().enumerate() {
            let last = (nodes - 1) as f64;
            let place = scaled[axis];
            // This is also false for NaN. A point on the last face belongs to the last cell.
            let inside = place >= -1e-9 && place <= last + 1e-9;
            if !inside {
                return None;
            }
            let lower = place.floor().clamp(0.0, last - 1.0);
            fraction[axis] = (place - lower).clamp(0.0, 1.0);
            // The number is between 0 and the number of nodes.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            {
                base += lower as usize * stride[axis];
            }
        }
        Some(Cell { base, stride, fraction, spacing: self.spacing })
    }
}

impl Cell {
    /// Returns the index of one of the eight nodes.
    pub(crate) fn corner(&self, corner: usize) -> usize {
        let [x, y, z] = self.stride;
        self.base + (corner & 1) * x + (corner >> 1 & 1) * y + (corner >> 2 & 1) * z
    }

    /// Returns the weight of one of the eight nodes, and the weight's gradient.
    pub(crate) fn weight(&self, corner: usize) -> (f64, Vector3<f64>) {
        let part = |axis: usize| {
            let f = self.fraction[axis];
            if corner >> axis & 1 == 1 { (f, 1.0) } else { (1.0 - f, -1.0) }
        };
        let ((x, dx), (y, dy), (z, dz)) = (part(0), part(1), part(2));
        (x * y * z, Vector3::new(dx * y * z, x * dy * z, x * y * dz) / self.spacing)
    }
}
