//! Voxels that are colours: read whole, they hold what their channels hold when read one by one.

use std::io::Write as _;
use std::path::Path;

use umbravox::io::{ReadOptions, read};
use umbravox::scene::VolumeColor;
use umbravox::volume::{Volume, VoxelType};

use super::{COUNT, SIZE, Scratch, assert_refused, open, stored};

/// A colour for each of [`COUNT`] voxels, in all of which the channels differ.
fn colors() -> Vec<[u8; 4]> {
    let color = |i: usize| [3 * i, 255 - 4 * i, 40 + i * i % 200, 7 * i % 256].map(|c| c as u8);
    (0..COUNT).map(color).collect()
}

fn rgb() -> Vec<u8> {
    colors()
        .iter()
        .flat_map(|&[r, g, b, _]| [r, g, b])
        .collect()
}

fn luminance([r, g, b, _]: [u8; 4]) -> f64 {
    let [r, g, b] = [r, g, b].map(f32::from);
    f64::from((0.2126 * r + 0.7152 * g + 0.0722 * b).round())
}

fn channel(path: &Path, channel: u32) -> Vec<f64> {
    let options = ReadOptions {
        channel: Some(channel),
        ..ReadOptions::default()
    };
    let volume = read(path, &options).unwrap();
    assert!(volume.colors().is_none(), "one channel is no colour");
    stored(&volume)
}

/// Colours without alpha, whose luminance is the value.
#[track_caller]
fn assert_opaque(volume: &Volume, wanted: &[[u8; 4]]) {
    let opaque: Vec<[u8; 4]> = wanted.iter().map(|&[r, g, b, _]| [r, g, b, 255]).collect();
    assert_eq!(volume.colors(), Some(&opaque[..]));
    assert_eq!(volume.voxels().voxel_type(), VoxelType::U8);
    let luma: Vec<f64> = wanted.iter().map(|&color| luminance(color)).collect();
    assert_eq!(stored(volume), luma);
}

/// Files of the formats' own libraries.
#[test]
#[cfg(feature = "formats")]
fn colors_are_their_channels() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats");
    let files = [
        "rgb.mha",
        "rgb.nii.gz",
        "rgb.nrrd",
        "rgb_dicom.zip",
        "planes_dicom.zip",
        "rgb_png.zip",
    ];
    for name in files {
        let path = folder.join(name);
        let channels = [0, 1, 2].map(|c| channel(&path, c));
        let wanted: Vec<[u8; 4]> = (0..channels[0].len())
            .map(|at| {
                let [r, g, b] = [0, 1, 2].map(|c: usize| channels[c][at] as u8);
                [r, g, b, 255]
            })
            .collect();
        assert_opaque(&open(&path), &wanted);
        let plain = ReadOptions {
            color: Some(VolumeColor::TransferFunction),
            ..ReadOptions::default()
        };
        let plain = read(&path, &plain).unwrap();
        assert!(plain.colors().is_none(), "{name}");
        assert_eq!(stored(&plain), stored(&open(&path)), "{name}");
    }
}

/// `YBR_FULL` becomes red, green and blue (PS3.3, C.7.6.3.1.2).
#[test]
#[cfg(feature = "formats")]
fn brightness_and_two_differences() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats/ybr_dicom.zip");
    let channels = [0, 1, 2].map(|c| channel(&path, c));
    let volume = open(&path);
    for (at, &[r, g, b, _]) in volume.colors().unwrap().iter().enumerate() {
        let [y, cb, cr] = [0, 1, 2].map(|c: usize| channels[c][at]);
        let (cb, cr) = (cb - 128.0, cr - 128.0);
        let wanted = [
            y + 1.402 * cr,
            y - 0.344136 * cb - 0.714136 * cr,
            y + 1.772 * cb,
        ];
        for (have, wanted) in [r, g, b].into_iter().zip(wanted) {
            let difference = f64::from(have) - wanted.clamp(0.0, 255.0);
            assert!(difference.abs() < 0.501, "{have} is not {wanted}");
        }
    }
}

#[test]
fn alpha_is_the_value_where_it_tells_voxels_apart() {
    let scratch = Scratch::new();
    let [x, y, z] = SIZE;
    let header = format!(
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 4 {x} {y} {z}\nkinds: RGBA-color domain domain domain\n\
         encoding: raw\n\n"
    );
    let mut file = header.clone().into_bytes();
    file.extend(colors().as_flattened());
    let volume = open(&scratch.file("alpha.nrrd", &file));
    // The first is transparent; what it has instead of its colour is the matter of another test.
    assert_eq!(volume.colors().map(|c| &c[1..]), Some(&colors()[1..]));
    let alpha: Vec<f64> = colors().iter().map(|&[.., alpha]| alpha.into()).collect();
    assert_eq!(stored(&volume), alpha);

    let constant: Vec<[u8; 4]> = colors().iter().map(|&[r, g, b, _]| [r, g, b, 9]).collect();
    let mut file = header.into_bytes();
    file.extend(constant.as_flattened());
    let volume = open(&scratch.file("constant.nrrd", &file));
    let luma: Vec<f64> = colors().iter().map(|&color| luminance(color)).collect();
    assert_eq!(stored(&volume), luma);
}

#[test]
fn transparent_voxels_take_the_colors_beside_them() {
    let scratch = Scratch::new();
    let [near, far] = [[200, 0, 40, 255], [0, 100, 40, 85]];
    // A row of two colours, and nothing around it for further than colours spread.
    let size = [3, 1, 40];
    let mut voxels = [[9, 9, 9, 0]; 3 * 2 * 40];
    voxels[0] = near;
    voxels[2] = far;
    let [x, _, z] = size;
    let header = format!(
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 4 {x} 2 {z}\nkinds: RGBA-color domain domain domain\n\
         encoding: raw\n\n"
    );
    let file = [header.as_bytes(), voxels.as_flattened()].concat();
    let volume = open(&scratch.file("row.nrrd", &file));
    let colors = volume.colors().unwrap();
    assert_eq!([colors[0], colors[2]], [near, far], "what is seen stays");
    // Weights 255 and 85: three to one.
    assert_eq!(colors[1], [150, 25, 40, 0]);
    // Beside the first voxel alone; then, along z, ring after ring.
    assert_eq!(colors[3], [200, 0, 40, 0]);
    let plane = 3 * 2;
    assert_eq!(colors[16 * plane][2], 40, "the last that is reached");
    assert_eq!(colors[17 * plane], [9, 9, 9, 0], "out of reach");
    let alpha: Vec<f64> = voxels.iter().map(|&[.., alpha]| alpha.into()).collect();
    assert_eq!(stored(&volume), alpha);
}

#[test]
fn arrays_whose_last_index_counts_three() {
    let scratch = Scratch::new();
    let [x, y, z] = SIZE;
    let array = |times: &str, data: &[u8]| {
        let header = format!(
            "{{'descr': '|u1', 'fortran_order': False, 'shape': ({times}{z}, {y}, {x}, 3), }}\n"
        );
        let mut file = b"\x93NUMPY\x01\x00".to_vec();
        file.extend((header.len() as u16).to_le_bytes());
        file.extend(header.as_bytes());
        file.extend(data);
        file
    };
    assert_opaque(
        &open(&scratch.file("rgb.npy", &array("", &rgb()))),
        &colors(),
    );

    let mut two = vec![17; rgb().len()];
    two.extend(rgb());
    let later = ReadOptions {
        timestep: Some(1),
        ..ReadOptions::default()
    };
    let path = scratch.file("times.npy", &array("2, ", &two));
    assert_opaque(&read(&path, &later).unwrap(), &colors());
}

#[test]
fn bytes_of_three_in_vtk_are_colors() {
    let scratch = Scratch::new();
    let [x, y, z] = SIZE.map(|n| n - 1);
    let numbers: Vec<String> = rgb().iter().map(u8::to_string).collect();
    let file = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
         <ImageData WholeExtent=\"0 {x} 0 {y} 0 {z}\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n\
         <Piece Extent=\"0 {x} 0 {y} 0 {z}\"><PointData Scalars=\"c\">\n\
         <DataArray type=\"UInt8\" Name=\"c\" NumberOfComponents=\"3\" format=\"ascii\">{}</DataArray>\n\
         </PointData></Piece></ImageData></VTKFile>\n",
        numbers.join(" ")
    );
    assert_opaque(&open(&scratch.file("rgb.vti", file.as_bytes())), &colors());
}

#[test]
#[cfg(feature = "formats")]
fn pages_of_colors() {
    let scratch = Scratch::new();
    let [x, y, z] = SIZE;
    let mut file = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut file).unwrap();
    for page in rgb().chunks((3 * x * y) as usize) {
        encoder
            .write_image::<tiff::encoder::colortype::RGB8>(x, y, page)
            .unwrap();
    }
    file.flush().unwrap();
    let volume = open(&scratch.file("rgb.tif", file.get_ref()));
    assert_eq!(volume.size(), [x, y, z]);
    assert_opaque(&volume, &colors());
}

/// 16 bits are read as luminance, as before.
#[test]
fn wider_colors_are_luminance() {
    let scratch = Scratch::new();
    let [x, y, z] = SIZE;
    let mut file = format!(
        "NRRD0004\ntype: ushort\ndimension: 4\nsizes: 3 {x} {y} {z}\nkinds: RGB-color domain domain domain\n\
         endian: little\nencoding: raw\n\n"
    )
    .into_bytes();
    file.extend(rgb().iter().flat_map(|&c| u16::from(c).to_le_bytes()));
    let path = scratch.file("wide.nrrd", &file);
    let volume = open(&path);
    assert!(volume.colors().is_none());
    assert_eq!(volume.voxels().voxel_type(), VoxelType::U16);
    let luma: Vec<f64> = colors().iter().map(|&color| luminance(color)).collect();
    assert_eq!(stored(&volume), luma);
    let fourth = ReadOptions {
        channel: Some(3),
        ..ReadOptions::default()
    };
    assert_refused(&path, &fourth, &["volume.channel 3", "3 channels"]);
}
