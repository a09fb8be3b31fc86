//! Images and the geometry of a camera as messages.

use moca_drivers::ros2::messages::{CameraInfo, Image, Time};
use moca_drivers::ros2::{FramePairs, Refusal, colour_of, depth_of, intrinsics_of};

use super::{after, header};

fn image(encoding: &str, step: u32, data: Vec<u8>) -> Image {
    let header = header("camera_color_optical_frame");
    let encoding = encoding.to_owned();
    Image { header, height: 2, width: 3, encoding, is_bigendian: 0, step, data }
}

fn info() -> CameraInfo {
    CameraInfo {
        header: header("camera_color_optical_frame"),
        height: 2,
        width: 3,
        distortion_model: "plumb_bob".to_owned(),
        d: vec![0.0; 5],
        k: [3.0, 0.0, 1.0, 0.0, 3.0, 0.5, 0.0, 0.0, 1.0],
        ..CameraInfo::default()
    }
}

fn stamped(mut image: Image, milliseconds: u32) -> Image {
    image.header.stamp.nanosec += milliseconds * 1_000_000;
    image
}

#[test]
fn colours_come_in_any_order_of_bytes() {
    // A red and a blue pixel in each column, with a byte that fills the row.
    let rgb = image("rgb8", 10, [[255, 0, 0, 0, 255, 0, 0, 0, 255, 9]; 2].concat());
    let bgr = image("bgr8", 9, [[0, 0, 255, 0, 255, 0, 255, 0, 0]; 2].concat());
    let rgba = image("rgba8", 12, [[255, 0, 0, 7, 0, 255, 0, 7, 0, 0, 255, 7]; 2].concat());
    for message in [&rgb, &bgr, &rgba] {
        let pixels = colour_of(message).unwrap();
        assert_eq!(pixels.dim(), (2, 3, 3), "{}", message.encoding);
        for row in 0..2 {
            for (column, channel) in [(0, 0), (1, 1), (2, 2)] {
                let found = [0, 1, 2].map(|channel| pixels[(row, column, channel)]);
                let mut expected = [0; 3];
                expected[channel] = 255;
                assert_eq!(found, expected, "{}", message.encoding);
            }
        }
    }
    let grey = colour_of(&image("mono8", 3, vec![1, 2, 3, 4, 5, 6])).unwrap();
    assert_eq!(grey[(1, 0, 0)], 4);
    assert_eq!(grey[(1, 0, 2)], 4);
}

#[test]
fn depths_are_millimetres_or_metres() {
    let bytes = [1500_u16, 0, 65_535].map(u16::to_le_bytes).concat();
    let depth = depth_of(&image("16UC1", 6, bytes.repeat(2))).unwrap();
    assert!((depth.depth(0, 1).unwrap() - 1.5).abs() < 1e-6);
    assert_eq!(depth.depth(1, 1), None);
    let mut big = image("16UC1", 6, [1500_u16, 0, 1].map(u16::to_be_bytes).concat().repeat(2));
    big.is_bigendian = 1;
    assert!((depth_of(&big).unwrap().depth(0, 0).unwrap() - 1.5).abs() < 1e-6);
    let metres = [1.5_f32, f32::NAN, -1.0].map(f32::to_le_bytes).concat().repeat(2);
    let depth = depth_of(&image("32FC1", 12, metres)).unwrap();
    assert_eq!([0, 1, 2].map(|column| depth.depth(column, 0)), [Some(1.5), None, None]);
}

#[test]
fn images_that_are_none_are_refused() {
    let yuv = colour_of(&image("yuv422", 6, vec![0; 12])).unwrap_err();
    assert!(matches!(yuv, Refusal::Encoding { .. }), "{yuv}");
    let cut = colour_of(&image("rgb8", 9, vec![0; 17])).unwrap_err();
    assert_eq!(cut, Refusal::Size { what: "image bytes", found: 17, expected: 18 });
    let narrow = colour_of(&image("rgb8", 8, vec![0; 16])).unwrap_err();
    assert_eq!(narrow, Refusal::Size { what: "a row's bytes", found: 8, expected: 9 });
    let colour = depth_of(&image("rgb8", 9, vec![0; 18])).unwrap_err();
    assert!(matches!(colour, Refusal::Encoding { .. }), "{colour}");
    let endless = Image { height: u32::MAX, step: u32::MAX, ..image("rgb8", 9, vec![0; 18]) };
    assert!(matches!(colour_of(&endless), Err(Refusal::Size { .. })));
}

#[test]
fn cameras_say_how_they_see() {
    let intrinsics = intrinsics_of(&info()).unwrap();
    assert_eq!((intrinsics.size(), intrinsics.focal()), ([3, 2], [3.0, 3.0]));
    let lens = |d: &[f64], model: &str| {
        let mut info = info();
        (info.d, info.distortion_model) = (d.to_vec(), model.to_owned());
        intrinsics_of(&info)
    };
    assert!(lens(&[0.01, 0.0, 0.0, 0.0, 0.0], "plumb_bob").is_ok());
    // The corner is 1.1 focal lengths off the axis at most, so that a factor of 10 moves it by pixels.
    let bent = lens(&[10.0, 0.0, 0.0, 0.0, 0.0], "plumb_bob").unwrap_err();
    assert!(matches!(bent, Refusal::Lens { pixels } if pixels > 1.0), "{bent}");
    assert!(matches!(lens(&[0.5], "plumb_bob"), Err(Refusal::Camera(_))));
    let none = CameraInfo { k: [0.0; 9], ..info() };
    assert!(matches!(intrinsics_of(&none), Err(Refusal::Camera(_))));
}

#[test]
fn images_of_a_moment_are_joined() {
    let (colour, depth) = (image("rgb8", 9, vec![0; 18]), image("16UC1", 6, vec![0; 12]));
    let mut pairs = FramePairs::default();
    let early = pairs.take_colour(&colour, after(1)).unwrap_err();
    assert_eq!(early, Refusal::NoCamera);
    pairs.take_info(&info()).unwrap();
    let (age, alone) = pairs.take_colour(&colour, after(3)).unwrap();
    assert!((age - 0.003).abs() < 1e-9 && alone.is_none());
    // The depth of the same moment may be stamped a little later, but not by half a frame.
    let (_, other) = pairs.take_depth(&stamped(depth.clone(), 20), after(21)).unwrap();
    assert!(other.is_none());
    let (_, both) = pairs.take_colour(&stamped(colour.clone(), 18), after(22)).unwrap();
    let expected = Time { nanosec: 268_000_000, ..colour.header.stamp };
    assert_eq!(both.unwrap().stamp, expected);
    assert_eq!(pairs.unpaired(), 1, "the first colour image");
    let again = pairs.take_depth(&stamped(depth, 20), after(23)).unwrap_err();
    assert_eq!(again, Refusal::Overtaken);
}

#[test]
fn images_of_other_cameras_are_refused() {
    let mut pairs = FramePairs::default();
    pairs.take_info(&info()).unwrap();
    let mut wide = image("rgb8", 12, vec![0; 24]);
    wide.width = 4;
    let refused = pairs.take_colour(&wide, after(1)).unwrap_err();
    assert_eq!(refused, Refusal::Pixels { found: [4, 2], expected: [3, 2] });
    let other = CameraInfo { k: [4.0, 0.0, 1.0, 0.0, 4.0, 0.5, 0.0, 0.0, 1.0], ..info() };
    assert_eq!(pairs.take_info(&other), Err(Refusal::OtherCamera));
}
