//! Finds boxes around people without a detector: from a tracker's expectation, or from upright
//! objects in a depth image.

use std::collections::VecDeque;

use nalgebra::{Point2, Point3};

use super::person_box::PersonBox;
use crate::camera::{Camera, DepthImage};

/// Radius around a standing person, arms included (m).
const RADIUS: f64 = 0.45;

/// Number of columns of the grid of depths.
const COLUMNS: usize = 160;

/// Range of depths of people (m).
const RANGE: [f32; 2] = [0.3, 8.0];

/// Range of heights above the floor that may belong to a person (m).
const HEIGHTS: [f64; 2] = [0.15, 2.4];

/// Largest difference of neighbouring depths on one surface, as a share of the depth (m/m).
const STEP: f32 = 0.06;

/// Smallest height that a person reaches (m), smallest visible height (m), largest width (m), and
/// smallest visible surface (m²).
const REACHES: f64 = 1.0;
const TALL: f64 = 0.6;
const WIDE: f64 = 1.5;
const AREA: f64 = 0.12;

impl PersonBox {
    /// Returns the box around a person of this stature (m) whom a tracker expects at this position
    /// on the floor (world, m). `None` if the person is not completely in front of the camera.
    pub fn around(camera: &Camera, floor: &Point2<f64>, stature: f64) -> Option<Self> {
        let mut bounds = Bounds::default();
        for (x, y) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            for height in [0.0, 1.05 * stature] {
                let (x, y) = (floor.x + 0.7 * RADIUS * x, floor.y + 0.7 * RADIUS * y);
                bounds.add(&camera.project(&Point3::new(x, y, height))?);
            }
        }
        bounds.person().filter(|person| person.validate().is_ok())
    }

    /// Returns the box around the nearest object of a depth image that is as upright, high, wide
    /// and large as a person. An object is a set of connected depths above the floor. `None` if
    /// there is none, or if the size of the depth image is not the camera's.
    pub fn nearest(camera: &Camera, depth: &DepthImage) -> Option<Self> {
        let [width, height] = depth.size();
        if camera.intrinsics().size() != depth.size() {
            return None;
        }
        let step = (width / COLUMNS).max(1);
        let grid = [width.div_ceil(step), height.div_ceil(step)];
        let mut cells = Vec::with_capacity(grid[0] * grid[1]);
        for row in 0..grid[1] {
            for column in 0..grid[0] {
                cells.push(Cell::of(camera, depth, [column * step, row * step]));
            }
        }
        let mut best: Option<(f64, Self)> = None;
        let mut queue: VecDeque<(usize, Cell)> = VecDeque::new();
        for start in 0..cells.len() {
            let first = cells.get_mut(start).and_then(Option::take);
            queue.extend(first.map(|cell| (start, cell)));
            let mut region = Region::default();
            while let Some((index, cell)) = queue.pop_front() {
                region.add(camera, &cell, step);
                let (column, row) = (index % grid[0], index / grid[0]);
                let beside = [
                    (column > 0).then(|| index - 1),
                    (column + 1 < grid[0]).then_some(index + 1),
                    (row > 0).then(|| index - grid[0]),
                    (row + 1 < grid[1]).then_some(index + grid[0]),
                ];
                for other in beside.into_iter().flatten() {
                    let near = |next: &mut Cell| {
                        (next.depth - cell.depth).abs() <= STEP * cell.depth.min(next.depth)
                    };
                    let next = cells.get_mut(other).and_then(|next| next.take_if(near));
                    queue.extend(next.map(|next| (other, next)));
                }
            }
            if let Some((distance, person)) = region.person()
                && best.is_none_or(|(nearest, _)| distance < nearest)
            {
                best = Some((distance, person));
            }
        }
        best.map(|(_, person)| person)
    }
}

/// A grid cell of a depth image that may belong to a person.
#[derive(Clone, Copy, Debug)]
struct Cell {
    pixel: Point2<f64>,
    depth: f32,
    /// Height above the floor (m).
    height: f64,
}

impl Cell {
    fn of(camera: &Camera, depth: &DepthImage, [column, row]: [usize; 2]) -> Option<Self> {
        let [nearest, farthest] = RANGE;
        let depth = depth.depth(column, row).filter(|z| (nearest..=farthest).contains(z))?;
        let pixel = Point2::new(column as f64, row as f64);
        let point = camera.intrinsics().back_project(&pixel, f64::from(depth));
        let height = (camera.world_from_camera() * point).z;
        let [low, high] = HEIGHTS;
        (low..=high).contains(&height).then_some(Self { pixel, depth, height })
    }
}

/// A set of connected cells.
#[derive(Debug)]
struct Region {
    bounds: Bounds,
    count: f64,
    depth: f64,
    /// Area (m²).
    area: f64,
    /// Range of heights (m).
    heights: [f64; 2],
    /// Sum of metres per pixel.
    scale: f64,
}

impl Default for Region {
    fn default() -> Self {
        Self {
            bounds: Bounds::default(),
            count: 0.0,
            depth: 0.0,
            area: 0.0,
            heights: [f64::INFINITY, f64::NEG_INFINITY],
            scale: 0.0,
        }
    }
}

impl Region {
    fn add(&mut self, camera: &Camera, cell: &Cell, step: usize) {
        let [focal, _] = camera.intrinsics().focal();
        let depth = f64::from(cell.depth);
        self.bounds.add(&cell.pixel);
        self.count += 1.0;
        self.depth += depth;
        self.area += (step as f64 * depth / focal).powi(2);
        self.scale += depth / focal;
        let [low, high] = self.heights;
        self.heights = [low.min(cell.height), high.max(cell.height)];
    }

    /// Returns the depth (m) and the box of the region, if it may be a person.
    fn person(&self) -> Option<(f64, PersonBox)> {
        let person = self.bounds.person()?;
        let [low, high] = self.heights;
        let wide = person.width * self.scale / self.count;
        let is_person = high >= REACHES && high - low >= TALL && wide <= WIDE && self.area >= AREA;
        is_person.then_some((self.depth / self.count, person))
    }
}

/// The bounds of some pixels.
#[derive(Debug)]
struct Bounds {
    low: Point2<f64>,
    high: Point2<f64>,
}

impl Default for Bounds {
    fn default() -> Self {
        let infinite = f64::INFINITY;
        Self { low: Point2::new(infinite, infinite), high: Point2::new(-infinite, -infinite) }
    }
}

impl Bounds {
    fn add(&mut self, pixel: &Point2<f64>) {
        self.low = self.low.inf(pixel);
        self.high = self.high.sup(pixel);
    }

    fn person(&self) -> Option<PersonBox> {
        let size = self.high - self.low;
        let (left, top, width, height) = (self.low.x, self.low.y, size.x, size.y);
        (width > 0.0 && height > 0.0).then_some(PersonBox { left, top, width, height })
    }
}
