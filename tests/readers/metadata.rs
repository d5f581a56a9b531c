//! What files say of their content.

use umbravox::io::read_labels;
use umbravox::volume::Content;

use super::{Kind, ReadOptions, Scratch, open};

/// 3D Slicer's segments tell a label map, and what its labels are called.
#[test]
fn segments_of_nrrd_have_names() {
    let scratch = Scratch::new();
    let file = |pairs: &str| {
        let header = format!(
            "NRRD0004\ntype: uchar\ndimension: 3\nspace: left-posterior-superior\nsizes: 3 4 5\nencoding: raw\n\
             space directions: (1,0,0) (0,1,0) (0,0,1)\n{pairs}\n"
        );
        let mut file = header.into_bytes();
        file.extend((0..60).map(|i| i / 20));
        file
    };
    let pairs = "Segment0_ID:=Segment_1\nSegment0_LabelValue:=1\nSegment0_Name:=left lung: upper\n\
                 Segment1_LabelValue:=2\nSegment1_Color:=1 0 0\nSegment2_Name:=of no value\n\
                 Segment3_LabelValue:=none\nSegment3_Name:=none\n";
    let path = scratch.file("a.seg.nrrd", &file(pairs));
    let volume = open(&path);
    let (content, key) = volume.metadata().content.clone().unwrap();
    assert_eq!(content, Content::Labels);
    assert_eq!(key, "NRRD key Segment0_LabelValue");
    assert!(volume.metadata().patient_axes);
    let map = read_labels(&path, &ReadOptions::default()).unwrap();
    assert_eq!(map.labels(), [0, 1, 2]);
    let names = [0, 1, 2, 3].map(|label| map.name(label));
    assert_eq!(names, [None, Some("left lung: upper"), None, None]);

    let other = "owner:=Segment0_LabelValue\nSegments_are:=3\n";
    let volume = open(&scratch.file("b.nrrd", &file(other)));
    assert_eq!(volume.metadata().content, None);
    assert!(volume.metadata().label_names.is_empty());
}

#[test]
fn meta_image_tells_modality_and_patient() {
    let scratch = Scratch::new();
    let file = |more: &str| {
        let header = format!(
            "ObjectType = Image\nNDims = 3\nDimSize = 3 4 5\n{more}ElementType = MET_SHORT\n\
             ElementByteOrderMSB = False\nElementDataFile = LOCAL\n"
        );
        let mut file = header.into_bytes();
        file.extend(Kind::I16.data(false));
        file
    };
    let said = |name: &str, more: &str| {
        let metadata = open(&scratch.file(name, &file(more))).metadata().clone();
        (metadata.content, metadata.patient_axes)
    };
    for (word, content) in [("MET_MOD_CT", Content::Ct), ("MET_MOD_MR", Content::Mr)] {
        let more = format!("Modality = {word}\nAnatomicalOrientation = RAI\n");
        let key = format!("MetaImage Modality {word}");
        assert_eq!(said("a.mha", &more), (Some((content, key)), true));
    }
    assert_eq!(said("b.mha", "Modality = MET_MOD_OTHER\n"), (None, false));
    assert_eq!(said("c.mha", ""), (None, false));
}

#[test]
#[cfg(feature = "formats")]
fn ome_xml_is_of_microscopy() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats");
    let content = |name: &str| open(&folder.join(name)).metadata().content.clone();
    let wanted = Some((Content::Microscopy, "OME-XML".to_owned()));
    assert_eq!(content("ome.ome.tif"), wanted);
    assert_eq!(content("imagej.tif"), None);
}

/// The class that OpenVDB gives a grid.
#[test]
#[cfg(feature = "formats")]
fn level_sets_say_so() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let content = |name: &str| open(&folder.join(name)).metadata().content.clone();
    let wanted = Some((Content::LevelSet, "OpenVDB class level set".to_owned()));
    assert_eq!(content("formats/sphere.vdb"), wanted);
    assert_eq!(content("geometry/vdb/xp_yp_zp.vdb"), None);
}
