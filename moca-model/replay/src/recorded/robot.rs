//! Appearance of the robot, from its description.

use moca_model::whole_body::Model;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use urdf_rs::{Geometry, Link, Robot};

use super::{ReplayError, Role, Shape, Solid, Stage};

/// Colour of shapes without a colour of their own.
const GREY: [f64; 3] = [0.7, 0.7, 0.7];
/// Largest distance at which the end of a cylinder and the centre of a ball count as equal \[m\].
const SAME: f64 = 1e-6;

impl Stage {
    /// Reads the visible shapes of a robot from the text of its URDF. A cylinder with a ball of its radius at both ends
    /// becomes a capsule; meshes are left out.
    ///
    /// # Errors
    /// [`ReplayError::Urdf`] for a text that is no URDF; [`ReplayError::Robot`] for a link that the
    /// model does not have.
    pub fn of_robot(model: &Model, urdf: &str) -> Result<Self, ReplayError> {
        let robot = urdf_rs::read_from_string(urdf)?;
        let mut stage = Self::default();
        for link in &robot.links {
            let shapes = merged(visible(&robot, link));
            if shapes.is_empty() {
                continue;
            }
            model.frame_id(&link.name)?;
            let frame = stage.add_frame(&link.name);
            for Look { pose: frame_from_shape, shape, colour } in shapes {
                let (name, role) = (link.name.clone(), Role::Robot);
                stage.push(Solid { name, role, frame, frame_from_shape, shape, colour });
            }
        }
        Ok(stage)
    }
}

/// Shape in its link.
#[derive(Clone, Copy, Debug)]
struct Look {
    pose: Isometry3<f64>,
    shape: Shape,
    colour: [f64; 3],
}

fn visible(robot: &Robot, link: &Link) -> Vec<Look> {
    let looks = link.visual.iter().filter_map(|visual| {
        let shape = shape(&visual.geometry)?;
        let ([x, y, z], [roll, pitch, yaw]) = (visual.origin.xyz.0, visual.origin.rpy.0);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        let pose = Isometry3::from_parts(Translation3::new(x, y, z), rotation);
        let named = visual.material.as_ref().map(|material| {
            let own = material.color.as_ref();
            own.or_else(|| {
                let of_robot = robot.materials.iter().find(|known| known.name == material.name);
                of_robot.and_then(|known| known.color.as_ref())
            })
        });
        let colour = named.flatten().map_or(GREY, |colour| {
            let [red, green, blue, _] = colour.rgba.0;
            [red, green, blue]
        });
        Some(Look { pose, shape, colour })
    });
    looks.collect()
}

fn shape(geometry: &Geometry) -> Option<Shape> {
    match geometry {
        Geometry::Box { size } => Some(Shape::Box { size: size.0 }),
        Geometry::Cylinder { radius, length } => {
            Some(Shape::Cylinder { length: *length, radius: *radius })
        }
        Geometry::Capsule { radius, length } => {
            Some(Shape::Capsule { length: *length, radius: *radius })
        }
        Geometry::Sphere { radius } => Some(Shape::Sphere { radius: *radius }),
        Geometry::Mesh { .. } => None,
    }
}

/// Replaces cylinders with a ball at both ends by capsules, and keeps the other shapes.
fn merged(mut looks: Vec<Look>) -> Vec<Look> {
    for index in 0..looks.len() {
        let Some(&Look { pose, shape: Shape::Cylinder { length, radius }, colour }) =
            looks.get(index)
        else {
            continue;
        };
        let ball_at = |end: f64| {
            let place = (pose * Translation3::new(0.0, 0.0, end)).translation.vector;
            looks.iter().position(|look| is_ball(look, &place, radius))
        };
        let ends = (ball_at(-0.5 * length), ball_at(0.5 * length));
        if let (Some(first), Some(second)) = ends {
            looks[index] = Look { pose, shape: Shape::Capsule { length, radius }, colour };
            // Balls to remove are marked by radius zero, so that no index changes.
            for ball in [first, second] {
                looks[ball].shape = Shape::Sphere { radius: 0.0 };
            }
        }
    }
    looks.retain(|look| look.shape != Shape::Sphere { radius: 0.0 });
    looks
}

fn is_ball(look: &Look, place: &Vector3<f64>, radius: f64) -> bool {
    let Shape::Sphere { radius: own } = look.shape else { return false };
    (own - radius).abs() <= SAME && (look.pose.translation.vector - place).norm() <= SAME
}

#[cfg(test)]
mod tests {
    use moca_model::{MOCA_URDF, moca};

    use super::*;

    #[test]
    fn every_link_of_the_arm_is_of_capsules() {
        let stage = Stage::of_robot(&moca().unwrap(), MOCA_URDF).unwrap();
        let arm = stage.solids().iter().filter(|solid| solid.name.starts_with("panda_"));
        let (mut count, mut names) = (0, Vec::new());
        for solid in arm {
            assert!(matches!(solid.shape, Shape::Capsule { .. }), "{solid:?}");
            count += 1;
            names.push(solid.name.clone());
        }
        names.dedup();
        assert!(count >= names.len() && names.len() >= 8, "{names:?}");
    }

    #[test]
    fn a_text_that_is_no_urdf_is_refused() {
        let refused = Stage::of_robot(&moca().unwrap(), "<robot").unwrap_err();
        assert!(refused.to_string().contains("robot's description"), "{refused}");
    }
}
