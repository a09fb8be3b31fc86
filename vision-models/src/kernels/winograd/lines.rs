//! The one-dimensional transforms, and the tilings made of them.

use crate::layout::Extent;

use super::super::vector::Vector;

/// F(m, 3) along one line: `POINTS` = m + 2 inputs, m = `OUTPUTS` outputs.
pub(super) trait Line<const POINTS: usize, const OUTPUTS: usize> {
    /// G, which gives the points' values from the three taps.
    const KERNEL: [[f64; 3]; POINTS];

    /// Returns Bᵀ d.
    ///
    /// # Safety
    /// The vector's instruction set must be enabled.
    unsafe fn input<V: Vector>(d: [V; POINTS]) -> [V; POINTS];

    /// Returns Aᵀ m.
    ///
    /// # Safety
    /// The vector's instruction set must be enabled.
    unsafe fn output<V: Vector>(m: [V; POINTS]) -> [V; OUTPUTS];
}

/// F(2, 3), with the points 0, 1, −1, ∞.
pub(super) struct Two;

impl Line<4, 2> for Two {
    const KERNEL: [[f64; 3]; 4] =
        [[1.0, 0.0, 0.0], [0.5, 0.5, 0.5], [0.5, -0.5, 0.5], [0.0, 0.0, 1.0]];

    #[inline(always)]
    unsafe fn input<V: Vector>(d: [V; 4]) -> [V; 4] {
        // SAFETY: passed on to the caller.
        unsafe { [d[0].sub(d[2]), d[1].add(d[2]), d[2].sub(d[1]), d[1].sub(d[3])] }
    }

    #[inline(always)]
    unsafe fn output<V: Vector>(m: [V; 4]) -> [V; 2] {
        // SAFETY: passed on to the caller.
        unsafe { [m[0].add(m[1]).add(m[2]), m[1].sub(m[2]).sub(m[3])] }
    }
}

/// F(4, 3), with the points 0, 1, −1, 2, −2, ∞.
pub(super) struct Four;

impl Line<6, 4> for Four {
    const KERNEL: [[f64; 3]; 6] = [
        [1.0 / 4.0, 0.0, 0.0],
        [-1.0 / 6.0, -1.0 / 6.0, -1.0 / 6.0],
        [-1.0 / 6.0, 1.0 / 6.0, -1.0 / 6.0],
        [1.0 / 24.0, 1.0 / 12.0, 1.0 / 6.0],
        [1.0 / 24.0, -1.0 / 12.0, 1.0 / 6.0],
        [0.0, 0.0, 1.0],
    ];

    #[inline(always)]
    unsafe fn input<V: Vector>(d: [V; 6]) -> [V; 6] {
        // SAFETY: passed on to the caller.
        unsafe {
            let (two, four, five) = (V::splat(2.0), V::splat(4.0), V::splat(-5.0));
            let minus_four = V::splat(-4.0);
            let even = d[2].mul_add(minus_four, d[4]);
            let odd = d[1].mul_add(minus_four, d[3]);
            let difference = d[4].sub(d[2]);
            let slope = d[3].sub(d[1]);
            [
                d[0].mul_add(four, d[2].mul_add(five, d[4])),
                even.add(odd),
                even.sub(odd),
                slope.mul_add(two, difference),
                slope.mul_add(V::splat(-2.0), difference),
                d[1].mul_add(four, d[3].mul_add(five, d[5])),
            ]
        }
    }

    #[inline(always)]
    unsafe fn output<V: Vector>(m: [V; 6]) -> [V; 4] {
        // SAFETY: passed on to the caller.
        unsafe {
            let (even, odd) = (m[1].add(m[2]), m[1].sub(m[2]));
            let (even_two, odd_two) = (m[3].add(m[4]), m[3].sub(m[4]));
            [
                m[0].add(even).add(even_two),
                odd_two.mul_add(V::splat(2.0), odd),
                even_two.mul_add(V::splat(4.0), even),
                odd_two.mul_add(V::splat(8.0), odd).add(m[5]),
            ]
        }
    }
}

/// Division of the output into tiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tiling {
    /// 1×3×3 kernels, 2×2 outputs per tile: 2.25 times fewer multiplications.
    Two,
    /// 1×3×3 kernels, 4×4 outputs per tile: four times fewer multiplications.
    Four,
    /// 3×1×1 kernels, four frames per tile: two times fewer multiplications.
    FourFrames,
}

impl Tiling {
    /// Returns the outputs of a tile.
    pub(crate) fn outputs(self) -> Extent {
        match self {
            Self::Two => [1, 2, 2],
            Self::Four => [1, 4, 4],
            Self::FourFrames => [4, 1, 1],
        }
    }

    /// Returns the kernel of this tiling.
    pub(crate) fn kernel(self) -> Extent {
        match self {
            Self::Two | Self::Four => [1, 3, 3],
            Self::FourFrames => [3, 1, 1],
        }
    }

    /// Returns the number of products of a tile.
    pub(crate) fn points(self) -> usize {
        match self {
            Self::Two => 16,
            Self::Four => 36,
            Self::FourFrames => 6,
        }
    }

    /// Returns the number of tiles along each axis.
    pub(crate) fn tiles(self, size: Extent) -> Extent {
        let outputs = self.outputs();
        std::array::from_fn(|axis| size[axis].div_ceil(outputs[axis]))
    }

    /// Returns the zeros that the input needs after its last frame, row and column.
    pub(crate) fn after(self, size: Extent) -> Extent {
        let (tiles, outputs, kernel) = (self.tiles(size), self.outputs(), self.kernel());
        std::array::from_fn(|axis| tiles[axis] * outputs[axis] - size[axis] + kernel[axis] / 2)
    }

    /// Computes G g Gᵀ, the points' values from the taps of one input and output channel.
    pub(crate) fn kernel_points(self, taps: &[f64], points: &mut [f64]) {
        match self {
            Self::Two => plane_kernel(&Two::KERNEL, taps, points),
            Self::Four => plane_kernel(&Four::KERNEL, taps, points),
            Self::FourFrames => {
                for (point, row) in points.iter_mut().zip(&Four::KERNEL) {
                    *point = dot(row, taps);
                }
            }
        }
    }
}

fn dot(row: &[f64], taps: &[f64]) -> f64 {
    row.iter().zip(taps).map(|(row, tap)| row * tap).sum()
}

fn plane_kernel(kernel: &[[f64; 3]], taps: &[f64], points: &mut [f64]) {
    for (points, vertical) in points.chunks_exact_mut(kernel.len()).zip(kernel) {
        let row: [f64; 3] = std::array::from_fn(|x| {
            vertical.iter().zip(taps.iter().skip(x).step_by(3)).map(|(v, tap)| v * tap).sum()
        });
        for (point, horizontal) in points.iter_mut().zip(kernel) {
            *point = dot(horizontal, &row);
        }
    }
}
