//! Voxels, scales and places that are not numbers.

use super::seeds::{META, NRRD};
use super::{Scratch, judge, limited, refuse};

const FLOATS: [f32; 6] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MAX,
    f32::MIN_POSITIVE,
    -0.0,
];

/// A float file of each format that is built from text, of 60 voxels.
fn float_files(voxels: &[f32]) -> Vec<(&'static str, Vec<u8>)> {
    let little: Vec<u8> = voxels.iter().flat_map(|v| v.to_le_bytes()).collect();
    let big: Vec<u8> = voxels.iter().flat_map(|v| v.to_be_bytes()).collect();
    let nrrd = NRRD.replace("ushort", "float") + "raw\n\n";
    let meta = META.replace("USHORT", "FLOAT") + "ElementDataFile = LOCAL\n";
    let shape = "{'descr': '<f4', 'fortran_order': False, 'shape': (5, 4, 3), }";
    let npy = [
        b"\x93NUMPY\x01\0v\0".as_slice(),
        format!("{shape:117}\n").as_bytes(),
    ]
    .concat();
    let text: Vec<String> = voxels.iter().map(|v| v.to_string()).collect();
    let vti = format!(
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\
         <ImageData WholeExtent=\"0 2 0 3 0 4\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\
         <Piece Extent=\"0 2 0 3 0 4\"><PointData Scalars=\"a\">\
         <DataArray type=\"Float32\" Name=\"a\" format=\"ascii\">{}</DataArray>\
         </PointData></Piece></ImageData></VTKFile>",
        text.join(" ")
    );
    vec![
        ("a.nrrd", [nrrd.as_bytes(), &big].concat()),
        ("a.mha", [meta.as_bytes(), &big].concat()),
        ("a.npy", [npy.as_slice(), &little].concat()),
        ("a.vti", vti.into_bytes()),
    ]
}

/// They become the smallest number there is, and are counted.
#[test]
fn some_voxels_are_not_numbers() {
    let scratch = Scratch::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut voxels: Vec<f32> = (0..60).map(|i| i as f32 - 7.5).collect();
        voxels[11] = bad;
        voxels[59] = bad;
        for (name, bytes) in float_files(&voxels) {
            let path = scratch.file(name, &bytes);
            let volume = judge(&path, &limited(), "not a number");
            let volume = volume.unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(volume.non_finite(), 2, "{name}");
            assert_eq!(volume.value_range(), [-7.5, 50.5], "{name}");
            assert_eq!(volume.voxels().get(11), -7.5, "{name}");
        }
    }
}

#[test]
fn no_voxel_is_a_number() {
    let scratch = Scratch::new();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for (name, bytes) in float_files(&[bad; 60]) {
            refuse(&scratch.file(name, &bytes), &limited(), &["finite"]);
        }
    }
}

/// The largest numbers that there are: read, and their range is finite.
#[test]
fn extreme_voxels() {
    let scratch = Scratch::new();
    let mut voxels = [0.0; 60];
    voxels[..6].copy_from_slice(&FLOATS);
    voxels[6] = f32::MIN;
    for (name, bytes) in float_files(&voxels) {
        let path = scratch.file(name, &bytes);
        let volume = judge(&path, &limited(), "extreme");
        let volume = volume.unwrap_or_else(|e| panic!("{e}"));
        let [least, most] = volume.value_range();
        assert!(
            least.is_finite() && most.is_finite() && least < most,
            "{name}"
        );
    }
}

#[test]
fn places_and_scales_that_are_not_numbers() {
    let scratch = Scratch::new();
    for bad in ["nan", "inf", "-inf", "1e999"] {
        for text in [
            NRRD.replace("(0,2,0)", &format!("(0,{bad},0)")),
            NRRD.replace("(1,2,3)", &format!("(1,{bad},3)")),
        ] {
            let bytes = [text.as_bytes(), b"raw\n\n", &[1; 120]].concat();
            refuse(&scratch.file("a.nrrd", &bytes), &limited(), &["a.nrrd"]);
        }
        for (from, to) in [
            ("ElementSpacing = 1", format!("ElementSpacing = {bad}")),
            ("Offset = 4", format!("Offset = {bad}")),
            ("TransformMatrix = 1", format!("TransformMatrix = {bad}")),
            (
                "Offset = 4",
                format!("ElementToIntensityFunctionSlope = {bad}\nOffset = 4"),
            ),
            (
                "Offset = 4",
                format!("ElementToIntensityFunctionOffset = {bad}\nOffset = 4"),
            ),
        ] {
            let text = META.replace(from, &to) + "ElementDataFile = LOCAL\n";
            let bytes = [text.as_bytes(), &[1; 120]].concat();
            refuse(&scratch.file("a.mha", &bytes), &limited(), &["a.mha"]);
        }
    }
}
