//! Every preset is drawn as the reference draws it, white where it is hot and black where nothing is.

use energywave::image::ImageSize;
use energywave::scene::{Antialias, Preset};
use energywave::{RadianceImage, Renderer, Scene, reference};

use crate::common::{self, difference, renderer};

/// Small: paths and their layers are slow in the reference.
const SIZE: ImageSize = ImageSize {
    width: 32,
    height: 18,
};
/// Linear light that no screen shows.
const LEAST_LIGHT: f32 = 1e-6;
/// How far chords may be off curved paths, world units.
const FLATNESS: f64 = 5e-5;
/// What is looked at as pictures.
const LARGER: ImageSize = ImageSize {
    width: 160,
    height: 90,
};
/// The least of the three channels of what an eye takes for white, and the largest of what it takes for black.
const WHITE: u8 = 215;
const BLACK: u8 = 6;

fn scenes() -> impl Iterator<Item = (&'static str, Scene)> {
    Preset::ALL.iter().map(|preset| {
        let mut scene = Scene::from_toml(preset.text).unwrap();
        scene.image = SIZE;
        scene.integration.antialias = Antialias::None;
        scene.integration.absolute_tolerance = 0.0;
        // Of so few pixels a hundredth is much of a thin core; 1080 rows have chords as short as these.
        for path in scene.paths.iter_mut() {
            path.flatness = Some(FLATNESS);
        }
        (preset.name, scene)
    })
}

/// Returns an image with a light over all of it, so that what is far darker counts by that: the last of a Gaussian.
fn lit(mut image: RadianceImage) -> RadianceImage {
    image
        .as_mut_slice()
        .iter_mut()
        .for_each(|value| *value += LEAST_LIGHT);
    image
}

/// Finds a white core, a coloured halo and a border that is mostly black.
fn is_a_picture(renderer: &mut Renderer, name: &str, scene: &Scene) {
    let mut scene = scene.clone();
    scene.image = LARGER;
    let picture = renderer.render(&scene).unwrap().tone_map(&scene.display);
    let row = LARGER.width as usize;
    let pixels: Vec<[u8; 3]> = picture
        .as_slice()
        .chunks_exact(3)
        .map(|p| [p[0], p[1], p[2]])
        .collect();
    let least = |pixel: &[u8; 3]| pixel.iter().copied().min().unwrap_or(0);
    let most = |pixel: &[u8; 3]| pixel.iter().copied().max().unwrap_or(0);
    let white = pixels.iter().filter(|pixel| least(pixel) >= WHITE).count();
    let coloured = pixels
        .iter()
        .filter(|pixel| most(pixel) - least(pixel) > 80)
        .count();
    let at_border = |i: &usize| {
        i.is_multiple_of(row) || i % row == row - 1 || *i < row || *i >= pixels.len() - row
    };
    let border: Vec<usize> = (0..pixels.len()).filter(at_border).collect();
    let black = border
        .iter()
        .filter(|i| most(&pixels[**i]) <= BLACK)
        .count();
    println!(
        "{name}: {white} white, {coloured} coloured, {black} of {} black",
        border.len()
    );
    assert!(
        white > 0 && coloured > 20 && 2 * black > border.len(),
        "{name}"
    );
}

// One test, so that the programs of all these kinds are compiled once.
#[test]
fn every_preset_is_drawn_as_the_reference_draws_it_and_is_a_picture() {
    let mut renderer = renderer(common::device().lanes, "");
    for (name, scene) in scenes() {
        is_a_picture(&mut renderer, name, &scene);
        let tolerance = common::tolerance(&scene);
        let truth = lit(reference::render(&scene).unwrap());
        let found = difference(&lit(renderer.render(&scene).unwrap()), &truth);
        println!("{name}: {found:?}");
        // Of so few pixels none may miss ten times the tolerance.
        assert!(
            found.max <= 10.0 * tolerance && found.rms <= tolerance,
            "{name}: {found:?}"
        );
        // Not whatever is drawn passes: here the camera sees one percent more.
        let mut other = scene.clone();
        other.camera.fov_y *= 1.01;
        let off = difference(&lit(renderer.render(&other).unwrap()), &truth);
        assert!(off.max > 10.0 * tolerance, "{name}: {off:?}");
    }
}
