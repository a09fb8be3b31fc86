//! Depth noise of a stereo camera.

use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use vision_models::{DepthImage, DepthNoise, Error};

use super::image::RenderedImage;

/// Size of a cell of pixels with nearly the same error, because their matching windows overlap.
const CELL: usize = 8;

/// Correlation time of errors \[s\].
const CORRELATION_TIME: f64 = 0.1;

/// Step of depth that counts as an edge \[m\].
const EDGE: f32 = 0.1;

/// Shares of pixels along an edge without a depth, and with a depth between both surfaces.
const HOLES_AT_EDGES: f32 = 0.4;
const BETWEEN_AT_EDGES: f32 = 0.2;

/// Share of pixels without a depth elsewhere.
const HOLES: f32 = 0.01;

/// A depth sensor whose errors are smooth over neighbouring pixels and continue from frame to frame.
#[derive(Clone, Debug)]
pub struct DepthSensor {
    noise: DepthNoise,
    factor: f64,
    draw: ChaCha8Rng,
    /// Errors at the corners of the cells, each of variance one.
    errors: Vec<f64>,
    cells: [usize; 2],
    weights: [[[f64; 4]; CELL]; CELL],
    /// State of the pixels' random numbers, never 0.
    state: u32,
}

impl DepthSensor {
    /// Creates a sensor for images of this width and height with this noise times `factor`.
    pub fn new(size: [usize; 2], noise: DepthNoise, factor: f64, mut draw: ChaCha8Rng) -> Self {
        let cells = size.map(|side| side / CELL + 2);
        let errors = (0..cells[0] * cells[1]).map(|_| StandardNormal.sample(&mut draw)).collect();
        let state = draw.random_range(1..u32::MAX);
        Self { noise, factor, draw, errors, cells, weights: weights(), state }
    }

    /// Measures an image, `interval` \[s\] after the frame before.
    ///
    /// # Errors
    /// Never, for an image of the sensor's size.
    pub fn measure(&mut self, image: &RenderedImage, interval: f64) -> Result<DepthImage, Error> {
        let keep = (-interval / CORRELATION_TIME).exp();
        let fresh = (1.0 - keep * keep).sqrt();
        for error in &mut self.errors {
            let new: f64 = StandardNormal.sample(&mut self.draw);
            *error = keep * *error + fresh * new;
        }
        let [width, height] = image.size();
        let mut depths = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                depths.push(self.pixel(image, column, row));
            }
        }
        DepthImage::from_metres(image.size(), depths)
    }

    fn pixel(&mut self, image: &RenderedImage, column: usize, row: usize) -> f32 {
        let mut depth = image.depth_at(column, row);
        if !depth.is_finite() {
            return 0.0;
        }
        if self.factor == 0.0 {
            return depth;
        }
        // One random number for each pixel decides.
        let luck = self.luck();
        let edge = |column, row| {
            let other = image.depth_at(column, row);
            (other.is_finite() && (other - depth).abs() > EDGE).then_some(other)
        };
        let beside = edge(column + 2, row)
            .or_else(|| edge(column.saturating_sub(2), row))
            .or_else(|| edge(column, row + 2));
        if let Some(other) = beside {
            if luck < HOLES_AT_EDGES {
                return 0.0;
            }
            if luck < HOLES_AT_EDGES + BETWEEN_AT_EDGES {
                depth += (other - depth) * (luck - HOLES_AT_EDGES) / BETWEEN_AT_EDGES;
            }
        } else if luck < HOLES {
            return 0.0;
        }
        let error = self.factor * self.noise.sigma(f64::from(depth)) * self.error(column, row);
        #[expect(clippy::cast_possible_truncation, reason = "a depth needs no more digits")]
        let error = error as f32;
        (depth + error).max(0.0)
    }

    /// A random number in [0, 1) by Marsaglia's xorshift. It is fast, since each pixel needs one.
    fn luck(&mut self) -> f32 {
        self.state ^= self.state << 13;
        self.state ^= self.state >> 17;
        self.state ^= self.state << 5;
        f32::from(u16::try_from(self.state >> 16).unwrap_or_default()) / 65_536.0
    }

    /// The error interpolated between the corners of the cell, of variance one.
    fn error(&self, column: usize, row: usize) -> f64 {
        let at = |x: usize, y: usize| {
            self.errors.get(y * self.cells[0] + x).copied().unwrap_or_default()
        };
        let (x, y) = (column / CELL, row / CELL);
        let [a, b, c, d] = self.weights[row % CELL][column % CELL];
        a * at(x, y) + b * at(x + 1, y) + c * at(x, y + 1) + d * at(x + 1, y + 1)
    }
}

/// The weights of the corners for each place in a cell, for which errors have the variance one.
fn weights() -> [[[f64; 4]; CELL]; CELL] {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let [u, v] = [column, row].map(|offset| offset as f64 / CELL as f64);
            let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
            let norm = weights.iter().map(|weight| weight * weight).sum::<f64>().sqrt();
            weights.map(|weight| weight / norm)
        })
    })
}
