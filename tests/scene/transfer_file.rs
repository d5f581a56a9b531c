//! Transfer functions of other programs. The files in tests/data/transfer are laid out as ParaView and 3D Slicer
//! write them; what they mean is checked against VTK 9.7 (`vtkColorTransferFunction`, `vtkPiecewiseFunction`).

use std::path::{Path, PathBuf};

use umbravox::scene::{
    ColorManagement, ControlPoint, Curve, PRESETS, Scene, TRANSFER_TOLERANCE, TransferFile,
    TransferFormat,
};
use umbravox::volume::{Volume, Voxels};

use crate::error;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/transfer")
        .join(name)
}

const BOTH: [ColorManagement; 2] = [ColorManagement::Linear, ColorManagement::None];

/// Display colour and opacity of a function at a value.
fn at(points: &[ControlPoint], management: ColorManagement, value: f64) -> [f64; 4] {
    let optical = Curve::new(1.0, points, management).evaluate(value);
    let [r, g, b] = management.encode(optical.color);
    [r, g, b, optical.opacity]
}

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    let near = found
        .iter()
        .zip(expected)
        .all(|(a, b)| (a - b).abs() <= tolerance);
    assert!(near, "{what}: {found:?} is not {expected:?}");
}

const PLACES: [f64; 5] = [0.1, 0.25, 0.5, 0.6, 0.9];

/// Colour space, RGB points, and what VTK shows at [`PLACES`].
type Space = (&'static str, [f64; 8], [[f64; 3]; 5]);

#[rustfmt::skip]
const SPACES: [Space; 8] = [
    ("RGB", [0.0, 0.231373, 0.298039, 0.752941, 1.0, 0.705882, 0.0156863, 0.14902], [[0.278824, 0.269804, 0.692549], [0.350000, 0.227451, 0.601961], [0.468627, 0.156863, 0.450981], [0.516078, 0.128627, 0.390588], [0.658431, 0.043922, 0.209412]]),
    ("HSV", [0.0, 0.9, 0.1, 0.1, 1.0, 0.8, 0.1, 0.7], [[0.890000, 0.506346, 0.100125], [0.653646, 0.875000, 0.100260], [0.100347, 0.850000, 0.528720], [0.100333, 0.776600, 0.840000], [0.546332, 0.100125, 0.810000]]),
    ("Wrapped", [0.0, 0.9, 0.1, 0.1, 1.0, 0.8, 0.1, 0.7], [[0.890000, 0.100125, 0.167829], [0.875000, 0.100260, 0.266276], [0.850000, 0.100347, 0.421627], [0.840000, 0.100333, 0.480733], [0.810000, 0.100125, 0.647743]]),
    ("Lab", [0.0, 0.231373, 0.298039, 0.752941, 1.0, 0.705882, 0.0156863, 0.14902], [[0.355755, 0.280486, 0.689156], [0.466813, 0.253075, 0.595160], [0.580663, 0.202498, 0.443043], [0.613357, 0.179330, 0.383717], [0.686925, 0.082291, 0.208762]]),
    ("Lab", [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0], [[0.395836, 0.944651, 0.259144], [0.595562, 0.857627, 0.425821], [0.789780, 0.696401, 0.634726], [0.845588, 0.622699, 0.710422], [0.969689, 0.313741, 0.928515]]),
    ("Diverging", [0.0, 0.231373, 0.298039, 0.752941, 1.0, 0.705882, 0.0156863, 0.14902], [[0.351735, 0.468506, 0.890376], [0.553318, 0.688635, 0.995188], [0.865395, 0.865410, 0.865396], [0.948076, 0.795205, 0.717170], [0.842251, 0.326619, 0.266613]]),
    ("Diverging", [0.0, 0.9, 0.9, 0.9, 1.0, 0.1, 0.2, 0.8], [[0.912446, 0.889104, 0.973657], [0.850812, 0.800236, 1.000000], [0.708740, 0.633129, 1.000000], [0.645640, 0.567292, 1.000000], [0.326182, 0.307715, 0.893495]]),
    ("Step", [0.0, 0.231373, 0.298039, 0.752941, 1.0, 0.705882, 0.0156863, 0.14902], [[0.705882, 0.015686, 0.149020], [0.705882, 0.015686, 0.149020], [0.705882, 0.015686, 0.149020], [0.705882, 0.015686, 0.149020], [0.705882, 0.015686, 0.149020]]),
];

#[test]
fn colors_between_points_are_vtks() {
    for (space, points, expected) in SPACES {
        let text = serde_json::json!([{ "ColorSpace": space, "RGBPoints": points }]).to_string();
        let text = text.replace("\"Wrapped\"", "\"HSV\",\"HSVWrap\":1");
        let file = TransferFile::parse(&text, "a.json").unwrap();
        for management in BOTH {
            let points = file.control_points(management);
            assert!(points.len() < 200, "{space}: {} points", points.len());
            for (place, color) in PLACES.into_iter().zip(expected) {
                let found = at(&points, management, place);
                let what = format!("{space} {management:?} at {place}");
                assert_near(&found[..3], &color, TRANSFER_TOLERANCE + 1e-4, &what);
                assert_near(
                    &found[3..],
                    &[place],
                    TRANSFER_TOLERANCE,
                    "ParaView's default opacity",
                );
            }
        }
    }
}

#[test]
fn midpoint_and_sharpness_are_vtks() {
    let points = |sharpness: f64| {
        let value = serde_json::json!({
            "RGBPoints": [0, 1, 0, 0, 1, 0, 1, 0.5],
            "Points": [0, 0.1, 0.3, sharpness, 1, 0.9, 0.5, 0],
        });
        let file = TransferFile::parse(&value.to_string(), "a.json").unwrap();
        file.control_points(ColorManagement::None)
    };
    let places = [0.1, 0.25, 0.3, 0.5, 0.9];
    for (sharpness, expected) in [
        (0.0, [0.233333, 0.433333, 0.5, 0.614286, 0.842857]),
        (0.4, [0.100992, 0.23002, 0.5, 0.847593, 0.899986]),
    ] {
        let points = points(sharpness);
        for (place, opacity) in places.into_iter().zip(expected) {
            let found = at(&points, ColorManagement::None, place);
            let what = format!("sharpness {sharpness} at {place}");
            assert_near(&found[3..], &[opacity], TRANSFER_TOLERANCE, &what);
        }
    }
}

#[test]
fn paraview_json_means_what_it_says() {
    let file = TransferFile::read(&data("paraview.json")).unwrap();
    assert_eq!(file.unit_distance, None);
    for management in BOTH {
        let points = file.control_points(management);
        assert_near(
            &at(&points, management, -1000.0),
            &[0.23137254902, 0.298039215686, 0.752941176471, 0.0],
            TRANSFER_TOLERANCE,
            "first",
        );
        assert_near(
            &at(&points, management, 0.0),
            &[0.865, 0.865, 0.865, 0.0],
            TRANSFER_TOLERANCE,
            "middle",
        );
        assert_near(
            &at(&points, management, 575.0)[3..],
            &[0.4],
            TRANSFER_TOLERANCE,
            "opacity",
        );
        assert_near(
            &at(&points, management, 5000.0),
            &[0.705882352941, 0.0156862745098, 0.149019607843, 0.8],
            TRANSFER_TOLERANCE,
            "the end holds",
        );
    }
}

#[test]
fn paraview_xml_means_what_it_says() {
    let points = TransferFile::read(&data("paraview.xml")).unwrap();
    let points = points.control_points(ColorManagement::Linear);
    for (value, expected) in [
        (0.25, [0.0, 1.0, 1.0, 0.125]),
        (0.5, [0.0, 1.0, 0.0, 0.25]),
        (0.75, [1.0, 1.0, 0.0, 0.625]),
    ] {
        let found = at(&points, ColorManagement::Linear, value);
        assert_near(&found, &expected, TRANSFER_TOLERANCE, &value.to_string());
    }
}

#[test]
fn slicer_files_mean_what_they_say() {
    let vp = TransferFile::read(&data("slicer.vp")).unwrap();
    let points = vp.control_points(ColorManagement::None);
    let middle = at(&points, ColorManagement::None, 312.4696);
    assert_near(
        &middle,
        &[0.817647, 0.535294, 0.427451, 0.357843],
        TRANSFER_TOLERANCE,
        "middle",
    );
    let json = TransferFile::read(&data("slicer.vp.json")).unwrap();
    assert_eq!(json.unit_distance, Some(1.5));
    let points = json.control_points(ColorManagement::None);
    let found = at(&points, ColorManagement::None, 0.5);
    assert_near(
        &found[3..],
        &[0.847593],
        TRANSFER_TOLERANCE,
        "VTK's sharpness",
    );
}

/// Ours to each form and back: the same function within twice the tolerance, but next to jumps.
#[test]
fn every_form_comes_back() {
    let jump =
        [(0.0, 0.1), (4.0, 0.2), (4.0, 0.9), (10.0, 0.3)].map(|(value, opacity)| ControlPoint {
            value,
            color: [value / 10.0, 1.0 - opacity, 0.3],
            opacity,
            emission: [0.0; 3],
            source: [0.0; 3],
        });
    let mut functions = vec![jump.to_vec()];
    functions.extend(PRESETS.iter().filter_map(|p| p.fixed_points()));
    assert_eq!(functions.len(), 6);
    for points in functions {
        let file = TransferFile::of_points(points.clone(), Some(0.7));
        for (name, format) in TransferFormat::ALL {
            for management in BOTH {
                let text = file.to_text(format, "A & <B>", management);
                let back = TransferFile::parse(&text, name).unwrap();
                let keeps_unit = !matches!(
                    format,
                    TransferFormat::SlicerVp | TransferFormat::ParaviewXml
                );
                assert_eq!(back.unit_distance, keeps_unit.then_some(0.7), "{name}");
                let back = back.control_points(management);
                let (low, high) = (points[0].value, points[points.len() - 1].value);
                for k in -5..=1005 {
                    let value = low + (high - low) * (f64::from(k) + 0.37) / 1000.0;
                    let expected = at(&points, management, value);
                    let found = at(&back, management, value);
                    let what = format!("{name} {management:?} at {value}");
                    assert_near(&found, &expected, 2.0 * TRANSFER_TOLERANCE + 1e-6, &what);
                }
            }
        }
    }
}

#[test]
fn scenes_name_files_beside_them() {
    let text = r#"{ "volume": { "path": "x.nrrd" },
        "transfer_function": { "file": "paraview.json", "range": [10, 20], "unit_distance": 2 } }"#;
    let scene = Scene::from_json(text, &data(""), &[]).unwrap();
    let volume = Volume::axis_aligned(Voxels::U8(vec![0; 8]), [2; 3], [0.5; 3]).unwrap();
    let mut function = scene.transfer_function;
    let curve = function.curve(&volume, ColorManagement::Linear).unwrap();
    assert_eq!(curve.unit_distance, 2.0);
    assert_eq!(curve.points.first().map(|p| p.value), Some(10.0));
    assert_eq!(curve.points.last().map(|p| p.value), Some(20.0));
    function.range = None;
    function.unit_distance = None;
    let curve = function.curve(&volume, ColorManagement::Linear).unwrap();
    assert_eq!(
        curve.unit_distance, 0.5,
        "the smallest spacing, where the file says nothing"
    );
    assert_eq!(curve.points.first().map(|p| p.value), Some(-1000.0));
}

#[test]
fn damage_is_named_with_its_place() {
    let message = |text: &str| error(TransferFile::parse(text, "f"));
    for (text, expected) in [
        ("", "f: is no transfer function"),
        ("{", "f: is not valid JSON"),
        ("[]", "f: an empty list"),
        ("{}", "f: has no \"RGBPoints\""),
        (
            r#"[{"IndexedColors":[1,0,0]}]"#,
            "f: 0: names colours of categories",
        ),
        (
            r#"[{"RGBPoints":[0,1,0]}]"#,
            "f: 0.RGBPoints: has 3 numbers; a point has 4",
        ),
        (r#"[{"RGBPoints":[]}]"#, "f: 0.RGBPoints: has 0 points"),
        (
            r#"[{"RGBPoints":[0,1,0,"x"]}]"#,
            "f: 0.RGBPoints.3: \"x\" is not a finite number",
        ),
        (
            r#"[{"RGBPoints":[0,1,0,2]}]"#,
            "f: 0.RGBPoints.0: 2 is not a number from 0 to 1",
        ),
        (
            r#"[{"RGBPoints":[1,0,0,0,0,1,1,1]}]"#,
            "f: 0.RGBPoints.1: value 0 is below 1",
        ),
        (
            r#"[{"RGBPoints":[0,1,0,1],"ColorSpace":"CIEDE2000"}]"#,
            "f: 0.ColorSpace: \"CIEDE2000\" is not followed; valid are RGB, HSV",
        ),
        (
            r#"[{"RGBPoints":[0,1,0,1],"UseLogScale":1}]"#,
            "f: 0.UseLogScale: logarithmic scales are not followed",
        ),
        (
            r#"[{"RGBPoints":[0,1,0,1],"Points":[0,1,1,0]}]"#,
            "f: 0.Points.0: midpoint 1 is not between 0 and 1",
        ),
        (
            r#"[{"RGBPoints":[0,1,0,1],"ScalarOpacityUnitDistance":0}]"#,
            "f: 0.ScalarOpacityUnitDistance: 0 is not a number > 0",
        ),
        ("<a", "f: is not valid XML"),
        ("<a/>", "f: has no <ColorMap>"),
        (
            "<ColorMap><Point x='0' r='0' g='0'/></ColorMap>",
            "f: ColorMap.Point 0.b: missing",
        ),
        (
            "<ColorMap><Point x='inf' r='0' g='0' b='0'/></ColorMap>",
            "f: ColorMap.Point 0.x: \"inf\" is not a finite number",
        ),
        ("1\n1\n", "f: line 3 (diffuse): missing"),
        (
            "1\n1\n1\n1\n1\n1\n4 0 1\n0\n4 0 1 1 1",
            "f: line 7 (scalar opacity): announces 4 numbers and has 2",
        ),
        (
            r#"{"volumeProperties":[]}"#,
            "f: volumeProperties.0.components.0: missing",
        ),
        (
            r#"{"points":[{"value":0}]}"#,
            "f: points[0]: missing field `color`",
        ),
        (
            r#"{"points":[{"value":0,"color":[0,0,0],"opacity":7}]}"#,
            "f: transfer_function.points.0.opacity: 7 is not valid",
        ),
    ] {
        let found = message(text);
        assert!(
            found.starts_with(expected),
            "{text}\n  {found}\n  {expected}"
        );
    }
}

/// Files of every form, cut off anywhere: an error or a function, never a panic.
#[test]
fn files_cut_off_anywhere_are_refused() {
    for name in [
        "paraview.json",
        "paraview.xml",
        "slicer.vp",
        "slicer.vp.json",
    ] {
        let text = std::fs::read_to_string(data(name)).unwrap();
        for end in (0..text.len()).filter(|&end| text.is_char_boundary(end)) {
            let cut = TransferFile::parse(&text[..end], name);
            // The last number of a .vp may lose digits, and white space may be missing at the end.
            let may_be_whole = name == "slicer.vp" || text[end..].trim().is_empty();
            assert!(may_be_whole || cut.is_err(), "{name} cut at {end}");
        }
    }
}
