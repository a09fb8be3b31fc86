//! Compares prepared frames with those of the training libraries.

use image::{ImageFormat, RgbImage};
use ndarray::{Array3, Axis, s};
use proptest::prelude::*;
use serde_json::Value;
use vision_models::{
    ClipSampling, Crops, Error, ImageFolder, Library, Preprocessing, Resize, decode_image,
    list_frames, read_image, resize_opencv, resize_pillow,
};

fn golden() -> Value {
    serde_json::from_str(include_str!("../data/preprocessing.json")).unwrap()
}

/// Returns noise on a gradient, as the script generates it.
#[allow(clippy::cast_possible_truncation)]
fn frame(height: usize, width: usize) -> Array3<u8> {
    let pixel = |index: usize| {
        let noise = ((index as u64 * 2654435761) & 0xffff_ffff) >> 24;
        ((noise + (index / (3 * width)) as u64 * 5) & 255) as u8
    };
    Array3::from_shape_vec((height, width, 3), (0..height * width * 3).map(pixel).collect())
        .unwrap()
}

fn usizes(value: &Value) -> Vec<usize> {
    let values = value.as_array().unwrap().iter();
    values.map(|value| value.as_u64().unwrap().try_into().unwrap()).collect()
}

#[test]
fn resized_bytes_are_those_of_pillow_and_opencv() {
    let golden = golden();
    let cases = golden["resized"].as_array().unwrap();
    assert!(cases.len() > 60);
    for case in cases {
        let case = usizes(case);
        let [height, width, to_height, to_width, pillow, opencv] = case[..] else { panic!() };
        let frame = frame(height, width);
        for (library, resized, checksum) in [
            ("Pillow", resize_pillow(frame.view(), to_height, to_width).unwrap(), pillow),
            ("OpenCV", resize_opencv(frame.view(), to_height, to_width).unwrap(), opencv),
        ] {
            assert_eq!(resized.dim(), (to_height, to_width, 3));
            let bytes: Vec<u8> = resized.iter().copied().collect();
            assert_eq!(
                crc32fast::hash(&bytes) as usize,
                checksum,
                "{library}: {height} × {width} to {to_height} × {to_width}"
            );
        }
    }
}

#[test]
fn whole_pipelines() {
    let golden = golden();
    for case in golden["pipelines"].as_array().unwrap() {
        let [height, width] = usizes(&case["size"])[..] else { panic!() };
        let frame = frame(height, width);
        for (name, library, resize) in [
            ("torchvision", Library::Torchvision, Resize::ShortSide(31)),
            ("square", Library::Torchvision, Resize::Square(31)),
            ("mmaction2", Library::Mmaction2, Resize::ShortSide(31)),
            ("pytorchvideo", Library::PyTorchVideo, Resize::ShortSide(31)),
        ] {
            let preprocessing = Preprocessing { library, resize, crop: 24, crops: Crops::Centre };
            let image = preprocessing.image(frame.view()).unwrap();
            assert_eq!(image.dim(), (1, 3, 24, 24));
            let expected = case[name].as_array().unwrap();
            let given: Vec<f32> = image.iter().copied().step_by(7).collect();
            assert_eq!(given.len(), expected.len());
            for (given, expected) in given.iter().zip(expected) {
                let error = (f64::from(*given) - expected.as_f64().unwrap()).abs();
                // The position of a pixel is rounded to f32: 97 pixels · 2⁻²⁴, times the contrast.
                assert!(error < 3e-5, "{name} of {height} × {width}: {given} for {expected}");
            }
        }
    }
}

#[test]
fn sampled_frames() {
    let golden = golden();
    let cases = golden["sampling"].as_array().unwrap();
    for case in cases {
        let [frames, length, interval, clips] = ["frames", "length", "interval", "clips"]
            .map(|key| usize::try_from(case[key].as_u64().unwrap()).unwrap());
        let clip_lists = |key: &str| -> Vec<Vec<usize>> {
            case[key].as_array().unwrap().iter().map(usizes).collect()
        };
        for (sampling, expected) in [
            (ClipSampling::Mmaction2 { length, interval, clips }, clip_lists("mmaction2")),
            (
                ClipSampling::Mmaction2Before1 { length, interval, clips },
                clip_lists("mmaction2_before_1"),
            ),
            (ClipSampling::PyTorchVideo { length }, vec![usizes(&case["pytorchvideo"])]),
        ] {
            assert_eq!(sampling.indices(frames).unwrap(), expected, "{sampling:?} of {frames}");
        }
    }
}

#[test]
fn crops_are_parts_of_the_frame() {
    let frame = frame(20, 30);
    let whole = |crops, crop| {
        let preprocessing = Preprocessing {
            library: Library::Mmaction2,
            resize: Resize::ShortSide(20),
            crop,
            crops,
        };
        preprocessing.image(frame.view()).unwrap()
    };
    let red = |pixel: u8| (f32::from(pixel) - 123.675) / 58.395;
    // Left, right, middle.
    let three = whole(Crops::Three, 20);
    for (index, left) in [0, 10, 5].into_iter().enumerate() {
        let part = frame.slice(s![.., left..left + 20, 0]).mapv(red);
        assert_eq!(three.slice(s![index, 0, .., ..]), part, "crop {index}");
    }
    // Corners and middle, each followed by its mirror image.
    let ten = whole(Crops::Ten, 12);
    assert_eq!(ten.dim(), (10, 3, 12, 12));
    for (index, (top, left)) in [(0, 0), (0, 16), (8, 0), (8, 16), (4, 8)].into_iter().enumerate() {
        let part = frame.slice(s![top..top + 12, left..left + 12, 0]).mapv(red);
        assert_eq!(ten.slice(s![2 * index, 0, .., ..]), part, "crop {index}");
        assert_eq!(ten.slice(s![2 * index + 1, 0, .., ..;-1]), part, "mirrored crop {index}");
    }
}

#[test]
fn clips_agree_with_their_frames() {
    let frames = [frame(40, 50), frame(40, 50).slice_move(s![..;-1, .., ..])];
    let views = [frames[0].view(), frames[1].view()];
    let preprocessing = Preprocessing { crops: Crops::Ten, crop: 200, ..Preprocessing::MMACTION2 };
    let clip = preprocessing.clip(&views).unwrap();
    assert_eq!(clip.dim(), (10, 3, 2, 200, 200));
    for (index, view) in views.iter().enumerate() {
        let image = preprocessing.image(view.view()).unwrap();
        assert_eq!(clip.index_axis(Axis(2), index), image);
    }
}

#[test]
fn frames_that_are_refused() {
    for shape in [(0, 5, 3), (5, 0, 3), (5, 5, 1), (5, 5, 4), (16_385, 1, 3)] {
        let frame = Array3::<u8>::zeros(shape);
        assert!(matches!(Preprocessing::TORCHVISION.image(frame.view()), Err(Error::Size { .. })));
        assert!(resize_pillow(frame.view(), 4, 4).is_err());
        assert!(resize_opencv(frame.view(), 4, 4).is_err());
    }
    // One side would become 25,500 pixels long.
    let thin = Array3::<u8>::zeros((1, 100, 3));
    assert!(matches!(Preprocessing::TORCHVISION.image(thin.view()), Err(Error::Size { .. })));
    let frame = frame(5, 5);
    assert!(resize_pillow(frame.view(), 0, 4).is_err());
    for preprocessing in [
        Preprocessing { crop: 0, ..Preprocessing::TORCHVISION },
        Preprocessing { resize: Resize::Square(0), ..Preprocessing::TORCHVISION },
        Preprocessing { resize: Resize::ShortSide(usize::MAX), ..Preprocessing::TORCHVISION },
    ] {
        assert!(matches!(preprocessing.image(frame.view()), Err(Error::Value { .. })));
    }
    let large = Preprocessing { crop: 256, ..Preprocessing::TORCHVISION }.image(frame.view());
    let message = "the resized frame has 255 × 255 pixels: give at least 256 × 256 for the crop";
    assert_eq!(large.unwrap_err().to_string(), message);
    assert_eq!(Preprocessing::MMACTION2.clip(&[]), Err(Error::NoFrames));
    let other = self::frame(5, 6);
    assert!(matches!(
        Preprocessing::MMACTION2.clip(&[frame.view(), other.view()]),
        Err(Error::Size { .. })
    ));
    for sampling in [
        ClipSampling::Mmaction2 { length: 0, interval: 4, clips: 1 },
        ClipSampling::Mmaction2Before1 { length: 8, interval: 0, clips: 1 },
        ClipSampling::Mmaction2 { length: 8, interval: 4, clips: usize::MAX },
        ClipSampling::PyTorchVideo { length: 0 },
    ] {
        assert!(matches!(sampling.indices(30), Err(Error::Value { .. })));
        assert!(sampling.indices(0).is_err());
    }
}

#[test]
fn images_and_folders_of_images() {
    let folder = tempfile::tempdir().unwrap();
    let frame = frame(6, 9);
    let image = RgbImage::from_raw(9, 6, frame.iter().copied().collect()).unwrap();
    for name in ["f10.png", "f9.PNG", "f1.jpg"] {
        image.save(folder.path().join(name)).unwrap();
    }
    std::fs::write(folder.path().join("notes.txt"), "no image").unwrap();
    std::fs::write(folder.path().join("broken.png"), "no image").unwrap();

    assert_eq!(read_image(folder.path().join("f10.png")).unwrap(), frame);
    assert_eq!(read_image(folder.path().join("f1.jpg")).unwrap().dim(), (6, 9, 3));
    let names: Vec<_> = list_frames(folder.path())
        .unwrap()
        .iter()
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    assert_eq!(names, ["broken.png", "f1.jpg", "f9.PNG", "f10.png"]);

    let broken = folder.path().join("broken.png");
    assert!(matches!(
        read_image(&broken),
        Err(Error::Image { path, .. }) if path == broken.display().to_string()
    ));
    assert!(matches!(read_image(folder.path().join("none.png")), Err(Error::File { .. })));
    let empty = tempfile::tempdir().unwrap();
    assert_eq!(list_frames(empty.path()), Err(Error::NoFrames));
    assert!(matches!(list_frames(empty.path().join("none")), Err(Error::File { .. })));
}

/// The system's own files are no data. Other files that are left out are counted.
#[test]
fn folders_list_images_and_count_other_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in [".git", "@eaDir", ".ipynb_checkpoints", "__MACOSX", "drilled", "2.png"] {
        std::fs::create_dir(at(name)).unwrap();
    }
    for name in
        ["._1.png", "1.png", "10.JPEG", "Thumbs.db", ".DS_Store", "a.bmp", "b.BMP", "README"]
    {
        std::fs::write(at(name), "x").unwrap();
    }
    let found = ImageFolder::open(folder.path()).unwrap();
    let names = |paths: &[std::path::PathBuf]| -> Vec<String> {
        paths.iter().map(|path| path.file_name().unwrap().to_str().unwrap().to_owned()).collect()
    };
    assert_eq!(names(&found.images), ["1.png", "10.JPEG"]);
    assert_eq!(names(&found.folders), ["2.png", "drilled"]);
    assert_eq!(found.others.count(), 3);
    assert_eq!(found.others.to_string(), "1 without an extension, 2 .bmp");
    assert!(!found.others.is_empty());
}

/// Returns a PNG whose header claims these sides (pixels), colour type and depth (bits), with the
/// pixels of a much smaller image.
fn png_that_claims(sides: [u32; 2], depth: u8, colour: u8) -> Vec<u8> {
    let mut png = Vec::new();
    RgbImage::new(1, 1).write_to(&mut std::io::Cursor::new(&mut png), ImageFormat::Png).unwrap();
    // The header chunk: its kind at 12, then width, height, depth, colour type, three bytes, and
    // the checksum.
    png[16..20].copy_from_slice(&sides[0].to_be_bytes());
    png[20..24].copy_from_slice(&sides[1].to_be_bytes());
    (png[24], png[25]) = (depth, colour);
    let checksum = crc32fast::hash(&png[12..29]);
    png[29..33].copy_from_slice(&checksum.to_be_bytes());
    png
}

/// Returns a JPEG whose header claims these sides (pixels), with the pixels of a much smaller
/// image.
fn jpeg_that_claims(sides: [u16; 2]) -> Vec<u8> {
    let mut jpeg = Vec::new();
    RgbImage::new(8, 8).write_to(&mut std::io::Cursor::new(&mut jpeg), ImageFormat::Jpeg).unwrap();
    // The frame header: marker, length, precision, height, width.
    let start = jpeg.windows(2).position(|marker| marker == [0xff, 0xc0]).unwrap();
    jpeg[start + 5..start + 7].copy_from_slice(&sides[1].to_be_bytes());
    jpeg[start + 7..start + 9].copy_from_slice(&sides[0].to_be_bytes());
    jpeg
}

fn reason(bytes: &[u8]) -> String {
    match decode_image(bytes) {
        Err(Error::Image { reason, .. }) => reason,
        other => panic!("{other:?}"),
    }
}

/// A few hundred bytes that claim gigabytes are rejected by their claim, before memory is
/// allocated.
#[test]
fn images_that_claim_to_be_huge() {
    const GREY: u8 = 0;
    const COLOUR: u8 = 2;
    const TRANSPARENT: u8 = 6;
    for (claim, taken) in [
        // Grey becomes colour: 1 + 3 bytes per pixel.
        (png_that_claims([16_384, 16_384], 8, GREY), "1024 MiB"),
        (png_that_claims([16_384, 8_193], 8, GREY), "512 MiB"),
        (png_that_claims([16_384, 16_384], 1, GREY), "1024 MiB"),
        (png_that_claims([16_384, 16_384], 16, GREY), "1280 MiB"),
        (png_that_claims([16_384, 16_384], 8, COLOUR), "768 MiB"),
        (png_that_claims([16_384, 16_384], 16, TRANSPARENT), "2816 MiB"),
        // 3 bytes per pixel, and 6 of coefficients.
        (jpeg_that_claims([16_384, 16_384]), "2304 MiB"),
        (jpeg_that_claims([16_384, 7_300]), "1026 MiB"),
    ] {
        let mut text = String::new();
        let held = allocation_counter::measure(|| text = reason(&claim)).bytes_max;
        assert!(text.contains(&format!("pixels take {taken}")), "{text}");
        assert!(held < 1 << 20, "{held} bytes for {text}");
    }
    // Images within the limits are rejected only because pixels are missing.
    for claim in
        [png_that_claims([4096, 4096], 8, GREY), png_that_claims([2000, 2000], 16, TRANSPARENT)]
    {
        assert!(!reason(&claim).contains("MiB"), "{}", reason(&claim));
    }
    for claim in [
        png_that_claims([30_000, 1], 8, GREY),
        png_that_claims([1, 16_385], 8, COLOUR),
        jpeg_that_claims([16_385, 1]),
    ] {
        assert_eq!(reason(&claim), "Image size exceeds limit");
    }
}

#[test]
fn every_kind_of_pixel_becomes_colour() {
    use image::{DynamicImage, GrayImage, ImageBuffer, Luma, Rgba, RgbaImage};
    let grey = GrayImage::from_fn(5, 4, |x, y| Luma([u8::try_from(40 * x + y).unwrap()]));
    let deep = ImageBuffer::from_fn(5, 4, |x, y| Luma([257 * u16::try_from(40 * x + y).unwrap()]));
    let clear = RgbaImage::from_fn(5, 4, |x, y| {
        let value = u8::try_from(40 * x + y).unwrap();
        Rgba([value, value, value, 7])
    });
    let expected = Array3::from_shape_fn((4, 5, 3), |(y, x, _)| u8::try_from(40 * x + y).unwrap());
    for image in
        [DynamicImage::from(grey), DynamicImage::ImageLuma16(deep), DynamicImage::from(clear)]
    {
        let mut png = std::io::Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png).unwrap();
        assert_eq!(decode_image(png.get_ref()).unwrap(), expected, "{:?}", image.color());
    }
}

#[test]
fn image_files_without_an_end() {
    match read_image("/dev/zero") {
        Err(Error::File { path, reason }) => {
            assert!(path == "/dev/zero" && reason.contains("268435456 bytes"), "{reason}");
        }
        other => panic!("{other:?}"),
    }
}

proptest! {
    /// A constant frame stays constant for any sizes. No result leaves the range of the frame's
    /// values.
    #[test]
    fn resizing_keeps_the_range(
        (height, width) in (1..40_usize, 1..40_usize),
        (to_height, to_width) in (1..40_usize, 1..40_usize),
        low in 0..=255_u8,
        high in 0..=255_u8,
    ) {
        let (low, high) = (low.min(high), low.max(high));
        let frame = frame(height, width).mapv(|pixel| pixel.clamp(low, high));
        for resized in [
            resize_pillow(frame.view(), to_height, to_width).unwrap(),
            resize_opencv(frame.view(), to_height, to_width).unwrap(),
        ] {
            prop_assert!(resized.iter().all(|pixel| (low..=high).contains(pixel)));
        }
    }

    #[test]
    fn sampled_indices_are_in_the_video(
        frames in 1..2000_usize,
        length in 1..40_usize,
        interval in 1..40_usize,
        clips in 1..40_usize,
    ) {
        for sampling in [
            ClipSampling::Mmaction2 { length, interval, clips },
            ClipSampling::Mmaction2Before1 { length, interval, clips },
            ClipSampling::PyTorchVideo { length },
        ] {
            for clip in sampling.indices(frames).unwrap() {
                prop_assert_eq!(clip.len(), length);
                prop_assert!(clip.iter().all(|&frame| frame < frames));
            }
        }
    }

    #[test]
    fn broken_images_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        prop_assert!(decode_image(&bytes).is_err());
    }
}
