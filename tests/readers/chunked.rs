//! Zarr stores beyond those of `independent`: levels, and stores that lie.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use umbravox::io::{Limits, ReadOptions, read};

use super::{Scratch, assert_refused, gzip};

fn formats() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats")
}

#[test]
fn the_finest_level_within_the_limits_is_read() {
    for name in ["ome04.zarr.zip", "ome05.zarr.zip"] {
        let path = formats().join(name);
        let of = |max_voxels, level| {
            let limits = Limits {
                max_voxels,
                ..Limits::default()
            };
            read(
                &path,
                &ReadOptions {
                    limits,
                    level,
                    ..ReadOptions::default()
                },
            )
            .map(|v| v.size())
        };
        assert_eq!(of(210, None).unwrap(), [7, 6, 5]);
        assert_eq!(of(209, None).unwrap(), [4, 3, 3]);
        assert!(of(209, Some(0)).unwrap_err().to_string().contains("limits"));
        assert!(of(35, None).unwrap_err().to_string().contains("limits"));
        let message = of(210, Some(2)).unwrap_err().to_string();
        assert!(message.contains("volume.level 2 of 2 levels"), "{message}");
    }
}

/// A folder is read as the archive of it is; without units a strict reader refuses.
#[test]
fn folders_and_strict() {
    let scratch = Scratch::new();
    let file = std::fs::File::open(formats().join("five.zarr.zip")).unwrap();
    let folder = scratch.0.path().join("five.zarr");
    zip::ZipArchive::new(file)
        .unwrap()
        .extract(&folder)
        .unwrap();
    let strict = ReadOptions {
        strict: true,
        ..ReadOptions::default()
    };
    let [a, b] =
        [folder, formats().join("five.zarr.zip")].map(|path| read(&path, &strict).unwrap());
    assert_eq!(a.voxels(), b.voxels());
    assert_eq!(a.world_from_ix(), b.world_from_ix());
    assert_refused(
        &formats().join("zstd3.zarr.zip"),
        &strict,
        &["no units", "strict"],
    );
    let beyond = ReadOptions {
        channel: Some(3),
        ..ReadOptions::default()
    };
    assert_refused(
        &formats().join("five.zarr.zip"),
        &beyond,
        &["volume.channel 3 of 3"],
    );
}

const ARRAY: &str = r#"{"zarr_format": 2, "shape": [4, 4, 4], "chunks": [4, 4, 4], "dtype": "|u1", "compressor": null,
    "fill_value": 0, "order": "C", "filters": null}"#;

fn store(scratch: &Scratch, name: &str, array: &str, chunk: &[u8]) -> PathBuf {
    scratch.file(&format!("{name}/.zarray"), array.as_bytes());
    let chunk = scratch.file(&format!("{name}/0.0.0"), chunk);
    chunk.parent().unwrap().to_owned()
}

#[test]
fn stores_that_lie_are_refused_at_once() {
    let scratch = Scratch::new();
    assert_eq!(
        super::open(&store(&scratch, "good", ARRAY, &[7; 64])).value(1, 2, 3),
        7.0
    );
    let bomb = gzip(&vec![0; 50 << 20]);
    let gzip_array = ARRAY.replace("null,\n", r#"{"id": "gzip"},"#);
    let blosc_array = ARRAY.replace("null,\n", r#"{"id": "blosc"},"#);
    let mut blosc = vec![2, 1, 0x22, 1];
    for number in [u32::MAX, 64, 64] {
        blosc.extend(number.to_le_bytes());
    }
    let terabytes = ARRAY.replace("\"shape\": [4, 4, 4]", "\"shape\": [20000, 20000, 20000]");
    let huge_chunks = ARRAY.replace(
        "\"chunks\": [4, 4, 4]",
        "\"chunks\": [4000000000, 4000000000, 4000000000]",
    );
    let no_chunks = ARRAY.replace("\"chunks\": [4, 4, 4]", "\"chunks\": [4, 0, 4]");
    let other_chunks = ARRAY.replace("\"chunks\": [4, 4, 4]", "\"chunks\": [4, 4]");
    let many = ARRAY.replace(
        "[4, 4, 4], \"chunks\": [4, 4, 4]",
        "[400, 400, 400], \"chunks\": [1, 1, 1]",
    );
    let negative = ARRAY.replace("\"shape\": [4, 4, 4]", "\"shape\": [4, -4, 4]");
    let filtered = ARRAY.replace("\"filters\": null", "\"filters\": [{\"id\": \"delta\"}]");
    let cases: &[(&str, &str, &[u8], &[&str])] = &[
        ("short", ARRAY, &[7; 63], &["63 bytes where 64 are needed"]),
        ("long", ARRAY, &[7; 65], &["65 bytes where 64 are needed"]),
        ("bomb", &gzip_array, &bomb, &["more than 64 bytes"]),
        (
            "blosc",
            &blosc_array,
            &blosc,
            &["claims 4294967295 bytes where 64"],
        ),
        (
            "terabytes",
            &terabytes,
            &[],
            &["8000000000000 voxels", "limits"],
        ),
        ("huge", &huge_chunks, &[], &["chunks", "at most"]),
        ("none", &no_chunks, &[], &["chunks", "above 0"]),
        ("other", &other_chunks, &[], &["chunks"]),
        ("many", &many, &[], &["64000000 chunks"]),
        ("negative", &negative, &[], &["-4"]),
        ("filtered", &filtered, &[], &["filters", "delta"]),
        (
            "type",
            &ARRAY.replace("|u1", "<c8"),
            &[],
            &["dtype", "c8", "u1"],
        ),
        ("text", "{\"zarr_format\": 2", &[], &["EOF"]),
    ];
    for (name, array, chunk, words) in cases {
        let path = store(&scratch, name, array, chunk);
        let start = Instant::now();
        assert_refused(&path, &ReadOptions::default(), words);
        assert!(
            start.elapsed() < Duration::from_millis(500),
            "{name}: {:?}",
            start.elapsed()
        );
    }
}

/// Paths of levels are keys of the store, and never lead out of it.
#[test]
fn levels_stay_in_the_store() {
    let scratch = Scratch::new();
    let outside = store(&scratch, "outside", ARRAY, &[7; 64]);
    let axes = r#"[{"name": "z", "type": "space"}, {"name": "y", "type": "space"}, {"name": "x", "type": "space"}]"#;
    for path in [
        "../outside",
        "/etc/passwd",
        &outside.to_string_lossy(),
        "absent",
    ] {
        let image = format!(
            r#"{{"multiscales": [{{"axes": {axes}, "datasets": [{{"path": "{path}"}}]}}]}}"#
        );
        let file = scratch.file("in/.zattrs", image.as_bytes());
        assert_refused(
            file.parent().unwrap(),
            &ReadOptions::default(),
            &["there is no array"],
        );
    }
    for (image, words) in [
        (r#"{"multiscales": []}"#, "multiscales is empty"),
        (r#"{"multiscales": [{}]}"#, "datasets"),
        (r#"{"plate": {}}"#, "plate"),
        ("{}", "there is no array"),
    ] {
        let file = scratch.file("in/.zattrs", image.as_bytes());
        assert_refused(file.parent().unwrap(), &ReadOptions::default(), &[words]);
    }
}

/// A shard whose index points anywhere.
#[test]
fn shards_that_lie_are_refused() {
    let scratch = Scratch::new();
    let header = r#"{"zarr_format": 3, "node_type": "array", "shape": [4, 4, 4], "data_type": "uint8", "fill_value": 5,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [4, 4, 4]}},
        "chunk_key_encoding": {"name": "default"},
        "codecs": [{"name": "sharding_indexed", "configuration": {"chunk_shape": [4, 4, 2], "codecs": [{"name": "bytes"}],
            "index_codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]}}]}"#;
    let shard = |header: &str, index: [u64; 4]| {
        let folder = scratch.file("shard/zarr.json", header.as_bytes());
        let mut bytes = vec![9; 32];
        for number in index {
            bytes.write_all(&number.to_le_bytes()).unwrap();
        }
        scratch.file("shard/c/0/0/0", &bytes);
        folder.parent().unwrap().to_owned()
    };
    let absent = u64::MAX;
    let volume = super::open(&shard(header, [0, 32, absent, absent]));
    assert_eq!([volume.value(0, 0, 0), volume.value(3, 0, 0)], [9.0, 5.0]);
    for (index, words) in [
        ([0, 32, u64::MAX - 1, 32], "ends after it"),
        ([60, 32, absent, absent], "ends after it"),
        ([0, 31, absent, absent], "31 bytes where 32"),
    ] {
        assert_refused(&shard(header, index), &ReadOptions::default(), &[words]);
    }
    for chunk in ["[4, 4, 3]", "[4, 4, 0]", "[4, 2]", "[1, 1, 1]"] {
        let header = header.replace("[4, 4, 2]", chunk);
        assert_refused(
            &shard(&header, [0; 4]),
            &ReadOptions::default(),
            &["this shard"],
        );
    }
}
