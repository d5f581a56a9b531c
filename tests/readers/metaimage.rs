//! MetaImage.

use umbravox::io::ReadOptions;
use umbravox::volume::Rescale;

use super::{Kind, Scratch, assert_holds, assert_placed, assert_refused, gzip, open, zlib};

fn type_name(kind: Kind) -> &'static str {
    match kind {
        Kind::U8 => "MET_UCHAR",
        Kind::I8 => "MET_CHAR",
        Kind::U16 => "MET_USHORT",
        Kind::I16 => "MET_SHORT",
        Kind::U32 => "MET_UINT",
        Kind::I32 => "MET_INT",
        Kind::U64 => "MET_ULONG_LONG",
        Kind::I64 => "MET_LONG_LONG",
        Kind::F32 => "MET_FLOAT",
        Kind::F64 => "MET_DOUBLE",
    }
}

/// A header up to the data file, which `more` must name at its end.
fn header(kind: Kind, big: bool, more: &str) -> String {
    format!(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = {}\n\
         DimSize = 3 4 5\nElementType = {}\n{more}\n",
        if big { "True" } else { "False" },
        type_name(kind)
    )
}

const LOCAL: &str = "ElementDataFile = LOCAL";

fn local(header: String, data: &[u8]) -> Vec<u8> {
    [header.as_bytes(), data].concat()
}

#[test]
fn every_type_order_and_coding() {
    let scratch = Scratch::new();
    for kind in Kind::ALL {
        for big in [false, true] {
            let data = kind.data(big);
            let packed = zlib(&data);
            let compressed = format!(
                "CompressedData = True\nCompressedDataSize = {}\n{LOCAL}",
                packed.len()
            );
            let unsized_ = format!("CompressedData = True\n{LOCAL}");
            let words: Vec<String> = kind.content().0.iter().map(f64::to_string).collect();
            let text = header(kind, big, LOCAL).replace("BinaryData = True", "BinaryData = False");
            for bytes in [
                local(header(kind, big, LOCAL), &data),
                local(header(kind, big, "ElementDataFile = Local\r"), &data),
                local(header(kind, big, &compressed), &packed),
                local(header(kind, big, &unsized_), &packed),
                local(text, words.join(" ").as_bytes()),
            ] {
                let volume = open(&scratch.file("a.mha", &bytes));
                assert_holds(&volume, kind);
                assert_eq!(volume.rescale(), Rescale::default());
                assert_placed(
                    &volume,
                    [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
                    [0.; 3],
                    0.0,
                );
            }
        }
    }
}

#[test]
fn byte_order_by_either_key() {
    let scratch = Scratch::new();
    let header = header(Kind::F32, true, LOCAL).replace("BinaryDataByteOrder", "ElementByteOrder");
    assert!(header.contains("ElementByteOrderMSB = True"));
    assert_holds(
        &open(&scratch.file("a.mha", &local(header, &Kind::F32.data(true)))),
        Kind::F32,
    );
}

/// Each triple of the matrix is the direction of one index axis.
#[test]
fn oblique_placement_under_every_name() {
    let scratch = Scratch::new();
    for (matrix, origin) in [
        ("TransformMatrix", "Offset"),
        ("Rotation", "Position"),
        ("Orientation", "Origin"),
    ] {
        let more = format!(
            "{matrix} = 0.8 0.6 0 -0.6 0.8 0 0 0.28 0.96\n{origin} = 10 -20 30.5\n\
             ElementSpacing = 0.5 0.75 2\nElementSize = 9 9 9\nAnatomicalOrientation = RAI\n{LOCAL}"
        );
        let bytes = local(header(Kind::U8, false, &more), &Kind::U8.data(false));
        assert_placed(
            &open(&scratch.file("a.mha", &bytes)),
            [[0.4, 0.3, 0.], [-0.45, 0.6, 0.], [0., 0.56, 1.92]],
            [10., -20., 30.5],
            1e-15,
        );
    }
}

#[test]
fn sizes_of_elements_stand_in_for_spacing() {
    let scratch = Scratch::new();
    let more = format!("ElementSize = 0.5 0.75 2\n{LOCAL}");
    let bytes = local(header(Kind::U8, false, &more), &Kind::U8.data(false));
    assert_eq!(
        open(&scratch.file("a.mha", &bytes)).spacing(),
        [0.5, 0.75, 2.0]
    );
}

#[test]
fn intensity_function_is_the_rescale() {
    let scratch = Scratch::new();
    let more = format!(
        "ElementToIntensityFunctionSlope = 2.5\nElementToIntensityFunctionOffset = -1024\n{LOCAL}"
    );
    let bytes = local(header(Kind::I16, false, &more), &Kind::I16.data(false));
    let volume = open(&scratch.file("a.mha", &bytes));
    assert_eq!(
        volume.rescale(),
        Rescale {
            slope: 2.5,
            intercept: -1024.0
        }
    );
    assert_holds(&volume, Kind::I16);
}

#[test]
fn detached_data_and_headers_in_them() {
    let scratch = Scratch::new();
    let kind = Kind::I16;
    let data = kind.data(false);
    scratch.file("sub/plain.raw", &data);
    scratch.file("headed.raw", &[b"seven..".as_slice(), &data].concat());
    scratch.file("packed.zraw", &zlib(&data));
    scratch.file(
        "headed.zraw",
        &[b"seven..".as_slice(), &zlib(&data)].concat(),
    );
    for more in [
        "ElementDataFile = sub/plain.raw",
        "HeaderSize = 0\nElementDataFile = ./sub/../sub/plain.raw",
        "HeaderSize = 7\nElementDataFile = headed.raw",
        "HeaderSize = -1\nElementDataFile = headed.raw",
        "CompressedData = True\nElementDataFile = packed.zraw",
        "CompressedData = True\nHeaderSize = 7\nElementDataFile = headed.zraw",
    ] {
        assert_holds(
            &open(&scratch.file("a.mhd", header(kind, false, more).as_bytes())),
            kind,
        );
    }
}

#[test]
fn detached_names_stay_in_the_folder() {
    let scratch = Scratch::new();
    let secret = scratch.file("secret.raw", &Kind::U8.data(false));
    for name in [
        secret.to_str().unwrap(),
        "../secret.raw",
        "a/../../secret.raw",
        "absent.raw",
        "",
    ] {
        let more = format!("ElementDataFile = {name}");
        let path = scratch.file("in/a.mhd", header(Kind::U8, false, &more).as_bytes());
        assert_refused(
            &path,
            &ReadOptions::default(),
            &["a.mhd", "ElementDataFile", name],
        );
    }
}

#[test]
fn further_axes_of_one_voxel_are_fine_others_are_counted() {
    let scratch = Scratch::new();
    let four = |n: u32| {
        let more = format!(
            "TransformMatrix = 0 1 0 0  -1 0 0 0  0 0 1 0  0 0 0 1\nOffset = 1 2 3 4\n\
             ElementSpacing = 0.5 0.75 2 9\n{LOCAL}"
        );
        header(Kind::U8, false, &more)
            .replace("NDims = 3", "NDims = 4")
            .replace("3 4 5", &format!("3 4 5 {n}"))
    };
    let data = Kind::U8.data(false);
    let volume = open(&scratch.file("a.mha", &local(four(1), &data)));
    assert_holds(&volume, Kind::U8);
    assert_placed(
        &volume,
        [[0., 0.5, 0.], [-0.75, 0., 0.], [0., 0., 2.]],
        [1., 2., 3.],
        0.0,
    );
    let path = scratch.file("a.mha", &local(four(3), &data.repeat(3)));
    assert_holds(&open(&path), Kind::U8);
    let beyond = ReadOptions {
        timestep: Some(3),
        ..ReadOptions::default()
    };
    assert_refused(
        &path,
        &beyond,
        &["DimSize", "volume.timestep 3", "3 volumes"],
    );
}

#[test]
fn wrong_headers_name_the_key() {
    let scratch = Scratch::new();
    let good = header(
        Kind::U16,
        false,
        &format!("ElementSpacing = 1 1 1\n{LOCAL}"),
    );
    let spacing = "ElementSpacing = 1 1 1";
    for (from, to, words) in [
        ("= Image", "= Tube", ["ObjectType", "Tube"]),
        ("NDims = 3", "NDims = three", ["NDims", "three"]),
        ("NDims = 3", "NDims = 2", ["DimSize", "NDims 2"]),
        ("NDims = 3\n", "NDims = 3\nNDims = 3\n", ["NDims", "twice"]),
        ("MET_USHORT", "MET_STRING", ["ElementType", "MET_STRING"]),
        ("ElementType = MET_USHORT\n", "", ["ElementType", "missing"]),
        ("DimSize = 3 4 5\n", "", ["DimSize", "missing"]),
        (
            "ElementDataFile = LOCAL\n",
            "",
            ["ElementDataFile", "missing"],
        ),
        ("3 4 5", "0 4 5", ["DimSize", "first axis has 0"]),
        ("3 4 5", "3 1 20", ["DimSize", "second axis has 1"]),
        ("3 4 5", "3 4 -5", ["DimSize", "-5"]),
        (
            "3 4 5",
            "3 4 4294967296",
            ["DimSize", "third axis has 4294967296"],
        ),
        (
            "3 4 5",
            "4294967295 4294967295 4294967295",
            ["DimSize", "more voxels than can be counted"],
        ),
        ("3 4 5", "100000 100000 100000", ["DimSize", "limits"]),
        ("3 4 5", "3 4 6", ["144 bytes", "file has 120"]),
        (
            "BinaryData = True",
            "BinaryData = maybe",
            ["BinaryData", "maybe"],
        ),
        (
            spacing,
            "ElementNumberOfChannels = 0",
            ["0 channels", "1 to"],
        ),
        (
            spacing,
            "ElementSpacing = 1 NaN 1",
            ["ElementSpacing", "NaN"],
        ),
        (
            spacing,
            "ElementSpacing = 1 -1 1",
            ["ElementSpacing", "above 0"],
        ),
        (
            spacing,
            "ElementSpacing = 1 0 1",
            ["ElementSpacing", "above 0"],
        ),
        (
            spacing,
            "ElementSpacing = 1 1",
            ["ElementSpacing", "3 numbers"],
        ),
        (
            spacing,
            "ElementSpacing = 1 1 mm",
            ["ElementSpacing", "\"mm\""],
        ),
        (spacing, "Offset = 0 inf 0", ["Offset", "finite"]),
        (
            spacing,
            "TransformMatrix = 1 0 0 0 1 0",
            ["TransformMatrix", "9 numbers"],
        ),
        (
            spacing,
            "TransformMatrix = 1 0 0 0 1 0 1 1 0",
            ["TransformMatrix", "span no space"],
        ),
        (
            spacing,
            "CompressedData = perhaps",
            ["CompressedData", "perhaps"],
        ),
        (
            spacing,
            "CompressedData = True\nHeaderSize = -1",
            ["HeaderSize", "-1"],
        ),
        (spacing, "CompressedData = True", ["damaged", "deflate"]),
        (spacing, "HeaderSize = 121", ["HeaderSize", "121"]),
        (spacing, "HeaderSize = x", ["HeaderSize", "\"x\""]),
        (
            spacing,
            "ElementToIntensityFunctionSlope = 0",
            ["rescale", "slope"],
        ),
        (spacing, "no assignment", ["line", "no assignment"]),
        ("= LOCAL", "= LIST", ["ElementDataFile", "not there"]),
        (
            "= LOCAL",
            "= slice%03d.raw",
            ["ElementDataFile", "slice%03d.raw"],
        ),
    ] {
        assert!(good.contains(from), "{from}");
        let bytes = local(good.replacen(from, to, 1), &Kind::U16.data(false));
        let path = scratch.file("bad.mha", &bytes);
        assert_refused(
            &path,
            &ReadOptions::default(),
            &["bad.mha", words[0], words[1]],
        );
    }
}

#[test]
fn gzip_is_not_taken_for_zlib() {
    let scratch = Scratch::new();
    let more = format!("CompressedData = True\n{LOCAL}");
    let bytes = local(header(Kind::U8, false, &more), &gzip(&Kind::U8.data(false)));
    assert_refused(
        &scratch.file("bad.mha", &bytes),
        &ReadOptions::default(),
        &["bad.mha", "damaged"],
    );
}
