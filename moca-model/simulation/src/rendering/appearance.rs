//! Appearance of clothes, tools, room and light.

use nalgebra::Vector3;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use vision_models::Tool;

/// Red, green and blue, from 0 to 1.
pub(super) type Colour = [f64; 3];

/// Colours and light of a film.
#[derive(Clone, Copy, Debug)]
pub struct Appearance {
    pub(super) skin: Colour,
    pub(super) shirt: Colour,
    pub(super) trousers: Colour,
    pub(super) shoes: Colour,
    pub(super) floor: Colour,
    pub(super) wall: Colour,
    pub(super) object: Colour,
    /// Direction towards the light, from the camera.
    pub(super) light: Vector3<f64>,
}

/// Creates the appearance of a person in blue under a lamp.
impl Default for Appearance {
    fn default() -> Self {
        Self {
            skin: [0.80, 0.60, 0.50],
            shirt: [0.25, 0.35, 0.60],
            trousers: [0.20, 0.20, 0.25],
            shoes: [0.10, 0.09, 0.08],
            floor: [0.45, 0.44, 0.42],
            wall: [0.75, 0.74, 0.70],
            object: [0.65, 0.55, 0.35],
            light: Vector3::new(0.3, -0.8, -0.5).normalize(),
        }
    }
}

impl Appearance {
    /// Creates another person in another light for each draw.
    pub fn random(draw: &mut ChaCha8Rng) -> Self {
        let mut around = |colour: Colour, spread: f64| {
            let brighter = draw.random_range(-spread..spread);
            colour.map(|part| part + brighter + 0.3 * draw.random_range(-spread..spread))
        };
        let (skin, floor) = (around([0.68, 0.50, 0.42], 0.18), around([0.45, 0.44, 0.42], 0.10));
        let (wall, object) = (around([0.72, 0.71, 0.68], 0.12), around([0.62, 0.54, 0.40], 0.12));
        let mut cloth = |brightest: f64| [(); 3].map(|()| draw.random_range(0.08..brightest));
        let (shirt, trousers, shoes) = (cloth(0.75), cloth(0.35), cloth(0.15));
        let mut off = || draw.random_range(-0.25..0.25);
        let light = Vector3::new(0.3 + off(), -0.8 + off(), -0.5 + off()).normalize();
        Self { skin, shirt, trousers, shoes, floor, wall, object, light }
    }
}

/// The colour of a tool, and half the lengths of its sides \[m\].
pub(super) fn tool(tool: Tool) -> (Colour, Vector3<f64>) {
    match tool {
        Tool::Drill => ([0.85, 0.35, 0.10], Vector3::new(0.09, 0.03, 0.05)),
        Tool::Polisher => ([0.10, 0.45, 0.50], Vector3::new(0.06, 0.08, 0.05)),
    }
}
