//! What stratified stochastic sampling (Cook 1986) gains where the paper of 2015, section 5.4, asks for it: the torus
//! of its figure 14 by Simpson's rule, and by as many jittered samples, beside the integral itself. Prints the relative
//! errors of the pixels, a root of mean squares, and of their means over 5x5 pixels, which is what an eye sees from
//! farther off; writes `figure-14-jittered.png` into the folder given.
//!
//! `cargo run --release --example jittered -- FOLDER`

use std::path::PathBuf;

use energywave::image::compare;
use energywave::scene::{Antialias, Method};
use energywave::{Device, Error, RadianceImage, Renderer, Scene};

fn main() -> energywave::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_default());
    let mut scene = Scene::from_toml(include_str!("../scenes/figure-14.toml"))?;
    let mut renderer = Renderer::new(&Device::best()?)?;
    let mut draw = |method| {
        scene.integration.method = method;
        scene.integration.antialias = Antialias::None;
        renderer.render(&scene)
    };
    let truth = draw(Method::exact(1e-5))?;
    let blurred_truth = blurred(&truth)?;
    println!("method    divisions   pixels  5x5 means");
    for divisions in [64, 200] {
        let seed = 0;
        for method in [
            Method::Simpson { divisions },
            Method::Jittered { divisions, seed },
        ] {
            let image = draw(method)?;
            let name = method.name();
            let of_pixels = rms(&image, &truth)?;
            let of_means = rms(&blurred(&image)?, &blurred_truth)?;
            println!("{name:<9} {divisions:>9} {of_pixels:>8.1e} {of_means:>10.1e}");
        }
    }
    let seed = 0;
    let image = draw(Method::Jittered {
        divisions: 64,
        seed,
    })?;
    image.save(folder.join("figure-14-jittered.png"), &scene.display)
}

/// Returns the root of the mean square of the pixels' relative differences.
fn rms(image: &RadianceImage, truth: &RadianceImage) -> energywave::Result<f64> {
    let difference = compare(image, truth);
    let sizes_differ = || Error::Unsupported("the truth has another size".to_owned());
    Ok(difference.ok_or_else(sizes_differ)?.rms)
}

/// Returns the mean of the 5x5 pixels around each pixel, of those that the image has.
fn blurred(image: &RadianceImage) -> energywave::Result<RadianceImage> {
    let mut means = RadianceImage::new(image.size())?;
    let width = image.size().width as i64;
    for (index, mean) in means.as_mut_slice().chunks_exact_mut(4).enumerate() {
        let (column, row) = (index as i64 % width, index as i64 / width);
        let places = (-2..=2).flat_map(|y| (-2..=2).map(move |x| (column + x, row + y)));
        let inside =
            places.filter_map(|(x, y)| image.pixel(x.try_into().ok()?, y.try_into().ok()?));
        let (mut sum, mut count) = ([0.0; 4], 0.0);
        for pixel in inside {
            sum.iter_mut()
                .zip(pixel)
                .for_each(|(sum, value)| *sum += f64::from(value));
            count += 1.0;
        }
        mean.iter_mut()
            .zip(sum)
            .for_each(|(mean, sum)| *mean = (sum / count) as f32);
    }
    Ok(means)
}
