//! Files as they occur in practice: too large, beside others, with special names.

use std::{fs, path::Path};

use examples::{
    program::{read_bytes, shown},
    settings::SettingsFile,
    shards::Part,
};
use moca_model::whole_body::{Description, Model};

use crate::support::{Runs, SmallDisk, resnet18, save_picture, small_frames};

/// A sparse file of this length that takes no disk space.
fn sparse(folder: &Path, name: &str) -> String {
    let path = folder.join(name);
    fs::File::create(&path).unwrap().set_len(6 << 30).unwrap();
    path.to_str().unwrap().to_owned()
}

/// Files are only read into memory if their length is acceptable. Streams of unknown length are only read up to the
/// limit.
#[test]
fn too_large_files_are_refused_cheaply() {
    let folder = tempfile::tempdir().unwrap();
    let file = sparse(folder.path(), "large");
    let endless = Path::new("/dev/zero");
    for path in [Path::new(&file), endless] {
        assert!(read_bytes(path, 1 << 20).is_err());
        let held = SettingsFile::read(path).unwrap_err().to_string();
        assert!(held.contains("at most 4194304 bytes"), "{held}");
        let description = Description::default();
        let error = Model::from_urdf_file(path, &description).unwrap_err().to_string();
        assert!(error.contains("larger than a URDF can be"), "{error}");
    }
    assert!(Part::<String, String>::read(Path::new(&file)).is_err());
    for (name, arguments) in [
        ("ik", vec![file.as_str(), "--frame=tool"]),
        ("follow", vec!["--settings", &file]),
        ("soak", vec!["--settings", &file]),
        ("experiment", vec!["following", "--no-report", "--recording", &file]),
        ("merge", vec![&file]),
    ] {
        let ran = Runs::within(name, 1500).with(&arguments).run();
        let says = if name == "merge" { "large" } else { "at most" };
        ran.failed(1, says);
    }
}

#[test]
fn names_from_outside_steer_no_terminal() {
    assert_eq!(shown("plain é.png").to_string(), "plain é.png");
    assert_eq!(shown("a\u{1b}[31m\n\u{202e}b").to_string(), "a\\u{1b}[31m\\n\\u{202e}b");
    let folder = tempfile::tempdir().unwrap();
    let name = "cat\u{1b}[2J\u{202e}gnp.png";
    let image = save_picture(&folder.path().join(name), 30, 1);
    let missing = folder.path().join("no\u{1b}]0;x\u{7}\u{2066}ne.png");
    let infer = Runs::new("infer").with(&["--weights", resnet18(), "--json"]);
    let ran = infer.with(&[&image, missing.to_str().unwrap()]).run();
    for text in [&ran.output, &ran.errors] {
        assert!(!text.contains(['\u{1b}', '\u{7}', '\u{202e}', '\u{2066}']), "{text:?}");
    }
    assert!(ran.output.contains("cat\\u{1b}[2J\\u{202e}gnp.png"), "{}", ran.output);
    // The JSON has the complete name.
    assert_eq!(ran.json()["images"][0]["image"], image);
}

/// torchvision's weights need 256 or 232 pixels, the paper's 255. An image may be rotated.
#[test]
fn the_size_and_the_orientation_are_choices() {
    let folder = tempfile::tempdir().unwrap();
    let image = save_picture(&folder.path().join("a.png"), 30, 1);
    let infer = |options: &[&str]| {
        let ran = Runs::new("infer").with(&["--weights", resnet18(), "--json"]);
        ran.with(&[&image]).with(options).run().done().json()["images"][0]["classes"].clone()
    };
    let of_paper = infer(&[]);
    assert_eq!(infer(&["--resize=255", "--orientation=stored"]), of_paper);
    assert_ne!(infer(&["--resize=232"]), of_paper);
    assert_ne!(infer(&["--resize=256"]), of_paper);
    // The file does not say how the camera was held.
    assert_eq!(infer(&["--orientation=exif"]), of_paper);
    Runs::new("infer")
        .with(&["--weights", resnet18(), &image, "--resize=100"])
        .run()
        .failed(2, "--resize");
}

/// System files in a data set do not count, and nothing is skipped without a message.
#[test]
fn only_data_folders_count_and_others_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let images = folder.path().join("images");
    for (class, level) in [("drilled", 30), ("smooth", 200)] {
        let own = images.join(class);
        fs::create_dir_all(own.join("@eaDir")).unwrap();
        for seed in 0..4 {
            save_picture(&own.join(format!("{seed}.png")), level, seed);
        }
        fs::write(own.join("._0.png"), "resource fork").unwrap();
        fs::write(own.join("a.bmp"), "BM").unwrap();
    }
    for hidden in [".git", ".ipynb_checkpoints", "@eaDir", "__MACOSX"] {
        fs::create_dir_all(images.join(hidden)).unwrap();
        save_picture(&images.join(hidden).join("0.png"), 100, 9);
    }
    let model = folder.path().join("model");
    let train = |images: &Path| {
        Runs::new("surface")
            .with(&["train"])
            .with(&[images])
            .with(&["--output"])
            .with(&[&model])
            .with(&["--random-backbone=1", "--depth=18", "--epochs=5", "--json"])
    };
    let ran = train(&images).run().done();
    assert_eq!(ran.json()["classes"], serde_json::json!(["drilled", "smooth"]));
    assert_eq!(ran.json()["unreadable"], 0);
    assert_eq!(ran.json()["in_two_parts"], 0);
    assert_eq!(ran.errors.matches("left out 1 .bmp").count(), 2, "{}", ran.errors);

    // One picture under many names is in every part.
    for seed in 0..10 {
        let copy = images.join("smooth").join(format!("copy{seed}.png"));
        fs::copy(images.join("smooth/0.png"), copy).unwrap();
    }
    let ran = train(&images).run().done();
    assert!(ran.json()["in_two_parts"].as_u64().unwrap() >= 2);
    assert!(ran.errors.contains("is the same picture as"), "{}", ran.errors);

    // The only files are of other types.
    for seed in 0..4 {
        let png = images.join(format!("smooth/{seed}.png"));
        fs::rename(&png, png.with_extension("bmp")).unwrap();
    }
    for seed in 0..10 {
        fs::remove_file(images.join(format!("smooth/copy{seed}.png"))).unwrap();
    }
    train(&images).run().failed(1, "no JPEG or PNG files, but 5 .bmp");
}

/// A folder of frames with links to the files of the small film.
fn film(change: impl Fn(&Path)) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let from = Path::new(small_frames());
    for part in ["", "depth", "skeletons"] {
        fs::create_dir_all(folder.path().join(part)).unwrap();
        for entry in fs::read_dir(from.join(part)).unwrap() {
            let path = entry.unwrap().path();
            if path.is_file() {
                fs::copy(&path, folder.path().join(part).join(path.file_name().unwrap())).unwrap();
            }
        }
    }
    change(folder.path());
    folder
}

fn perceive(folder: &Path) -> Runs {
    let skeletons = folder.join("skeletons");
    let output = folder.join("out.jsonl");
    Runs::new("perceive")
        .with(&[folder])
        .with(&["--skeletons"])
        .with(&[skeletons])
        .with(&["--json", "--output"])
        .with(&[output])
}

fn rename_skeletons(folder: &Path, name: impl Fn(u64) -> String) {
    let skeletons = folder.join("skeletons");
    for entry in fs::read_dir(&skeletons).unwrap() {
        let path = entry.unwrap().path();
        let number = path.file_name().unwrap().to_str().unwrap()[..6].parse().unwrap();
        fs::rename(&path, skeletons.join(name(number))).unwrap();
    }
}

fn edit(path: &Path, change: impl Fn(&mut serde_json::Value)) {
    let mut value = serde_json::from_slice(&fs::read(path).unwrap()).unwrap();
    change(&mut value);
    fs::write(path, value.to_string()).unwrap();
}

/// OpenPose's file names have twelve digits after the name of a video.
#[test]
fn skeletons_are_found_by_openpose_names() {
    let plain = perceive(film(|_| {}).path()).run().done().json();
    let seen = plain["with_body"].as_u64().unwrap();
    assert!(seen > 0, "{plain}");
    let openpose = "_keypoints.json";
    for (prefix, end) in
        [("", openpose), ("video_", openpose), ("film-2_", openpose), ("film-2_", ".json")]
    {
        let folder = film(|folder| {
            rename_skeletons(folder, |number| format!("{prefix}{number:012}{end}"));
        });
        let ran = perceive(folder.path()).run().done().json();
        assert_eq!(ran["with_body"], seen, "{prefix}{end}");
    }
}

/// If nobody can be found, the error names one of three reasons and no recording is left.
#[test]
fn nothing_found_is_no_success() {
    let check = |folder: &tempfile::TempDir, says: &str| {
        perceive(folder.path()).run().failed(1, says);
        assert!(!folder.path().join("out.jsonl").exists());
    };
    // The names do not belong to frames.
    let names = film(|folder| {
        rename_skeletons(folder, |number| format!("{:06}_keypoints.json", number + 500_000));
    });
    check(&names, "no frame has a file of joints");
    // The joints are from 0 to 1.
    let scaled = film(|folder| {
        for entry in fs::read_dir(folder.join("skeletons")).unwrap() {
            edit(&entry.unwrap().path(), |value| {
                for person in value["people"].as_array_mut().unwrap() {
                    let numbers = person["pose_keypoints_2d"].as_array_mut().unwrap();
                    for number in numbers.chunks_mut(3).flat_map(|joint| &mut joint[..2]) {
                        *number = (number.as_f64().unwrap() / 32.0).clamp(0.0, 1.0).into();
                    }
                }
            });
        }
    });
    check(&scaled, "--keypoint_scale 0");
    // The scale of the depth is a thousand times too small, or too large.
    for scale in [1e-6, 1.0] {
        let wrong = film(|folder| {
            edit(&folder.join("camera.json"), |camera| camera["depth_scale"] = scale.into());
        });
        check(&wrong, "depth_scale in camera.json");
    }
}

#[test]
fn broken_frame_is_named_and_others_kept() {
    let folder = film(|folder| {
        fs::write(folder.join("depth/000012.png"), "").unwrap();
        fs::write(folder.join("skeletons/000020_keypoints.json"), "{\"people\":[").unwrap();
    });
    let whole = perceive(film(|_| {}).path()).run().done().json();
    let ran = perceive(folder.path()).run().failed(1, "000012.png");
    assert!(ran.errors.contains("000020_keypoints.json"), "{}", ran.errors);
    let json = ran.json();
    assert_eq!(json["broken"], 2);
    assert_eq!(json["frames"].as_u64().unwrap() + 2, whole["frames"].as_u64().unwrap());
    let text = fs::read_to_string(folder.path().join("out.jsonl")).unwrap();
    assert_eq!(text.lines().count() as u64, json["frames"].as_u64().unwrap() + 2);
}

/// A frame without room on a full disk is missing, and not an empty file.
#[test]
fn a_full_disk_leaves_no_empty_frame() {
    let Some(disk) = SmallDisk::new(300) else { return };
    let folder = disk.path().join("walk");
    let film = ["--size=64x48", "--duration=20", "--walk", "--frames"];
    Runs::new("record").with(&film).with(&[&folder]).run().failed(1, "walk");
    let mut pictures = 0;
    for part in ["colour", "depth", "surface", "skeletons"] {
        for entry in fs::read_dir(folder.join(part)).unwrap() {
            let path = entry.unwrap().path();
            assert!(fs::metadata(&path).unwrap().len() > 0, "{} is empty", path.display());
            pictures += 1;
        }
    }
    assert!(pictures > 10, "{pictures} files");
}
