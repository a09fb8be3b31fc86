//! Unfinished recordings. `record` is interrupted, killed or has nowhere to write, and `follow` plays the remainder.
#![cfg(unix)]

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};

use percept_recording::{self, Completeness, IfPartial, Reader, Recording, RecordingError};

use crate::support::{Ran, Runs, signal};

/// An hour of camera frames takes some 70 MB.
const HOUR: &str = "--duration=3600";

/// Runs `follow` with a recording and no report, to its end.
fn follow(recording: &Path, options: &[&str]) -> Ran {
    let played = Runs::follow().with(&["--no-report", "--recording"]).with(&[recording]);
    played.with(options).run()
}

/// Runs a program in a shell that has set its limits by `before`.
fn after(before: &str, program: &str, arguments: &[&str]) -> Ran {
    let script = format!("{before}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    let output = command.args(["-c", &script, program]).args(arguments).output().unwrap();
    Ran {
        status: output.status,
        output: String::from_utf8(output.stdout).unwrap(),
        errors: String::from_utf8(output.stderr).unwrap(),
    }
}

fn record_after(before: &str, output: &Path) -> Ran {
    let arguments = [HOUR, "--output", output.to_str().unwrap()];
    after(before, env!("CARGO_BIN_EXE_record"), &arguments)
}

fn record_hour(output: &Path) -> Child {
    Runs::new("record").with(&[HOUR, "--output"]).with(&[output]).start()
}

/// The files of a folder, with hidden ones.
fn files(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
}

/// A complete recording of some seconds.
fn short(folder: &Path) -> PathBuf {
    let path = folder.join("short.jsonl");
    Runs::new("record").with(&["--duration=4", "--output"]).with(&[&path]).run().done();
    path
}

#[test]
fn cut_recording_is_refused_or_partial() {
    let folder = tempfile::tempdir().unwrap();
    let path = short(folder.path());
    let bytes = fs::read(&path).unwrap();
    let cut = bytes.len() - 1500;
    fs::write(&path, &bytes[..cut]).unwrap();
    let line = bytes[..cut].split(|byte| *byte == b'\n').count();
    let place = format!("{}: line {line}: the recording is cut off here", path.display());

    let refused = follow(&path, &[]).failed(1, &place).failed(1, "--partial plays");
    assert_eq!((refused.output.as_str(), refused.errors.lines().count()), ("", 1), "{refused:?}");

    let played = follow(&path, &["--partial", "--json", "--quiet"]).done();
    let says = format!("{} is partial: {} whole camera frames", path.display(), line - 2);
    assert!(played.errors.contains(&says), "{played:?}");
    let summary = played.json();
    assert_eq!((&summary["partial"], &summary["limit_violations"]), (&true.into(), &0.into()));
}

#[test]
fn first_version_recording_plays_with_warning() {
    let folder = tempfile::tempdir().unwrap();
    let path = short(folder.path());
    let whole = fs::read_to_string(&path).unwrap().replace("\"version\":2", "\"version\":1");
    let old: Vec<&str> = whole.lines().filter(|line| !line.contains("\"end\"")).collect();
    // A text editor may store it like this.
    fs::write(&path, format!("\u{feff}{}\r\n", old.join("\r\n"))).unwrap();
    let played = follow(&path, &["--json", "--quiet"]).done();
    let says = format!("{} is of version 1, which has no closing line", path.display());
    assert!(played.errors.contains(&says), "{played:?}");
    assert_eq!(played.json()["partial"], false);
}

#[test]
fn partial_recording_gives_partial_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = short(folder.path());
    let whole = fs::read_to_string(&path).unwrap();
    fs::write(&path, whole.replace("\"complete\":true", "\"complete\":false")).unwrap();
    let report = folder.path().join("report");
    let options = ["--partial", "--quiet", "--output", report.to_str().unwrap(), "--recording"];
    Runs::follow().with(&options).with(&[&path]).run().done();
    let mut names: Vec<_> =
        files(&report).into_iter().map(|file| file.file_name().unwrap().to_owned()).collect();
    names.sort();
    assert!(names.iter().all(|name| name.to_str().unwrap().contains(".partial.")), "{names:?}");
    assert!(names.iter().any(|name| name == "ticks-off.partial.csv"), "{names:?}");
}

/// The second line is 200 MB long, and the program has less memory than that.
#[test]
fn line_of_200_mb_is_refused_briefly() {
    let folder = tempfile::tempdir().unwrap();
    let path = short(folder.path());
    let header = fs::read_to_string(&path).unwrap().lines().next().unwrap().to_owned();
    let mut file = File::create(&path).unwrap();
    writeln!(file, "{header}").unwrap();
    file.seek(SeekFrom::Start(200_000_000)).unwrap();
    file.write_all(b"\n").unwrap();
    drop(file);
    let arguments = ["--no-report", "--recording", path.to_str().unwrap()];
    let refused = after("ulimit -v 150000", env!("CARGO_BIN_EXE_follow"), &arguments);
    refused.failed(1, &format!("{}: line 2 is longer than 65536 bytes", path.display()));
}

/// The system ends the writer in the middle of the file.
#[test]
fn a_killed_record_leaves_nothing_that_plays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.jsonl");
    fs::write(&path, "what stood there").unwrap();
    let killed = record_after("ulimit -f 400", &path);
    assert!(killed.status.signal().is_some(), "{killed:?}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "what stood there");
    for left in files(folder.path()).iter().filter(|left| **left != path) {
        follow(left, &[]).failed(1, "the recording is cut off here");
    }
}

/// The system refuses further writes in the middle of the file.
#[test]
fn a_full_disk_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.jsonl");
    let full = record_after("trap '' XFSZ; ulimit -f 400", &path);
    let full = full.failed(1, path.to_str().unwrap());
    assert_eq!(full.errors.lines().count(), 1, "{full:?}");
    assert_eq!(files(folder.path()), Vec::<PathBuf>::new());
}

/// Nobody reads from the pipe until the signal is sent, so that it arrives in the middle.
#[test]
fn interrupted_record_marks_its_last_line() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let child = record_hour(&pipe);
    let mut reader = File::open(&pipe).unwrap();
    let mut bytes = vec![0; 100_000];
    reader.read_exact(&mut bytes).unwrap();
    signal(&child, "INT");
    reader.read_to_end(&mut bytes).unwrap();
    let ran = Ran::of(child);
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    assert!(ran.output.starts_with(&format!("{}: ", pipe.display())), "{ran:?}");

    let error = Reader::new(bytes.as_slice()).unwrap().find_map(Result::err).unwrap();
    let RecordingError::Interrupted { frames, .. } = error else { panic!("{error}") };
    let reader = Reader::new(bytes.as_slice()).unwrap();
    let taken = Recording::read(reader, IfPartial::Take).unwrap();
    assert_eq!(taken.completeness, Completeness::Partial);
    assert_eq!(taken.percepts.len() as u64, frames);
    assert!((50..60_000).contains(&frames), "{frames}");
}

#[test]
fn interrupted_record_keeps_a_partial_file() {
    for (name, code) in [("INT", 130), ("TERM", 143)] {
        // A signal that came too late is tried again.
        let caught = (0..20).find_map(|_| {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("walk.jsonl");
            fs::write(&path, "what stood there").unwrap();
            let mut child = record_hour(&path);
            while !files(folder.path()).iter().any(|file| *file != path && length(file) > 100_000) {
                if child.try_wait().unwrap().is_some() {
                    return None;
                }
            }
            signal(&child, name);
            let ran = Ran::of(child);
            (ran.code() != Some(0)).then_some((folder, path, ran))
        });
        let (folder, path, ran) = caught.expect("an hour takes longer to record than a signal");
        assert_eq!(ran.code(), Some(code), "{ran:?}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "what stood there");
        let partial = folder.path().join("walk.partial.jsonl");
        assert!(ran.output.contains(partial.to_str().unwrap()), "{ran:?}");
        assert_eq!(files(folder.path()).len(), 2, "{:?}", files(folder.path()));

        let error = percept_recording::open(&partial).unwrap().find_map(Result::err).unwrap();
        assert!(matches!(error, RecordingError::Interrupted { .. }), "{error}");
        follow(&partial, &[]).failed(1, "walk.partial.jsonl").failed(1, "it was interrupted after");
    }
}

/// The length of a file that may no longer exist.
fn length(path: &Path) -> u64 {
    fs::metadata(path).map_or(0, |found| found.len())
}
