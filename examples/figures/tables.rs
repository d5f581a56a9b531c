//! The measurements behind Fig. 5, 6 and 7, on the CT of the demo.

use std::path::Path;
use std::process::Command;

use umbravox::headless::Headless;
use umbravox::picture::Picture;
use umbravox::renderer::Settings;
use umbravox::scene::{ColorManagement, Image, Override, Scene};
use umbravox::{Error, Result, output};

use crate::difference::Difference;
use crate::{Loaded, load, picture};

const SCENE: &str = "examples/aorta.json";
/// Ambient occlusion alone, at the size of the error pictures.
const OVERRIDES: [&str; 2] = ["image.size=[256,256]", "lighting.shading=none"];
/// What stands around the tables.
const TEMPLATE: &str = include_str!("results.md.in");

/// Data reductions of Fig. 5 and 6.
const REDUCTIONS: [f64; 7] = [1.0, 2.0, 4.0, 8.5, 15.7, 31.4, 92.8];
const TIMED_ROUNDS: u32 = 3;
const TIMED_RAYS: u32 = 3;
/// What others are compared with in Fig. 6, and what Fig. 7 is drawn at.
const BASE_REDUCTION: f64 = 8.5;
/// Mean error that the paper states for a reduction, percent.
const PAPER_REDUCTIONS: [(f64, f64); 3] = [(15.7, 0.6), (31.4, 1.2), (92.8, 1.6)];
const BASE_RAYS: u32 = 128;
/// Mean error that the paper states for a number of directions, percent.
const PAPER_RAYS: [(u32, f64); 3] = [(64, 0.3), (16, 0.7), (8, 0.9)];
/// Difference shown white in the error pictures, percent.
const WHITE: f64 = 20.0;

/// Measures, and writes the tables to `results` and the error pictures into `folder`.
///
/// # Errors
/// When the scene or the device fails, or a file cannot be written.
pub(crate) fn measure(headless: &Headless, folder: &Path, results: &Path) -> Result<()> {
    let overrides = OVERRIDES
        .iter()
        .map(|text| Override::parse(text))
        .collect::<Result<Vec<_>>>()?;
    let scene = Scene::read(Path::new(SCENE), &overrides)?;
    let mut bench = Bench {
        loaded: load(headless, &scene)?,
        scene,
        folder,
    };
    let reduced = bench.by_reduction()?;
    let device = headless.device();
    let text = TEMPLATE
        .replace(
            "{{device}}",
            &format!("{} ({})", device.name, device.driver),
        )
        .replace("{{date}}", &today())
        .replace("{{size}}", &format!("{:?}", bench.loaded.volume.size()))
        .replace("{{fig5}}", &bench.fig5()?)
        .replace("{{fig6}}", &bench.fig6(&reduced)?)
        .replace("{{fig7}}", &bench.fig7()?);
    output::write_bytes(results, text.as_bytes())?;
    println!("{}", results.display());
    Ok(())
}

/// A picture at a data reduction.
struct Reduced {
    asked: f64,
    reached: f64,
    picture: Picture,
}

/// What a direction of light takes at a data reduction.
#[derive(Clone, Copy)]
struct Timed {
    reached: f64,
    voxels: u64,
    ms_per_ray: f64,
}

struct Bench<'a> {
    loaded: Loaded,
    scene: Scene,
    folder: &'a Path,
}

impl Bench<'_> {
    fn render(&mut self, data_reduction: f64, rays: Option<u32>) -> Result<Reduced> {
        let mut scene = self.scene.clone();
        scene.storage.data_reduction = data_reduction;
        if let (Some(rays), Some(ao)) = (rays, &mut scene.ambient_occlusion) {
            ao.rays = rays;
        }
        let Loaded { volume, session } = &mut self.loaded;
        session.set_settings(Settings::of_scene(&scene, volume)?)?;
        let picture = picture(session)?;
        Ok(Reduced {
            asked: data_reduction,
            reached: session.stats()?.data_reduction,
            picture,
        })
    }

    /// Traces a few directions anew. The levels must differ from those before.
    fn time(&mut self, data_reduction: f64, skipping: bool) -> Result<Timed> {
        let mut scene = self.scene.clone();
        scene.storage.data_reduction = data_reduction;
        scene.march.empty_space_skipping = skipping;
        let Loaded { volume, session } = &mut self.loaded;
        session.set_settings(Settings::of_scene(&scene, volume)?)?;
        for _ in 0..TIMED_RAYS {
            session.refine_light()?;
        }
        let stats = session.stats()?;
        let light = stats
            .lao
            .ok_or_else(|| Error::invalid(SCENE, "has no ambient occlusion to measure"))?;
        Ok(Timed {
            reached: stats.data_reduction,
            voxels: light.voxels,
            ms_per_ray: light.ms_per_ray,
        })
    }

    /// Time by data reduction, with and without leaps over empty space. Of several rounds the fastest counts, the
    /// one that other work on the machine disturbed least.
    fn fig5(&mut self) -> Result<String> {
        let mut fastest: [Vec<Timed>; 2] = [Vec::new(), Vec::new()];
        for _ in 0..TIMED_ROUNDS {
            for (skipping, fastest) in [false, true].into_iter().zip(&mut fastest) {
                for (at, reduction) in REDUCTIONS.into_iter().enumerate() {
                    let timed = self.time(reduction, skipping)?;
                    match fastest.get_mut(at) {
                        Some(best) if best.ms_per_ray > timed.ms_per_ray => *best = timed,
                        Some(_) => {}
                        None => fastest.push(timed),
                    }
                }
            }
        }
        let mut table = "| data reduction | lit voxels | ms a ray | faster than 1 : 1 | \
                         ms a ray with skipping | faster than 1 : 1 |\n\
                         | --: | --: | --: | --: | --: | --: |\n"
            .to_owned();
        let [plain, skipping] = &fastest;
        for (plain_at, skipping_at) in plain.iter().zip(skipping) {
            table += &format!(
                "| {:.1} : 1 | {} | {:.1} | {:.1} | {:.1} | {:.1} |\n",
                plain_at.reached,
                plain_at.voxels,
                plain_at.ms_per_ray,
                plain[0].ms_per_ray / plain_at.ms_per_ray,
                skipping_at.ms_per_ray,
                skipping[0].ms_per_ray / skipping_at.ms_per_ray,
            );
        }
        Ok(table)
    }

    /// Pictures at every data reduction.
    fn by_reduction(&mut self) -> Result<Vec<Reduced>> {
        REDUCTIONS
            .iter()
            .map(|&reduction| self.render(reduction, None))
            .collect()
    }

    /// Error by data reduction.
    fn fig6(&self, reduced: &[Reduced]) -> Result<String> {
        let Some(base) = reduced.iter().find(|r| r.asked == BASE_REDUCTION) else {
            return Ok(String::new());
        };
        let image = &self.scene.image;
        let mut table = "| data reduction | paper | mean, covered pixels | mean, all pixels | \
                         covered, against 1 : 1 |\n| --: | --: | --: | --: | --: |\n"
            .to_owned();
        self.write("fig6_base", &base.picture, image)?;
        for r in &reduced[1..] {
            let absolute = Difference::new(&reduced[0].picture, &r.picture, image);
            let mut columns = " | | ".to_owned();
            if r.asked > BASE_REDUCTION {
                let error = Difference::new(&base.picture, &r.picture, image);
                let paper = PAPER_REDUCTIONS.iter().find(|(asked, _)| *asked == r.asked);
                columns = format!(
                    "{} | {:.2} % | {:.2} %",
                    paper.map_or(String::new(), |(_, e)| format!("{e:.1} %")),
                    error.mean_covered,
                    error.mean
                );
                self.write_error(&format!("fig6_error_{:.0}", r.asked), &error)?;
            }
            table += &format!(
                "| {:.1} : 1 | {columns} | {:.2} % |\n",
                r.reached, absolute.mean_covered
            );
        }
        Ok(table)
    }

    /// Error by number of directions.
    fn fig7(&mut self) -> Result<String> {
        let base = self.render(BASE_REDUCTION, Some(BASE_RAYS))?;
        let image = self.scene.image.clone();
        self.write("fig7_base", &base.picture, &image)?;
        let mut table = "| directions | paper | mean, covered pixels | mean, all pixels |\n\
                         | --: | --: | --: | --: |\n"
            .to_owned();
        for (rays, paper) in PAPER_RAYS {
            let few = self.render(BASE_REDUCTION, Some(rays))?;
            let error = Difference::new(&base.picture, &few.picture, &image);
            table += &format!(
                "| {rays} | {paper:.1} % | {:.2} % | {:.2} % |\n",
                error.mean_covered, error.mean
            );
            self.write_error(&format!("fig7_error_{rays}"), &error)?;
        }
        Ok(table)
    }

    fn write_error(&self, name: &str, error: &Difference) -> Result<()> {
        // Shades stand for percentages, not for light.
        let image = Image {
            color_management: ColorManagement::None,
            ..self.scene.image.clone()
        };
        self.write(name, &error.picture(image.size, WHITE), &image)
    }

    fn write(&self, name: &str, picture: &Picture, image: &Image) -> Result<()> {
        let path = self.folder.join(format!("{name}.png"));
        output::write(&path, picture, image, &[])
    }
}

/// The day, as `2026-01-31`.
fn today() -> String {
    let output = Command::new("date").arg("+%F").output();
    output.map_or("an unknown day".to_owned(), |o| {
        String::from_utf8_lossy(&o.stdout).trim().to_owned()
    })
}
