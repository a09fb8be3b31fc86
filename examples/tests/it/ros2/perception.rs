//! `perceive --live --ros2` with a camera on this machine.

use std::path::Path;
use std::thread;
use std::time::{Duration, Instant, SystemTime};

use human_perception::frames::{FramesReader, truth};
use moca_drivers::ros2::messages::{
    CameraInfo, Float64MultiArray, Header, Image, PoseArray, Quaternion, TfMessage, Time,
    Transform, TransformStamped, Vector3,
};
use moca_drivers::ros2::ros2_client::qos::Durability;
use moca_drivers::ros2::ros2_client::{
    Context, ContextOptions, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher,
    QosProfile, Subscription,
};
use moca_drivers::ros2::{Perceived, RosDomain};
use serde::Serialize;
use serde::de::DeserializeOwned;
use vision_models::{Body25, read_image};

use crate::support::{Ran, Runs, signal};

/// No other test uses this domain.
const DOMAIN: u16 = 79;

/// A camera, and a listener to what is seen by it.
struct Camera {
    infos: Publisher<CameraInfo>,
    colours: Publisher<Image>,
    depths: Publisher<Image>,
    places: Publisher<TfMessage>,
    bodies: Subscription<PoseArray>,
    confidences: Subscription<Float64MultiArray>,
    covariances: Subscription<Float64MultiArray>,
    people: Subscription<Float64MultiArray>,
    delays: Subscription<Float64MultiArray>,
    /// Keeps the connection open.
    _node: (Context, Node),
}

impl Camera {
    fn join(domain: RosDomain) -> Self {
        let options = ContextOptions::new().domain_id(domain.number());
        let context = Context::with_options(options).unwrap();
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let mut node = context.new_node(NodeName::new("/", "camera").unwrap(), options).unwrap();
        Self {
            infos: publisher(
                &mut node,
                "/camera/camera/color/camera_info",
                ("sensor_msgs", "CameraInfo"),
                &QosProfile::publisher_default(),
            ),
            colours: publisher(
                &mut node,
                "/camera/camera/color/image_raw",
                ("sensor_msgs", "Image"),
                &QosProfile::publisher_default(),
            ),
            depths: publisher(
                &mut node,
                "/camera/camera/aligned_depth_to_color/image_raw",
                ("sensor_msgs", "Image"),
                &QosProfile::publisher_default(),
            ),
            places: publisher(
                &mut node,
                "/tf_static",
                ("tf2_msgs", "TFMessage"),
                &QosProfile::publisher_default().durability(Durability::TransientLocal),
            ),
            bodies: listener(&mut node, "/body_joints", ("geometry_msgs", "PoseArray")),
            confidences: numbers(&mut node, "/body_confidences"),
            covariances: numbers(&mut node, "/body_covariances"),
            people: numbers(&mut node, "/people"),
            delays: numbers(&mut node, "/perception_delays"),
            _node: (context, node),
        }
    }
}

fn publisher<M: Serialize>(
    node: &mut Node,
    name: &str,
    kind: (&str, &str),
    qos: &QosProfile,
) -> Publisher<M> {
    let kind = MessageTypeName::new(kind.0, kind.1);
    let topic = node.create_topic(&Name::parse(name).unwrap(), kind, qos).unwrap();
    node.create_publisher(&topic, None).unwrap()
}

fn listener<M: DeserializeOwned + 'static>(
    node: &mut Node,
    name: &str,
    kind: (&str, &str),
) -> Subscription<M> {
    let kind = MessageTypeName::new(kind.0, kind.1);
    let qos = QosProfile::subscription_default();
    let topic = node.create_topic(&Name::parse(name).unwrap(), kind, &qos).unwrap();
    node.create_subscription(&topic, None).unwrap()
}

fn numbers(node: &mut Node, name: &str) -> Subscription<Float64MultiArray> {
    listener(node, name, ("std_msgs", "Float64MultiArray"))
}

/// Waits for a message, and gives the newest one.
fn newest<M: DeserializeOwned + 'static>(of: &Subscription<M>, patience: Duration) -> Option<M> {
    let begun = Instant::now();
    let mut found = None;
    while found.is_none() && begun.elapsed() < patience {
        while let Ok(Some((message, _))) = of.take() {
            found = Some(message);
        }
        thread::sleep(Duration::from_millis(2));
    }
    found
}

/// The images of a folder as messages of this moment.
fn messages(reader: &FramesReader, frame: usize) -> [Image; 2] {
    let (folder, stamp) = (reader.surfaces(), Time::from(SystemTime::now()));
    let folder = folder.parent().unwrap();
    let colour = read_image(folder.join(format!("colour/{frame:06}.png"))).unwrap();
    let depth = vision_models::read_depth(folder.join(format!("depth/{frame:06}.png")), 0.001);
    let depth = depth.unwrap();
    let units = depth.depths().iter().flat_map(|depth| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "up to 65 m")]
        let unit = (depth * 1e3).round() as u16;
        unit.to_le_bytes()
    });
    let units = units.collect();
    let [width, height] =
        reader.camera().intrinsics().size().map(|side| u32::try_from(side).unwrap());
    let header = Header { stamp, frame_id: "camera_color_optical_frame".to_owned() };
    let image = |encoding: &str, bytes: u32, data: Vec<u8>| Image {
        header: header.clone(),
        height,
        width,
        encoding: encoding.to_owned(),
        is_bigendian: 0,
        step: bytes * width,
        data,
    };
    [image("rgb8", 3, colour.into_raw_vec_and_offset().0), image("16UC1", 2, units)]
}

fn info(reader: &FramesReader) -> CameraInfo {
    let intrinsics = reader.camera().intrinsics();
    let [width, height] = intrinsics.size().map(|side| u32::try_from(side).unwrap());
    let ([fx, fy], [cx, cy]) = (intrinsics.focal(), intrinsics.centre());
    let stamp = Time::from(SystemTime::now());
    CameraInfo {
        header: Header { stamp, frame_id: "camera_color_optical_frame".to_owned() },
        height,
        width,
        distortion_model: "plumb_bob".to_owned(),
        d: vec![0.0; 5],
        k: [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        ..CameraInfo::default()
    }
}

/// The place of the film's camera on its mast, as a publisher of static transforms tells it.
fn place(camera: &vision_models::Camera) -> TfMessage {
    let pose = camera.world_from_camera();
    let (at, turn) = (pose.translation.vector, pose.rotation.coords);
    let tie = |parent: &str, child: &str, transform: Transform| TransformStamped {
        header: Header { stamp: Time::default(), frame_id: parent.to_owned() },
        child_frame_id: child.to_owned(),
        transform,
    };
    let mast = Transform {
        translation: Vector3 { x: at.x, y: at.y, z: at.z },
        rotation: Quaternion { w: 1.0, ..Quaternion::default() },
    };
    let rotation = Quaternion { x: turn.x, y: turn.y, z: turn.z, w: turn.w };
    let lens = Transform { rotation, ..Transform::default() };
    let still = Transform { translation: Vector3::default(), ..mast };
    let links = [
        tie("map", "camera_link", mast),
        tie("camera_link", "camera_color_optical_frame", lens),
        tie("map", "odom", still),
    ];
    TfMessage { transforms: links.to_vec() }
}

/// A camera shows a person who stands, and `perceive` says where their joints are, frame by frame. Its place is
/// published once, before there is anybody to receive it.
#[test]
fn people_before_a_camera_are_published() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames").to_str().unwrap().to_owned();
    let film = ["--frames", &frames, "--size=160x120", "--duration=3", "--drop=0", "--walk"];
    Runs::new("record").with(&film).run().done();
    let reader = FramesReader::open(Path::new(&frames), Duration::ZERO).unwrap();
    let truths = truth::read(&Path::new(&frames).join("truth.jsonl")).unwrap();
    let camera = Camera::join(RosDomain::parse(&DOMAIN.to_string()).unwrap());
    camera.places.publish(place(reader.camera())).unwrap();
    // The file has another place.
    let elsewhere = folder.path().join("elsewhere");
    std::fs::create_dir(&elsewhere).unwrap();
    let file = std::fs::read_to_string(Path::new(&frames).join("camera.json")).unwrap();
    let mut file: serde_json::Value = serde_json::from_str(&file).unwrap();
    file["position"] = serde_json::json!([7.0, 7.0, 7.0]);
    std::fs::write(elsewhere.join("camera.json"), file.to_string()).unwrap();
    let settings = folder.path().join("place.toml");
    std::fs::write(&settings, "version = 1\n[camera]\nframe = \"map\"\nfrom_tf = true\n").unwrap();
    let [elsewhere, settings] = [&elsewhere, &settings].map(|path| path.to_str().unwrap());
    let skeletons = format!("{frames}/skeletons");
    let options = ["--live", "--ros2", "--wait=60", "--json", "--skeletons", &skeletons];
    let options = options.into_iter().chain(["--settings", settings]).collect::<Vec<_>>();
    let child = Runs::new("perceive").with(&[elsewhere]).with(&options).on_domain(DOMAIN).start();

    // The camera tells of itself until somebody has heard it: images before that would be refused.
    let (mut seen, mut worst) = (0, 0.0_f64);
    let mut perceived = Perceived::default();
    perceived.take_static_transforms(&place(reader.camera())).unwrap();
    let begun = Instant::now();
    let mut frame = 0;
    while seen < 10 && begun.elapsed() < Duration::from_secs(100) {
        camera.infos.publish(info(&reader)).unwrap();
        let [colour, depth] = messages(&reader, frame);
        let stamp = colour.header.stamp;
        if frame == 1 {
            camera
                .colours
                .publish(Image { encoding: "yuv422".to_owned(), ..colour.clone() })
                .unwrap();
            // The publisher keeps one message, until it has left.
            thread::sleep(Duration::from_millis(100));
        }
        camera.colours.publish(colour).unwrap();
        camera.depths.publish(depth).unwrap();
        let Some(poses) = newest(&camera.bodies, Duration::from_millis(500)) else { continue };
        assert_eq!(poses.header.frame_id, "map");
        let late = poses.header.stamp.seconds_since(stamp).abs();
        assert!(late < 1e-6, "the result of another frame, {late} s");
        let confidences = newest(&camera.confidences, Duration::from_secs(5)).unwrap();
        perceived.take_confidences(&confidences).unwrap();
        let covariances = newest(&camera.covariances, Duration::from_secs(5)).unwrap();
        perceived.take_covariances(&covariances).unwrap();
        let people = perceived.take_body(&poses, SystemTime::now()).unwrap();
        let truth = truths[frame].body.as_ref().unwrap();
        for body in people.body.iter().chain(&people.others) {
            let joints = [Body25::Neck, Body25::LeftShoulder, Body25::RightShoulder];
            for joint in joints {
                let Some(keypoint) = body.get(joint) else { continue };
                let of_truth = truth.get(joint).unwrap().position;
                worst = worst.max((keypoint.position - of_truth).norm());
                assert!(body.covariance(joint).is_some());
                seen += 1;
            }
        }
        let delays = newest(&camera.delays, Duration::from_secs(5)).unwrap();
        let [_, _, came, known, ..] = delays.data[..] else { panic!("{delays:?}") };
        assert!(0.0 < came && came <= known && known < 5.0, "{delays:?}");
        let places = newest(&camera.people, Duration::from_secs(5)).unwrap().data;
        assert_eq!(places.len(), 2 + 6 * poses.poses.len() / 25, "a row for each body");
        frame += 1;
    }
    assert!(seen >= 10, "{seen} joints were published");
    // The skeleton is off by 3 of 640 pixels, and the depth by a few centimetres.
    assert!(worst < 0.25, "{worst} m from the truth");

    signal(&child, "INT");
    let ran = Ran::of(child);
    assert_eq!(ran.code(), Some(130), "{ran:?}");
    let report = ran.json();
    let topics = report["ros2"]["topics"].as_array().unwrap();
    let of = |name: &str| topics.iter().find(|topic| topic["topic"] == name).unwrap();
    let refused = of("/camera/camera/color/image_raw")["refused"].as_array().unwrap();
    let because: Vec<_> = refused.iter().filter_map(|one| one["because"].as_str()).collect();
    assert!(because.iter().any(|text| text.contains("yuv422")), "{because:?}");
    assert!(report["frames"].as_u64().unwrap() >= frame as u64, "{report}");
}

/// A silent graph ends the program with the name of the topic on which it waits.
#[test]
fn no_camera_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let frames = folder.path().join("frames").to_str().unwrap().to_owned();
    let film = ["--frames", &frames, "--size=32x32", "--duration=0.1"];
    Runs::new("record").with(&film).run().done();
    let skeletons = format!("{frames}/skeletons");
    let settings = folder.path().join("names.toml");
    std::fs::write(&settings, "version = 1\n[topics]\ncamera_info = \"/eye/info\"\n").unwrap();
    let settings = settings.to_str().unwrap();
    let options = ["--live", "--ros2", "--wait=0.2", "--skeletons", &skeletons];
    let perceive = || Runs::new("perceive").with(&[&frames]).with(&options).on_domain(80);
    perceive().with(&["--settings", settings]).run().failed(1, "/eye/info");
    let settings = folder.path().join("both.toml");
    let both =
        "version = 1\n[camera]\nfrom_tf = true\npose = [0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0]\n";
    std::fs::write(&settings, both).unwrap();
    let settings = settings.to_str().unwrap();
    perceive().with(&["--settings", settings]).run().failed(1, "camera.pose");
    perceive().with(&["--output=percepts"]).run().failed(2, "--output");
}
