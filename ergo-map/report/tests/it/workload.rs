//! NASA-TLX questionnaires: scores, tests and the box plot.

use std::fmt::Write;
use std::ops::ControlFlow;

use ergo_report::Error;
use ergo_report::sheets::{SheetTable, Unknown};
use ergo_report::workload::{Quartiles, Questionnaire, SignedRank, WorkloadStudy, figure};
use proptest::prelude::*;
use serde::Deserialize;

const RATINGS: &str =
    "temporal_demand,mental_demand,effort,physical_demand,performance,frustration";
const WEIGHTS: &str = "weight_temporal_demand,weight_mental_demand,weight_effort,\
                       weight_physical_demand,weight_performance,weight_frustration";

/// A study with the results of NumPy, SciPy and statsmodels (`tests/data/tlx.py`).
#[derive(Deserialize)]
struct Golden {
    before: Vec<Vec<f64>>,
    after: Vec<Vec<f64>>,
    weights: Vec<f64>,
    p: Vec<f64>,
    effect: Vec<f64>,
    p_holm: Vec<f64>,
    quartiles: Vec<[f64; 3]>,
    raw: Vec<f64>,
    weighted: Vec<f64>,
}

fn golden() -> Vec<Golden> {
    let studies = include_str!("../data/tlx.jsonl").lines();
    studies.map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn join(cells: impl IntoIterator<Item = f64>) -> String {
    cells.into_iter().map(|cell| cell.to_string()).collect::<Vec<_>>().join(",")
}

impl Golden {
    fn table(&self) -> String {
        let mut table = format!("condition,subject,{RATINGS},{WEIGHTS}\n");
        for (name, ratings) in [("without", &self.before), ("with", &self.after)] {
            for subject in 0..ratings[0].len() {
                let ratings = join(ratings.iter().map(|scale| scale[subject]));
                let weights = join(self.weights.iter().copied());
                writeln!(table, "{name},S{subject},{ratings},{weights}").unwrap();
            }
        }
        table
    }
}

fn read(table: &str) -> Result<Vec<Questionnaire>, Error> {
    let mut table = SheetTable::<Questionnaire, _>::new(table.as_bytes(), Unknown::Refuse)?;
    let mut read = Vec::new();
    let all = table.score(std::io::sink(), |questionnaire| {
        read.push(questionnaire.clone());
        ControlFlow::Continue(())
    })?;
    assert!(all.is_continue());
    Ok(read)
}

fn questionnaires(table: &str) -> Vec<Questionnaire> {
    read(table).unwrap()
}

fn assert_near(ours: f64, theirs: f64, what: &str) {
    assert!((ours - theirs).abs() <= 1e-12 * (1.0 + theirs.abs()), "{what}: {ours} {theirs}");
}

#[test]
fn scores_and_tests_are_those_of_scipy() {
    let studies = golden();
    assert_eq!(studies.len(), 100);
    for (number, golden) in studies.iter().enumerate() {
        let study = WorkloadStudy::new(&questionnaires(&golden.table())).unwrap();
        let [comparison] = study.comparisons().try_into().unwrap();
        assert_eq!((comparison.first.as_str(), comparison.second.as_str()), ("without", "with"));
        for (scale, tested) in comparison.tested.iter().take(6).enumerate() {
            let what = format!("study {number}, {}", tested.name);
            assert_near(tested.p, golden.p[scale], &what);
            assert_near(tested.effect, golden.effect[scale], &what);
            assert_near(tested.p_holm.unwrap(), golden.p_holm[scale], &what);
        }
        let after = &study.conditions()[1];
        for (scale, [lower, median, upper]) in golden.quartiles.iter().enumerate() {
            let quartiles = Quartiles::of(&after.scale(scale));
            assert_near(quartiles.lower, *lower, "lower quartile");
            assert_near(quartiles.median, *median, "median");
            assert_near(quartiles.upper, *upper, "upper quartile");
        }
        let weighted = after.weighted.as_ref().unwrap();
        let scores = after.raw.iter().chain(weighted);
        for (ours, theirs) in scores.zip(golden.raw.iter().chain(&golden.weighted)) {
            assert_near(*ours, *theirs, "raw and weighted TLX");
        }
    }
}

proptest! {
    /// Compares with a count of all 2^n signs.
    #[test]
    fn the_probability_counts_all_signs(
        differences in prop::collection::vec((-6..=6_i32).prop_map(|x| f64::from(x) / 2.0), 0..10),
    ) {
        let test = SignedRank::of(&differences);
        let sizes: Vec<f64> = differences.iter().map(|x| x.abs()).filter(|x| *x > 0.0).collect();
        // The mean rank counts smaller values fully, and equal ones half.
        let rank = |size: f64| {
            let below = sizes.iter().filter(|other| **other < size).count() as f64;
            let equal = sizes.iter().filter(|other| **other == size).count() as f64;
            below + f64::midpoint(equal, 1.0)
        };
        let ranks: Vec<f64> = sizes.iter().map(|size| rank(*size)).collect();
        let all = 1_u32 << ranks.len();
        let sum = |signs: u32| -> f64 {
            let chosen = ranks.iter().enumerate().filter(|(bit, _)| signs >> bit & 1 == 1);
            chosen.map(|(_, rank)| rank).sum()
        };
        let observed = test.positive;
        let below = (0..all).filter(|signs| sum(*signs) <= observed).count();
        let above = (0..all).filter(|signs| sum(*signs) >= observed).count();
        let p = (2.0 * below.min(above) as f64 / f64::from(all)).min(1.0);
        prop_assert!((test.p - p).abs() < 1e-12, "{} {p}", test.p);
        prop_assert_eq!(test.pairs, ranks.len());
        let turned: Vec<f64> = differences.iter().map(|x| -x).collect();
        let turned = SignedRank::of(&turned);
        prop_assert_eq!((turned.p, turned.effect()), (test.p, -test.effect()));
    }

    /// The same rating on either scale of performance gives the same score.
    #[test]
    fn performance_may_be_rated_either_way(performance in 0..=20_u8, other in 0..=20_u8) {
        let rated = format!("subject,{RATINGS}\nS,{other},1,2,3,{performance},4\n");
        let inverted = RATINGS.replace("performance", "performance_inverted");
        let turned = format!("subject,{inverted}\nS,{other},1,2,3,{},4\n", 20 - performance);
        let [rated, turned] = [rated, turned].map(|table| questionnaires(&table).remove(0));
        prop_assert_eq!(rated.ratings().unwrap(), turned.ratings().unwrap());
        prop_assert_eq!(rated.ratings().unwrap()[4], f64::from(performance));
    }
}

const PAIR: &str = "subject,condition,temporal_demand,mental_demand,effort,physical_demand,\
                    performance,frustration\n\
                    A,off,10,8,12,14,6,4\nB,off,9,9,11,15,5,3\nA,on,6,5,7,6,3,2\nB,on,4,9,8,7,4,3\n";

fn refused(table: &str) -> String {
    WorkloadStudy::new(&questionnaires(table)).unwrap_err().to_string()
}

#[test]
fn studies_that_cannot_be_compared_are_refused() {
    let empty = format!("subject,{RATINGS}\n");
    assert_eq!(refused(&empty), "the table has no questionnaire; give one a row");
    let twice = format!("{PAIR}A,on,1,1,1,1,1,1\n");
    assert!(refused(&twice).contains("subject \"A\" answers twice for the condition \"on\""));
    let alone = format!("{PAIR}C,on,1,1,1,1,1,1\n");
    assert!(
        refused(&alone).contains("subject \"C\" has no questionnaire for the condition \"off\"")
    );
    let many =
        (0..501).map(|number| format!("\nS{number},1,1,1,1,1,1")).collect::<Vec<_>>().concat();
    let many = refused(&format!("subject,{RATINGS}{many}"));
    assert!(many.starts_with("501 subjects; at most"), "{many}");
}

#[test]
fn tables_with_faults_are_refused_with_the_place() {
    let refused = |table: &str, says: &str| {
        let message = read(table).unwrap_err().to_string();
        assert!(message.contains(says), "{table:?}: {message}");
    };
    let row = |names: &str, cells: &str| format!("subject,{names}\n{cells}\n");
    refused(
        &row(RATINGS, "S,1,2,3,4,21,6"),
        "line 2, column 6 (performance): \"21\" is not possible",
    );
    refused(&row(RATINGS, "S,1,2,,4,5,6"), "line 2, column 4 (effort)");
    refused(&row(RATINGS, "S,1,2,nan,4,5,6"), "a rating from 0 to 20");
    refused(&row(RATINGS, ",1,2,3,4,5,6"), "line 2, column 1 (subject)");
    let without = "temporal_demand,mental_demand,effort,physical_demand,frustration";
    refused(&row(without, "S,1,2,3,4,5"), "line 2: no rating of performance");
    let both = format!("{RATINGS},performance_inverted");
    refused(&row(&both, "S,1,2,3,4,5,6,7"), "line 2: performance and performance_inverted");
    let weighed = format!("{RATINGS},{WEIGHTS}");
    refused(&row(&weighed, "S,1,2,3,4,5,6,5,4,3,2,1,1"), "line 2: the weights add up to 16");
    refused(&row(&weighed, "S,1,2,3,4,5,6,6,4,3,2,0,0"), "(weight_temporal_demand): \"6\"");
    let some = format!("{RATINGS},weight_effort");
    refused(&row(&some, "S,1,2,3,4,5,6,5"), "line 2: weights for 1 of six scales");
    refused(&row("temporal_demand,mental_demand", "S,1,2"), "missing columns: effort");
    refused(
        &row(&RATINGS.replace("mental_demand", "metal_demand"), "S,1,2,3,4,5,6"),
        "do you mean mental_demand?",
    );
    refused("", "the table is empty");
}

/// Each of six places has boxes from the lower to the upper quartile, at the height of the ratings.
#[test]
fn the_figure_shows_each_condition() {
    let one = WorkloadStudy::new(&questionnaires(PAIR)).unwrap();
    let svg = figure(&one).unwrap();
    let boxes = svg.matches("<rect").count();
    // The background, twelve boxes with their frames, and two marks of the legend.
    assert_eq!(boxes, 1 + 2 * 12 + 2, "{svg}");
    assert!(svg.contains("off") && svg.contains("on"));
}
