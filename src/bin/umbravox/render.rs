//! `umbravox render`.

use std::path::PathBuf;
use std::sync::Arc;

use umbravox::headless::{Provenance, Session};
use umbravox::output::{self, Backdrop, Target};
use umbravox::scene::Scene;
use umbravox::volume::Volume;
use umbravox::{Error, Result};

use crate::args::{InputArgs, RenderArgs, RenderInput};
use crate::series::Series;
use crate::{check_validation, input, progress, stats_of, terminal};

pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    let outputs = Outputs::check(&args.outputs)?;
    let mut job = Job::read(args.input.resolve())?;
    if let Some(path) = &args.input.volume {
        if job.recorded().is_none() {
            let message = "goes with --reproduce; use --set volume.path=PATH with a scene";
            return Err(Error::invalid("--volume", message));
        }
        job.scene.volume.path = path.clone();
        job.scene.volume.procedural = None;
    }
    let mut places = Vec::new();
    for path in args.outputs.iter().chain(&args.stats) {
        let place = input::check_output(path, &job.path, &job.scene)?;
        if places.contains(&place) {
            return Err(Error::invalid(
                path.display().to_string(),
                "is given twice; give each output once",
            ));
        }
        places.push(place);
    }
    let (headless, (volume, backdrop)) = input::beside_device(&args.device.options(), || {
        let volume = job.load()?;
        Ok((volume, Backdrop::of(&job.scene.image)?))
    })?;
    let mut session = headless.load(volume, &job.scene)?;
    outputs.render(&mut session, &job, &backdrop)?;
    check_validation(&headless)?;
    if let Some(path) = &args.stats {
        let stats = terminal::to_json(&stats_of(&mut session)?, &path.display().to_string())?;
        output::write_bytes(path, (stats + "\n").as_bytes())?;
    }
    Ok(())
}

/// What is to be rendered.
struct Job {
    /// The file named on the command line.
    path: PathBuf,
    scene: Scene,
    input: Input,
}

enum Input {
    /// A scene or volume.
    Named(InputArgs),
    /// What a picture that is rendered again says of its origin.
    Recorded(Box<Provenance>),
}

impl Job {
    fn read(input: RenderInput) -> Result<Self> {
        Ok(match input {
            RenderInput::Scene(args) => Self {
                path: args.path.clone(),
                scene: input::read_scene(&args)?,
                input: Input::Named(args),
            },
            RenderInput::Picture(path) => {
                let entries = output::read_provenance(&path)?;
                let recorded = Provenance::from_entries(&entries, &path.display().to_string())?;
                Self {
                    path,
                    scene: recorded.scene.clone(),
                    input: Input::Recorded(Box::new(recorded)),
                }
            }
        })
    }

    fn recorded(&self) -> Option<&Provenance> {
        match &self.input {
            Input::Named(_) => None,
            Input::Recorded(recorded) => Some(recorded),
        }
    }

    /// Reads the volume, and completes the scene where it depends on what that holds. Refuses other data than a picture
    /// was rendered from.
    fn load(&mut self) -> Result<Arc<Volume>> {
        let recorded = match &self.input {
            Input::Named(args) => {
                let (scene, volume) = input::load(args, self.scene.clone())?;
                self.scene = scene;
                return Ok(volume);
            }
            Input::Recorded(recorded) => recorded,
        };
        let volume = input::read_volume(&self.scene)?;
        let found = volume.fingerprint();
        if found == recorded.data {
            return Ok(volume);
        }
        Err(Error::invalid(
            self.path.display().to_string(),
            format!(
                "was rendered from data {}, but {} holds data {found}; give the data with --volume",
                recorded.data,
                self.scene.volume.name()
            ),
        ))
    }

    /// Where pictures of a session come from, as their files say it.
    fn provenance(&self, session: &Session) -> Result<Provenance> {
        let mut provenance = session.provenance(&self.scene);
        match self.recorded() {
            Some(recorded) => provenance.scene = recorded.scene.clone(),
            None => {
                // A file says the same, and finds its data, wherever the program was started.
                let scene = &mut provenance.scene;
                let labels = scene.volume.labels.iter_mut().map(|l| &mut l.path);
                let is_file = scene.volume.procedural.is_none();
                let volume = is_file.then_some(&mut scene.volume.path);
                let files = volume.into_iter().chain(labels);
                let map = scene.lighting.environment.iter_mut();
                let map = map.filter_map(|environment| environment.path.as_mut());
                let files = files.chain(map).chain(&mut scene.image.background_image);
                for path in files.chain(&mut scene.transfer_function.file) {
                    *path = std::path::absolute(&*path).map_err(|e| Error::io(&*path, e))?;
                }
            }
        }
        Ok(provenance)
    }

    /// Directions of light to trace: all, or as many as were recorded.
    fn light_directions(&self, session: &Session) -> u32 {
        let recorded = self.recorded().map(|r| r.light_directions);
        recorded.unwrap_or(u32::MAX).min(session.light_rays())
    }
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

    fn render(&self, session: &mut Session, job: &Job, backdrop: &Backdrop) -> Result<()> {
        let origin = job.provenance(session)?;
        let after = |directions: u32| Provenance {
            light_directions: directions,
            ..origin.clone()
        };
        let image = &job.scene.image;
        let write_series = |session: &mut Session, number: u32, directions: u32| {
            if self.series.is_empty() {
                return Ok(());
            }
            let picture = session.frame()?;
            let entries = after(directions).entries();
            self.series.iter().try_for_each(|series| {
                let target = Target::new(series.path(number))?;
                target.write_over(backdrop, &picture, image, &entries)
            })
        };
        let directions = job.light_directions(session);
        if directions == 0 {
            write_series(session, 0, 0)?;
        }
        progress::trace_light(session, directions, |session, traced| {
            write_series(session, traced - 1, traced)
        })?;
        let now = after(directions);
        if let Some(recorded) = job.recorded() {
            for difference in recorded.differences(&now) {
                terminal::warn(&format!("not as it was recorded: {difference}"));
            }
        }
        if self.pictures.is_empty() {
            return Ok(());
        }
        let picture = session.frame()?;
        let entries = now.entries();
        self.pictures
            .iter()
            .try_for_each(|target| target.write_over(backdrop, &picture, image, &entries))
    }
}
