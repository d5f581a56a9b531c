//! `umbravox bench`.

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Command, Stdio};

use serde_json::Value;

use super::assert_stats;
use super::workplace::Workplace;

#[test]
fn bench_prints_json() {
    let place = Workplace::new();
    let args = [
        "bench",
        "scene.json",
        "--frames",
        "3",
        "--warmup",
        "1",
        "--orbit",
        "-10",
        "--json",
    ];
    let report: Value = serde_json::from_str(&place.succeed(&args)).unwrap();
    let spread = |of: &str| {
        ["min", "median", "max"].map(|key| {
            report[of][key]
                .as_f64()
                .unwrap_or_else(|| panic!("{report}"))
        })
    };
    let [min, median, max] = spread("frame_ms");
    assert!(0.0 < min && min <= median && median <= max, "{report}");
    if cfg!(unix) {
        let [min, median, max] = spread("cpu_ms");
        assert!(0.0 < min && min <= median && median <= max, "{report}");
    }
    assert_stats(&report["stats"]);
    assert!(report["stats"]["memory"]["uploaded_bytes"].as_u64() > Some(0));
    assert!(
        place
            .succeed(&["bench", "scene.json", "--frames", "1"])
            .contains("frame_ms.median")
    );
}

#[test]
fn paced_frames_wait_for_their_line() {
    let place = Workplace::new();
    let mut program = Command::new(env!("CARGO_BIN_EXE_umbravox"))
        .args(["bench", "scene.json", "--paced", "--json"])
        .current_dir(place.folder.path())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut input = program.stdin.take().unwrap();
    let mut output = BufReader::new(program.stdout.take().unwrap());
    for _ in 0..2 {
        // The answer comes before the next line is sent, or this hangs.
        input.write_all(b"\n").unwrap();
        let mut line = String::new();
        output.read_line(&mut line).unwrap();
        let time: Value = serde_json::from_str(&line).unwrap();
        assert!(time["wall_ms"].as_f64() > Some(0.0), "{line}");
    }
    drop(input);
    let report: Value = serde_json::from_reader(output).unwrap();
    assert_stats(&report["stats"]);
    assert!(program.wait().unwrap().success());
}

#[test]
fn paced_needs_a_line() {
    let place = Workplace::new();
    let message = place.refuse(&["bench", "scene.json", "--paced"]);
    assert!(message.contains("--paced"), "{message}");
}
