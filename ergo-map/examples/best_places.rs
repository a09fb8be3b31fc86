//! Best place to hold something for people of several statures, with its REBA score.
#![allow(clippy::print_stdout)]

use ergo_map::{Conditions, ErgonomicsMap, Error, FitOptions, MapOptions, Person};

fn main() -> Result<(), Error> {
    for stature in [1.5, 1.6, 1.7, 1.8, 1.9] {
        let map = ErgonomicsMap::build(&Person::new(stature)?, &MapOptions::default(), None)?;
        let (_quadratic, report) = map.fit(&FitOptions::default())?;
        let best = report.optimum; // x forward, y left, z up [m]
        let score = map.sample(&best)?.score;
        let reba = map.assess(&best, &Conditions::default())?.reba;
        println!(
            "{stature} m: hand at {:.2} {:.2} {:.2} m, e_s {score:.2}, REBA {reba}",
            best.x, best.y, best.z
        );
    }
    Ok(())
}
