//! Plots as inline SVG.

use std::fmt::Write as _;

const WIDTH: f64 = 860.0;
const LEFT: f64 = 330.0;
const BAR: f64 = 14.0;
const COLORS: [&str; 3] = ["#2f6f9f", "#c9782b", "#7a9f4a"];

/// Horizontal bars in groups: a label and one value for each series. `unit` stands behind each value.
pub(crate) fn bars(series: &[&str], groups: &[(String, Vec<f64>)], unit: &str) -> String {
    let finite = groups
        .iter()
        .flat_map(|g| &g.1)
        .copied()
        .filter(|v| v.is_finite());
    let largest = finite.fold(f64::MIN_POSITIVE, f64::max);
    let group_height = BAR * series.len() as f64 + 8.0;
    let height = 28.0 + group_height * groups.len() as f64;
    let mut svg = open(height);
    legend(&mut svg, series);
    for (at, (label, values)) in groups.iter().enumerate() {
        let top = 28.0 + group_height * at as f64;
        let middle = top + 0.5 * BAR * series.len() as f64 + 4.0;
        text(&mut svg, LEFT - 8.0, middle, "end", label);
        for (i, value) in values.iter().enumerate().filter(|(_, v)| v.is_finite()) {
            let y = top + BAR * i as f64;
            let length = (WIDTH - LEFT - 110.0) * value / largest;
            let color = COLORS[i % COLORS.len()];
            // Writing to a string does not fail, here and below.
            let _ = write!(
                svg,
                r#"<rect x="{LEFT}" y="{y:.1}" width="{length:.1}" height="{}" fill="{color}"/>"#,
                BAR - 2.0
            );
            let shown = format!("{} {unit}", short(*value));
            text(
                &mut svg,
                LEFT + length + 4.0,
                y + 10.0,
                "start",
                shown.trim(),
            );
        }
    }
    svg + "</svg>\n"
}

/// Points joined by lines, on logarithmic axes; coordinates are above 0. `dashed`: a line between two points to compare with.
pub(crate) fn line(
    points: &[[f64; 2]],
    dashed: Option<[[f64; 2]; 2]>,
    x_label: &str,
    y_label: &str,
) -> String {
    const HEIGHT: f64 = 340.0;
    const LEFT: f64 = 60.0;
    const TOP: f64 = 40.0;
    const RIGHT: f64 = WIDTH - 90.0;
    const BOTTOM: f64 = HEIGHT - 50.0;
    // Where a coordinate lies between the smallest and the largest.
    let share = |axis: usize, value: f64| {
        let values = || {
            let all = points.iter().chain(dashed.iter().flatten());
            all.map(|p| p[axis].ln())
        };
        let low = values().fold(f64::INFINITY, f64::min);
        let high = values().fold(f64::NEG_INFINITY, f64::max);
        (value.ln() - low) / (high - low).max(f64::MIN_POSITIVE)
    };
    let place = |p: &[f64; 2]| {
        let x = LEFT + 20.0 + (RIGHT - LEFT - 20.0) * share(0, p[0]);
        [x, BOTTOM - 20.0 - (BOTTOM - TOP - 20.0) * share(1, p[1])]
    };
    let mut svg = open(HEIGHT);
    let _ = write!(
        svg,
        r##"<path d="M{LEFT} {TOP}V{BOTTOM}H{RIGHT}" stroke="#888" fill="none"/>"##
    );
    let path = |points: &[[f64; 2]]| {
        let places = points.iter().map(place);
        let written: Vec<String> = places
            .map(|p| p.map(|c| format!("{c:.1}")).join(","))
            .collect();
        written.join(" ")
    };
    let color = COLORS[0];
    let _ = write!(
        svg,
        r#"<polyline points="{}" stroke="{color}" stroke-width="2" fill="none"/>"#,
        path(points)
    );
    if let Some(ends) = dashed {
        let _ = write!(
            svg,
            r##"<polyline points="{}" stroke="#888" stroke-dasharray="5 4" fill="none"/>"##,
            path(&ends)
        );
    }
    for p in points {
        let [x, y] = place(p);
        let _ = write!(
            svg,
            r#"<circle cx="{x:.1}" cy="{y:.1}" r="4" fill="{color}"/>"#
        );
        let label = format!("{}: {}", short(p[0]), short(p[1]));
        text(&mut svg, x + 6.0, y - 6.0, "start", &label);
    }
    text(&mut svg, 0.5 * WIDTH, HEIGHT - 12.0, "middle", x_label);
    text(&mut svg, LEFT, 16.0, "start", y_label);
    svg + "</svg>\n"
}

/// Three digits that count, or all before the point.
fn short(value: f64) -> String {
    match value {
        ..10.0 => format!("{value:.2}"),
        ..100.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

fn open(height: f64) -> String {
    format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height:.0}" width="{WIDTH}" height="{height:.0}" font-family="sans-serif" font-size="11">"#
    )
}

fn legend(svg: &mut String, series: &[&str]) {
    for (i, name) in series.iter().enumerate() {
        let x = LEFT + 170.0 * i as f64;
        let color = COLORS[i % COLORS.len()];
        let _ = write!(
            svg,
            r#"<rect x="{x}" y="4" width="12" height="12" fill="{color}"/>"#
        );
        text(svg, x + 16.0, 14.0, "start", name);
    }
}

fn text(svg: &mut String, x: f64, y: f64, anchor: &str, text: &str) {
    let _ = write!(
        svg,
        r##"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" fill="#222">{}</text>"##,
        escaped(text)
    );
}

/// For the body of a page.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
