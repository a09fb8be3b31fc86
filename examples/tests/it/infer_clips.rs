//! Networks over folders of frames.

use std::fs;

use vision_models::{
    Action, Checkpoint, ClipSampling, Options, Preprocessing, SlowOnly, SlowOnlyForm, read_image,
    softmax,
};

use crate::support::{Runs, png_that_claims, resnet18, save_picture, slow_only_r18};

/// A folder of frames.
struct Video(tempfile::TempDir);

impl Video {
    fn new(frames: u32) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for frame in 0..frames {
            save_picture(&folder.path().join(format!("f{frame}.png")), 60, frame);
        }
        Self(folder)
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_owned()
    }

    /// The program with the small network and clips of two frames.
    fn infer(&self) -> Runs {
        let folder = self.path("");
        let options =
            [&folder, "--weights", slow_only_r18(), "--model=slowonly_r18_mm", "--length=2"];
        Runs::new("infer").with(&options)
    }
}

#[test]
fn averages_the_probabilities_of_all_clips() {
    let video = Video::new(12);
    let ran = video.infer().with(&["--clips=2", "--interval=2", "--json"]).run().done();
    let json = ran.json();
    assert_eq!((&json["clips"], &json["views"]), (&2.into(), &2.into()));

    let weights = Checkpoint::open(slow_only_r18()).unwrap();
    let form = SlowOnlyForm::MmAction2Depth18;
    let mut network = SlowOnly::load(form, weights, [2, 256, 256], Options::default()).unwrap();
    let sampling = ClipSampling::Mmaction2 { length: 2, interval: 2, clips: 2 };
    let mut sums = [0.0; 30];
    for clip in sampling.indices(12).unwrap() {
        let frames: Vec<_> =
            clip.iter().map(|at| read_image(video.path(&format!("f{at}.png"))).unwrap()).collect();
        let views: Vec<_> = frames.iter().map(|frame| frame.view()).collect();
        let clips = Preprocessing::MMACTION2.clip(&views).unwrap();
        let logits: Vec<f32> =
            network.infer(clips.view()).unwrap().logits.iter().copied().collect();
        for (sum, probability) in sums.iter_mut().zip(softmax(&logits)) {
            *sum += probability / 2.0;
        }
    }
    let classes = json["classes"].as_array().unwrap();
    assert_eq!(classes.len(), 5);
    let mut order: Vec<usize> = (0..30).collect();
    order.sort_by(|&one, &other| sums[other].total_cmp(&sums[one]));
    for (class, &expected) in classes.iter().zip(&order) {
        assert_eq!(class["class"], expected);
        assert_eq!(class["name"], Action::ALL[expected].name());
        let probability = class["probability"].as_f64().unwrap();
        assert!((probability - f64::from(sums[expected])).abs() < 1e-6, "{probability}");
    }
    let first = Action::ALL[order[0]].name();
    assert!(ran.output.starts_with("1  ") && ran.output.lines().next().unwrap().ends_with(first));
}

#[test]
fn unsuitable_network_is_named_with_its_option() {
    let video = Video::new(2);
    let (folder, slow_only) = (video.path(""), slow_only_r18());
    for (weights, says) in [
        (slow_only, "this is a SlowOnly-R18 of mmaction2: try --model slowonly_r18_mm"),
        (resnet18(), "this is a ResNet-18: try --model resnet18"),
    ] {
        let options = [&folder, "--weights", weights, "--model=slowonly_mm"];
        let ran = Runs::new("infer").with(&options).run().failed(1, says);
        assert_eq!(ran.errors, format!("error: {weights}: {says}\n"));
    }
    // The checkpoint identifies its network and names the suitable option.
    let image = Runs::new("infer").with(&["a.png", "--weights", slow_only]).run();
    image.failed(1, "a.png: a SlowOnly-R18 of mmaction2 takes a folder of JPEG or PNG files");
    let clip = Runs::new("infer").with(&[&folder, "--weights", resnet18()]).run();
    clip.failed(1, "a ResNet-18 takes JPEG or PNG files");
    let both = Runs::new("infer").with(&["a.png", &folder, "--weights", slow_only]).run();
    both.failed(1, "give images, or one folder of frames, or one array");
}

#[test]
fn wrong_options_and_frames_are_reported() {
    let video = Video::new(3);
    let none = |folder: &str| {
        Runs::new("infer").with(&[folder, "--model=slowonly_mm", "--weights=/nope/w.pth"])
    };
    let folder = video.path("");
    none(&folder).with(&["--length=0"]).run().failed(1, "--length 0: give from 1 to 1,024");
    none(&folder).with(&["--clips=9999"]).run().failed(1, "--clips 9999: give from 1 to 1,024");
    none(&folder).with(&["--threads=40000"]).run().failed(2, "1..=1024");
    none(&folder).with(&["--output=/nope/out"]).run().failed(1, "there is no folder /nope");
    fs::create_dir(video.path("empty")).unwrap();
    none(&video.path("empty")).run().failed(1, "empty: no JPEG or PNG files");
    none("/nope").run().failed(1, "/nope: No such file");

    fs::write(video.path("names.txt"), "a\nb\n").unwrap();
    let names = video.infer().with(&["--names", &video.path("names.txt")]).run();
    names.failed(1, "names.txt: 2 names, but the network has 30 classes");
    fs::write(video.path("f1.png"), png_that_claims(16_384, 16_384)).unwrap();
    video.infer().with(&["--interval=1"]).run().failed(1, "f1.png: no JPEG or PNG image");
    image::RgbImage::new(9, 9).save(video.path("f1.png")).unwrap();
    let says = "f1.png: 9 × 9 pixels, but the clip's first frame has 30 × 40";
    video.infer().with(&["--interval=1"]).run().failed(1, says);
}

#[test]
fn interrupt_gives_mean_of_clips_so_far() {
    let video = Video::new(4);
    let out = video.path("out.txt");
    let infer = video.infer().with(&["--clips=1000", "--json", "-o", &out]);
    let ran = infer.interrupt_at("clips: ", "INT");
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    let json = ran.json();
    let seen = json["clips"].as_u64().unwrap();
    assert!(json["partial"] == true && (1..1000).contains(&seen), "{json}");
    assert!(ran.errors.contains(&format!("interrupted after {seen} of 1000 clips")), "{ran:?}");
    assert!(!fs::exists(out).unwrap());
    assert_eq!(fs::read_to_string(video.path("out.partial.txt")).unwrap().lines().count(), 5);
}
