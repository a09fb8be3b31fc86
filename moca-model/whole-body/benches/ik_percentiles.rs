//! Median and maximum of the time of many `Ik::step`s in motion, for the robots of the bench `ik`.
//!
//! Run `cargo bench -p whole-body --bench ik_percentiles`. Each motion is run several times, and the fastest run of
//! each step counts. This removes the time that the operating system takes. The arguments `-- ROBOT STEPS` run one
//! robot once, for a profiler.
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

#[path = "support/ik_loops.rs"]
mod ik_loops;

use std::time::Instant;

use ik_loops::{Loop, humanoid, panda, two_arms};

const STEPS: usize = 20_000;
const RUNS: usize = 5;

type Make = fn() -> Loop;

fn main() {
    let robots = [("panda", panda as Make), ("two_arms", two_arms), ("humanoid", humanoid)];
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [name, steps] = &arguments[..]
        && let Some((_, make)) = robots.iter().find(|(robot, _)| robot == name)
    {
        let mut robot = make();
        return (0..steps.parse().unwrap()).for_each(|_| robot.step());
    }
    println!("{:10} {:>9} {:>9} {:>9} {:>9}  [µs]", "", "median", "p99", "p99.9", "slowest");
    for (name, make) in robots {
        let mut times = vec![f64::INFINITY; STEPS];
        for _ in 0..RUNS {
            let mut robot = make();
            (0..500).for_each(|_| robot.step());
            for time in &mut times {
                let begin = Instant::now();
                robot.step();
                *time = time.min(1e6 * begin.elapsed().as_secs_f64());
            }
        }
        times.sort_by(f64::total_cmp);
        let of = |share: usize| times[(STEPS * share / 1000).min(STEPS - 1)];
        let [median, p99, p999, slowest] = [500, 990, 999, 1000].map(of);
        println!("{name:10} {median:9.2} {p99:9.2} {p999:9.2} {slowest:9.2}");
    }
}
