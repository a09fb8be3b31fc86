//! The format of problem sets and the program that solves them.

use std::io::{BufReader, Read, Write};
use std::process::{Command, Output};

use ahqp_core::Objective;
use hqp_problems::file::{HqpError, HqpReader, MOST_VARIABLES, Problem};
use proptest::prelude::*;

const TWO: &str = "hqpset tiny 2
problem 0 bounded 2 3
level B 1 2
0 -1 1
1 -1e30 1e30
level G 1 1
1 -1 -1e30 0.5
level G 0 1
1 1 3 3
problem 7 soft 1 2
level B 0 1
0 2 2
level G 0 0
";

fn read(text: &str) -> Result<Vec<Problem>, HqpError> {
    HqpReader::new(text.as_bytes())?.collect()
}

#[test]
fn problems_are_read_as_they_are_written() {
    let problems = read(TWO).unwrap();
    assert_eq!((problems[0].index, problems[1].index), (0, 7));
    assert_eq!((problems[0].name.as_str(), problems[1].name.as_str()), ("bounded", "soft"));
    let first = &problems[0].hierarchy;
    assert_eq!(first.lower(), [-1.0, f64::NEG_INFINITY]);
    assert_eq!(first.upper(), [1.0, f64::INFINITY]);
    assert_eq!(first.levels().len(), 2);
    assert_eq!(first.levels()[0].objective(), &Objective::None);
    assert_eq!(first.levels()[0].constraints().row(0), Some(&[1.0, -1.0][..]));
    assert_eq!(first.levels()[0].constraints().lower(), [f64::NEG_INFINITY]);
    let Objective::LeastSquares(rows) = first.levels()[1].objective() else { panic!("objective") };
    assert_eq!((rows.lower(), rows.upper()), (&[3.0][..], &[3.0][..]));
    let second = &problems[1].hierarchy;
    assert_eq!(second.upper(), [f64::INFINITY]);
    let Objective::LeastSquares(rows) = second.levels()[0].objective() else { panic!("objective") };
    assert_eq!((rows.row(0), rows.lower()), (Some(&[1.0][..]), &[2.0][..]));
}

#[test]
fn variable_bounded_twice_keeps_both_bounds() {
    let text = "hqpset s 1 problem 0 p 1 1 level B 1 2 0 -1 3 0 2 5";
    let problems = read(text).unwrap();
    assert_eq!(problems[0].hierarchy.levels()[0].constraints().len(), 2);
}

#[test]
fn every_kind_of_line_end_is_accepted() {
    let windows = TWO.replace('\n', "\r\n");
    let one_line = TWO.replace('\n', " ");
    let expected = read(TWO).unwrap();
    let marked = format!("\u{feff}{TWO}");
    for text in [windows.as_str(), TWO.trim_end(), marked.as_str()] {
        assert_eq!(read(text).unwrap(), expected);
    }
    // Only the lines of the levels differ.
    for (problem, expected) in read(&one_line).unwrap().into_iter().zip(expected) {
        assert_eq!((problem.name, problem.hierarchy), (expected.name, expected.hierarchy));
    }
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let cases = [
        ("", 1, "`hqpset`"),
        ("hqpset", 1, "NAME"),
        ("hqp x 1", 1, "`hqp` stands where `hqpset`"),
        ("hqpset x", 1, "COUNT"),
        ("hqpset x one", 1, "`one`"),
        ("hqpset x -1", 1, "not negative"),
        ("hqpset x 1\n", 2, "`problem`"),
        ("hqpset x 0\nproblem", 2, "end of the file"),
        ("hqpset x 1\nproblem 0 p 0 0", 2, "between 1 and"),
        ("hqpset x 1\nproblem 0 p 1.5 0", 2, "whole number"),
        ("hqpset x 1\nproblem 0 p 99999999999999999999 0", 2, "whole number"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel C 0 1", 3, "KIND, B or G"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 2 1", 3, "HARD, 0 or 1"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\nNaN 0 1", 4, "finite number"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\ninf 0 1", 4, "finite number"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\n1,5 0 1", 4, "`1,5`"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\n1 nan 1", 4, "lower bound"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\n1 0 x", 4, "upper bound"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel B 1 1\n1 0 0", 4, "between 0 and 0"),
        // Counts are larger or smaller than the data.
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 2\n1 0 1", 4, "coefficient"),
        ("hqpset x 1\nproblem 0 p 1 2\nlevel G 0 1\n1 0 1\n", 5, "`level`"),
        ("hqpset x 2\nproblem 0 p 1 0\n", 3, "`problem`"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\n1 0 1\n2 0 1", 5, "end of the file"),
        ("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\n1 0 1 1 0 1", 4, "end of the file"),
    ];
    for (text, line, words) in cases {
        let message = read(text).expect_err(text).to_string();
        assert!(message.starts_with(&format!("line {line}: ")), "{text:?}: {message}");
        assert!(message.contains(words), "{text:?}: {message}");
    }
}

#[test]
fn binary_files_are_refused() {
    let noise: Vec<u8> = (0..100_000).map(|i: u32| (i * 7 % 251) as u8 | 0x80).collect();
    for bytes in [&noise[..], b"hqpset \xff\xfe 1", b"hqpset x 1\nproblem 0 \xff 1 0"] {
        let result: Result<Vec<_>, _> = HqpReader::new(bytes).and_then(Iterator::collect);
        assert!(result.unwrap_err().to_string().starts_with("line "));
    }
}

#[test]
fn huge_counts_cost_nothing_until_there_are_numbers() {
    for text in [
        format!("hqpset x {}", u64::MAX),
        format!("hqpset x 1\nproblem 0 p {MOST_VARIABLES} {}", u64::MAX),
        format!("hqpset x 1\nproblem 0 p {MOST_VARIABLES} 1\nlevel G 0 {}", u64::MAX),
        format!("hqpset x 1\nproblem 0 p {MOST_VARIABLES} 1\nlevel B 0 {}", u64::MAX),
    ] {
        assert!(matches!(read(&text), Err(HqpError::Ended { .. })), "{text}");
    }
}

#[test]
fn bounds_too_many_for_rows_are_refused() {
    // Each short line would become a row of 4096 coefficients.
    let bounds = "0 0 1\n".repeat(20_000);
    let text = format!("hqpset x 1\nproblem 0 p {MOST_VARIABLES} 1\nlevel B 0 20000\n{bounds}");
    assert!(matches!(read(&text), Err(HqpError::Value { .. })));
}

#[test]
fn after_an_error_there_is_nothing() {
    let mut reader = HqpReader::new("hqpset x 3\nproblem a".as_bytes()).unwrap();
    assert!(reader.next().is_some_and(|item| item.is_err()));
    assert!(reader.next().is_none());
}

/// A reader that returns its text byte by byte.
struct Slow<'a>(&'a [u8]);

impl Read for Slow<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.0.len().min(buffer.len()).min(1);
        buffer[..count].copy_from_slice(&self.0[..count]);
        self.0 = &self.0[count..];
        Ok(count)
    }
}

proptest! {
    #[test]
    fn how_the_text_arrives_does_not_matter(capacity in 1..40_usize) {
        let slow = BufReader::with_capacity(capacity, Slow(TWO.as_bytes()));
        let problems: Result<Vec<_>, _> = HqpReader::new(slow).unwrap().collect();
        prop_assert_eq!(problems.unwrap(), read(TWO).unwrap());
    }

    #[test]
    fn damaged_text_is_read_or_refused(
        at in 0..TWO.len(), cut in 0..12_usize, put in "[ 0-9a-zA-Z.+\\-\n]{0,6}",
    ) {
        let end = (at + cut).min(TWO.len());
        let text = format!("{}{put}{}", &TWO[..at], &TWO[end..]);
        if let Err(error) = read(&text) {
            prop_assert!(error.to_string().starts_with("line "), "{error}");
        }
    }
}

fn hqp(text: &str, options: &[&str]) -> Output {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    Command::new(env!("CARGO_BIN_EXE_hqp")).arg(file.path()).args(options).output().unwrap()
}

fn lines(output: &Output) -> Vec<Vec<String>> {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    text.lines().map(|line| line.split(' ').map(str::to_owned).collect()).collect()
}

#[test]
fn prints_a_line_for_each_problem() {
    for options in [&[][..], &["--warm"], &["--repeat", "3"], &["--warm", "--repeat", "2"]] {
        let output = hqp(TWO, options);
        assert!(output.status.success());
        let lines = lines(&output);
        assert_eq!(lines.len(), 2);
        assert_eq!((lines[0].len(), lines[1].len()), (5, 4));
        assert_eq!((lines[0][0].as_str(), lines[1][0].as_str()), ("0", "7"));
        assert_eq!((lines[0][1].as_str(), lines[1][1].as_str()), ("0", "0"));
        let x: Vec<f64> = lines[0][3..].iter().map(|word| word.parse().unwrap()).collect();
        assert!((x[0] - 1.0).abs() < 1e-12 && (x[1] - 2.0).abs() < 1e-12);
        let digits = lines[0][3].split('e').next().unwrap();
        assert_eq!(digits.chars().filter(char::is_ascii_digit).count(), 17);
        let errors = String::from_utf8(output.stderr).unwrap();
        let names: Vec<&str> = errors
            .lines()
            .last()
            .unwrap()
            .split(' ')
            .map(|item| {
                let (name, value) = item.split_once('=').unwrap();
                assert!(value.parse::<f64>().unwrap() >= 0.0);
                name
            })
            .collect();
        assert_eq!(names, ["median_us", "p90_us", "p99_us", "max_us", "mean_iterations"]);
    }
}

#[test]
fn certificates_are_checked_and_counted() {
    let output = hqp(TWO, &["--certificate"]);
    assert!(output.status.success());
    assert_eq!(lines(&output), lines(&hqp(TWO, &[])));
    let errors = String::from_utf8(output.stderr).unwrap();
    let [proof, times] = errors.lines().collect::<Vec<_>>()[..] else { panic!("{errors}") };
    let (worst, failed) = proof.split_once(' ').unwrap();
    let worst: f64 = worst.strip_prefix("certificate_worst=").unwrap().parse().unwrap();
    assert!(worst < 1e-9);
    assert_eq!(failed, "certificate_failed=0");
    assert!(times.starts_with("median_us="));
}

#[test]
fn problems_without_a_solution_say_why() {
    let text = "hqpset x 3
problem 0 contradiction 1 2
level G 1 1
1 2 3
level G 1 1
1 0 1
problem 1 backwards 2 1
level G 0 1
1 1 3 2
problem 2 fine 1 1
level G 0 1
1 4 4
";
    let output = hqp(text, &["--warm"]);
    assert!(output.status.success());
    let lines = lines(&output);
    let statuses: Vec<&str> = lines.iter().map(|line| line[1].as_str()).collect();
    assert_eq!(statuses, ["2", "4", "0"]);
    assert_eq!((lines[0][3].as_str(), lines[1].len()), ("NaN", 5));
    let errors = String::from_utf8(output.stderr).unwrap();
    let [infeasible, refused, times] = errors.lines().collect::<Vec<_>>()[..] else {
        panic!("{errors}")
    };
    // The file's name is before the first colon.
    let [infeasible, refused] = [infeasible, refused].map(|line| line.split_once(": ").unwrap().1);
    assert!(
        infeasible.starts_with(
            "problem 0 (contradiction), the level of line 5: its hard rows cannot hold together \
             with those above; row 0 of the level of line "
        ),
        "{infeasible}"
    );
    assert!(
        infeasible.ends_with(
            "what cannot hold together: row 0 of the level of line 5; row 0 of the level of line 3"
        ),
        "{infeasible}"
    );
    assert_eq!(
        refused,
        "problem 1 (backwards), row 0 of the level of line 8: the lower bound 3 lies above the upper \
         bound 2; order them"
    );
    assert!(times.starts_with("median_us="));
}

#[test]
fn equal_infinite_bounds_and_long_conflicts_are_reported() {
    let impossible = "1 2 1e30\n".repeat(30);
    let text = format!(
        "hqpset x 2
problem 0 nowhere 1 1
level G 1 1
1 1e30 1e30
problem 1 crowd 1 2
level B 1 1
0 -1 1
level G 1 30
{impossible}"
    );
    let output = hqp(&text, &[]);
    assert!(output.status.success());
    let errors = String::from_utf8(output.stderr).unwrap();
    let lines: Vec<&str> = errors.lines().collect();
    assert!(lines[0].contains("line 3: both bounds are inf, where no number is"), "{errors}");
    assert!(lines[1].contains("; row 9 of the level of line 8; and 21 more"), "{errors}");
}

#[test]
fn missing_file_or_folder_is_refused() {
    let output = Command::new(env!("CARGO_BIN_EXE_hqp")).arg("/not/there.hqp").output().unwrap();
    assert!(!output.status.success());
    assert!(String::from_utf8(output.stderr).unwrap().contains("/not/there.hqp"));
    let output = hqp("hqpset x 1\nproblem 0 p 1 1\nlevel G 0 1\n1 0 nan\n", &[]);
    assert!(!output.status.success() && output.stdout.is_empty());
    assert!(String::from_utf8(output.stderr).unwrap().contains("line 4"));
    assert!(!hqp(TWO, &["--repeat", "0"]).status.success());
}

#[test]
fn stacked_equalities_solve_the_same_set() {
    let numbers = |output: &Output| -> Vec<f64> {
        assert!(output.status.success(), "{output:?}");
        lines(output).iter().flat_map(|line| line[3..].iter().map(|x| x.parse().unwrap())).collect()
    };
    let (one, other) = (hqp(TWO, &[]), hqp(TWO, &["--stacking", "equalities"]));
    for (one, other) in numbers(&one).into_iter().zip(numbers(&other)) {
        assert!((one - other).abs() < 1e-9, "{one} and {other}");
    }
    let refused = hqp(TWO, &["--stacking=equalities", "--certificate"]);
    let errors = String::from_utf8(refused.stderr).unwrap();
    assert!(!refused.status.success() && errors.contains("only elimination has one"), "{errors}");
}

#[test]
fn both_methods_are_compared_and_timed() {
    let text = "hqpset x 2\nproblem 0 p 2 1\nlevel G 0 1\n1 1 2 2\nproblem 1 none 1 1\nlevel G 1 2\n1 0 0\n1 1 1\n";
    let output = hqp(text, &["--compare", "--json", "--quiet"]);
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let json: serde_json::Value = serde_json::from_str(text.lines().last().unwrap()).unwrap();
    let stacking = &json["stacking"];
    // What has no optimum is not compared.
    assert_eq!((&stacking["compared"], &stacking["failed"]), (&1.into(), &0.into()), "{json}");
    assert!(stacking["largest_difference"].as_f64().unwrap() < 1e-9);
    for method in ["elimination", "equalities"] {
        assert!(stacking[method]["median_us"].as_f64().unwrap() > 0.0, "{json}");
    }
}
