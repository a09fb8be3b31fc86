//! From pixels to the controller: data sets from films, and the script that runs the chain.

use std::{fs, path::Path, process::Command};

use crate::support::{Runs, coarse_map_file};

/// Makes films of a person who brings the object, and of one with a polisher. Returns their folders.
fn films(folder: &Path) -> [String; 2] {
    [("drilling", "--tool=drill"), ("polishing", "--tool=polisher")].map(|(name, tool)| {
        let frames = folder.join(name).to_str().unwrap().to_owned();
        let film = ["--frames", &frames, tool, "--size=32x32", "--duration=5.5", "--quiet"];
        Runs::new("record").with(&film).run().done();
        frames
    })
}

fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string();
    let mut names: Vec<String> = fs::read_dir(folder).unwrap().map(|e| name(e).unwrap()).collect();
    names.sort();
    names
}

#[test]
fn films_become_clips_and_images_by_class() {
    let folder = tempfile::tempdir().unwrap();
    let [one, other] = films(folder.path());
    let place = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let cut = |program, output: &str, options: &[&str]| {
        Runs::new(program)
            .with(&["cut", &one, &other, "-o", &place(output), "--json"])
            .with(options)
    };
    let json = cut("actions", "clips", &["--length=10", "--every=5"]).run().done().json();
    let classes = ["Deliver Object", "Walking With Object"];
    assert_eq!(names(&folder.path().join("clips")), classes);
    let counts = classes.map(|class| json["classes"][class].as_u64().unwrap());
    // There are 111 frames of each: 21 beginnings. Clips over the change belong to no class.
    let sum: u64 = counts.iter().sum();
    assert_eq!(json["samples"], sum);
    assert!((2 * 17..2 * 21).contains(&sum), "{counts:?}");
    let clip = folder.path().join("clips/Walking With Object/polishing-000005");
    assert_eq!(names(&clip).len(), 10);
    let frame = |path: String| fs::read(path).unwrap();
    let shown = frame(clip.join("00003.png").to_str().unwrap().to_owned());
    assert_eq!(shown, frame(format!("{other}/colour/000008.png")));
    // More clips follow if less of the action must be at the end.
    let options = ["--length=10", "--every=5", "--settled=2"];
    let more = cut("actions", "more", &options).run().done().json();
    assert!(more["samples"].as_u64() > json["samples"].as_u64());

    let json = cut("surface", "images", &["--every=10"]).run().done().json();
    assert_eq!(names(&folder.path().join("images")), ["drilled", "smooth"]);
    assert_eq!(json["classes"]["smooth"], json["classes"]["drilled"]);
    for name in names(&folder.path().join("images/smooth")) {
        assert!(name.starts_with("polishing-"), "{name}");
    }
}

#[test]
fn films_that_cannot_be_cut_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let [film, _] = films(folder.path());
    let output = folder.path().join("clips").to_str().unwrap().to_owned();
    let refused = |films: &[&str], says: &str| {
        let cut = ["--output", &output, "--length=100"];
        Runs::new("actions").with(&["cut"]).with(films).with(&cut).run().failed(1, says);
    };
    refused(&[&film, &format!("{film}/../drilling")], "two folders are called \"drilling\"");
    refused(&[&film], "no clips in 1 folders of frames");
    let truth = format!("{film}/truth.jsonl");
    let lines = fs::read_to_string(&truth).unwrap();
    let without = |at: usize| -> String {
        let lines = lines.split_inclusive('\n').enumerate();
        lines.filter(|(line, _)| *line != at).map(|(_, line)| line).collect()
    };
    fs::write(&truth, without(5).replace("\"frames\":111", "\"frames\":110")).unwrap();
    refused(&[&film], "truth.jsonl: nothing of frame 4 at 0.2 s");
    fs::write(&truth, without(112)).unwrap();
    refused(&[&film], "truth.jsonl: ");
    fs::remove_file(&truth).unwrap();
    refused(&[&film], "truth.jsonl");
    fs::write(folder.path().join("drilling/truth.jsonl"), lines).unwrap();
    fs::create_dir_all(&output).unwrap();
    fs::write(format!("{output}/own"), "").unwrap();
    refused(&[&film], "clips: there are files already: give a new folder");
}

#[cfg(unix)]
#[test]
fn the_chain_is_closed_by_one_script() {
    let folder = tempfile::tempdir().unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/chain.sh");
    let programs = Path::new(env!("CARGO_BIN_EXE_record")).parent().unwrap();
    let run = |programs: &Path| {
        let work = folder.path().join("chain");
        let mut sh = Command::new("sh");
        let arguments = [Path::new(script), &work, programs, Path::new("short")];
        let output =
            sh.args(arguments).env("FOLLOW", format!("--map {} --stature 1.75", coarse_map_file()));
        let output = output.output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        (output.status.success(), text(output.stdout) + &text(output.stderr))
    };
    let (done, said) = run(programs);
    assert!(done, "{said}");
    for stage in ["resnet18+svm", "clips: top-1 ", "against the truth: surface ", "ergonomics"] {
        assert!(said.contains(stage), "no {stage:?} in {said}");
    }
    // The script needs its own folder, and ends at the first error.
    assert!(!run(programs).0);
    fs::remove_dir_all(folder.path().join("chain")).unwrap();
    let (done, said) = run(folder.path());
    assert!(!done && said.ends_with("chain.sh: record failed\n"), "{said}");
}
