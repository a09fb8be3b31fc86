//! Shards: together they are the whole, whatever their number.

use std::collections::BTreeMap;
use std::fs;
use std::ops::ControlFlow;

use examples::shards::{Merged, Part, Shard, ShardError};
use examples::soak::{self, Job, SoakPart, merged_summary};
use moca_simulation::plant::{Drive, PlantSettings};
use moca_simulation::soak::{Soak, Summary};
use proptest::prelude::*;

use crate::support::Runs;

type Numbers = Part<u8, u64>;

fn part(shard: Shard, cases: u64) -> Numbers {
    let results = shard.of(cases).map(|case| (case, 3 * case)).collect::<BTreeMap<_, _>>();
    Part { program: "numbers".to_owned(), job: 1, shard, cases, results, times: () }
}

fn shards(count: u64) -> impl Iterator<Item = Shard> {
    (1..=count).map(move |index| format!("{index}/{count}").parse().unwrap())
}

proptest! {
    #[test]
    fn every_case_is_of_one_shard(cases in 0..50_u64, count in 1..20_u64) {
        for case in 0..cases {
            prop_assert_eq!(shards(count).filter(|shard| shard.contains(case)).count(), 1);
        }
    }

    #[test]
    fn all_shards_in_any_order_are_the_whole(
        cases in 0..50_u64, count in 1..20_u64, order in any::<proptest::sample::Index>(),
    ) {
        let mut parts: Vec<_> = shards(count).map(|shard| part(shard, cases)).collect();
        let middle = order.index(parts.len());
        parts.rotate_left(middle);
        let merged = Merged::of(parts).unwrap();
        prop_assert_eq!(merged.results, (0..cases).map(|case| 3 * case).collect::<Vec<_>>());
    }

    #[test]
    fn no_shard_may_be_missing(cases in 0..50_u64, count in 2..20_u64, one in any::<proptest::sample::Index>()) {
        let mut parts: Vec<_> = shards(count).map(|shard| part(shard, cases)).collect();
        let removed = parts.remove(one.index(parts.len())).shard.to_string();
        let error = Merged::of(parts).unwrap_err();
        prop_assert!(error.to_string().contains(&removed), "{}", error);
    }
}

#[test]
fn shards_that_do_not_fit_are_refused() {
    let two = || shards(2).map(|shard| part(shard, 5)).collect::<Vec<_>>();
    let refused = |change: fn(&mut Vec<Numbers>)| {
        let mut parts = two();
        change(&mut parts);
        Merged::of(parts).unwrap_err()
    };
    assert!(matches!(refused(Vec::clear), ShardError::Nothing));
    assert!(matches!(refused(|parts| parts[1].job = 2), ShardError::Different { .. }));
    assert!(matches!(refused(|parts| parts[1].cases = 6), ShardError::Different { .. }));
    assert!(matches!(refused(|parts| parts[1].shard = parts[0].shard), ShardError::Twice { .. }));
    let incomplete = refused(|parts| {
        parts[0].results.pop_first();
    });
    assert!(matches!(incomplete, ShardError::Cases { got: 2, wanted: 3, .. }), "{incomplete}");
    for text in ["", "1", "0/2", "3/2", "1/0", "-1/2", "1/2/3", "a/b", "99999999999/99999999999"] {
        assert!(text.parse::<Shard>().is_err(), "{text}");
    }
}

/// Number of ticks: few for a test, and more than an episode of some seeds.
const TICKS: u64 = 4_300;

fn soak(seed: u64) -> Soak {
    let robot = PlantSettings { drive: Drive::Kinematic, ..PlantSettings::default() };
    Soak::new(seed, TICKS).unwrap().with_robot(robot)
}

#[test]
fn sharded_soak_equals_whole_except_times() {
    let second = "2/3".parse().unwrap();
    let seed = (0..100).find(|seed| !soak::episodes(&soak(*seed), second).is_empty()).unwrap();
    let run = |shard: Shard| -> SoakPart {
        let job = Job::new(seed, TICKS, Drive::Kinematic, String::new());
        soak::run(&soak(seed), job, shard, |_| ControlFlow::Continue(())).unwrap()
    };
    let whole = run(Shard::WHOLE);
    let whole = Summary::of(&whole.results, &whole.times);
    assert_eq!((whole.episodes, whole.ticks), (2, TICKS));
    let parts: Vec<_> = shards(3).map(run).collect();
    // The shards come from their files.
    let folder = tempfile::tempdir().unwrap();
    let files: Vec<_> = parts
        .iter()
        .map(|part| folder.path().join(part.shard.to_string().replace('/', "-")))
        .collect();
    for (part, file) in parts.iter().zip(&files) {
        fs::write(file, part.to_json().unwrap()).unwrap();
    }
    let merged = merged_summary(Merged::read(&files).unwrap());
    let text = |mut summary: Summary| {
        summary.tick_us = [0.0; 2];
        format!("{summary}\n{:?}", summary.findings)
    };
    assert_eq!(text(merged), text(whole));
}

#[test]
fn merge_says_what_is_wrong_with_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (file, other) = (path("1.json"), path("other.json"));
    let shard = ["--ticks=50", "--kinematic", "--shard=1/2", "--shard-file", &file];
    Runs::new("soak").with(&shard).run().done();
    Runs::new("merge").with(&[&file]).run().failed(1, "missing: 2/2");
    Runs::new("merge").with(&[&file, &file]).run().failed(1, "1/2 is there twice");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&other, &text[..text.len() / 2]).unwrap();
    Runs::new("merge").with(&[&file, &other]).run().failed(1, "other.json is not the whole file");
    fs::write(&other, text.replace("\"soak\"", "\"nobody\"")).unwrap();
    Runs::new("merge")
        .with(&[&other])
        .run()
        .failed(1, "known are soak, actions evaluate and experiment");
    Runs::new("merge").with(&[path("none")]).run().failed(1, "cannot read");
    Runs::new("soak").with(&["--shard=1/2"]).run().failed(2, "--shard-file");
    Runs::new("soak").with(&["--shard=3/2", "--shard-file", &file]).run().failed(2, "I/N");
}
