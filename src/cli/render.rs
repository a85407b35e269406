//! `energywave render`: a scene file to an image file.

use energywave::image::{ImageFile, ImageFormat};
use energywave::{Error, Renderer, Scene};

use super::args::RenderArguments;
use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::{Outcome, choose_devices, tell_depths};

pub fn run(arguments: RenderArguments) -> Outcome {
    ImageFormat::of(&arguments.output)?;
    let overrides = &arguments.overrides;
    let scene =
        Scene::from_file_with(&arguments.scene, |scene, keys| overrides.apply(scene, keys))?;
    tell_depths(&scene, arguments.quiet);
    let devices = choose_devices(arguments.device.device.as_deref())?;
    catch_interrupts();
    let output = ImageFile::create(&arguments.output)?;
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
