//! Headers that name other files, and folders: outside, missing, themselves, in circles.

use std::os::unix::fs::symlink;

use super::seeds::{META, NRRD};
use super::{Scratch, judge, limited, refuse};

/// A header of each format that names `data`.
fn headers(data: &str) -> [(&'static str, String); 2] {
    [
        ("a.nhdr", format!("{NRRD}raw\ndata file: {data}\n\n")),
        ("a.mhd", format!("{META}ElementDataFile = {data}\n")),
    ]
}

#[test]
fn names_that_lead_out_of_the_folder() {
    let scratch = Scratch::new();
    // Of the right length, so that only the name can be wrong.
    let secret = scratch.file("secret.raw", &[7; 120]);
    let absolute = secret.to_str().unwrap();
    for name in [
        absolute,
        "../secret.raw",
        "./../secret.raw",
        "b/../../secret.raw",
        "b/../../inside/../secret.raw",
    ] {
        scratch.file("inside/b/c.raw", &[7; 120]);
        for (header, text) in headers(name) {
            let path = scratch.file(&format!("inside/{header}"), text.as_bytes());
            refuse(&path, &limited(), &["inside"]);
        }
    }
}

#[test]
fn files_that_are_not_there_or_not_files() {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.0.path().join("folder")).unwrap();
    for name in [
        "missing.raw",
        "folder",
        ".",
        "..",
        "folder/",
        "x\0y",
        "/dev/zero",
    ] {
        for (header, text) in headers(name) {
            let path = scratch.file(header, text.as_bytes());
            refuse(&path, &limited(), &[]);
        }
    }
}

/// Its own bytes are no voxels: the length does not fit.
#[test]
fn headers_that_name_themselves() {
    let scratch = Scratch::new();
    for (header, text) in headers("a.nhdr").into_iter().chain(headers("a.mhd")) {
        let path = scratch.file(header, text.as_bytes());
        let _ = judge(&path, &limited(), "names itself or its twin");
    }
}

#[test]
fn links_in_circles() {
    let scratch = Scratch::new();
    let root = scratch.0.path();
    symlink("loop", root.join("loop")).unwrap();
    symlink("b.raw", root.join("a.raw")).unwrap();
    symlink("a.raw", root.join("b.raw")).unwrap();
    for name in ["loop", "a.raw"] {
        for (header, text) in headers(name) {
            let path = scratch.file(header, text.as_bytes());
            refuse(&path, &limited(), &[]);
        }
        refuse(&root.join(name), &limited(), &[]);
    }
    // A folder that holds itself, again and again.
    let folder = root.join("deep");
    std::fs::create_dir(&folder).unwrap();
    symlink("..", folder.join("up")).unwrap();
    symlink(".", folder.join("here")).unwrap();
    refuse(&folder, &limited(), &[]);
}

/// Deeper than any folder of slices is; and one of more files than are accepted.
#[test]
fn folders_without_end() {
    let scratch = Scratch::new();
    let deep = scratch.0.path().join("d/".repeat(200));
    std::fs::create_dir_all(deep).unwrap();
    refuse(&scratch.0.path().join("d"), &limited(), &[]);
    for i in 0..=super::limits().max_files {
        scratch.file(&format!("many/{i}.dcm"), b"");
    }
    refuse(
        &scratch.0.path().join("many"),
        &limited(),
        &["more than 100 files"],
    );
}

/// Opening a pipe would wait for its writer, and a device has no end.
#[test]
fn pipes_and_devices() {
    let scratch = Scratch::new();
    let pipe = scratch.0.path().join("pipe");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    assert!(made.unwrap().success());
    refuse(&pipe, &limited(), &["not a regular file"]);
    for (header, text) in headers("pipe") {
        let path = scratch.file(header, text.as_bytes());
        refuse(&path, &limited(), &["not a regular file"]);
    }
    refuse(scratch.0.path(), &limited(), &[]);
    refuse(
        std::path::Path::new("/dev/zero"),
        &limited(),
        &["not a regular file"],
    );
}
