//! Data in several files, raw files by name, volumes in archives, and files that are known but not read.

use umbravox::io::{ReadOptions, read};

use super::{Kind, Scratch, assert_holds, assert_refused, gzip};

const NRRD: &str = "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 3 4 5\nendian: little\nencoding: raw\ndata file: ";
const META: &str = "NDims = 3\nDimSize = 3 4 5\nElementType = MET_USHORT\nElementDataFile = ";

/// Five slices, and headers that name them.
fn slices(scratch: &Scratch) {
    for (k, slice) in Kind::U16.data(false).chunks(24).enumerate() {
        scratch.file(&format!("in/s{k}.raw"), slice);
    }
}

#[test]
fn lists_and_patterns() {
    let scratch = Scratch::new();
    slices(&scratch);
    let list = "LIST\ns0.raw\ns1.raw\n\ns2.raw\ns3.raw\n./s4.raw\n";
    for names in [
        "s%d.raw 0 4 1\n",
        "s%d.raw 0 4 1 2\n",
        list,
        &list.replace("LIST", "LIST 2"),
    ] {
        assert_holds(
            &super::open(&scratch.file("in/a.nhdr", format!("{NRRD}{names}").as_bytes())),
            Kind::U16,
        );
        if !names.contains("1 2") {
            assert_holds(
                &super::open(&scratch.file("in/a.mhd", format!("{META}{names}").as_bytes())),
                Kind::U16,
            );
        }
    }
}

#[test]
fn lists_that_lie_are_refused() {
    let scratch = Scratch::new();
    slices(&scratch);
    scratch.file("secret.raw", &[1; 24]);
    let cases = [
        ("LIST\n../../etc/passwd\n", "leaves the header's folder"),
        ("LIST\n../secret.raw\n", "leaves the header's folder"),
        ("LIST\n/etc/passwd\n", "absolute"),
        ("LIST\n", "names no file"),
        (
            "LIST\ns0.raw\ns1.raw\ns2.raw\ns3.raw\ns9.raw\n",
            "\"s9.raw\", one of 5 files, is not there",
        ),
        ("LIST\ns0.raw\ns1.raw\n", "cut short"),
        (
            "LIST\ns0.raw\ns1.raw\ns2.raw\ns3.raw\ns4.raw\ns0.raw\ns1.raw\n",
            "7 files of one size",
        ),
        ("../s%d.raw 0 4 1\n", "leaves the header's folder"),
        (
            "s%d.raw 0 5 1\n",
            "\"s5.raw\", one of 6 files, is not there",
        ),
        ("s%d.raw 0 4 0\n", "no numbers of files"),
        ("s%d.raw 0 4 -1\n", "no numbers of files"),
        ("s%d.raw 0 4000000000000 1\n", "the limit is"),
        (
            "s%d.raw -9223372036854775808 9223372036854775807 1\n",
            "the limit is",
        ),
        ("s%99999999999d.raw 0 4 1\n", "one number like %d"),
        ("s%s.raw 0 4 1\n", "one number like %d"),
        ("s%d%d.raw 0 4 1\n", "one number like %d"),
        ("s%d.raw 0 four 1\n", "four"),
    ];
    for (names, words) in cases {
        for (name, header) in [("in/a.nhdr", NRRD), ("in/a.mhd", META)] {
            let path = scratch.file(name, format!("{header}{names}").as_bytes());
            assert_refused(&path, &ReadOptions::default(), &[words]);
        }
    }
}

#[test]
fn names_of_raw_files() {
    let scratch = Scratch::new();
    let data = Kind::U16.data(true);
    let path = scratch.file("a_3x4x5_uint16_big.raw", &data);
    assert_holds(&super::open(&path), Kind::U16);
    assert_holds(
        &super::open(&scratch.file("A-3x4x5-U16.BE.raw.gz", &gzip(&data))),
        Kind::U16,
    );
    let strict = ReadOptions {
        strict: true,
        ..ReadOptions::default()
    };
    assert_refused(&path, &strict, &["no spacing", "strict"]);
    let refused = |name: &str, words: &[&str]| {
        assert_refused(&scratch.file(name, &data), &ReadOptions::default(), words);
    };
    refused("a_3x4x5_uint8.raw", &["file name", "60 bytes", "has 120"]);
    refused("a_3x4x6_uint16.raw", &["144 bytes", "has 120"]);
    refused("a_0x4x5_uint16.raw", &["first axis"]);
    refused("a_20000x20000x20000_uint16.raw", &["limits"]);
    refused("a_3x4x5.raw", &["volume.raw"]);
    refused("a_3x4x5_uint16.txt", &["volume.raw"]);
    refused("a_3x4x99999999999_uint16.raw", &["volume.raw"]);
}

#[test]
fn files_that_are_known_but_not_read_say_what_to_do() {
    let scratch = Scratch::new();
    for (bytes, words) in [
        (b"\x89HDF\r\n\x1a\n".as_slice(), ["HDF5", ".npy"]),
        (b"# vtk DataFile Version 3.0\n", ["legacy VTK", ".vti"]),
        (
            b"<?xml version=\"1.0\"?>\n<VTKFile type=\"StructuredGrid\">",
            ["StructuredGrid", "Resample To Image"],
        ),
        (
            b"<VTKFile type=\"UnstructuredGrid\" version=\"1.0\">",
            ["UnstructuredGrid", "ImageData"],
        ),
        (b"NanoVDB0", ["NanoVDB", ".vdb"]),
        (b"BZh9", ["bzip2", "unpack"]),
    ] {
        assert_refused(&scratch.file("x", bytes), &ReadOptions::default(), &words);
    }
}

#[cfg(feature = "formats")]
#[test]
fn volumes_in_archives() {
    let scratch = Scratch::new();
    let header = format!("{NRRD}x.raw\n");
    let data = Kind::U16.data(false);
    let pack = |files: &[(&str, &[u8])]| {
        let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for (name, bytes) in files {
            zip.start_file(*name, zip::write::SimpleFileOptions::default())
                .unwrap();
            std::io::Write::write_all(&mut zip, bytes).unwrap();
        }
        zip.finish().unwrap().into_inner()
    };
    let zipped = pack(&[
        ("a/b.nhdr", header.as_bytes()),
        ("a/x.raw", &data),
        ("c/readme", b"?"),
    ]);
    let path = scratch.file("one.zip", &zipped);
    assert_holds(&super::open(&path), Kind::U16);

    let attached = [header.replace("data file: x.raw\n", "\n").as_bytes(), &data].concat();
    let two = scratch.file(
        "two.zip",
        &pack(&[("b.nrrd", &attached), ("c.nrrd", &attached)]),
    );
    assert_refused(
        &two,
        &ReadOptions::default(),
        &["2 volumes", "b.nrrd", "volume.series"],
    );
    let second = ReadOptions {
        series: Some("c.nrrd".into()),
        ..ReadOptions::default()
    };
    assert_holds(&read(&two, &second).unwrap(), Kind::U16);

    // Names that lead out of the archive are nowhere written to.
    let evil = scratch.file("evil.zip", &pack(&[("../evil.nrrd", &attached)]));
    assert_refused(&evil, &ReadOptions::default(), &["no plain name"]);
    let cut = scratch.file(
        "cut.zip",
        &pack(&[("b.nrrd", &attached[..attached.len() - 1])]),
    );
    assert_refused(
        &cut,
        &ReadOptions::default(),
        &["cut.zip/b.nrrd", "cut short"],
    );
    assert_refused(
        &scratch.file("no.zip", &pack(&[("a.txt", b"?")])),
        &ReadOptions::default(),
        &["volume.raw"],
    );
    let bomb = scratch.file("bomb.nrrd.gz", &gzip(&vec![0; 80 << 20]));
    assert_refused(&bomb, &ReadOptions::default(), &["unpacks to more"]);
}
