//! Robots that are drawn into themselves.

use std::fmt::Write;

use hrsw_safety::{Capsule, LinkCapsule};
use moca_model::nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use moca_model::whole_body::robot::LimitOverride;
use moca_model::whole_body::tasks::PositionTask;
use moca_model::whole_body::{Description, Ik, Model};
use moca_model::{Error, SelfCollisionLimit};
use proptest::prelude::*;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Period of the loops \[s\].
const PERIOD: f64 = 1e-3;
/// Least distance that is asked for \[m\].
const LEAST: f64 = 0.03;

/// An arm as a product of screws: before each joint a translation \[m\] and a rotation about x \[rad\].
struct Chain {
    joints: Vec<([f64; 3], f64)>,
    /// Position limits \[rad\].
    range: Vec<[f64; 2]>,
    speed: f64,
}

/// A segment with a radius on a link; link 0 is the base.
#[derive(Debug, Clone, Copy)]
struct Body {
    link: usize,
    ends: [Vector3<f64>; 2],
    radius: f64,
}

fn body(link: usize, start: [f64; 3], end: [f64; 3], radius: f64) -> Body {
    Body { link, ends: [start.into(), end.into()], radius }
}

const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

/// The lengths of a Franka Emika Panda.
fn panda() -> Chain {
    let joints = vec![
        ([0.0, 0.0, 0.333], 0.0),
        ([0.0; 3], -QUARTER),
        ([0.0, -0.316, 0.0], QUARTER),
        ([0.0825, 0.0, 0.0], QUARTER),
        ([-0.0825, 0.384, 0.0], -QUARTER),
        ([0.0; 3], QUARTER),
        ([0.088, 0.0, 0.0], QUARTER),
    ];
    let range = [2.8, 1.7, 2.8, 0.0, 2.8, 3.7, 2.8];
    let range = range.iter().map(|&end| if end == 0.0 { [-3.0, -0.1] } else { [-end, end] });
    Chain { joints, range: range.collect(), speed: 2.1 }
}

/// The lengths of a UR5.
fn ur5() -> Chain {
    let joints = vec![
        ([0.0, 0.0, 0.089], 0.0),
        ([0.0; 3], QUARTER),
        ([0.425, 0.0, 0.0], 0.0),
        ([0.392, 0.0, 0.109], 0.0),
        ([0.0, -0.095, 0.0], QUARTER),
        ([0.0, 0.082, 0.0], -QUARTER),
    ];
    Chain { range: vec![[-3.1, 3.1]; joints.len()], joints, speed: 3.1 }
}

impl Chain {
    fn urdf(&self) -> String {
        let mut text = "<robot name=\"arm\"><link name=\"link0\"/>".to_owned();
        for (index, ((xyz, roll), [lower, upper])) in
            self.joints.iter().zip(&self.range).enumerate()
        {
            let [x, y, z] = xyz;
            write!(
                text,
                "<link name=\"link{0}\"/><joint name=\"joint{0}\" type=\"revolute\"><parent link=\"link{index}\"/>
                <child link=\"link{0}\"/><origin xyz=\"{x} {y} {z}\" rpy=\"{roll} 0 0\"/><axis xyz=\"0 0 1\"/>
                <limit lower=\"{lower}\" upper=\"{upper}\" velocity=\"{1}\" effort=\"50\"/></joint>",
                index + 1, self.speed
            )
            .unwrap();
        }
        text + "</robot>"
    }

    fn model(&self, acceleration: f64, jerk: Option<f64>) -> Model {
        let own =
            LimitOverride { acceleration: Some(acceleration), jerk, ..LimitOverride::default() };
        let limits = (1..=self.joints.len()).map(|joint| (format!("joint{joint}"), own));
        let description = Description { limits: limits.collect(), ..Description::default() };
        Model::from_urdf(&self.urdf(), &description).unwrap()
    }

    /// The poses of all links, the base first.
    fn poses(&self, q: &[f64]) -> Vec<Isometry3<f64>> {
        let mut poses = vec![Isometry3::identity()];
        for ((xyz, roll), q) in self.joints.iter().zip(q) {
            let [x, y, z] = *xyz;
            let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), *roll)
                * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), *q);
            let last = *poses.last().unwrap();
            poses.push(last * Isometry3::from_parts(Translation3::new(x, y, z), turn));
        }
        poses
    }

    /// The least distance of pairs of bodies \[m\].
    fn least(&self, bodies: &[Body], pairs: &[(usize, usize)], q: &[f64]) -> f64 {
        let poses = self.poses(q);
        let on = |link: usize| bodies.iter().filter(move |body| body.link == link);
        let placed =
            |body: &Body| body.ends.map(|end| (poses[body.link] * Point3::from(end)).coords);
        let mut least = f64::INFINITY;
        for &(one, other) in pairs {
            for (one, other) in on(one).flat_map(|one| on(other).map(move |other| (one, other))) {
                let (first, second, radii) =
                    (placed(one), placed(other), one.radius + other.radius);
                // The search takes long, and no point is nearer than the spheres around both.
                let [(centre, half), (other_centre, other_half)] = [first, second]
                    .map(|[start, end]| (0.5 * (start + end), 0.5 * (end - start).norm()));
                if (other_centre - centre).norm() - half - other_half - radii < least {
                    least = least.min(apart(first, second) - radii);
                }
            }
        }
        least
    }

    fn configuration(&self, draw: &mut ChaCha8Rng) -> Vec<f64> {
        self.range.iter().map(|&[lower, upper]| draw.random_range(lower..upper)).collect()
    }
}

/// Distance of two segments \[m\]: that of two points in closed form, and of others by a search over convex functions,
/// to a millionth of their lengths.
fn apart(first: [Vector3<f64>; 2], second: [Vector3<f64>; 2]) -> f64 {
    let of_point = |point: Vector3<f64>, [start, end]: [Vector3<f64>; 2]| {
        let along = end - start;
        let share = (point - start).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        (point - start - along * share.clamp(0.0, 1.0)).norm()
    };
    let at = |share: f64| of_point(first[0] + (first[1] - first[0]) * share, second);
    if first[0] == first[1] {
        return at(0.0);
    }
    let (mut lower, mut upper) = (0.0, 1.0);
    for _ in 0..30 {
        let (left, right) = (lower + (upper - lower) / 3.0, upper - (upper - lower) / 3.0);
        if at(left) < at(right) { upper = right } else { lower = left }
    }
    at(0.5 * (lower + upper))
}

/// What a run found.
#[derive(Debug)]
struct Found {
    /// The least distance of the pairs \[m\].
    least: f64,
    /// Ticks with a pair near its least distance.
    near: usize,
    /// Memory allocated in a tick.
    allocated: u64,
}

/// One robot with its bodies and the pairs of links that stay apart.
struct Case {
    chain: Chain,
    bodies: Vec<Body>,
    pairs: Vec<(usize, usize)>,
}

impl Case {
    fn limit(&self, model: &Model) -> SelfCollisionLimit {
        let bodies = self.bodies.iter().map(|body| {
            let capsule = Capsule::new(body.ends[0], body.ends[1], body.radius).unwrap();
            LinkCapsule { link: format!("link{}", body.link), capsule }
        });
        let bodies: Vec<_> = bodies.collect();
        let name = |link: usize| format!("link{link}");
        let pairs: Vec<_> =
            self.pairs.iter().map(|&(one, other)| (name(one), name(other))).collect();
        SelfCollisionLimit::new(model, &bodies, &pairs, LEAST).unwrap()
    }

    /// Draws the last link into other bodies for some seconds, and checks the limits of the joints in every tick.
    fn run(&self, model: &Model, seed: u64, seconds: usize, limited: bool) -> Found {
        let mut draw = ChaCha8Rng::seed_from_u64(seed);
        let mut q = self.chain.configuration(&mut draw);
        while self.chain.least(&self.bodies, &self.pairs, &q) < LEAST + 0.01 {
            q = self.chain.configuration(&mut draw);
        }
        let mut builder = Ik::builder(model);
        if limited {
            builder.limit("own bodies", self.limit(model));
        }
        let last = self.chain.joints.len();
        let tip = model.frame_id(&format!("link{last}")).unwrap();
        let task =
            builder.push("tool", PositionTask::new(tip).with_gain(draw.random_range(2.0..20.0)));
        let mut ik = builder.build_at(&q).unwrap();
        let mut found = Found { least: f64::INFINITY, near: 0, allocated: 0 };
        let (mut v, mut a) = (vec![0.0; last], vec![0.0; last]);
        for tick in 0..seconds * 1000 {
            if tick % 700 == 0 {
                let target = self.target(&q, &mut draw);
                ik.task_mut(task).unwrap().set_target(Point3::from(target)).unwrap();
            }
            let memory = allocation_counter::measure(|| {
                ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
            });
            found.allocated += memory.bytes_total;
            for (joint, limits) in model.limits().iter().enumerate() {
                let acceleration = (ik.velocity()[joint] - v[joint]) / PERIOD;
                let jerk = (acceleration - a[joint]) / PERIOD;
                assert!(q[joint] > limits.lower - 1e-9 && q[joint] < limits.upper + 1e-9);
                for (value, limit) in [
                    (ik.velocity()[joint], limits.velocity),
                    (acceleration, limits.acceleration),
                    (jerk, limits.jerk),
                ] {
                    assert!(value.abs() <= limit * (1.0 + 1e-6) + 1e-6, "{value} of {limit}");
                }
                (v[joint], a[joint]) = (ik.velocity()[joint], acceleration);
            }
            let least = self.chain.least(&self.bodies, &self.pairs, &q);
            found.least = found.least.min(least);
            found.near += usize::from(least < LEAST + 0.01);
        }
        found
    }

    /// A point in or near a body, mostly, so that the tool meets it on its way.
    fn target(&self, q: &[f64], draw: &mut ChaCha8Rng) -> Vector3<f64> {
        let body = self.bodies[draw.random_range(0..self.bodies.len() - 1)];
        let at = self.chain.poses(q)[body.link] * Point3::from(body.ends[0]);
        at.coords + Vector3::from_fn(|_, _| draw.random_range(-0.25..0.25))
    }
}

fn spheres(is_panda: bool) -> Case {
    let (elbow, wrist) = if is_panda { ([0.0, 0.0, 0.0], 5) } else { ([-0.2, 0.0, 0.1], 4) };
    let last = if is_panda { 7 } else { 6 };
    let point = |link, at, radius| body(link, at, at, radius);
    let bodies = vec![
        point(0, [-0.05, 0.0, 0.05], 0.13),
        point(3, elbow, 0.09),
        point(wrist, [0.0; 3], 0.07),
        point(last, [0.0, 0.0, 0.1], 0.07),
    ];
    let chain = if is_panda { panda() } else { ur5() };
    Case { chain, bodies, pairs: vec![(0, last), (0, wrist), (3, last)] }
}

fn capsules(is_panda: bool) -> Case {
    let Case { chain, pairs, .. } = spheres(is_panda);
    let last = chain.joints.len();
    let upper = if is_panda {
        [[0.0, 0.0, -0.1], [0.0, 0.0, -0.2]]
    } else {
        [[-0.35, 0.0, 0.1], [-0.05, 0.0, 0.1]]
    };
    let fore = if is_panda {
        (5, [0.0, 0.0, -0.2], [0.0, 0.0, -0.1])
    } else {
        (4, [-0.3, 0.0, 0.0], [0.0; 3])
    };
    let bodies = vec![
        body(0, [-0.15, 0.0, 0.05], [0.05, 0.0, 0.05], 0.1),
        body(3, upper[0], upper[1], 0.07),
        body(fore.0, fore.1, fore.2, 0.06),
        body(last, [0.0, -0.08, 0.1], [0.0, 0.08, 0.1], 0.04),
    ];
    Case { chain, bodies, pairs }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(
        std::env::var("AHQP_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(8)
    ))]

    /// Arms, accelerations, jerks, starts and targets are random.
    #[test]
    fn own_bodies_keep_their_distance(
        seed in any::<u64>(), is_panda in any::<bool>(), is_round in any::<bool>(),
        acceleration in 1.0..20.0_f64, jerk in prop_oneof![Just(None), (0.02..0.3_f64).prop_map(Some)],
    ) {
        let case = if is_round { spheres(is_panda) } else { capsules(is_panda) };
        let model = case.chain.model(acceleration, jerk.map(|time| acceleration / time));
        let found = case.run(&model, seed, 10, true);
        prop_assert!(found.least > LEAST - 2e-3, "{:?} of {}", found, LEAST);
        prop_assert_eq!(found.allocated, 0);
    }
}

#[test]
fn bare_arms_collide() {
    let (mut collided, mut near) = (0, 0);
    for seed in 0..8 {
        for case in [spheres(seed % 2 == 0), capsules(seed % 2 == 0)] {
            let model = case.chain.model(10.0, None);
            collided += usize::from(case.run(&model, seed, 4, false).least < 0.0);
            near += usize::from(case.run(&model, seed, 4, true).near > 100);
        }
    }
    assert!(collided >= 8 && near >= 8, "{collided} of 16 arms collide, {near} come near");
}

#[test]
fn pairs_without_bodies_are_refused() {
    let case = spheres(true);
    let model = case.chain.model(10.0, None);
    let sphere = Capsule::sphere(Vector3::zeros(), 0.1).unwrap();
    let bodies = [LinkCapsule { link: "link0".to_owned(), capsule: sphere }];
    let refused = |pairs: &[(&str, &str)], distance| {
        SelfCollisionLimit::new(&model, &bodies, pairs, distance).unwrap_err()
    };
    assert!(
        matches!(refused(&[("link0", "link5")], 0.0), Error::NoBody { link } if link == "link5")
    );
    assert!(refused(&[("link0", "link9")], 0.0).to_string().contains("link9"));
    for distance in [-0.1, f64::NAN] {
        assert!(matches!(refused(&[("link0", "link5")], distance), Error::Value { .. }));
    }
    assert!(matches!(refused(&[], 0.0), Error::Value { got: 0.0, .. }));
}
