//! Symmetric 3 × 3 matrices that store and compute one half.

use nalgebra::{Matrix3, Vector3};

/// A symmetric 3 × 3 matrix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Symmetric3 {
    pub(crate) xx: f64,
    pub(crate) yy: f64,
    pub(crate) zz: f64,
    pub(crate) xy: f64,
    pub(crate) xz: f64,
    pub(crate) yz: f64,
}

impl Symmetric3 {
    pub(crate) const ZERO: Self = Self { xx: 0.0, yy: 0.0, zz: 0.0, xy: 0.0, xz: 0.0, yz: 0.0 };

    /// s · 1.
    #[inline]
    pub(crate) fn scalar(s: f64) -> Self {
        Self { xx: s, yy: s, zz: s, ..Self::ZERO }
    }

    /// R I Rᵀ of a symmetric I.
    #[inline]
    pub(crate) fn turned(inertia: &Matrix3<f64>, rotation: &Matrix3<f64>) -> Self {
        let (r, i) = (rotation, inertia);
        // Columns of R I; I is symmetric.
        let x = r.column(0) * i[(0, 0)] + r.column(1) * i[(1, 0)] + r.column(2) * i[(2, 0)];
        let y = r.column(0) * i[(1, 0)] + r.column(1) * i[(1, 1)] + r.column(2) * i[(2, 1)];
        let z = r.column(0) * i[(2, 0)] + r.column(1) * i[(2, 1)] + r.column(2) * i[(2, 2)];
        let entry = |row: usize, column: usize| {
            x[row] * r[(column, 0)] + y[row] * r[(column, 1)] + z[row] * r[(column, 2)]
        };
        Self {
            xx: entry(0, 0),
            yy: entry(1, 1),
            zz: entry(2, 2),
            xy: entry(0, 1),
            xz: entry(0, 2),
            yz: entry(1, 2),
        }
    }

    /// m (|r|² 1 − r rᵀ).
    #[inline]
    pub(crate) fn about_distance(mass: f64, r: &Vector3<f64>) -> Self {
        let scaled = mass * r;
        let (xx, yy, zz) = (scaled.x * r.x, scaled.y * r.y, scaled.z * r.z);
        Self {
            xx: yy + zz,
            yy: xx + zz,
            zz: xx + yy,
            xy: -scaled.x * r.y,
            xz: -scaled.x * r.z,
            yz: -scaled.y * r.z,
        }
    }

    /// s a aᵀ.
    #[inline]
    pub(crate) fn outer(s: f64, a: &Vector3<f64>) -> Self {
        let scaled = s * a;
        Self {
            xx: scaled.x * a.x,
            yy: scaled.y * a.y,
            zz: scaled.z * a.z,
            xy: scaled.x * a.y,
            xz: scaled.x * a.z,
            yz: scaled.y * a.z,
        }
    }

    #[inline]
    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            xx: self.xx + other.xx,
            yy: self.yy + other.yy,
            zz: self.zz + other.zz,
            xy: self.xy + other.xy,
            xz: self.xz + other.xz,
            yz: self.yz + other.yz,
        }
    }

    #[inline]
    pub(crate) fn times(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }

    /// S [d], [d] v being d × v.
    #[inline]
    pub(crate) fn times_cross(&self, d: &Vector3<f64>) -> Matrix3<f64> {
        let Self { xx, yy, zz, xy, xz, yz } = *self;
        Matrix3::new(
            xy * d.z - xz * d.y,
            xz * d.x - xx * d.z,
            xx * d.y - xy * d.x,
            yy * d.z - yz * d.y,
            yz * d.x - xy * d.z,
            xy * d.y - yy * d.x,
            yz * d.z - zz * d.y,
            zz * d.x - xz * d.z,
            xz * d.y - yz * d.x,
        )
    }

    #[inline]
    pub(crate) fn trace(&self) -> f64 {
        self.xx + self.yy + self.zz
    }

    pub(crate) fn to_matrix(self) -> Matrix3<f64> {
        let Self { xx, yy, zz, xy, xz, yz } = self;
        Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }
}
