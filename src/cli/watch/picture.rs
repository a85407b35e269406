//! The pictures of a scene whose file changes.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use energywave::image::{Exposure, ImageFormat};
use energywave::scene::{AnimatedScene, MethodKeys};
use energywave::{Device, Error, ErrorKind, RadianceImage, Renderer, Scene};

use super::WatchArguments;
use super::changes::{Changes, is_one_of};
use crate::cli::progress::was_interrupted;
use crate::cli::{choose_devices, note, warn_all};

/// A file that cannot be read may be half written: for so long it is tried again.
const PATIENCE: Duration = Duration::from_millis(200);
const STEP: Duration = Duration::from_millis(20);

/// What draws a scene, whose file may change.
pub struct Pictures {
    pub arguments: WatchArguments,
    pub changes: Changes,
    pub devices: Vec<Device>,
    renderer: Renderer,
    /// As it was read last.
    moving: Option<AnimatedScene>,
    /// The warnings that were told last.
    warned: Vec<String>,
}

/// A picture, and the scene that it shows.
pub struct Picture {
    pub light: RadianceImage,
    pub scene: Scene,
    /// At how many it was drawn.
    pub moments: u32,
}

/// Changes a scene that was read.
pub type Change<'a> = &'a dyn Fn(&mut Scene);

impl Pictures {
    /// Opens a device; the scene's file must be there, and the output be no file that is watched.
    pub fn open(arguments: WatchArguments) -> Result<Self, crate::cli::Failure> {
        let mut files = vec![arguments.scene.clone()];
        files.extend(arguments.overrides.depth.clone());
        let changes = Changes::of(&files)?;
        match AnimatedScene::from_file(&arguments.scene) {
            Ok(scene) => files.extend(scene.files().into_iter().chain(scene.slices())),
            Err(error) if error.kind() == ErrorKind::Input => return Err(error.into()),
            Err(_) => {} // which is told when it is to be drawn
        }
        if let Some(output) = &arguments.output {
            refuse_output(output, &files)?;
        }
        let devices = choose_devices(arguments.device.device.as_deref())?;
        let renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
        Ok(Self {
            changes,
            devices,
            renderer,
            moving: None,
            warned: Vec::new(),
            arguments,
        })
    }

    /// Returns the scene as it was read last.
    #[cfg(feature = "window")]
    pub fn moving(&self) -> Option<&AnimatedScene> {
        self.moving.as_ref()
    }

    /// Takes a change, reads the file and draws it; again for a while where it cannot be read.
    pub fn draw_change(
        &mut self,
        time: f64,
        format: Option<ImageFormat>,
    ) -> Result<Picture, Error> {
        let mut begun = Instant::now();
        loop {
            if self.changes.are_there() {
                self.changes.take();
                begun = Instant::now();
            }
            let nothing = &mut |_: f32| ControlFlow::Continue(());
            let drawn = self
                .read()
                .and_then(|()| self.draw(time, format, &|_| {}, nothing));
            match drawn {
                Err(Error::Interrupted) if !was_interrupted() => {}
                Err(error) if is_of_file(&error) && begun.elapsed() < PATIENCE => {
                    self.changes.wait(STEP);
                }
                drawn => return drawn,
            }
        }
    }

    /// Reads the file; what was read before stays where it has a fault.
    pub fn read(&mut self) -> Result<(), Error> {
        self.arguments.overrides.opened_depth.forget();
        let moving = AnimatedScene::from_file(&self.arguments.scene)?;
        self.changes.add(&moving.files())?;
        self.changes.add(&moving.slices())?;
        self.moving = Some(moving);
        Ok(())
    }

    /// Draws the scene at a time as `change` makes it; another change of the file stops it.
    pub fn draw(
        &mut self,
        time: f64,
        format: Option<ImageFormat>,
        change: Change<'_>,
        progress: &mut dyn FnMut(f32) -> ControlFlow<()>,
    ) -> Result<Picture, Error> {
        let Self {
            arguments,
            changes,
            renderer,
            moving,
            warned,
            ..
        } = self;
        let Some(moving) = moving else {
            return Err(Error::Interrupted);
        };
        let adjust = |scene: &mut Scene, keys: &MethodKeys| {
            arguments.overrides.apply(scene, keys)?;
            format.map_or(Ok(()), |format| format.check(&scene.display))
        };
        let (mut scene, warnings) = moving.at_with_warnings(time, adjust)?;
        let words: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        if words != *warned {
            warn_all(&warnings);
            *warned = words;
        }
        change(&mut scene);
        let is_auto = scene.display.exposure == Exposure::Auto;
        renderer.spread_bloom(!is_auto);
        let is_stopped = Cell::new(false);
        let progress = &mut |share: f32| {
            is_stopped.set(is_stopped.get() || was_interrupted() || changes.are_there());
            match is_stopped.get() {
                true => ControlFlow::Break(()),
                false => progress(share),
            }
        };
        let blur = arguments.fps.map(|rate| moving.open_at(time, rate));
        let mut light = match blur {
            Some(times) if !times.is_empty() => {
                let scene_at = &mut |time| {
                    let mut scene = moving.at_with(time, adjust)?;
                    change(&mut scene);
                    Ok(scene)
                };
                renderer.render_mean_with_progress(times, scene_at, progress)?
            }
            _ => renderer.render_with_progress(&scene, progress)?,
        };
        if is_auto {
            let stops = light.auto_exposure();
            scene.display.exposure = stops.into();
            note(&format!("exposure: {stops:.2} stops, by auto"));
            if let Some(bloom) = &scene.display.bloom {
                renderer.bloom(&mut light, bloom)?;
            }
        }
        Ok(Picture {
            light,
            scene,
            moments: renderer.last_moments(),
        })
    }
}

/// Refuses an output whose writing would be a change.
fn refuse_output(output: &Path, files: &[PathBuf]) -> Result<(), Error> {
    let place = |file: &Path| file.canonicalize().ok();
    let is_it = |file: &PathBuf| place(file).is_some() && place(file) == place(output);
    let folder = |file: &Path| {
        place(
            file.parent()
                .filter(|it| *it != Path::new(""))
                .unwrap_or(Path::new(".")),
        )
    };
    let is_slice = |file: &PathBuf| {
        let names = file.file_name().zip(output.file_name());
        names.is_some_and(|(slices, name)| is_one_of(slices, name))
            && folder(file) == folder(output)
    };
    match files.iter().any(|file| is_it(file) || is_slice(file)) {
        true => Err(Error::output(output, "it is a file that is watched")),
        false => Ok(()),
    }
}

/// Whether something of a file is wrong, which may be half written.
pub fn is_of_file(error: &Error) -> bool {
    matches!(error.kind(), ErrorKind::Scene | ErrorKind::Input)
}
