//! `energywave figures`: the papers' figures into a folder, and a page that shows each beside its caption.

use std::time::Instant;

use energywave::image::ImageFile;
use energywave::papers::Figure;
use energywave::{Error, Renderer, TextFile, shown};

use super::progress::{Progress, catch_interrupts, was_interrupted};
use super::subcommands::FiguresArguments;
use super::{Outcome, choose_devices, names, note};

const PAGE: &str = "index.html";

pub fn run(arguments: &FiguresArguments) -> Outcome {
    let folder = &arguments.output;
    if folder.is_file() {
        let reason = "it is a file; the pictures need a folder";
        return Err(Error::output(folder, reason).into());
    }
    std::fs::create_dir_all(folder)
        .map_err(|error| Error::output(folder, error.to_string()).caused_by(error))?;
    // All are known to be writable before the work.
    let page = TextFile::create(folder.join(PAGE))?;
    let picture = |figure: &Figure| ImageFile::create(folder.join(file_name(figure)));
    let pictures = Figure::ALL.iter().map(picture);
    let pictures = pictures.collect::<Result<Vec<_>, _>>()?;
    catch_interrupts();
    let devices = choose_devices(arguments.device.device.as_deref())?;
    let begun = Instant::now();
    let mut progress = Progress::new();
    let mut renderer = Renderer::on_devices(&devices, &arguments.device.options())?;
    let count = Figure::ALL.len();
    for (number, (figure, picture)) in Figure::ALL.iter().zip(pictures).enumerate() {
        let scene = figure.scene(arguments.size)?;
        let image = renderer.render_with_progress(&scene, &mut |share| {
            progress.report((number as f32 + share) / count as f32)
        })?;
        if was_interrupted() {
            return Err(Error::Interrupted.into());
        }
        picture.write(&image, &scene.display)?;
    }
    drop(progress);
    let device = names(&devices);
    page.write(&html(&device))?;
    note(&format!(
        "drawn: {count} figures in {:.2} s on {device}; {} shows them with their captions",
        begun.elapsed().as_secs_f64(),
        shown(&folder.join(PAGE).to_string_lossy())
    ));
    Ok(())
}

fn file_name(figure: &Figure) -> String {
    format!("{}.png", figure.name)
}

/// Lays the figures out on a dark page that needs no other file.
fn html(device: &str) -> String {
    let mut page = "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>The papers' figures</title>\n\
         <style>\nbody { background: #111; color: #ccc; font: 16px/1.5 sans-serif; }\n\
         body { max-width: 72em; margin: 2em auto; }\n\
         figure { display: flex; gap: 1.5em; align-items: center; margin: 1.5em; }\nimg { max-width: 60%; }\n</style>\n\
         <h1>The papers' figures</h1>\n"
        .to_owned();
    for figure in Figure::ALL {
        let (name, caption) = (file_name(figure), escaped(&figure.caption()));
        page += &format!(
            "<figure><img src=\"{name}\" alt=\"{}\"><figcaption>{caption}</figcaption></figure>\n",
            figure.name
        );
    }
    page + &format!(
        "<p>Drawn by energywave {} on {}.</p>\n</html>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(device)
    )
}

/// Returns a text as HTML has it.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
