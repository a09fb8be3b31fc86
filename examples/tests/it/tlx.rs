//! NASA-TLX questionnaires: scores, tests and the program that prints them.

use std::fmt::Write;

use examples::sheets::{SheetTable, Unknown};
use examples::workload::{
    Quartiles, Questionnaire, Scale, SignedRank, WorkloadError, WorkloadStudy, figure,
};
use proptest::prelude::*;
use serde::Deserialize;

use crate::support::Runs;

const RATINGS: &str =
    "temporal_demand,mental_demand,effort,physical_demand,performance,frustration";
const WEIGHTS: &str = "weight_temporal_demand,weight_mental_demand,weight_effort,\
                       weight_physical_demand,weight_performance,weight_frustration";

/// A study as NumPy, SciPy and statsmodels see it (`tests/data/tlx.py`).
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

fn questionnaires(table: &str) -> Vec<Questionnaire> {
    let mut table = SheetTable::<Questionnaire, _>::new(table.as_bytes(), Unknown::Refuse).unwrap();
    let mut read = Vec::new();
    table
        .score(std::io::sink(), |questionnaire| {
            read.push(questionnaire.clone());
            true
        })
        .unwrap();
    read
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
    /// All 2^n signs counted one by one.
    #[test]
    fn the_probability_counts_all_signs(
        differences in prop::collection::vec((-6..=6_i32).prop_map(|x| f64::from(x) / 2.0), 0..10),
    ) {
        let test = SignedRank::of(&differences);
        let sizes: Vec<f64> = differences.iter().map(|x| x.abs()).filter(|x| *x > 0.0).collect();
        // A mean rank: those below count whole, equal ones half.
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

fn refused(table: &str) -> WorkloadError {
    WorkloadStudy::new(&questionnaires(table)).unwrap_err()
}

#[test]
fn studies_that_cannot_be_compared_are_refused() {
    let empty = format!("subject,{RATINGS}\n");
    assert_eq!(refused(&empty), WorkloadError::Empty);
    let twice = format!("{PAIR}A,on,1,1,1,1,1,1\n");
    assert!(matches!(refused(&twice), WorkloadError::Repeated { subject, condition }
        if subject == "A" && condition == "on"));
    let alone = format!("{PAIR}C,on,1,1,1,1,1,1\n");
    assert!(matches!(refused(&alone), WorkloadError::Unpaired { subject, condition }
        if subject == "C" && condition == "off"));
    let many =
        (0..501).map(|number| format!("\nS{number},1,1,1,1,1,1")).collect::<Vec<_>>().concat();
    let many = refused(&format!("subject,{RATINGS}{many}"));
    assert!(matches!(many, WorkloadError::TooMany { found: 501, .. }), "{many}");
}

#[test]
fn tables_with_faults_are_refused_with_the_place() {
    let tlx = |table: &str| Runs::new("tlx").with(&["--input", "-"]).run_on(table);
    let row = |names: &str, cells: &str| format!("subject,{names}\n{cells}\n");
    tlx(&row(RATINGS, "S,1,2,3,4,21,6"))
        .failed(1, "standard input: line 2, column 6 (performance): \"21\" is not possible");
    tlx(&row(RATINGS, "S,1,2,,4,5,6")).failed(1, "line 2, column 4 (effort)");
    tlx(&row(RATINGS, "S,1,2,nan,4,5,6")).failed(1, "a rating from 0 to 20");
    tlx(&row(RATINGS, ",1,2,3,4,5,6")).failed(1, "line 2, column 1 (subject)");
    let without = "temporal_demand,mental_demand,effort,physical_demand,frustration";
    tlx(&row(without, "S,1,2,3,4,5")).failed(1, "line 2: no rating of performance");
    let both = format!("{RATINGS},performance_inverted");
    tlx(&row(&both, "S,1,2,3,4,5,6,7")).failed(1, "line 2: performance and performance_inverted");
    let weighed = format!("{RATINGS},{WEIGHTS}");
    tlx(&row(&weighed, "S,1,2,3,4,5,6,5,4,3,2,1,1")).failed(1, "line 2: the weights add up to 16");
    tlx(&row(&weighed, "S,1,2,3,4,5,6,6,4,3,2,0,0")).failed(1, "(weight_temporal_demand): \"6\"");
    let some = format!("{RATINGS},weight_effort");
    tlx(&row(&some, "S,1,2,3,4,5,6,5")).failed(1, "line 2: weights for 1 of six scales");
    tlx(&row("temporal_demand,mental_demand", "S,1,2")).failed(1, "missing columns: effort");
    tlx(&row(&RATINGS.replace("mental_demand", "metal_demand"), "S,1,2,3,4,5,6"))
        .failed(1, "do you mean mental_demand?");
    tlx(&format!("{PAIR}C,on,1,1,1,1,1,1\n")).failed(1, "subject \"C\" has no questionnaire");
    tlx("").failed(1, "standard input: the table is empty");
}

#[test]
fn the_program_prints_scores_tests_and_a_figure() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name| folder.path().join(name).to_str().unwrap().to_owned();
    let (scores, drawing) = (path("scores.csv"), path("boxes.svg"));
    let arguments = ["--input", "-", "--scores", &scores, "--figure", &drawing, "--json"];
    let ran = Runs::new("tlx").with(&arguments).run_on(PAIR).done();
    assert!(ran.output.starts_with("off (2 subjects"), "{}", ran.output);
    assert!(ran.output.contains("\non against off\n"), "{}", ran.output);
    let json: serde_json::Value = serde_json::from_str(ran.output.lines().last().unwrap()).unwrap();
    assert_eq!(json["subjects"], 2);
    assert_eq!(json["conditions"][1]["name"], "on");
    assert_eq!(json["comparisons"][0]["tested"][3]["median_difference"], -8.0);
    assert_eq!(json["comparisons"][0]["tested"][3]["effect"], -1.0);
    assert_eq!(json["partial"], false);
    let scored = std::fs::read_to_string(&scores).unwrap();
    assert!(scored.lines().nth(1).unwrap().starts_with("A,off,10,8,12,14,6,4,9,"), "{scored}");
    let svg = std::fs::read_to_string(&drawing).unwrap();
    for scale in Scale::ALL {
        assert!(svg.contains(scale.abbreviation()), "{svg}");
    }
    // A place that cannot be written is known before the table is read.
    let nowhere = path("none/boxes.svg");
    Runs::new("tlx").with(&["--input", "-", "--figure", &nowhere]).run_on("").failed(1, "none");
}

/// A box from the lower to the upper quartile in each of six places, at the height of the ratings.
#[test]
fn the_figure_shows_each_condition() {
    let one = WorkloadStudy::new(&questionnaires(PAIR)).unwrap();
    let svg = figure(&one).unwrap();
    let boxes = svg.matches("<rect").count();
    // The background, twelve boxes with their frames, and two marks of the legend.
    assert_eq!(boxes, 1 + 2 * 12 + 2, "{svg}");
    assert!(svg.contains("off") && svg.contains("on"));
}

#[test]
fn ratings_to_a_hundred_are_those_to_twenty_times_five() {
    let row = |values: [f64; 6]| format!("subject,{RATINGS}\nS1,{}\n", join(values));
    let twenty = row([4.0, 6.5, 8.0, 2.0, 17.0, 1.0]);
    let hundred = row([20.0, 32.5, 40.0, 10.0, 85.0, 5.0]);
    let tlx = |arguments: &[&str], table: &str| {
        Runs::new("tlx").with(&["--input", "-"]).with(arguments).run_on(table)
    };
    let expected = tlx(&[], &twenty).done().output;
    assert_eq!(tlx(&["--hundred"], &hundred).done().output, expected);
    tlx(&[], &hundred).failed(
        1,
        "column 3 (mental_demand): \"32.5\" is not possible; give a rating from 0 to 20",
    );
    let beyond = row([101.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    tlx(&["--hundred"], &beyond).failed(1, "\"101\" is not possible; give a rating from 0 to 100");
}
