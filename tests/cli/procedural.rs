//! Volumes without a file, from the scene to the picture.

use serde_json::{Value, json};

use crate::workplace::Workplace;

#[test]
fn a_computed_cloud_is_described_drawn_and_drawn_again() {
    let place = Workplace::new();
    let scene = json!({
        "volume": { "procedural": { "type": "cloud", "size": [24, 24, 18] } },
        "image": { "size": [24, 16] },
        "transfer_function": { "points": [
            { "value": 0, "color": [1, 1, 1], "opacity": 0 },
            { "value": 1, "color": [1, 1, 1], "opacity": 0.5 },
        ] },
    });
    std::fs::write(place.path("cloud.json"), scene.to_string()).unwrap();

    let info: Value =
        serde_json::from_str(&place.succeed(&["info", "cloud.json", "--json"])).unwrap();
    assert_eq!(info["size"], json!([24, 24, 18]));

    place.succeed(&["render", "cloud.json", "-o", "cloud.png"]);
    place.succeed(&["render", "--reproduce", "cloud.png", "-o", "again.png"]);
    let [first, again] =
        ["cloud.png", "again.png"].map(|name| std::fs::read(place.path(name)).unwrap());
    assert_eq!(first, again);
    let source = umbravox::output::read_provenance(&place.path("cloud.png")).unwrap();
    assert!(source.contains(&("Source".to_owned(), "procedural cloud".to_owned())));

    let message = place.refuse(&[
        "info",
        "cloud.json",
        "--set",
        "volume.procedural.octaves=99",
    ]);
    assert!(
        message.contains("volume.procedural.octaves: 99"),
        "{message}"
    );
}
