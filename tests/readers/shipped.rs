//! The shipped volumes, against numbers from other readers: SimpleITK 2.5 (MetaImage), pynrrd 1.1 (NRRD) and
//! nibabel 5.4 (NIfTI), with NumPy.

use std::path::Path;

use umbravox::volume::{Summary, Volume, VoxelType};

use super::{assert_placed, open};

fn shipped(name: &str) -> Volume {
    open(
        &Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("data")
            .join(name),
    )
}

/// Sum of all voxels, and with the weights 1, 2, … 251, 1, 2, … in file order, which no swap of axes keeps.
fn sums(volume: &Volume) -> (i64, i64) {
    let voxels = volume.voxels();
    (0..voxels.len()).fold((0, 0), |(sum, weighted), i| {
        let value = voxels.get(i) as i64;
        (sum + value, weighted + value * (i as i64 % 251 + 1))
    })
}

fn percentiles(summary: &Summary) -> [f64; 5] {
    let p = summary.percentiles;
    [p.p1, p.p5, p.p50, p.p95, p.p99]
}

#[test]
fn aorta() {
    let volume = shipped("ct_aorta_stent.mha");
    assert_eq!(volume.size(), [120, 126, 164]);
    assert_eq!(volume.voxels().voxel_type(), VoxelType::I16);
    assert_eq!(sums(&volume), (-497_705_824, -62_603_280_679));
    assert_eq!(volume.value(60, 63, 82), 422.0);
    assert_eq!(volume.value(10, 20, 30), 43.0);
    assert_eq!(volume.value(50, 31, 7), 79.0);
    assert_eq!(volume.value(77, 90, 140), -745.0);
    let origin = [-71.658203125, -255.658203125, 540.2000122070312];
    assert_placed(
        &volume,
        [[1.5, 0., 0.], [0., 1.5, 0.], [0., 0., 1.5]],
        origin,
        0.0,
    );
    let summary = Summary::of(&volume);
    assert_eq!(summary.value_range, [-1078.0, 3343.0]);
    assert_eq!(percentiles(&summary), [-994.0, -866.0, -29.0, 499.0, 729.0]);
    assert_eq!(summary.mean, -497_705_824.0 / 2_479_680.0);
    assert_eq!(summary.orientation, "LPS");
}

#[test]
fn tooth() {
    let volume = shipped("ct_tooth.nrrd");
    assert_eq!(volume.size(), [103, 94, 161]);
    assert_eq!(volume.voxels().voxel_type(), VoxelType::U16);
    assert_eq!(sums(&volume), (821_287_590, 103_488_892_783));
    assert_eq!(volume.value(60, 63, 82), 789.0);
    assert_eq!(volume.value(77, 90, 140), 360.0);
    assert_placed(
        &volume,
        [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
        [0.; 3],
        0.0,
    );
    let summary = Summary::of(&volume);
    assert_eq!(summary.value_range, [0.0, 1300.0]);
    assert_eq!(percentiles(&summary), [360.0, 376.0, 405.0, 1123.0, 1218.0]);
    assert_eq!(summary.histogram.counts.iter().sum::<u64>(), 103 * 94 * 161);
}

#[test]
fn fuel() {
    let volume = shipped("sim_fuel_tiny.nii.gz");
    assert_eq!(volume.size(), [64, 33, 32]);
    assert_eq!(volume.voxels().voxel_type(), VoxelType::U8);
    assert_eq!(sums(&volume), (509_815, 64_069_009));
    assert_eq!(volume.value(32, 16, 16), 189.0);
    assert_eq!(volume.value(20, 18, 12), 42.0);
    // nibabel's affine is diag(1,1,1) with offset (-31,-16,-16) in RAS.
    assert_placed(
        &volume,
        [[-1., 0., 0.], [0., -1., 0.], [0., 0., 1.]],
        [31., 16., -16.],
        0.0,
    );
    let summary = Summary::of(&volume);
    assert_eq!(percentiles(&summary), [0.0, 0.0, 0.0, 49.0, 163.0]);
    assert_eq!(summary.orientation, "RAS");
}
