//! `energywave render`: a scene file to an image file.

use energywave::image::{Output, OutputFormat};
use energywave::{Error, Renderer, Scene};

use super::args::RenderArguments;
use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::{Outcome, choose_devices};

pub fn run(arguments: RenderArguments) -> Outcome {
    OutputFormat::of(&arguments.output)?;
    let overrides = &arguments.overrides;
    let scene = Scene::from_file_with(&arguments.scene, |scene| overrides.apply(scene))?;
    let devices = choose_devices(arguments.device.device.as_deref())?;
    catch_interrupts();
    let output = Output::create(&arguments.output)?;
    let mut renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
    let mut progress = Progress::new(arguments.quiet);
    let image = renderer.render_with_progress(&scene, &mut |share| progress.report(share))?;
    drop(progress);
    if was_interrupted() {
        return Err(Error::Interrupted.into());
    }
    output.write(&image, &scene.display)?;
    Ok(())
}
