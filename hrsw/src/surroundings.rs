//! Where the desired pose cannot or must not be: out of reach, or in table and shelf.

use nalgebra::{Isometry3, Point3, Vector3};

use crate::error::{Error, check_all, check_pose, not_negative, positive};
use crate::rows::{PoseRow, stack};
use crate::shape::PositionShape;
use crate::workspace::Workspace;

/// How near a point counts as within \[m\].
const TOLERANCE: f64 = 1e-4;
/// Projections tried from each start.
const ROUNDS: usize = 400;

/// The positions that an arm reaches from its present base: between two spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    center: Vector3<f64>,
    inner: f64,
    outer: f64,
}

impl Reach {
    /// Between `inner` and `outer` \[m\] from the shoulder at `center`, in the world.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; [`Error::Parameter`] unless 0 ≤ inner < outer.
    pub fn new(center: Vector3<f64>, inner: f64, outer: f64) -> Result<Self, Error> {
        check_all("the center of the reach", center.iter())?;
        not_negative("the inner radius of the reach", inner)?;
        positive("the outer radius of the reach", outer)?;
        if outer <= inner {
            let (name, expected) = ("the outer radius of the reach", "above the inner");
            return Err(Error::Parameter { name, value: outer, expected });
        }
        Ok(Self { center, inner, outer })
    }

    /// Moves the shoulder with the base.
    ///
    /// # Errors
    /// [`Error::NotFinite`]; the reach then stays as it was.
    pub fn move_to(&mut self, center: Vector3<f64>) -> Result<(), Error> {
        check_all("the center of the reach", center.iter())?;
        self.center = center;
        Ok(())
    }

    /// How far `point` lies out of reach \[m\]; negative within.
    pub fn signed_distance(&self, point: &Vector3<f64>) -> f64 {
        let distance = (point - self.center).norm();
        (distance - self.outer).max(self.inner - distance)
    }

    fn nearest(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let away = point - self.center;
        let distance = away.norm();
        if distance == 0.0 {
            return self.center + Vector3::x() * self.inner;
        }
        self.center + away * (distance.clamp(self.inner, self.outer) / distance)
    }

    /// Outwards, then inwards.
    fn rows(&self, point: &Vector3<f64>) -> [PoseRow; 2] {
        let away = point - self.center;
        let distance = away.norm();
        let normal = if distance > 1e-9 { away / distance } else { Vector3::x() };
        [row(&normal, distance - self.outer), row(&-normal, self.inner - distance)]
    }
}

/// A convex region in the world that the desired position must stay out of.
#[derive(Debug, Clone, PartialEq)]
pub struct ForbiddenRegion {
    world_from_region: Isometry3<f64>,
    shape: PositionShape,
    margin: f64,
}

impl ForbiddenRegion {
    /// `shape` in the axes of `world_from_region`, and `margin` \[m\] around it.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::NotUnit`]; [`Error::Parameter`] for a negative margin.
    pub fn new(
        world_from_region: Isometry3<f64>,
        shape: impl Into<PositionShape>,
        margin: f64,
    ) -> Result<Self, Error> {
        check_pose(&world_from_region)?;
        let margin = not_negative("the margin of a forbidden region", margin)?;
        Ok(Self { world_from_region, shape: shape.into(), margin })
    }

    /// How far `point` lies in the region \[m\]; negative outside.
    pub fn depth(&self, point: &Vector3<f64>) -> f64 {
        self.margin - self.shape.signed_distance(&self.inner(point))
    }

    /// The plane through the nearest point of the surface, its normal out of the region, and
    /// how deep `point` lies behind it.
    fn way_out(&self, point: &Vector3<f64>) -> (Vector3<f64>, f64) {
        let inner = self.inner(point);
        let away = inner - self.shape.nearest(&inner);
        let distance = away.norm();
        let (normal, distance) = if distance > 1e-9 {
            (away / distance, distance)
        } else {
            let faces = (0..self.shape.row_count())
                .filter_map(|i| self.shape.half_space(i, &inner))
                .map(|face| (*face.normal(), face.signed_distance(&inner)));
            faces.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((Vector3::z(), 0.0))
        };
        (self.world_from_region.rotation * normal, self.margin - distance)
    }

    fn inner(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.world_from_region.inverse_transform_point(&Point3::from(*point)).coords
    }
}

/// Whether the positions of a workspace leave any to the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Intersection {
    /// This position, in the world, lies in the workspace, within reach and nowhere forbidden.
    Point(Vector3<f64>),
    /// The workspace lies out of reach.
    OutOfReach,
    /// No position was found that forbidden regions leave.
    Forbidden {
        /// The region in which the search ended.
        region: usize,
    },
}

/// Reach and forbidden regions.
///
/// ```
/// use hrsw::{Bounds, ForbiddenRegion, Intersection, Reach, Surroundings, Workspace};
/// use nalgebra::{Isometry3, Vector3};
///
/// let table = Bounds::new(Vector3::new(0.0, -1.0, 0.0), Vector3::new(2.0, 1.0, 0.8))?;
/// let surroundings = Surroundings {
///     reach: Some(Reach::new(Vector3::new(0.0, 0.0, 0.6), 0.2, 0.8)?),
///     forbidden: vec![ForbiddenRegion::new(Isometry3::identity(), table, 0.05)?],
/// };
/// let ahead = Bounds::new(Vector3::new(0.3, -0.2, 0.5), Vector3::new(0.7, 0.2, 1.0))?;
/// let turn = Bounds::symmetric(Vector3::repeat(0.2))?;
/// let workspace = Workspace::new(Isometry3::identity(), ahead, turn)?;
/// assert!(matches!(surroundings.intersection(&workspace), Intersection::Point(_)));
/// # Ok::<(), hrsw::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surroundings {
    /// What the robot reaches from its present base.
    pub reach: Option<Reach>,
    /// Where it must not go.
    pub forbidden: Vec<ForbiddenRegion>,
}

impl Surroundings {
    /// How many rows they make.
    pub fn row_count(&self) -> usize {
        2 * self.reach.iter().len() + self.forbidden.len()
    }

    /// The bounds of a pose, for [`SoftWorkspace::write_within`](crate::SoftWorkspace::write_within):
    /// two for the reach, one a region.
    pub fn rows(&self, pose: &Isometry3<f64>) -> impl Iterator<Item = PoseRow> + '_ {
        let point = pose.translation.vector;
        let reach = self.reach.iter().flat_map(move |reach| reach.rows(&point));
        let regions = self.forbidden.iter().map(move |region| {
            let (normal, depth) = region.way_out(&point);
            row(&-normal, depth)
        });
        reach.chain(regions)
    }

    /// Looks for a position in the workspace, within reach and nowhere forbidden, by projecting
    /// a grid of starts in the workspace onto one set after the other.
    ///
    /// Sure where the workspace meets the outer sphere of the reach or not, both convex.
    /// Forbidden regions and the inner sphere leave no convex set, and a narrow gap may be
    /// missed; what is returned as a point always is one, to 0.1 mm. Not for every tick.
    pub fn intersection(&self, workspace: &Workspace) -> Intersection {
        let mut outcome = Intersection::OutOfReach;
        let (min, max) = (*workspace.position().min(), *workspace.position().max());
        for i in 0..27 {
            let share = |digit: i32| f64::from(digit % 3) * 0.5;
            // The middle first.
            let digits = (i + 13) % 27;
            let at = Vector3::new(share(digits), share(digits / 3), share(digits / 9));
            let local = min + (max - min).component_mul(&at);
            let start = workspace.world_from_workspace() * Point3::from(local);
            match self.search(workspace, start.coords) {
                found @ Intersection::Point(_) => return found,
                other if i == 0 => outcome = other,
                _ => {}
            }
        }
        outcome
    }

    fn search(&self, workspace: &Workspace, start: Vector3<f64>) -> Intersection {
        let frame = workspace.world_from_workspace();
        let shape = workspace.position_shape();
        let into_workspace = |point: &Vector3<f64>| {
            let local = frame.inverse_transform_point(&Point3::from(*point));
            (frame * Point3::from(shape.nearest(&local.coords))).coords
        };
        let mut point = into_workspace(&start);
        for _ in 0..ROUNDS {
            if let Some(reach) = &self.reach {
                point = reach.nearest(&point);
            }
            for region in &self.forbidden {
                let (normal, depth) = region.way_out(&point);
                if depth > 0.0 {
                    point += normal * (depth + 0.5 * TOLERANCE);
                }
            }
            point = into_workspace(&point);
            let out_of_reach = self.reach.iter().any(|r| r.signed_distance(&point) > TOLERANCE);
            let forbidden = self.forbidden.iter().position(|r| r.depth(&point) > TOLERANCE);
            if !out_of_reach && forbidden.is_none() {
                return Intersection::Point(point);
            }
        }
        let forbidden = self.forbidden.iter().position(|r| r.depth(&point) > TOLERANCE);
        forbidden.map_or(Intersection::OutOfReach, |region| Intersection::Forbidden { region })
    }
}

/// A bound of the position along a normal, in world axes.
fn row(normal: &Vector3<f64>, excess: f64) -> PoseRow {
    let gradient = stack(normal, &Vector3::zeros());
    PoseRow { gradient, axes: gradient, excess, drift: 0.0 }
}
