use nalgebra::{DMatrix, DVector, Isometry3, Point3, Quaternion, Translation3, Unit, UnitQuaternion, Vector3};
use whole_body::*;
use crate::support::arms::{arm, arms};
use crate::support::monitor::Monitor;
use crate::support::stacks::{PERIOD, Random, panda};
use crate::support::{jacobian, last_frame, pose};
use std::fmt::Write as _;

fn rest() -> OutOfReach { if std::env::var("REST").is_ok_and(|v| v == "1") { OutOfReach::Rest } else { OutOfReach::Approach } }
fn least(model: &Model, q: &[f64]) -> f64 {
    let jacobian = jacobian(model, q, last_frame(model), Axes::World);
    let rows = DMatrix::from_fn(6, q.len(), |i, j| jacobian[(i, j)] / jacobian.row(i).norm());
    rows.singular_values().min()
}
fn inside(model: &Model, q: &[f64]) -> f64 {
    let joints = q.iter().zip(model.limits());
    let shares = joints.map(|(q, l)| (q - l.lower).min(l.upper - q) / (0.5 * (l.upper - l.lower)));
    shares.fold(1.0, f64::min)
}
fn singular_start(model: &Model, random: &mut Random) -> Vec<f64> {
    let n = model.velocity_count();
    let away = [0.0, 1e-7, 1e-4, 1e-2][(random.unit() * 4.0) as usize % 4];
    loop {
        let limits = model.limits();
        let mut q: Vec<f64> = limits.iter().map(|l| 0.6 * random.within(l.lower, l.upper) + 0.2 * (l.lower + l.upper)).collect();
        for _ in 0..60 {
            let now = least(model, &q);
            if now < 1e-10 { break; }
            let slopes: Vec<f64> = (0..n).map(|i| { let mut moved = q.clone(); moved[i] += 1e-7; (least(model, &moved) - now) / 1e-7 }).collect();
            let square: f64 = slopes.iter().map(|slope| slope * slope).sum();
            q.iter_mut().zip(&slopes).for_each(|(q, slope)| *q -= now * slope / square.max(1e-6));
        }
        if least(model, &q) < 1e-7 && inside(model, &q) > 0.15 {
            q.iter_mut().for_each(|q| *q += away * random.within(-1.0, 1.0));
            return q;
        }
    }
}
fn missing(target: &Isometry3<f64>, now: &Isometry3<f64>) -> Vector3<f64> { target.translation.vector - now.translation.vector }
fn is_in_reach(model: &Model, start: &[f64], target: &Isometry3<f64>, random: &mut Random) -> bool {
    let tool = last_frame(model);
    let mut data = Data::new(model);
    (0..8).any(|attempt| {
        let spread = if attempt < 5 { 0.3 } else { 0.8 };
        let mut q: Vec<f64> = start.iter().map(|q| q + random.within(-spread, spread)).collect();
        let mut left = f64::INFINITY;
        for _ in 0..100 {
            let mut j = nalgebra::Matrix6xX::zeros(q.len());
            let posed = data.pose(model, &q).unwrap();
            posed.jacobian_into(tool, Axes::World, &mut j).unwrap();
            let now = posed.world_from(tool).unwrap();
            let turn = (target.rotation * now.rotation.inverse()).scaled_axis();
            let error = DVector::from_iterator(6, missing(target, &now).iter().chain(turn.iter()).copied());
            left = error.norm();
            if left < 1e-8 { break; }
            let damped = &j * j.transpose() + nalgebra::Matrix6::identity() * (1e-5 * left);
            let Some(factor) = damped.cholesky() else { break };
            let step = j.transpose() * factor.solve(&nalgebra::Vector6::from_column_slice(error.as_slice()));
            q.iter_mut().zip(&step).for_each(|(q, step)| *q += step.clamp(-0.3, 0.3));
        }
        left < 1e-7 && inside(model, &q) > 0.02
    })
}
fn reach(model: &Model, q: &[f64], threshold: f64, target: Isometry3<f64>) -> Ik {
    let mut builder = Ik::builder(model);
    builder.settings(IkSettings { singularity_threshold: threshold, out_of_reach: rest(), ..IkSettings::default() });
    let task = builder.push("pose", FrameTask::new(last_frame(model)));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(q).unwrap();
    ik.task_mut(task).unwrap().set_target(target).unwrap();
    ik
}
/// arrival time, speed 1 s after, speed 3 s after, final error, angle
fn arrival(model: &Model, start: &[f64], threshold: f64, target: Isometry3<f64>) -> [f64; 6] {
    let (tool, mut q) = (last_frame(model), start.to_vec());
    let mut ik = reach(model, start, threshold, target);
    let mut monitor = Monitor::new(model, &q);
    let mut data = Data::new(model);
    let mut arrived: Option<u32> = None;
    let mut speeds = [0.0; 2];
    let mut since_out = 0;
    for tick in 0..13_000_u32 {
        let now = data.pose(model, &q).unwrap().world_from(tool).unwrap();
        let near = missing(&target, &now).norm() < 1e-3;
        if arrived.is_none() && near { arrived = Some(tick); }
        if !near { since_out = tick; }
        if let Some(since) = arrived {
            let fastest = ik.velocity().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            if tick == since + 1000 { speeds[0] = fastest; }
            if tick > since + 2500 { speeds[1] = f64::max(speeds[1], fastest); }
            if tick > since + 3000 { break; }
        }
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        monitor.check(&q);
    }
    let end = data.pose(model, &q).unwrap().world_from(tool).unwrap();
    let t = arrived.map_or(f64::INFINITY, |t| f64::from(t) * PERIOD);
    [t, speeds[0], speeds[1], missing(&target, &end).norm(), end.rotation.angle_to(&target.rotation), f64::from(since_out) * PERIOD]
}
struct Case { arm: usize, start: Vec<f64>, target: Isometry3<f64>, undamped: [f64; 6] }
fn generate(count: usize) {
    let arms = arms();
    let mut random = Random(11);
    let mut out = String::new();
    for number in 0..count {
        let model = &arms[number % arms.len()];
        let distance = [0.03, 0.1][number / arms.len() % 2];
        let (start, target) = loop {
            let start = singular_start(model, &mut random);
            let way = Vector3::from_fn(|_, _| random.within(-1.0, 1.0)).normalize();
            let mut target = pose(model, &start, last_frame(model));
            target.translation.vector += distance * way;
            let mut farther = target;
            farther.translation.vector *= 1.01;
            if is_in_reach(model, &start, &target, &mut random) && is_in_reach(model, &start, &farther, &mut random) { break (start, target); }
        };
        let u = arrival(model, &start, 0.0, target);
        let c = target.rotation.coords;
        let t = target.translation.vector;
        write!(out, "{}", number % arms.len()).unwrap();
        for v in [t.x, t.y, t.z, c.x, c.y, c.z, c.w].iter().chain(&u).chain(&start) { write!(out, " {v:e}").unwrap(); }
        out.push('\n');
    }
    std::fs::write("/tmp/whole_cases.txt", out).unwrap();
}
fn load() -> Vec<Case> {
    std::fs::read_to_string("/tmp/whole_cases.txt").unwrap().lines().map(|line| {
        let v: Vec<f64> = line.split(' ').map(|t| t.parse().unwrap()).collect();
        let target = Isometry3::from_parts(Translation3::new(v[1], v[2], v[3]), UnitQuaternion::new_unchecked(Quaternion::new(v[7], v[4], v[5], v[6])));
        Case { arm: v[0] as usize, target, undamped: v[8..14].try_into().unwrap(), start: v[14..].to_vec() }
    }).collect()
}
fn parallel<T: Send>(count: usize, f: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = std::sync::atomic::AtomicUsize::new(0);
    let out: Vec<std::sync::Mutex<Option<T>>> = (0..count).map(|_| std::sync::Mutex::new(None)).collect();
    std::thread::scope(|s| for _ in 0..2 { s.spawn(|| loop {
        let i = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if i >= count { break; }
        *out[i].lock().unwrap() = Some(f(i));
    }); });
    out.into_iter().map(|m| m.into_inner().unwrap().unwrap()).collect()
}
fn floors(threshold: f64) {
    let (arms, cases) = (arms(), load());
    let results = parallel(cases.len(), |i| arrival(&arms[cases[i].arm], &cases[i].start, threshold, cases[i].target));
    let (mut not, mut slow, mut fast1, mut fast3, mut und) = (0, 0, 0, 0, 0);
    for (i, (c, r)) in cases.iter().zip(&results).enumerate() {
        let u = c.undamped;
        let u_ok = u[0].is_finite() && u[3] < 1e-3;
        und += u32::from(u_ok);
        let ok = r[0].is_finite() && r[3] < 1e-3;
        let late = ok && u_ok && r[0] > 1.5 * u[0].max(0.1);
        let swing1 = ok && r[1] > 0.01;
        let swing3 = ok && r[2] > 0.01;
        not += u32::from(!ok); slow += u32::from(late); fast1 += u32::from(swing1); fast3 += u32::from(swing3);
        if !ok || late || swing3 || (swing1 && arms[c.arm].velocity_count() == 6) {
            println!("{i} {} {:.0e}: {:.3?} undamped {:.3?}{}{}{}{}", arms[c.arm].name(), least(&arms[c.arm], &c.start), r, u, if ok {""} else {" NOT"}, if late {" LATE"} else {""}, if swing1 {" SWING1"} else {""}, if swing3 {" SWING3"} else {""});
        }
    }
    println!("of {}: not {not} late {slow} swing1 {fast1} swing3 {fast3}; undamped arrives {und}", cases.len());
}
const DIRECTIONS: [[f64; 3]; 16] = [[1.0, 0.0, 0.0],[0.0, 0.0, 1.0],[-1.0, 0.0, 0.0],[0.0, 1.0, 0.0],[0.0, -1.0, 0.0],[0.0, 0.0, -1.0],[1.0, 1.0, 1.0],[-1.0, 0.3, 0.8],[0.2, -1.0, 0.5],[-0.7, -0.7, 0.1],[0.001, 0.0, 1.0],[-1.0, 0.001, 0.3],[1.0, 0.0, 1.0],[0.0, 1.0, 1.0],[0.6, 0.0, -0.6],[0.5, -1.0, 0.0]];
struct Arm { model: Model, hand: FrameId, shoulder: Vector3<f64>, start: Vec<f64> }
fn panda_arm() -> Arm {
    let model = panda();
    let hand = model.frame_id("panda_hand_tcp").unwrap();
    Arm { model, hand, shoulder: Vector3::new(0.0, 0.0, 0.333), start: vec![0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785] }
}
fn left_arm() -> Arm {
    let urdf = include_str!("../../examples/urdf/two_arms.urdf");
    let model = Model::from_urdf(urdf, &Description { tips: vec!["left_hand".to_owned()], ..Description::default() }).unwrap();
    let mut start = model.neutral();
    for (joint, angle) in [("left_elbow", -1.5), ("left_shoulder_pitch", 0.5)] {
        let id = model.joint_id(joint).unwrap();
        start[model.joint(id).unwrap().position_index] = angle;
    }
    let hand = model.frame_id("left_hand").unwrap();
    Arm { model, hand, shoulder: Vector3::new(0.0, 0.2, 1.2), start }
}
fn most(values: &[f64]) -> f64 { values.iter().fold(0.0_f64, |a, b| a.max(b.abs())) }
/// kind 0: position over orientation over posture; 1: pose over posture.
fn out(arm: &Arm, kind: usize, target: &Vector3<f64>) -> [f64; 4] {
    let mut builder = Ik::builder(&arm.model);
    builder.settings(IkSettings { out_of_reach: rest(), ..IkSettings::default() });
    let mut q = arm.start.clone();
    let mut ik = if kind == 0 {
        let p = builder.push("position", PositionTask::new(arm.hand));
        builder.push("orientation", OrientationTask::new(arm.hand));
        builder.push("posture", PostureTask::new());
        let mut ik = builder.build_at(&q).unwrap();
        ik.task_mut(p).unwrap().set_target(Point3::from(*target)).unwrap();
        ik
    } else {
        let p = builder.push("pose", FrameTask::new(arm.hand));
        builder.push("posture", PostureTask::new());
        let mut ik = builder.build_at(&q).unwrap();
        let mut there = pose(&arm.model, &q, arm.hand);
        there.translation.vector = *target;
        ik.task_mut(p).unwrap().set_target(there).unwrap();
        ik
    };
    let mut worst = [0.0_f64; 2];
    for tick in 0..12_000 {
        let step = ik.step(&q, PERIOD).unwrap();
        if tick >= 11_000 {
            worst = [worst[0].max(most(step.velocity())), worst[1].max(most(step.acceleration()))];
        }
        step.integrate(&mut q).unwrap();
    }
    let end = pose(&arm.model, &q, arm.hand);
    [worst[0], worst[1], (end.translation.vector - target).norm(), 0.0]
}
fn outs(verbose: bool) {
    let robots = [panda_arm(), left_arm()];
    let results = parallel(128, |i| {
        let (kind, robot, direction, distance) = (i / 64, i / 32 % 2, i / 2 % 16, [1.2, 2.0][i % 2]);
        let arm = &robots[robot];
        out(arm, kind, &(arm.shoulder + distance * Unit::new_normalize(Vector3::from(DIRECTIONS[direction])).into_inner()))
    });
    for group in 0..4 {
        let mut rest = 0;
        let mut sum = 0.0;
        for i in group * 32..group * 32 + 32 {
            let r = results[i];
            let ok = r[0] < 1e-2 && r[1] < 0.1;
            rest += u32::from(ok);
            sum += r[2];
            if verbose || !ok { println!("  {i} dir {:?} {}: {:.4?}", DIRECTIONS[i / 2 % 16], [1.2, 2.0][i % 2], r); }
        }
        println!("kind {} robot {}: {rest} of 32 rest, sum of distances {sum:.4}", group / 2, group % 2);
    }
}
fn singles() {
    let arm_ = panda_arm();
    let there = [1.3003, -0.7164, 1.533, -1.6466, 1.2488, 2.6647, 1.6661];
    let target = pose(&arm_.model, &there, arm_.hand);
    let mut builder = Ik::builder(&arm_.model);
    builder.settings(IkSettings { out_of_reach: rest(), ..IkSettings::default() });
    let task = builder.push("pose", FrameTask::new(arm_.hand));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&arm_.start).unwrap();
    ik.task_mut(task).unwrap().set_target(target).unwrap();
    let mut q = arm_.start.clone();
    let mut when = f64::INFINITY;
    for t in 0..20_000 { ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
        let end = pose(&arm_.model, &q, arm_.hand);
        if (end.translation.vector - target.translation.vector).norm() < 1e-3 && when.is_infinite() { when = t as f64 * 1e-3; } }
    let end = pose(&arm_.model, &q, arm_.hand);
    println!("panda item 5: {:e} m {:e} rad at {when}", (end.translation.vector - target.translation.vector).norm(), end.rotation.angle_to(&target.rotation));
    // comes back
    let mut builder = Ik::builder(&arm_.model);
    builder.settings(IkSettings { out_of_reach: rest(), ..IkSettings::default() });
    let p = builder.push("position", PositionTask::new(arm_.hand));
    builder.push("orientation", OrientationTask::new(arm_.hand));
    builder.push("posture", PostureTask::new());
    let mut ik = builder.build_at(&arm_.start).unwrap();
    let mut q = arm_.start.clone();
    let near = pose(&arm_.model, &q, arm_.hand).translation.vector + Vector3::new(0.1, 0.1, 0.1);
    let mut when = f64::INFINITY;
    for (target, ticks) in [(Vector3::new(-2.0, 0.6, 1.9), 6000), (near, 6000)] {
        ik.task_mut(p).unwrap().set_target(Point3::from(target)).unwrap();
        when = f64::INFINITY;
        for t in 0..ticks { ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
            if when.is_infinite() && (pose(&arm_.model, &q, arm_.hand).translation.vector - near).norm() < 1e-3 { when = t as f64 * 1e-3; } }
    }
    println!("comes back: {:e} m at {when}", (pose(&arm_.model, &q, arm_.hand).translation.vector - near).norm());
    for far in [[1.5, 0.3, 0.5], [0.2, -1.6, 0.9], [-0.9, 0.8, 0.4], [1.0, 1.0, 1.0], [0.95, 0.0, 0.3]] {
        let target = Vector3::from(far);
        let r = out(&arm_, 0, &target);
        println!("far {far:?}: {r:.4?} reach {:.4}", 0.0);
    }
    let model = arm("irb1600");
    let q = vec![0.0; 6];
    let mut target = pose(&model, &q, last_frame(&model));
    target.translation.vector.z -= 0.03;
    println!("irb1600: {:.4?} undamped {:.4?}", arrival(&model, &q, 0.1, target), arrival(&model, &q, 0.0, target));
    let model = arm("ur5");
    for (wrist, elbow) in [(0.0, 1.6), (0.0, 1.0), (0.02, 1.0), (0.02, 0.4)] {
        let q = vec![0.0, -0.6, elbow, 0.2, wrist, 0.0];
        let mut target = pose(&model, &q, last_frame(&model));
        target.translation.vector.x -= 0.1;
        println!("ur5 {wrist} {elbow}: {:.4?} undamped {:.4?}", arrival(&model, &q, 0.1, target), arrival(&model, &q, 0.0, target));
    }
}
fn trace(i: usize, threshold: f64) {
    let (arms, cases) = (arms(), load());
    let c = &cases[i];
    let model = &arms[c.arm];
    let (tool, mut q) = (last_frame(model), c.start.clone());
    let mut ik = reach(model, &c.start, threshold, c.target);
    for t in 0..13000 {
        if t % 100 == 0 && t < 4000 || t % 1000 < 5 {
            let now = pose(model, &q, tool);
            println!("{t} e {:.5} {:.5} σ {:.1e} q {:.3?} v {:.4?}", missing(&c.target, &now).norm(), now.rotation.angle_to(&c.target.rotation), least(model, &q), q, ik.velocity().to_vec());
        }
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    }
}
fn trace_out(i: usize) {
    let robots = [panda_arm(), left_arm()];
    let (kind, robot, direction, distance) = (i / 64, i / 32 % 2, i / 2 % 16, [1.2, 2.0][i % 2]);
    let arm = &robots[robot];
    let target = arm.shoulder + distance * Unit::new_normalize(Vector3::from(DIRECTIONS[direction])).into_inner();
    let mut builder = Ik::builder(&arm.model);
    builder.settings(IkSettings { out_of_reach: rest(), ..IkSettings::default() });
    let mut q = arm.start.clone();
    let mut ik = if kind == 0 {
        let p = builder.push("position", PositionTask::new(arm.hand));
        builder.push("orientation", OrientationTask::new(arm.hand));
        builder.push("posture", PostureTask::new());
        let mut ik = builder.build_at(&q).unwrap();
        ik.task_mut(p).unwrap().set_target(Point3::from(target)).unwrap();
        ik
    } else {
        let p = builder.push("pose", FrameTask::new(arm.hand));
        builder.push("posture", PostureTask::new());
        let mut ik = builder.build_at(&q).unwrap();
        let mut there = pose(&arm.model, &q, arm.hand);
        there.translation.vector = target;
        ik.task_mut(p).unwrap().set_target(there).unwrap();
        ik
    };
    for t in 0..12000 {
        if t % 200 == 0 && t < 4000 || t % 1000 < 5 || (t > 11000 && t % 20 == 0) {
            let now = pose(&arm.model, &q, arm.hand);
            println!("{t} e {:.5} q {:.3?} v {:.3?}", (target - now.translation.vector).norm(), q, ik.velocity().to_vec());
        }
        let detail = t >= 11400;
        if detail { eprintln!("tick {t} q {q:.3?} v {:.3?}", ik.velocity()); }
        whole_body::set_trace(detail);
        ik.step(&q, PERIOD).unwrap().integrate(&mut q).unwrap();
    }
}
pub fn main() {
    let args: Vec<String> = std::env::args().collect();
    let number = |i: usize, d: f64| args.get(i).map_or(d, |t| t.parse().unwrap());
    match args[1].as_str() {
        "gen" => generate(number(2, 200.0) as usize),
        "floors" => floors(number(2, 0.1)),
        "outs" => outs(args.len() > 2),
        "singles" => singles(),
        "trace" => trace(number(2, 0.0) as usize, number(3, 0.1)),
        "traceout" => trace_out(number(2, 0.0) as usize),
        _ => panic!(),
    }
}
