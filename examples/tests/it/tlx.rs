//! The program that scores NASA-TLX questionnaires and compares conditions.

use ergo_report::workload::Scale;

use crate::support::Runs;

const RATINGS: &str =
    "temporal_demand,mental_demand,effort,physical_demand,performance,frustration";
const PAIR: &str = "subject,condition,temporal_demand,mental_demand,effort,physical_demand,\
                    performance,frustration\n\
                    A,off,10,8,12,14,6,4\nB,off,9,9,11,15,5,3\nA,on,6,5,7,6,3,2\nB,on,4,9,8,7,4,3\n";

#[test]
fn tables_with_faults_are_refused_with_the_place() {
    let tlx = |table: &str| Runs::new("tlx").with(&["--input", "-"]).run_on(table);
    tlx(&format!("subject,{RATINGS}\nS,1,2,3,4,21,6\n"))
        .failed(1, "standard input: line 2, column 6 (performance): \"21\" is not possible");
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
    // A place that cannot be written is detected before the table is read.
    let nowhere = path("none/boxes.svg");
    Runs::new("tlx").with(&["--input", "-", "--figure", &nowhere]).run_on("").failed(1, "none");
}

#[test]
fn ratings_to_100_are_divided_by_five() {
    let row = |values: [f64; 6]| {
        format!("subject,{RATINGS}\nS1,{}\n", values.map(|value| value.to_string()).join(","))
    };
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
