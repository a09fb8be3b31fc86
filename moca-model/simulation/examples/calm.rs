use std::ops::ControlFlow;
use moca_simulation::ergo_map::{ErgonomicsMap, MapOptions, Person};
use moca_simulation::moca_model::Goal;
use moca_simulation::people::{WalkerSettings, CameraSettings};
use moca_simulation::run::{Run, Scenario};
use moca_simulation::experiment::{Sight, Walk};
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    let get = |name: &str| args.iter().position(|a| a == name).map(|i| args[i + 1].clone());
    let seeds = get("--seeds").unwrap_or("1-3".into());
    let (from, to) = seeds.split_once('-').map(|(a,b)|(a.parse::<u64>().unwrap(), b.parse::<u64>().unwrap())).unwrap_or_else(|| (seeds.parse().unwrap(), seeds.parse().unwrap()));
    let noise: f64 = get("--noise").map_or(1.0, |n| n.parse().unwrap());
    let off = args.iter().any(|a| a == "--off");
    let csv = get("--csv");
    let kin = args.iter().any(|a| a == "--kinematic");
    let person = Person::new(1.75)?;
    let path = std::env::temp_dir().join("calm-map.json");
    let map = match ErgonomicsMap::load(&path) { Ok(map) => map, Err(_) => { let m = ErgonomicsMap::build(&person, &MapOptions::default(), None)?; m.save(&path)?; m } };
    println!("seed      |  1s: work p99 base rest lim rev  joint trk |  2s: work p99 | walk: work p99 lim rev trk | out es  near viol stops retr fail");
    let mut sums: Vec<Vec<f64>> = vec![];
    for seed in from..=to {
        let mut settings = WalkerSettings { seed, ..WalkerSettings::default() };
        settings.camera = CameraSettings { noise: settings.camera.noise * noise, ..settings.camera };
        let walk = Walk::new(settings, Sight::default())?;
        let mut scenario = Scenario::new(walk.percepts.clone(), &person, map.clone())?;
        if args.iter().any(|a| a == "--late") { scenario.arrivals.clone_from(&walk.arrivals); }
        scenario.truth.clone_from(&walk.motion);
        let num = |name: &str, d: f64| get(name).map_or(d, |v| v.parse().unwrap());
        let tr = &mut scenario.settings.tracker;
        tr.position_sigma = num("--ps", tr.position_sigma); tr.heading_sigma = num("--hs", tr.heading_sigma);
        if args.iter().any(|a| a == "--nosep") { scenario = scenario.without_separation(); }
        let st = &mut scenario.settings;
        st.safety.contact_speed = num("--cs", st.safety.contact_speed);
        let bw = num("--bw", 0.5); for i in 0..3 { st.posture.weight[i] = bw; }
        let pg = num("--pg", 1.0); for i in 3..10 { st.posture.gain[i] = pg; }
        st.space.clearance = num("--cl", st.space.clearance);
        st.space.lead = num("--lead", st.space.lead);
        st.safety.person.position_sigma = num("--zd", st.safety.person.position_sigma);
        if kin { scenario = scenario.kinematic(); }
        let run = Run::new(&scenario, if off { Goal::LeastMotion } else { Goal::Ergonomics })?;
        let mut out = csv.as_ref().map(|p| std::io::BufWriter::new(std::fs::File::create(format!("{p}-{seed}.csv")).unwrap()));
        let sum = run.play(|row, plant| {
            if let Some(out) = &mut out {
                use std::io::Write;
                let c = plant.command();
                let sp = plant.controller().space();
                let p = sp.person();
                let truth = scenario.truth.as_ref().and_then(|m| m.at(row.time));
                let hip = truth.map(|t| t[8]).unwrap_or_default();
                let w = sp.workspace().world_from_workspace().translation.vector;
                write!(out, "{} {} {:?} {:?}", row.time, u8::from(row.collaborating), c.safety, c.intention).ok();
                for v in row.actual.iter().chain(&row.desired).chain(&row.qdot).chain(&row.q) { write!(out, " {v}").ok(); }
                write!(out, " {} {} {}", w.x, w.y, w.z).ok();
                for v in [p.map_or(0.0,|p|p.floor.x),p.map_or(0.0,|p|p.floor.y),p.map_or(0.0,|p|p.heading),p.map_or(0.0,|p|p.velocity.x),p.map_or(0.0,|p|p.velocity.y),p.map_or(0.0,|p|p.heading_rate),hip.x,hip.y] { write!(out, " {v}").ok(); }
                for v in row.slack.iter() { write!(out, " {v}").ok(); }
                let j = plant.controller().robot().jacobian(); let mut g = moca_simulation::moca_model::nalgebra::Matrix6::<f64>::zeros(); for c in j.column_iter().skip(3) { g += c * c.transpose(); } let m = g.determinant().max(0.0).sqrt(); let dx = plant.controller().robot().world_from_tool().translation.vector.xy() - moca_simulation::moca_model::nalgebra::Vector2::new(row.q[0], row.q[1]); write!(out, " 0 {m} {} {} {}", u8::from(c.base_motion == moca_simulation::moca_model::BaseMotion::Stands), dx.norm(), u8::from(sp.is_at_rest())).ok();
                let n = plant.controller().safety().nearest();
                write!(out, " {} {} {}", n.map_or(9.0, |n| n.room()), n.map_or(0, |n| n.robot), n.map_or(0, |n| n.other)).ok();
                for v in plant.controller().safety().dbg(&c.joint_velocity) { write!(out, " {v}").ok(); }
                writeln!(out).ok();
            }
            ControlFlow::Continue(())
        })?;
        let c = &sum.calmness;
        let s = c.standing.unwrap(); let s2 = c.settled.unwrap(); 
        let w = c.walking.unwrap_or(s);
        let v = vec![s.workpiece*1e3, s.workpiece_p99*1e3, s.base*1e3, s.base_at_rest, s.base_at_limit, s.base_reversals, s.joints, s.tracking_error*1e3, s2.workpiece*1e3, s2.workpiece_p99*1e3, w.workpiece*1e3, w.workpiece_p99*1e3, w.base_at_limit, w.base_reversals, w.tracking_error*1e3, sum.outside, sum.score_mean, sum.separation_violations as f64, sum.limit_violations as f64+sum.torque_violations.unwrap_or(0) as f64, sum.protective_stops as f64, sum.retreats as f64, sum.solver_failures as f64];
        print(&format!("{seed:>4} {:5.1}", s.duration), &v);
        sums.push(v);
    }
    let n = sums.len() as f64;
    let mean: Vec<f64> = (0..sums[0].len()).map(|i| sums.iter().map(|v| v[i]).sum::<f64>() / n).collect();
    let worst: Vec<f64> = (0..sums[0].len()).map(|i| sums.iter().map(|v| v[i]).fold(if i==3 {1.0} else {0.0}, |a: f64, b| if i==3 {a.min(b)} else {a.max(b)})).collect();
    print("mean      ", &mean); print("worst     ", &worst);
    Ok(())
}
fn print(n: &str, v: &[f64]) {
    println!("{n}| {:5.1} {:5.1} {:5.1} {:.2} {:.2} {:5.1} {:.3} {:4.1} | {:5.1} {:5.1} | {:5.1} {:5.1} {:.2} {:5.1} {:4.1} | {:4.2} {:.2} {} {} {} {} {}", v[0],v[1],v[2],v[3],v[4],v[5],v[6],v[7],v[8],v[9],v[10],v[11],v[12],v[13],v[14],v[15],v[16],v[17],v[18],v[19],v[20],v[21]);
}
