//! NRRD and NHDR.

use umbravox::io::{ReadOptions, read};

use super::{Kind, Scratch, assert_holds, assert_placed, assert_refused, gzip, open};

fn type_name(kind: Kind) -> &'static str {
    match kind {
        Kind::U8 => "uint8",
        Kind::I8 => "signed char",
        Kind::U16 => "unsigned short",
        Kind::I16 => "int16_t",
        Kind::U32 => "unsigned int",
        Kind::I32 => "signed int",
        Kind::U64 => "ulonglong",
        Kind::I64 => "long long int",
        Kind::F32 => "float",
        Kind::F64 => "double",
    }
}

fn header(kind: Kind, big: bool, encoding: &str, more: &str) -> String {
    format!(
        "NRRD0004\n# first comment\n# second comment: with a colon\ntype: {}\ndimension: 3\nsizes: 3 4 5\n\
         endian: {}\nencoding: {encoding}\nkey:=value: with := marks\n{more}",
        type_name(kind),
        if big { "big" } else { "little" },
    )
}

fn attached(header: String, data: &[u8]) -> Vec<u8> {
    [header.as_bytes(), b"\n", data].concat()
}

#[test]
fn every_type_order_and_encoding() {
    let scratch = Scratch::new();
    for kind in Kind::ALL {
        for big in [false, true] {
            let data = kind.data(big);
            let hex: String = data.iter().map(|b| format!("{b:02x}\n")).collect();
            let (values, _) = kind.content();
            let words: Vec<String> = values.iter().map(f64::to_string).collect();
            for (encoding, data) in [
                ("raw", data.clone()),
                ("gzip", gzip(&data)),
                ("GZ", gzip(&data)),
                ("hex", hex.into_bytes()),
                ("ascii", words.join(" ").into_bytes()),
                ("txt", words.join("\n, ").into_bytes()),
            ] {
                let bytes = attached(header(kind, big, encoding, ""), &data);
                let volume = open(&scratch.file("a.nrrd", &bytes));
                assert_holds(&volume, kind);
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
fn oblique_directions_in_every_space() {
    let scratch = Scratch::new();
    let place =
        "space directions: (0.5,0.1,0) (-0.2, 1, 0.25) (0,-0.5,2)\nspace origin: (10,-20,30)\n";
    for (space, [x, y, z]) in [
        ("left-posterior-superior", [1., 1., 1.]),
        ("LPS", [1., 1., 1.]),
        ("right-anterior-superior", [-1., -1., 1.]),
        ("ras", [-1., -1., 1.]),
        ("left-anterior-superior", [1., -1., 1.]),
        ("3D-right-handed", [1., 1., 1.]),
    ] {
        let more = format!("space: {space}\n{place}");
        let bytes = attached(header(Kind::U8, false, "raw", &more), &Kind::U8.data(false));
        let volume = open(&scratch.file("a.nrrd", &bytes));
        assert_placed(
            &volume,
            [
                [0.5 * x, 0.1 * y, 0.],
                [-0.2 * x, y, 0.25 * z],
                [0., -0.5 * y, 2. * z],
            ],
            [10. * x, -20. * y, 30. * z],
            1e-15,
        );
        assert_holds(&volume, Kind::U8);
    }
}

#[test]
fn spacing_by_spacings_units_or_bounds() {
    let scratch = Scratch::new();
    for (more, spacing, origin) in [
        ("spacings: 0.5 0.75 2\n", [0.5, 0.75, 2.], [0.; 3]),
        (
            "spacings: 1 2 3\nunits: \"cm\" \"um\" \"m\"\n",
            [10., 2e-3, 3000.],
            [0.; 3],
        ),
        (
            "space dimension: 3\nspace directions: (32,0,0) (0,32,0) (0,0,40)\nspace units: \"nm\" \"nm\" \"nm\"\n\
             space origin: (1000,0,0)\n",
            [32e-6, 32e-6, 40e-6],
            [1e-3, 0., 0.],
        ),
        // Nodes: 2, 3 and 4 intervals between the outer centres. Cells: 5 voxels between the outer faces.
        (
            "axis mins: 0 3 10\naxismaxs: 4 12 20\ncenterings: node node cell\n",
            [2., 3., 2.],
            [0., 3., 11.],
        ),
    ] {
        let bytes = attached(header(Kind::I16, true, "raw", more), &Kind::I16.data(true));
        let [x, y, z] = spacing;
        assert_placed(
            &open(&scratch.file("a.nrrd", &bytes)),
            [[x, 0., 0.], [0., y, 0.], [0., 0., z]],
            origin,
            1e-12,
        );
    }
}

#[test]
fn detached_data_and_skips() {
    let scratch = Scratch::new();
    let kind = Kind::U16;
    let data = kind.data(true);
    let skipped = [b"P5\n3 20\n".as_slice(), b"abc", &data].concat();
    scratch.file("plain.raw", &data);
    scratch.file("sub/skipped.raw", &skipped);
    scratch.file(
        "packed.gz",
        &[
            b"line\n".as_slice(),
            &gzip(&[b"abc", data.as_slice()].concat()),
        ]
        .concat(),
    );
    for (encoding, more) in [
        ("raw", "data file: plain.raw\n"),
        ("raw", "datafile: ./sub/../plain.raw\r\n"),
        (
            "raw",
            "data file: sub/skipped.raw\nline skip: 2\nbyte skip: 3\n",
        ),
        ("raw", "data file: sub/skipped.raw\nbyteskip: -1\n"),
        ("gzip", "data file: packed.gz\nlineskip: 1\nbyte skip: 3\n"),
    ] {
        let path = scratch.file("a.nhdr", header(kind, true, encoding, more).as_bytes());
        assert_holds(&open(&path), kind);
    }
}

#[test]
fn detached_names_stay_in_the_folder() {
    let scratch = Scratch::new();
    let secret = scratch.file("secret.raw", &Kind::U8.data(false));
    for name in [
        secret.to_str().unwrap(),
        "../secret.raw",
        "deeper/../../secret.raw",
        "./../secret.raw",
    ] {
        let more = format!("data file: {name}\n");
        let path = scratch.file(
            "in/a.nhdr",
            header(Kind::U8, false, "raw", &more).as_bytes(),
        );
        assert_refused(
            &path,
            &ReadOptions::default(),
            &["a.nhdr", "data file", name],
        );
    }
    for (name, why) in [
        ("absent.raw", "cannot open"),
        (".", "names no file"),
        ("LIST", "names no file"),
    ] {
        let more = format!("data file: {name}\n");
        let path = scratch.file(
            "in/a.nhdr",
            header(Kind::U8, false, "raw", &more).as_bytes(),
        );
        assert_refused(
            &path,
            &ReadOptions::default(),
            &["a.nhdr", "data file", name, why],
        );
    }
}

#[test]
fn further_axes_of_one_voxel_are_fine_others_are_counted() {
    let scratch = Scratch::new();
    let four = |n: u32| {
        header(
            Kind::U8,
            false,
            "raw",
            "spacings: 1 2 3 nan\nkinds: space space space time\n",
        )
        .replace("dimension: 3", "dimension: 4")
        .replace("3 4 5", &format!("3 4 5 {n}"))
    };
    let data = Kind::U8.data(false);
    let volume = open(&scratch.file("a.nrrd", &attached(four(1), &data)));
    assert_holds(&volume, Kind::U8);
    assert_eq!(volume.spacing(), [1., 2., 3.]);
    let zeros = vec![0; data.len()];
    let seven = [zeros.repeat(3), data, zeros.repeat(3)].concat();
    let path = scratch.file("a.nrrd", &attached(four(7), &seven));
    let at = |timestep| ReadOptions {
        timestep: Some(timestep),
        ..ReadOptions::default()
    };
    assert_holds(&read(&path, &at(3)).unwrap(), Kind::U8);
    assert_eq!(read(&path, &at(2)).unwrap().value_range(), [0.0, 0.0]);
    assert_refused(&path, &at(7), &["sizes", "volume.timestep 7", "7 volumes"]);
}

#[test]
fn wrong_headers_name_the_field() {
    let scratch = Scratch::new();
    let good = header(Kind::U16, false, "raw", "spacings: 1 1 1\n");
    let directions = "space directions: (1,0,0) (0,1,0)";
    for (from, to, words) in [
        ("NRRD0004", "NRRD0009", ["first line", "NRRD0009"]),
        ("unsigned short", "quaternion", ["type", "quaternion"]),
        ("unsigned short", "block", ["type", "block"]),
        ("type: unsigned short\n", "", ["type", "missing"]),
        ("sizes: 3 4 5\n", "", ["sizes", "missing"]),
        ("dimension: 3\n", "", ["dimension", "missing"]),
        ("encoding: raw\n", "", ["encoding", "missing"]),
        ("endian: little\n", "", ["endian", "missing"]),
        ("dimension: 3", "dimension: x", ["dimension", "\"x\""]),
        ("dimension: 3", "dimension: 2", ["sizes", "dimension 2"]),
        (
            "dimension: 3\nsizes: 3 4 5",
            "dimension: 2\nsizes: 3 20",
            ["sizes", "2 axes"],
        ),
        ("encoding: raw", "encoding: zstd", ["encoding", "zstd"]),
        ("endian: little", "endian: middle", ["endian", "middle"]),
        ("3 4 5", "0 4 5", ["sizes", "first axis has 0"]),
        ("3 4 5", "3 1 20", ["sizes", "second axis has 1"]),
        ("3 4 5", "3 4 -5", ["sizes", "-5"]),
        ("3 4 5", "3 4 5.5", ["sizes", "5.5"]),
        (
            "3 4 5",
            "3 4 4294967296",
            ["sizes", "third axis has 4294967296"],
        ),
        (
            "3 4 5",
            "4294967295 4294967295 4294967295",
            ["sizes", "more voxels than can be counted"],
        ),
        ("3 4 5", "100000 100000 100000", ["sizes", "limits"]),
        ("3 4 5", "3 4 6", ["144 bytes", "file has 120"]),
        (
            "spacings: 1 1 1",
            "spacings: 1 nan 1",
            ["spacings", "finite"],
        ),
        ("spacings: 1 1 1", "spacings: 1 1", ["spacings", "2 values"]),
        (
            "spacings: 1 1 1",
            "spacings: 1 0 1",
            ["spacings", "span no space"],
        ),
        (
            "spacings: 1 1 1",
            "spacing: 1 1 1",
            ["unknown field", "\"spacing\""],
        ),
        ("spacings: 1 1 1", "no field", ["line", "no field"]),
        ("spacings: 1 1 1", "type: float", ["type", "twice"]),
        ("spacings: 1 1 1", "space: sideways", ["space", "sideways"]),
        (
            "spacings: 1 1 1",
            directions,
            ["space directions", "2 values"],
        ),
        (
            "spacings: 1 1 1",
            &format!("{directions} none"),
            ["space directions", "none"],
        ),
        (
            "spacings: 1 1 1",
            &format!("{directions} (1,2)"),
            ["space directions", "three numbers"],
        ),
        (
            "spacings: 1 1 1",
            &format!("{directions} (1,1,0)"),
            ["space directions", "span no space"],
        ),
        (
            "spacings: 1 1 1",
            &format!("{directions} (0,0,inf)"),
            ["space directions", "finite"],
        ),
        (
            "spacings: 1 1 1",
            "space origin: (1,2",
            ["space origin", "(1,2"],
        ),
        (
            "spacings: 1 1 1",
            "kinds: RGB-color domain domain",
            ["kinds", "RGB-color"],
        ),
        (
            "spacings: 1 1 1",
            "line skip: -1",
            ["line skip", "negative"],
        ),
        ("spacings: 1 1 1", "byte skip: -2", ["byte skip", "-2"]),
        (
            "spacings: 1 1 1",
            "byte skip: 9",
            ["129 bytes", "file has 120"],
        ),
        (
            "spacings: 1 1 1",
            "space units: mm mm mm",
            ["space units", "quoted"],
        ),
    ] {
        assert!(good.contains(from), "{from}");
        let bytes = attached(good.replacen(from, to, 1), &Kind::U16.data(false));
        let path = scratch.file("bad.nrrd", &bytes);
        assert_refused(
            &path,
            &ReadOptions::default(),
            &["bad.nrrd", words[0], words[1]],
        );
    }
}

#[test]
fn wrong_data_name_the_place() {
    let scratch = Scratch::new();
    let wide = |value: f64| {
        let mut data = Kind::F64.data(false);
        data[8 * 41..8 * 42].copy_from_slice(&Kind::F64.bytes(value, false));
        attached(header(Kind::F64, false, "raw", ""), &data)
    };
    let mut damaged = gzip(&Kind::U8.data(false));
    let last = damaged.len() - 5;
    damaged[last] ^= 1;
    for (bytes, words) in [
        (wide(0.1), ["voxel 41", "0.1"]),
        (wide(1e300), ["voxel 41", "f32"]),
        (
            attached(
                header(Kind::U8, false, "ascii", ""),
                "1 2 256 ".repeat(20).as_bytes(),
            ),
            ["256", "type u8"],
        ),
        (
            attached(
                header(Kind::U8, false, "hex", ""),
                "0g".repeat(60).as_bytes(),
            ),
            ["'g'", "digit"],
        ),
        (
            attached(header(Kind::U8, false, "gzip", ""), &damaged),
            ["damaged", "checksum"],
        ),
        (
            attached(header(Kind::U8, false, "gzip", ""), &[7; 60]),
            ["damaged", "gzip"],
        ),
        (
            attached(header(Kind::U8, false, "gzip", ""), &gzip(&[7; 59])),
            ["ends in voxel 59", "60"],
        ),
    ] {
        let path = scratch.file("bad.nrrd", &bytes);
        assert_refused(
            &path,
            &ReadOptions::default(),
            &["bad.nrrd", words[0], words[1]],
        );
    }
}
