//! Pictures and light volumes as files, read back.
#![cfg(feature = "image-io")]

use std::fs;
use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};
use umbravox::Error;
use umbravox::output::{self, Target};
use umbravox::picture::{Measured, Picture};
use umbravox::scene::{ColorManagement, Image, srgb_from_linear};

/// 3 x 2: nothing, half covered, opaque; over-bright, faint, opaque.
fn picture() -> Picture {
    Picture {
        size: [3, 2],
        rgba: vec![
            [0.0, 0.0, 0.0, 0.0],
            [0.25, 0.1, 0.0, 0.5],
            [0.5, 1.0, 0.2, 1.0],
            [4.0, 0.0, 0.0, 1.0],
            [0.001, 0.002, 0.003, 0.004],
            [0.0, 0.0, 0.0, 1.0],
        ],
        depth: vec![f32::INFINITY, 1.5, 2.5, 3.5, f32::INFINITY, 4.5],
        through: None,
        variance: None,
        median_depth: vec![f32::INFINITY, 2.5, 3.0, 4.0, f32::INFINITY, 5.0],
        measure: vec![f32::INFINITY, 2.0, 2.75, 3.75, 1.0, 4.75],
        measured: Measured::ExpectedDepth,
        samples: vec![0, 10, 20, 30, 40, 50],
    }
}

fn settings(color_management: ColorManagement, png_bits: u8) -> Image {
    Image {
        background: [0.5, 0.0, 1.0],
        color_management,
        png_bits,
        ..Image::default()
    }
}

/// Names in a folder: nothing but what was asked for may be left there.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|e| e.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

fn channel(linear: f64, encode: bool, max: f64) -> u32 {
    let display = if encode {
        srgb_from_linear(linear)
    } else {
        linear
    };
    (display.clamp(0.0, 1.0) * max).round() as u32
}

#[test]
fn png_is_composited_encoded_and_rounded() {
    let folder = tempfile::tempdir().unwrap();
    for (colors, encode) in [
        (ColorManagement::Linear, true),
        (ColorManagement::None, false),
    ] {
        for (bits, max) in [(8, 255.0), (16, 65_535.0)] {
            let path = folder.path().join("a.png");
            let settings = settings(colors, bits);
            output::write(&path, &picture(), &settings, &[]).unwrap();
            let read = image::open(&path).unwrap();
            let expected_type = if bits == 8 {
                image::ColorType::Rgb8
            } else {
                image::ColorType::Rgb16
            };
            assert_eq!(read.color(), expected_type);
            let read: Vec<u32> = if bits == 8 {
                read.to_rgb8().iter().map(|&v| v.into()).collect()
            } else {
                read.to_rgb16().iter().map(|&v| v.into()).collect()
            };
            let background = colors.decode(settings.background);
            let expected: Vec<u32> = picture()
                .rgba
                .iter()
                .flat_map(|p| {
                    (0..3).map(|i| {
                        let behind = (1.0 - f64::from(p[3])) * background[i];
                        channel(f64::from(p[i]) + behind, encode, max)
                    })
                })
                .collect();
            assert_eq!(read, expected, "{colors:?}, {bits} bits");
        }
    }
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
fn uncovered_pixels_show_exactly_the_background() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    for level in 0..=255u8 {
        let image = Image {
            background: [f64::from(level) / 255.0; 3],
            ..Image::default()
        };
        output::write(&path, &picture(), &image, &[]).unwrap();
        assert_eq!(
            image::open(&path).unwrap().to_rgb8().get_pixel(0, 0).0,
            [level; 3]
        );
    }
}

#[test]
fn png_carries_provenance() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let provenance = [
        ("Software", "umbravox".to_owned()),
        ("Source", "Schädel.nrrd".to_owned()),
    ];
    output::write(&path, &picture(), &Image::default(), &provenance).unwrap();
    let bytes = fs::read(&path).unwrap();
    let chunks = png_chunks(&bytes);
    let kinds: Vec<&str> = chunks.iter().map(|(kind, _)| kind.as_str()).collect();
    assert_eq!(kinds[..4], ["IHDR", "sRGB", "tEXt", "iTXt"]);
    assert_eq!(kinds.last(), Some(&"IEND"));
    assert_eq!(chunks[2].1, b"Software\0umbravox");
    assert_eq!(chunks[3].1, "Source\0\0\0\0\0Schädel.nrrd".as_bytes());
    // A reader that checks the chunks' sums takes it.
    image::open(&path).unwrap();
}

#[test]
fn provenance_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let written = [
        (
            "Scene",
            r#"{"volume":{"path":"C:\\Schädel 頭 🙂"}}"#.to_owned(),
        ),
        ("Source", "Schädel 頭 🙂.nrrd".to_owned()),
        ("Software", "umbravox".to_owned()),
    ];
    let mut expected: Vec<(String, String)> = written
        .iter()
        .map(|(name, text)| ((*name).to_owned(), text.clone()))
        .collect();
    expected.sort();
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        output::write(&path, &picture(), &Image::default(), &written).unwrap();
        let mut read = output::read_provenance(&path).unwrap();
        read.sort();
        assert_eq!(read, expected, "{name}");
    }
    let path = folder.path().join("text");
    for content in ["", "no picture at all", "\x7fELF"] {
        fs::write(&path, content).unwrap();
        let error = output::read_provenance(&path).unwrap_err();
        assert!(error.is_bad_input(), "{error}");
    }
}

/// Pictures cut off anywhere, and with any byte of their beginning changed: an error or some text, never a panic.
#[test]
fn damaged_pictures_are_refused_or_read() {
    let folder = tempfile::tempdir().unwrap();
    let written = [("Source", "head.nrrd".to_owned())];
    for name in ["a.png", "a.exr"] {
        let path = folder.path().join(name);
        output::write(&path, &picture(), &Image::default(), &written).unwrap();
        let whole = fs::read(&path).unwrap();
        let mut refused = 0;
        let mut read = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            match output::read_provenance(&path) {
                Ok(_) => {}
                Err(error) => {
                    assert!(error.is_bad_input(), "{error}");
                    refused += 1;
                }
            }
        };
        let count = whole.len().min(700);
        for at in 0..count {
            read(&whole[..at]);
            for value in [0, 0x7f, 0xff] {
                let mut changed = whole.clone();
                changed[at] = value;
                read(&changed);
            }
        }
        assert!(refused > count / 2, "{name}: {refused}");
    }
}

/// Type and content of every chunk; sums are checked.
fn png_chunks(bytes: &[u8]) -> Vec<(String, &[u8])> {
    let mut chunks = Vec::new();
    let mut rest = &bytes[8..];
    while !rest.is_empty() {
        let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        let mut crc = flate2::Crc::new();
        crc.update(&rest[4..8 + length]);
        let stored = u32::from_be_bytes(rest[8 + length..12 + length].try_into().unwrap());
        assert_eq!(crc.sum(), stored);
        let kind = String::from_utf8(rest[4..8].to_vec()).unwrap();
        chunks.push((kind, &rest[8..8 + length]));
        rest = &rest[12 + length..];
    }
    chunks
}

#[test]
fn exr_holds_linear_radiance_and_layers() {
    use exr::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.EXR");
    let settings = settings(ColorManagement::Linear, 8);
    let provenance = [("Source", "head.nrrd".to_owned())];
    output::write(&path, &picture(), &settings, &provenance).unwrap();
    let image = read_first_flat_layer_from_file(&path).unwrap();
    let layer = image.layer_data;
    assert_eq!(layer.size, Vec2(3, 2));
    let values = |name: &str| {
        let channel = layer
            .channel_data
            .list
            .iter()
            .find(|c| c.name.eq(name))
            .unwrap();
        match &channel.sample_data {
            FlatSamples::F32(values) => values.clone(),
            other => panic!("{name} is {other:?}"),
        }
    };
    let names: Vec<String> = layer
        .channel_data
        .list
        .iter()
        .map(|c| c.name.to_string())
        .collect();
    assert_eq!(
        names,
        [
            "A",
            "B",
            "G",
            "R",
            "depth.Z",
            "expected_depth.Z",
            "median_depth.Z",
            "opacity.Y",
            "samples.Y"
        ]
    );
    let picture = picture();
    let background = settings.color_management.decode(settings.background);
    for (i, name) in ["R", "G", "B"].into_iter().enumerate() {
        let expected: Vec<f32> = picture
            .rgba
            .iter()
            .map(|p| (f64::from(p[i]) + (1.0 - f64::from(p[3])) * background[i]) as f32)
            .collect();
        assert_eq!(values(name), expected);
    }
    let opacity: Vec<f32> = picture.rgba.iter().map(|p| p[3]).collect();
    assert_eq!(values("A"), opacity);
    assert_eq!(values("opacity.Y"), opacity);
    assert_eq!(values("depth.Z"), picture.depth);
    assert_eq!(values("median_depth.Z"), picture.median_depth);
    assert_eq!(values("expected_depth.Z"), picture.measure);
    assert_eq!(values("samples.Y"), [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]);
    let source = layer.attributes.other.get(&Text::from("umbravox"));
    assert_eq!(
        source,
        Some(&attribute::AttributeValue::Text(
            r#"{"Source":"head.nrrd"}"#.into()
        ))
    );
    assert_eq!(self::names(folder.path()), ["a.EXR"]);
}

#[test]
fn bad_places_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let message = |name: &str| {
        let error = Target::new(folder.path().join(name)).unwrap_err();
        assert!(error.is_bad_input());
        error.to_string()
    };
    assert!(
        message("a.gif").ends_with("extension \"gif\" is not a picture format; give .png or .exr")
    );
    assert!(message("png").ends_with("extension \"\" is not a picture format; give .png or .exr"));
    let missing = message("none/a.png");
    assert!(missing.ends_with("none; create it first"), "{missing}");
    fs::create_dir(folder.path().join("dir.png")).unwrap();
    assert!(message("dir.png").ends_with("is a folder; give a file name"));
    assert_eq!(names(folder.path()), ["dir.png"]);
}

#[test]
fn failed_writes_leave_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    fs::write(&path, "old").unwrap();
    let target = Target::new(&path).unwrap();
    // PNG has no picture without pixels.
    let empty = Picture {
        size: [0, 0],
        rgba: vec![],
        depth: vec![],
        through: None,
        variance: None,
        median_depth: vec![],
        measure: vec![],
        measured: Measured::ExpectedDepth,
        samples: vec![],
    };
    assert!(target.write(&empty, &Image::default(), &[]).is_err());
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(names(folder.path()), ["a.png"]);
    // The folder disappears between the check and the write.
    let gone = folder.path().join("sub");
    fs::create_dir(&gone).unwrap();
    let target = Target::new(gone.join("a.exr")).unwrap();
    fs::remove_dir(&gone).unwrap();
    let written = target.write(&picture(), &Image::default(), &[]);
    assert!(matches!(written, Err(Error::Io { .. })), "{written:?}");
    assert!(!gone.exists());
}

#[test]
fn light_volumes_are_float_nrrd_in_lps() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("light.nrrd");
    let placement = DAffine3 {
        matrix3: DMat3::from_cols(
            DVec3::new(0.0, 0.5, 0.0),
            DVec3::new(-0.5, 0.0, 0.0),
            DVec3::new(0.0, 0.0, 2.25),
        ),
        translation: DVec3::new(-71.66, 10.0, 540.2),
    };
    let rgba: Vec<[f32; 4]> = (0..12u8).map(|i| [f32::from(i), 0.5, -1.0, 1.0]).collect();
    output::write_light(&path, [2, 3, 2], &rgba, placement).unwrap();
    let bytes = fs::read(&path).unwrap();
    let end = bytes.windows(2).position(|w| w == b"\n\n").unwrap();
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    assert_eq!(
        header.lines().collect::<Vec<_>>(),
        [
            "NRRD0005",
            "type: float",
            "dimension: 4",
            "space: left-posterior-superior",
            "sizes: 4 2 3 2",
            "space directions: none (0,0.5,0) (-0.5,0,0) (0,0,2.25)",
            "kinds: RGBA-color domain domain domain",
            "endian: little",
            "encoding: raw",
            "space origin: (-71.66,10,540.2)",
            "space units: \"mm\" \"mm\" \"mm\"",
        ]
    );
    let data: Vec<f32> = bytes[end + 2..]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(data, rgba.as_flattened());
    assert_eq!(names(folder.path()), ["light.nrrd"]);
    assert!(
        output::write_light(&path, [2, 2, 2], &rgba, placement)
            .unwrap_err()
            .is_bad_input()
    );
}
