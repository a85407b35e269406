//! Draws frames into the same memory as often as a line of the input says, and prints what each took, seconds.
//! `render_into.py` has it and Python do so in turn.
//!
//! render_into SCENE WIDTH HEIGHT
#![allow(unsafe_code)] // the environment is set before there are threads

use std::error::Error;
use std::io::{BufRead, Write, stdin, stdout};
use std::time::Instant;

use energywave::image::ImageSize;
use energywave::{Device, Renderer, Scene};

fn main() -> Result<(), Box<dyn Error>> {
    // SAFETY: no other thread runs yet.
    for warning in unsafe { energywave::suit_pocl() } {
        eprintln!("warning: {warning}");
    }
    let arguments: Vec<String> = std::env::args().collect();
    let [_, scene, width, height] = arguments.as_slice() else {
        return Err("usage: render_into SCENE WIDTH HEIGHT".into());
    };
    let mut scene = Scene::from_file(scene)?;
    scene.image = ImageSize {
        width: width.parse()?,
        height: height.parse()?,
    };
    let mut renderer = Renderer::new(&Device::best()?)?;
    let mut light = vec![0.0; 4 * scene.image.pixels()];
    for line in stdin().lock().lines() {
        let mut times = Vec::new();
        for _ in 0..line?.trim().parse::<usize>()? {
            let begun = Instant::now();
            renderer.render_into(&scene, &mut light)?;
            times.push(begun.elapsed().as_secs_f64().to_string());
        }
        println!("{}", times.join(" "));
        stdout().flush()?;
    }
    Ok(())
}
