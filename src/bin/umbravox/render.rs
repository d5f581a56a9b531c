//! `umbravox render`.

use std::path::PathBuf;

use umbravox::headless::{Headless, Session};
use umbravox::output::{self, Target};
use umbravox::scene::Scene;
use umbravox::{Error, Result};

use crate::args::RenderArgs;
use crate::series::Series;
use crate::{check_validation, input, progress, stats_of, terminal};

pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    let outputs = Outputs::check(&args.outputs)?;
    let scene = input::read_scene(&args.input)?;
    let mut places = Vec::new();
    for path in args.outputs.iter().chain(&args.stats) {
        let place = input::check_output(path, &args.input, &scene)?;
        if places.contains(&place) {
            return Err(Error::invalid(
                path.display().to_string(),
                "is given twice; give each output once",
            ));
        }
        places.push(place);
    }
    let (scene, volume) = input::load(&args.input, scene)?;
    let headless = Headless::new(&args.device.options())?;
    let mut session = headless.load(volume, &scene)?;
    outputs.render(&mut session, &scene)?;
    check_validation(&headless)?;
    if let Some(path) = &args.stats {
        let stats = terminal::to_json(&stats_of(&mut session)?, &path.display().to_string())?;
        output::write_bytes(path, (stats + "\n").as_bytes())?;
    }
    Ok(())
}

/// Pictures to write, checked.
struct Outputs {
    /// Of the complete light.
    pictures: Vec<Target>,
    /// One picture after each direction of light.
    series: Vec<Series>,
}

impl Outputs {
    fn check(paths: &[PathBuf]) -> Result<Self> {
        let mut outputs = Self {
            pictures: Vec::new(),
            series: Vec::new(),
        };
        for path in paths {
            let target = Target::new(path)?;
            match Series::parse(path) {
                Some(series) => outputs.series.push(series),
                None => outputs.pictures.push(target),
            }
        }
        Ok(outputs)
    }

    fn render(&self, session: &mut Session, scene: &Scene) -> Result<()> {
        let provenance = provenance(scene);
        let write_series = |session: &mut Session, number: u32| {
            if self.series.is_empty() {
                return Ok(());
            }
            let picture = session.frame()?;
            self.series.iter().try_for_each(|series| {
                output::write(&series.path(number), &picture, &scene.image, &provenance)
            })
        };
        if session.light_rays() == 0 {
            write_series(session, 0)?;
        }
        progress::complete_light(session, |session, traced| write_series(session, traced - 1))?;
        if self.pictures.is_empty() {
            return Ok(());
        }
        let picture = session.frame()?;
        self.pictures
            .iter()
            .try_for_each(|target| target.write(&picture, &scene.image, &provenance))
    }
}

/// What it takes to make the picture again.
fn provenance(scene: &Scene) -> Vec<(&'static str, String)> {
    let software = concat!("umbravox ", env!("CARGO_PKG_VERSION"));
    let mut provenance = vec![
        ("Software", software.to_owned()),
        ("Source", scene.volume.path.display().to_string()),
    ];
    // A volume path that is not UTF-8 cannot stand in JSON.
    if let Ok(scene) = serde_json::to_string(scene) {
        provenance.push(("Scene", scene));
    }
    provenance
}
