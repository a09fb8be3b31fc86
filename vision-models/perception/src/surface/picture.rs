//! Synthetic pictures of plates with and without holes, for tests of classifiers.

use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use rand::Rng;
use vision_models::Surface;

use crate::{error::Error, random::generator};

/// Returns a random picture of a surface as a square PNG file with this side (pixels). The same
/// seed and stream give the same picture.
///
/// # Errors
/// The encoder's error.
pub fn picture(surface: Surface, side: u16, seed: u64, stream: u64) -> Result<Vec<u8>, Error> {
    let mut random = generator(seed, stream);
    let pixels = Scene::random(surface, &mut random).draw(side.into(), &mut random);
    let (mut png, side) = (Vec::new(), u32::from(side));
    PngEncoder::new(&mut png)
        .write_image(&pixels, side, side, ExtendedColorType::Rgb8)
        .map_err(|error| Error::at("a picture", error))?;
    Ok(png)
}

/// Number of samples per pixel along each axis, for smooth edges.
const SAMPLES: usize = 2;

/// A plate in front of a background, seen from a possible camera position.
#[derive(Debug)]
struct Scene {
    surface: Surface,
    /// Cosine and sine of the plate's rotation in the image.
    turn: [f64; 2],
    /// Foreshortening along its axes, due to its tilt.
    shortening: [f64; 2],
    /// Middle of the surface, in parts of the image's side.
    middle: [f64; 2],
    /// Half its sides, in parts of the image's side.
    half: [f64; 2],
    colour: [f64; 3],
    /// Direction and strength of the light's fall-off.
    light: [f64; 2],
    brightness: f64,
    /// Distance of the holes and their radius, in parts of the image's side.
    pitch: f64,
    radius: f64,
    /// Position of the first hole.
    offset: [f64; 2],
    background: Background,
    /// Number of passes of the blur over a radius of one pixel.
    blur: usize,
    noise: f64,
}

/// A background of stripes of two colours, or of one colour.
#[derive(Debug)]
struct Background {
    colours: [[f64; 3]; 2],
    /// Cosine and sine of the stripes' direction. `stripes` is their number.
    direction: [f64; 2],
    stripes: f64,
}

impl Scene {
    /// Creates a random scene: light, pose, background and blur.
    fn random(surface: Surface, random: &mut impl Rng) -> Self {
        let turn: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let light: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let fall_off: f64 = random.random_range(0.0..0.5);
        let stripes: f64 = random.random_range(0.0..std::f64::consts::TAU);
        let grey: f64 = random.random_range(0.35..0.8);
        let pitch = random.random_range(0.07..0.12);
        Self {
            surface,
            turn: [turn.cos(), turn.sin()],
            shortening: [(); 2].map(|()| random.random_range(0.75..1.0)),
            middle: [(); 2].map(|()| random.random_range(0.44..0.56)),
            half: [(); 2].map(|()| random.random_range(0.34..0.46)),
            colour: [(); 3].map(|()| grey + random.random_range(-0.06..0.06)),
            light: [fall_off * light.cos(), fall_off * light.sin()],
            brightness: random.random_range(0.75..1.15),
            pitch,
            radius: pitch * random.random_range(0.25..0.36),
            offset: [(); 2].map(|()| random.random_range(0.0..1.0)),
            background: Background {
                colours: [(); 2].map(|()| [(); 3].map(|()| random.random_range(0.05..0.9))),
                direction: [stripes.cos(), stripes.sin()],
                stripes: random.random_range(0.0..6.0),
            },
            blur: random.random_range(0..3),
            noise: random.random_range(0.0..0.03),
        }
    }

    /// Draws the scene as a square image: red, green, blue, row by row.
    fn draw(&self, side: usize, random: &mut impl Rng) -> Vec<u8> {
        let mut pixels = vec![[0.0; 3]; side * side];
        for (place, pixel) in pixels.iter_mut().enumerate() {
            let (row, column) = (place / side, place % side);
            for sample in 0..SAMPLES * SAMPLES {
                let part = |index: usize| (index as f64 + 0.5) / SAMPLES as f64;
                let x = (column as f64 + part(sample % SAMPLES)) / side as f64;
                let y = (row as f64 + part(sample / SAMPLES)) / side as f64;
                let colour = self.colour_at([x, y]);
                for (sum, value) in pixel.iter_mut().zip(colour) {
                    *sum += value / (SAMPLES * SAMPLES) as f64;
                }
            }
        }
        for _ in 0..self.blur {
            pixels = blurred(&pixels, side);
        }
        let mut byte = |value: f64| {
            let value = value + self.noise * random.random_range(-1.0..1.0);
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped")]
            let value = (255.0 * value).round().clamp(0.0, 255.0) as u8;
            value
        };
        pixels.into_iter().flatten().map(&mut byte).collect()
    }

    /// Returns the colour at a position in the image, from 0 to 1 along each side.
    fn colour_at(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let [cos, sin] = self.turn;
        let [dx, dy] = [x - self.middle[0], y - self.middle[1]];
        // Coordinates on the plate.
        let u = (cos * dx + sin * dy) / self.shortening[0];
        let v = (cos * dy - sin * dx) / self.shortening[1];
        if u.abs() > self.half[0] || v.abs() > self.half[1] {
            return self.background.colour_at([x, y]);
        }
        let [fall_x, fall_y] = self.light;
        let light = self.brightness * (1.0 + fall_x * (x - 0.5) + fall_y * (y - 0.5));
        self.colour.map(|colour| colour * light * self.of_hole([u, v]))
    }

    /// Returns the brightness of the plate at a position: dark in a hole, a little brighter on its
    /// rim towards the light.
    fn of_hole(&self, [u, v]: [f64; 2]) -> f64 {
        if self.surface == Surface::Smooth {
            return 1.0;
        }
        let from_hole = |place: f64, offset: f64| {
            let cells = place / self.pitch + offset;
            (cells - cells.round()) * self.pitch
        };
        let (du, dv) = (from_hole(u, self.offset[0]), from_hole(v, self.offset[1]));
        let distance = du.hypot(dv);
        if distance < self.radius {
            // The wall of the hole is lit on one side.
            0.15 + 0.15 * (du / self.radius).max(0.0)
        } else if distance < 1.2 * self.radius {
            1.12
        } else {
            1.0
        }
    }
}

impl Background {
    fn colour_at(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let along = self.direction[0] * x + self.direction[1] * y;
        let odd = (self.stripes * along).rem_euclid(2.0) >= 1.0;
        self.colours[usize::from(odd)]
    }
}

/// Returns the mean of each pixel and its existing neighbours.
fn blurred(pixels: &[[f64; 3]], side: usize) -> Vec<[f64; 3]> {
    let mean = |place: usize| {
        let (row, column) = (place / side, place % side);
        let rows = row.saturating_sub(1)..(row + 2).min(side);
        let mut sum = [0.0; 3];
        let mut count = 0.0;
        for near in rows {
            let columns = column.saturating_sub(1)..(column + 2).min(side);
            for pixel in &pixels[near * side + columns.start..near * side + columns.end] {
                sum = [sum[0] + pixel[0], sum[1] + pixel[1], sum[2] + pixel[2]];
                count += 1.0;
            }
        }
        sum.map(|sum| sum / count)
    };
    (0..pixels.len()).map(mean).collect()
}
