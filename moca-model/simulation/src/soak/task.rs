//! Tasks of the workspace: other places, other shapes, other orientations, at random.

use std::f64::consts::PI;

use hrsw::{
    Attachment, Bounds, Capsule, Cone, OrientationShape, OrientedBox, Path, Polytope, PositionShape,
};
use moca_model::SharedSpace;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::Rng;
use rand_chacha::ChaCha8Rng;

use crate::error::Error;

#[derive(Clone, Debug)]
pub(super) struct Task {
    draw: ChaCha8Rng,
    next: f64,
}

impl Task {
    pub(super) fn new(mut draw: ChaCha8Rng) -> Self {
        let next = draw.random_range(0.0..1.0);
        Self { draw, next }
    }

    /// Changes the workspace of a robot whose tool is at `tool`, if it is time to (s).
    pub(super) fn advance(
        &mut self,
        time: f64,
        space: &mut SharedSpace,
        tool: &Isometry3<f64>,
    ) -> Result<(), Error> {
        if time < self.next {
            return Ok(());
        }
        self.next = time + self.draw.random_range(0.2..2.5);
        match self.draw.random_range(0..8) {
            0..3 => space.assign(Some(Attachment::World(self.pose(tool))))?,
            3 => {
                let waypoints =
                    [*space.workspace().world_from_workspace(), self.pose(tool), self.pose(tool)];
                let speed = self.draw.random_range(0.05..0.6);
                space.assign(Some(Attachment::Path(Path::new(&waypoints, speed)?)))?;
            }
            4 => space.assign(None)?,
            5 => {
                let (shape, duration) = (self.position()?, self.draw.random_range(0.1..2.0));
                space.reshape_position(&shape, duration)?;
            }
            6 => {
                let (shape, duration) = (self.orientation()?, self.draw.random_range(0.1..2.0));
                space.moving_mut().reshape_orientation(&shape, duration)?;
            }
            _ => {
                let goal = self.rotation(PI);
                space.moving_mut().reorient(goal, &Vector3::z_axis())?;
            }
        }
        Ok(())
    }

    /// A frame such that the middle of a usual workspace lies within 1.5 m of the tool.
    fn pose(&mut self, tool: &Isometry3<f64>) -> Isometry3<f64> {
        let rotation =
            UnitQuaternion::from_axis_angle(&Vector3::z_axis(), self.draw.random_range(-PI..PI))
                * self.rotation(0.2);
        let away = self.vector(Vector3::new(1.5, 1.5, 0.3));
        let middle = tool.translation.vector + away;
        let origin = middle - rotation * Vector3::new(0.475, -0.15, 1.18);
        Isometry3::from_parts(Translation3::from(origin), rotation)
    }

    fn position(&mut self) -> Result<PositionShape, Error> {
        let middle = Vector3::new(0.475, -0.15, 1.18) + self.vector(Vector3::repeat(0.2));
        let half = Vector3::from_fn(|_, _| self.draw.random_range(0.02..0.4));
        Ok(match self.draw.random_range(0..4) {
            0 => Bounds::new(middle - half, middle + half)?.into(),
            1 => {
                let pose = Isometry3::from_parts(Translation3::from(middle), self.rotation(1.0));
                OrientedBox::new(pose, Bounds::symmetric(half)?)?.into()
            }
            2 => {
                let end = middle + self.vector(half);
                Capsule::new(middle, end, self.draw.random_range(0.05..0.4))?.into()
            }
            _ => {
                let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
                let corners = axes.map(|axis| [middle + axis * 0.3, middle - axis * 0.3]);
                Polytope::hull(corners.as_flattened())?.into()
            }
        })
    }

    fn orientation(&mut self) -> Result<OrientationShape, Error> {
        Ok(if self.draw.random_bool(0.6) {
            let half = Vector3::from_fn(|_, _| self.draw.random_range(0.05..1.0));
            Bounds::symmetric(half)?.into()
        } else {
            Cone::new(Vector3::z(), Vector3::z(), self.draw.random_range(0.1..0.8))?.into()
        })
    }

    fn vector(&mut self, half: Vector3<f64>) -> Vector3<f64> {
        half.map(|half| self.draw.random_range(-half..half))
    }

    fn rotation(&mut self, angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_scaled_axis(self.vector(Vector3::repeat(angle / 3.0_f64.sqrt())))
    }
}
